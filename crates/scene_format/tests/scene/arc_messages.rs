//! Whole messages about arcs and files, one snapshot for each kind of trouble.

use insta::assert_snapshot;
use scene_format::{Limits, Options};

use crate::files::{folder, load_in, messages, messages_with, without_folder};
use crate::vocabulary::options;

#[test]
fn missing_files() {
    assert_snapshot!(messages(&[
        (
            "root.ron",
            "Layer(\n    sublayers: [\"lihgt.ron\"],\n    prims: {\"/W\": Def(references: [\"lib/ring.ron#/Ring\"])},\n)\n"
        ),
        ("light.ron", "Layer()"),
    ]));
}

#[test]
fn missing_prims() {
    assert_snapshot!(messages(&[
        (
            "root.ron",
            "Layer(prims: {\n    \"/W\": Def(references: [\"a.ron#/Rign\", \"a.ron\", \"#/Here\"]),\n})\n"
        ),
        ("a.ron", "Layer(prims: {\"/Ring\": Def(), \"/Stone\": Def()})"),
    ]));
}

#[test]
fn missing_default_prim_of_the_root() {
    assert_snapshot!(messages(&[(
        "root.ron",
        "Layer(default_prim: \"World\", prims: {\"/W\": Def()})"
    )]));
}

#[test]
fn an_arc_to_itself() {
    assert_snapshot!(messages(&[(
        "root.ron",
        "Layer(prims: {\n    \"/W\": Def(references: [\"#/W\"]),\n})\n"
    )]));
}

#[test]
fn arcs_in_a_circle_through_files() {
    assert_snapshot!(messages(&[
        (
            "root.ron",
            "Layer(prims: {\n    \"/W\": Def(references: [\"a.ron#/A\"]),\n})\n"
        ),
        (
            "a.ron",
            "Layer(prims: {\n    \"/A\": Def(payloads: [\"b.ron#/B\"]),\n})\n"
        ),
        (
            "b.ron",
            "Layer(prims: {\n    \"/B\": Def(references: [\"a.ron#/A\"]),\n})\n"
        ),
    ]));
}

#[test]
fn classes_in_a_circle() {
    assert_snapshot!(messages(&[(
        "root.ron",
        "Layer(prims: {\n    \"/_C\": Class(inherits: [\"/_D\"]),\n    \"/_D\": Class(inherits: [\"/_C\"]),\n    \"/W\": Def(inherits: [\"/_C\"]),\n})\n"
    )]));
}

#[test]
fn sublayers_in_a_circle() {
    assert_snapshot!(messages(&[
        ("root.ron", "Layer(\n    sublayers: [\"a.ron\"],\n)\n"),
        ("a.ron", "Layer(\n    sublayers: [\"b.ron\"],\n)\n"),
        ("b.ron", "Layer(\n    sublayers: [\"root.ron\"],\n)\n"),
    ]));
}

#[test]
fn targets_outside_of_a_reference() {
    assert_snapshot!(messages(&[
        (
            "root.ron",
            "Layer(prims: {\n    \"/W\": Def(references: [\"a.ron#/A\"]),\n})\n"
        ),
        (
            "a.ron",
            "Layer(prims: {\n    \"/A\": Def(LightLinks: (exclude: [\"/Gold\", \"/A/K\"]), children: {\"K\": Def()}),\n    \"/Gold\": Def(),\n})\n"
        ),
    ]));
}

#[test]
fn targets_that_are_not_there() {
    assert_snapshot!(messages(&[(
        "root.ron",
        "Layer(prims: {\n    \"/Camera\": Def(),\n    \"/Render\": Def(Render: (camera: \"/Camra\")),\n})\n"
    )]));
}

#[test]
fn files_outside_of_the_root() {
    let text = "Layer(prims: {\n    \"/A\": Def(references: [\"/etc/passwd#/A\"]),\n    \"/B\": Def(references: [\"../up.ron#/A\"]),\n    \"/C\": Def(references: [\"https://example.org/a.ron#/A\"]),\n    \"/D\": Def(references: [\"lib//a.ron#/A\"]),\n    \"/E\": Def(references: [\"lib\\\\a.ron#/A\"]),\n    \"/F\": Def(references: [\"\"]),\n})\n";
    assert_snapshot!(messages(&[("root.ron", text)]));
}

#[test]
fn what_is_no_file() {
    assert_snapshot!(messages(&[
        (
            "root.ron",
            "Layer(prims: {\n    \"/W\": Def(references: [\"lib#/A\"]),\n})\n"
        ),
        ("lib/a.ron", "Layer()"),
    ]));
}

#[cfg(unix)]
#[test]
fn links_out_of_the_root() {
    let outside = folder(&[("secret.ron", "Layer(prims: {\"/A\": Def()})")]);
    let inside = folder(&[(
        "root.ron",
        "Layer(prims: {\n    \"/W\": Def(references: [\"link.ron#/A\"]),\n})\n",
    )]);
    std::os::unix::fs::symlink(outside.path().join("secret.ron"), inside.path().join("link.ron")).unwrap();
    let errors = load_in(inside.path(), &options()).unwrap_err();
    assert_snapshot!(without_folder(&errors.to_string(), inside.path()));
}

#[test]
fn trouble_in_a_file_says_how_it_was_reached() {
    assert_snapshot!(messages(&[
        ("root.ron", "Layer(\n    sublayers: [\"shot/light.ron\"],\n)\n"),
        (
            "shot/light.ron",
            "Layer(prims: {\n    \"/W\": Def(references: [\"../lib/a.ron#/A\"]),\n})\n"
        ),
        (
            "lib/a.ron",
            "Layer(prims: {\n    \"/A\": Def(Camera: (fov: \"wide\")),\n})\n"
        ),
    ]));
}

#[test]
fn a_broken_file_hides_no_other() {
    assert_snapshot!(messages(&[
        ("root.ron", "Layer(\n    sublayers: [\"a.ron\", \"b.ron\"],\n)\n"),
        ("a.ron", "Layer(prims: {"),
        ("b.ron", "Layer(prims: {\n    \"/W\": Def(Camra: ()),\n})\n"),
    ]));
}

#[test]
fn offsets_and_scales() {
    assert_snapshot!(messages(&[
        (
            "root.ron",
            "Layer(\n    sublayers: [(to: \"a.ron\", scale: -1)],\n    prims: {\"/W\": Def(references: [(to: \"a.ron\", scale: 0, offset: 2)], payloads: Edit(prepnd: []))},\n)\n"
        ),
        ("a.ron", "Layer()"),
    ]));
    assert_snapshot!(messages(&[
        (
            "root.ron",
            "Layer(prims: {\n    \"/W\": Def(references: [(to: \"a.ron#/A\", scale: 1e-300)]),\n})\n"
        ),
        (
            "a.ron",
            "Layer(prims: {\n    \"/A\": Def(references: [(to: \"b.ron#/B\", scale: 1e-300)]),\n})\n"
        ),
        (
            "b.ron",
            "Layer(prims: {\"/B\": Def(Camera: (fov: Samples({0: 1, 1: 2})))})\n"
        ),
    ]));
}

#[test]
fn variants_that_nobody_has() {
    let files = [(
        "root.ron",
        "Layer(prims: {\n    \"/W\": Def(\n        select: {\"metal\": \"glod\"},\n        variants: {\"metal\": {\"gold\": (), \"silver\": ()}},\n    ),\n})\n",
    )];
    assert_snapshot!(messages(&files));
    let with = |variant: &str| Options {
        variants: vec![variant.to_owned()],
        ..options()
    };
    assert_snapshot!(messages_with(&files, &with("/W{metal=copper}")));
    assert_snapshot!(messages_with(&files, &with("/W{metl=gold}")));
    assert_snapshot!(messages_with(&files, &with("/V{metal=gold}")));
    assert_snapshot!(messages_with(&files, &with("/W.metal")));
}

#[test]
fn warnings_of_what_has_no_effect() {
    assert_snapshot!(messages(&[
        (
            "root.ron",
            "Layer(\n    sublayers: [\"weak.ron\"],\n    order: [\"Nobody\"],\n    prims: {\n        \"/W\": Def(\n            references: Edit(delete: [\"weak.ron#/P\"]),\n            inherits: [\"/_Metl\"],\n            without: [\"Film\"],\n            LightLinks: (exclude: [\"/W\"]),\n        ),\n        \"/_Metal\": Class(),\n    },\n)\n"
        ),
        (
            "weak.ron",
            "Layer(prims: {\"/W\": Over(LightLinks: (exclude: [\"/P\", \"/W\"])), \"/P\": Def()})"
        ),
    ]));
}

#[test]
fn warnings_of_variants_without_effect() {
    let files = [(
        "root.ron",
        "Layer(prims: {\n    \"/W\": Def(\n        select: {\"size\": \"big\"},\n        Camera: (fov: 30),\n        variants: {\"size\": {\"big\": (Camera: (fov: 60)), \"small\": (Camera: (fov: 20))}},\n    ),\n})\n",
    )];
    let with = |variant: &str| Options {
        variants: vec![variant.to_owned()],
        ..options()
    };
    assert_snapshot!(messages_with(&files, &with("/W{size=big}")));
    assert_snapshot!(messages_with(&files, &with("/W{size=small}")));
}

#[test]
fn limits_of_arcs() {
    let chain: String = (0..70)
        .map(|n| format!("    \"/P{n}\": Def(references: [\"#/P{}\"]),\n", n + 1))
        .collect();
    assert_snapshot!(messages(&[(
        "root.ron",
        &format!("Layer(prims: {{\n{chain}    \"/P70\": Def(),\n}})\n")
    )]));
    // References double at every level: "billion laughs".
    let laughs: String = (0..30)
        .map(|n| format!("    \"/P{n}\": Def(references: [\"#/P{next}\", \"#/Q{next}\"]),\n    \"/Q{n}\": Over(references: [\"#/P{next}\"]),\n", next = n + 1))
        .collect();
    let text = format!("Layer(prims: {{\n{laughs}    \"/P30\": Def(),\n    \"/Q30\": Def(),\n}})\n");
    let errors = messages(&[("root.ron", &text)]);
    assert!(errors.contains("error[index-too-large]"), "{errors}");
    let limited = Options {
        limits: Limits {
            index_nodes: 20,
            ..Limits::default()
        },
        ..options()
    };
    assert_snapshot!(messages_with(
        &[(
            "root.ron",
            "Layer(prims: {\n    \"/W\": Def(references: [\"#/A\", \"#/B\"]),\n    \"/A\": Def(references: [\"#/C\", \"#/D\"]),\n    \"/B\": Def(references: [\"#/C\", \"#/D\"]),\n    \"/C\": Def(references: [\"#/E\", \"#/F\"]),\n    \"/D\": Def(references: [\"#/E\", \"#/F\"]),\n    \"/E\": Def(references: [\"#/G\", \"#/H\"]),\n    \"/F\": Def(references: [\"#/G\", \"#/H\"]),\n    \"/G\": Def(),\n    \"/H\": Def(),\n})\n"
        )],
        &limited
    ));
}

#[test]
fn limits_of_files() {
    let limited = |limits: Limits| Options { limits, ..options() };
    let few = limited(Limits {
        layers: 2,
        ..Limits::default()
    });
    assert_snapshot!(messages_with(
        &[
            ("root.ron", "Layer(\n    sublayers: [\"a.ron\", \"b.ron\"],\n)\n"),
            ("a.ron", "Layer()"),
            ("b.ron", "Layer()"),
        ],
        &few
    ));
    let small = limited(Limits {
        file_bytes: 40,
        ..Limits::default()
    });
    assert_snapshot!(messages_with(
        &[
            ("root.ron", "Layer(sublayers: [\"a.ron\"])\n"),
            ("a.ron", "Layer(doc: \"longer than forty bytes, this one\")"),
        ],
        &small
    ));
}

#[test]
fn prims_nested_too_deep_through_arcs() {
    let limited = Options {
        limits: Limits {
            prim_depth: 3,
            ..Limits::default()
        },
        ..options()
    };
    assert_snapshot!(messages_with(
        &[
            (
                "root.ron",
                "Layer(prims: {\n    \"/A/B\": Def(references: [\"a.ron#/X\"]),\n})\n"
            ),
            ("a.ron", "Layer(prims: {\n    \"/X/Y/Z\": Def(),\n})\n"),
        ],
        &limited
    ));
}
