//! Limits, and files that are none.

use scene_format::{Diagnostics, Limits, Options, load};

use crate::vocabulary::{load_with, options, registry, schema};

fn codes(errors: &Diagnostics) -> Vec<&'static str> {
    errors.list.iter().map(|error| error.code).collect()
}

fn code_with(text: &str, limits: Limits) -> &'static str {
    let options = Options { limits, ..options() };
    match load_with(text, &options) {
        Ok(_) => "",
        Err(errors) => {
            assert_eq!(errors.list.len(), 1, "{errors}");
            errors.list[0].code
        }
    }
}

#[test]
fn each_limit_is_an_error() {
    let least = || Limits {
        file_bytes: 200,
        prims: 2,
        prim_depth: 2,
        opinions: 2,
        list_items: 2,
        samples: 2,
        variants: 2,
        name_bytes: 4,
        ..Limits::default()
    };
    let code = |text: &str| code_with(text, least());
    assert_eq!(
        code(r#"Layer(prims: {"/A": Def(children: {"Bcde": Def(Film: (edges: [1, 2]))})})"#),
        ""
    );
    assert_eq!(code(&format!("Layer({:200})", "")), "too-large");
    assert_eq!(
        code(r#"Layer(prims: {"/A": Def(), "/B": Def(), "/C": Def()})"#),
        "too-many-prims"
    );
    assert_eq!(code(r#"Layer(prims: {"/A/B": Def(), "/C": Def()})"#), "too-many-prims");
    assert_eq!(code(r#"Layer(prims: {"/A/B/C": Def()})"#), "too-deep");
    assert_eq!(
        code(r#"Layer(prims: {"/A": Def(Camera: (fov: 1, fstop: 2), Render: (seed: 3))})"#),
        "too-many-opinions"
    );
    assert_eq!(
        code(r#"Layer(prims: {"/A": Def(Film: (edges: [1, 2, 3]))})"#),
        "too-long"
    );
    assert_eq!(
        code(r#"Layer(prims: {"/A": Def(LightLinks: (exclude: ["/A", "/B", "/C"]))})"#),
        "too-long"
    );
    assert_eq!(
        code(r#"Layer(prims: {"/A": Def(Camera: (fov: Samples({1: 1, 2: 1, 3: 1})))})"#),
        "too-long"
    );
    assert_eq!(
        code(r#"Layer(prims: {"/A": Def(Camera: (fov: Samples({})))})"#),
        "too-long"
    );
    assert_eq!(code(r#"Layer(prims: {"/Abcde": Def()})"#), "bad-name");
}

fn nested(levels: usize) -> String {
    let mut text = String::from("Layer(prims: {\"/W\": Def(");
    for _ in 1..levels {
        text.push_str("children: {\"K\": Def(");
    }
    text.push_str("Camera: (fov: 1)");
    for _ in 1..levels {
        text.push_str(")}");
    }
    text + ")})"
}

#[test]
fn prims_nest_64_deep() {
    let scene = load_with(&nested(64), &options()).unwrap();
    assert_eq!(scene.prims.len(), 64);
    for levels in [65, 300, 20_000] {
        let errors = load_with(&nested(levels), &options()).unwrap_err();
        assert_eq!(codes(&errors), ["too-deep"], "{levels}");
    }
    let path = "/A".repeat(65);
    let errors = load_with(&format!("Layer(prims: {{\"{path}\": Def()}})"), &options()).unwrap_err();
    assert_eq!(codes(&errors), ["too-deep"]);
}

#[test]
fn endless_brackets_are_refused() {
    for bracket in ["(", "[", "{", "Some(", "Def(a:", "/*"] {
        let many = bracket.repeat(100_000);
        for text in [
            many.clone(),
            format!("Layer(prims: {many}"),
            format!("Layer(prims: {{\"/W\": Def(Film: (edges: {many}"),
            format!("Layer(prims: {{\"/W\": Def(references: {many}"),
        ] {
            assert!(load_with(&text, &options()).is_err());
        }
    }
}

#[test]
fn reports_at_most_twenty_errors() {
    let many: String = (0..30).map(|n| format!("\"/P{n}\": Def(Nothing{n}: ()),")).collect();
    let errors = load_with(&format!("Layer(prims: {{{many}}})"), &options()).unwrap_err();
    assert_eq!((errors.list.len(), errors.omitted), (20, 10));
    assert!(errors.to_string().ends_with("and 10 more\n"));
}

#[test]
fn files_that_are_none() {
    let registry = registry();
    let schema = schema(&registry);
    let folder = tempfile::tempdir().unwrap();
    let errors = |name: &str, bytes: Option<&[u8]>| {
        let path = folder.path().join(name);
        if let Some(bytes) = bytes {
            std::fs::write(&path, bytes).unwrap();
        }
        load(&path, &schema, &Options::default()).unwrap_err()
    };
    assert_eq!(codes(&errors("none.ron", None)), ["missing-file"]);
    assert_eq!(codes(&errors("", None)), ["not-a-file"]);
    assert_eq!(codes(&errors("empty.ron", Some(b""))), ["syntax"]);
    let binary = errors("binary.ron", Some(b"Layer(\n  doc: \"\xff\")"));
    assert_eq!(codes(&binary), ["not-utf-8"]);
    let place = binary.list[0].place.unwrap();
    assert_eq!(binary.sources.line_column(place), (2, 9));
    let near = errors("empt.ron", None);
    assert_eq!(near.list[0].suggestion.as_deref(), Some("empty.ron"));
    std::fs::write(folder.path().join("mark.ron"), "\u{feff}Layer()").unwrap();
    assert!(load(&folder.path().join("mark.ron"), &schema, &Options::default()).is_ok());
    #[cfg(unix)]
    assert_eq!(
        codes(&load(std::path::Path::new("/dev/null"), &schema, &Options::default()).unwrap_err()),
        ["not-a-file"]
    );
}
