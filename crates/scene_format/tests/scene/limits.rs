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

/// Gives the codes of the errors about files of which the first is `root.ron`.
fn codes_of(files: &[(&str, &str)], limits: Limits) -> Vec<&'static str> {
    let options = Options { limits, ..options() };
    let folder = crate::files::folder(files);
    match crate::files::load_in(folder.path(), &options) {
        Ok(_) => Vec::new(),
        Err(errors) => codes(&errors),
    }
}

#[test]
fn long_paths_are_refused() {
    for names in [65, 100_000] {
        let path = "/a".repeat(names);
        for text in [
            format!("Layer(prims: {{\"/W\": Def(inherits: [\"{path}\"])}})"),
            format!("Layer(prims: {{\"/W\": Def(references: [\"#{path}\"])}})"),
            format!("Layer(prims: {{\"/W\": Def(LightLinks: (exclude: [\"{path}\"]))}})"),
        ] {
            let errors = load_with(&text, &options()).unwrap_err();
            assert_eq!(codes(&errors), ["bad-path"], "{names}");
        }
    }
}

/// The deepest chain that the limits allow: each of 62 arcs targets a prim 62 names deep. Tests run on threads with
/// small stacks.
#[test]
fn arcs_and_names_nest_together() {
    let path: String = (0..62).map(|level| format!("/d{level}")).collect();
    let files: Vec<(String, String)> = (0..62)
        .map(|number| {
            let name = if number == 0 {
                "root.ron".to_owned()
            } else {
                format!("f{number}.ron")
            };
            let next = number + 1;
            let text = if next < 62 {
                format!("Layer(prims: {{\"/d0\": Def(references: [\"f{next}.ron#{path}\"])}})")
            } else {
                format!("Layer(prims: {{\"{path}\": Def(Camera: (fov: 7))}})")
            };
            // Each file has the prim that the one before targets.
            let text = text.replacen("Layer(prims: {", &format!("Layer(prims: {{\"{path}/K\": Over(), "), 1);
            (name, text)
        })
        .collect();
    let files: Vec<(&str, &str)> = files
        .iter()
        .map(|(name, text)| (name.as_str(), text.as_str()))
        .collect();
    assert_eq!(codes_of(&files, Limits::default()), [""; 0]);
}

#[test]
fn what_multiplies_through_arcs_is_bounded() {
    let small = || Limits {
        opinions: 20_000,
        work: 1_000_000,
        ..Limits::default()
    };
    // Thirteen levels that each reference the next twice.
    let doubling = |body: &str| {
        let levels: String = (0..13)
            .map(|n| format!("\"/P{n}\": Def(references: [\"#/P{next}\", \"#/Q{next}\"]), \"/Q{n}\": Def(references: [\"#/P{next}\"]),", next = n + 1))
            .collect();
        format!("Layer(prims: {{{levels} \"/P13\": Def({body}), \"/Q13\": Def()}})")
    };
    let targets: String = (0..2_000).map(|n| format!("\"/P13/T{n}\",")).collect();
    let text = doubling(&format!("LightLinks: (exclude: Edit(prepend: [{targets}]))"));
    assert_eq!(codes_of(&[("root.ron", &text)], small()), ["too-much-work"]);
    let children: String = (0..500).map(|n| format!("\"K{n}\": Def(),")).collect();
    let text = doubling(&format!("children: {{{children}}}"));
    let found = codes_of(&[("root.ron", &text)], small());
    assert!(
        matches!(found[..], ["too-much-work" | "too-many-opinions"]),
        "{found:?}"
    );
    // One field of many samples, referenced often.
    let samples: String = (0..1_000).map(|n| format!("{n}: 1,")).collect();
    let many: String = (0..100)
        .map(|n| format!("\"/R{n}\": Def(references: [\"#/A\"]),"))
        .collect();
    let text = format!("Layer(prims: {{{many} \"/A\": Def(Camera: (fov: Samples({{{samples}}})))}})");
    assert_eq!(codes_of(&[("root.ron", &text)], small()), ["too-many-opinions"]);
    // A large file below many small ones.
    let big: String = (0..1_000).map(|n| format!("\"/B{n}\": Def(),")).collect();
    let big = format!("Layer(prims: {{{big}}})");
    let mut files: Vec<(String, String)> = vec![("root.ron".into(), String::new()), ("big.ron".into(), big)];
    let mut arcs = String::new();
    for n in 0..100 {
        files.push((
            format!("f{n}.ron"),
            "Layer(sublayers: [\"big.ron\"], prims: {\"/A\": Def()})".into(),
        ));
        arcs.push_str(&format!("\"/R{n}\": Def(references: [\"f{n}.ron#/A\"]),"));
    }
    files[0].1 = format!("Layer(prims: {{{arcs}}})");
    let files: Vec<(&str, &str)> = files
        .iter()
        .map(|(name, text)| (name.as_str(), text.as_str()))
        .collect();
    assert_eq!(codes_of(&files, small()), ["too-many-opinions"]);
}

#[test]
fn warnings_are_counted_after_fifty() {
    let many: String = (0..60)
        .map(|n| format!("\"/W{n}\": Def(inherits: [\"/Nobody{n}x\"]),"))
        .collect();
    let scene = load_with(&format!("Layer(prims: {{{many}}})"), &options()).unwrap();
    assert_eq!(scene.warnings.len(), 51);
    assert_eq!(scene.warnings[50].message, "and 10 more warnings");
}

#[test]
fn a_file_of_a_gigabyte_is_refused() {
    let folder = crate::files::folder(&[("root.ron", "Layer(sublayers: [\"huge.ron\"])")]);
    let huge = std::fs::File::create(folder.path().join("huge.ron")).unwrap();
    huge.set_len(1 << 30).unwrap();
    let errors = crate::files::load_in(folder.path(), &options()).unwrap_err();
    assert_eq!(codes(&errors), ["too-large"]);
}
