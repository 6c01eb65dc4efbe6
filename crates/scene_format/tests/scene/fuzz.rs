//! Whatever is in a file: an answer, no panic.

use proptest::prelude::*;
use scene_format::Options;

use crate::vocabulary::{load_with, options};

const SCENES: [&str; 3] = [
    include_str!("cornell.ron"),
    r#"#![enable(implicit_some)]
Layer(version: 1, doc: "A", default_prim: "World", time: (start: 1, end: 48, fps: 24), order: ["World"],
    prims: {
        "/World/Camera": Over(Camera: (fstop: 2.8, fov: Samples({0: 1, 24: /* c */ 2}))),
        "/World": Def(type: "Xform", active: true, without: ["Film"], order: ["Key", "Ring"],
            Transform: (translate: Samples({0: (0, 1, 6), 24: (1, 1, 5)}), scale: Block),
            LightLinks: (exclude: Edit(prepend: ["/World/Ring"], delete: ["."])),
            children: {"Ring": Over(Film: (filter: Box, edges: [1, 2])), "Key": Def()},
        ),
    },
)"#,
    r#"Layer(sublayers: ["a.ron", (to: "b.ron", offset: 10, scale: 1)], prims: {"/W": Def(
        references: ["lib/ring.ron#/Ring"], payloads: Edit(prepend: ["c.ron"]), inherits: ["/_M"],
        select: {"m": "a"}, variants: {"m": {"a": (Camera: (fov: 0.1)), "b": (children: {"S": Def()})}},
    )})"#,
];

/// Loads and renders, which also looks at every place.
fn survives(text: &str, sets: &[String]) {
    let options = Options {
        sets: sets.to_vec(),
        variants: sets.to_vec(),
        ..options()
    };
    if let Err(errors) = load_with(text, &options) {
        assert!(!errors.list.is_empty());
        let shown = errors.render(true);
        assert!(shown.contains("error"));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn any_text(text in "\\PC{0,200}") {
        survives(&text, &[]);
    }

    #[test]
    fn any_tokens(tokens in prop::collection::vec(prop::sample::select(vec![
        "Layer", "(", ")", "{", "}", "[", "]", ":", ",", "prims", "\"/W\"", "Def", "Over", "children",
        "Camera", "fov", "1", "-", "..", "Samples", "Block", "Edit", "prepend", "\"a\"", "/*", "//", "\n",
        "variants", "references", "order", "\"", "r#\"", "'", "b'", "#![enable(", "Some", "None", "\u{2028}",
    ]), 0..60)) {
        survives(&tokens.join(" "), &[]);
        survives(&format!("Layer(prims: {{\"/W\": Def({}", tokens.concat()), &[]);
        survives("Layer(prims: {\"/W\": Def(Camera: ())})", &[format!("/W.fov={}", tokens.concat())]);
    }

    #[test]
    fn cut_scenes(which in 0..SCENES.len(), share in 0.0..1.0_f64) {
        let text = SCENES[which];
        let mut at = (text.len() as f64 * share) as usize;
        while !text.is_char_boundary(at) { at -= 1; }
        survives(&text[..at], &[]);
    }

    #[test]
    fn changed_scenes(
        which in 0..SCENES.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..3_u8), 1..6),
    ) {
        let mut bytes = SCENES[which].as_bytes().to_vec();
        for (at, byte, kind) in changes {
            let at = at.index(bytes.len());
            match kind {
                0 => bytes[at] = byte,
                1 => { bytes.remove(at); }
                _ => bytes.insert(at, byte),
            }
        }
        survives(&String::from_utf8_lossy(&bytes), &[]);
    }

    #[test]
    fn any_argument(argument in "\\PC{0,40}", tail in "\\PC{0,20}") {
        let scene = "Layer(prims: {\"/W\": Def(Camera: ())})";
        survives(scene, &[argument, format!("/W.fov={tail}"), format!("/W{{{tail}}}")]);
    }
}
