//! Why values are what they are, and scenes written out flat.

use insta::assert_snapshot;
use scene_format::{Options, Scene, explain, flatten_ron, load_str};

use crate::files::{folder, load_in, without_folder};
use crate::vocabulary::{options, registry, schema};

const RING: [(&str, &str); 4] = [
    (
        "root.ron",
        r#"Layer(
    sublayers: ["layout.ron"],
    prims: {
        "/World/Ring": Over(select: {"metal": "silver"}, Conductor: (roughness: 0.05)),
        "/World/Camera": Over(Camera: (fov: 30)),
    },
)
"#,
    ),
    (
        "layout.ron",
        r#"Layer(prims: {
    "/_Metal": Class(Conductor: (roughness: 0.2)),
    "/World": Def(children: {
        "Camera": Def(Camera: (fov: Samples({0: 20, 10: 40}))),
        "Floor": Def(LightLinks: (exclude: ["/World/Camera"])),
        "Ring": Def(references: ["lib/ring.ron"], inherits: ["/_Metal"]),
    }),
})
"#,
    ),
    (
        "lib/ring.ron",
        r#"Layer(default_prim: "Ring", prims: {
    "/_Polished": Class(Conductor: (roughness: 0.02, metal: "gold")),
    "/Ring": Def(
        specializes: ["/_Polished"],
        variants: {"metal": {"gold": (), "silver": (Conductor: (metal: "silver", roughness: 0.1))}},
        LightLinks: (exclude: Edit(prepend: ["/Ring/Stone"])),
        Mesh: (file: "ring.obj"),
        children: {"Stone": Def(Emission: (power: (1, 2.5, 0.1)))},
    ),
})
"#,
    ),
    ("lib/ring.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
];

fn with_ring<T>(options: &Options, use_it: impl FnOnce(&Scene, &std::path::Path) -> T) -> T {
    let folder = folder(&RING);
    let scene = load_in(folder.path(), options).unwrap_or_else(|errors| panic!("{errors}"));
    use_it(&scene, folder.path())
}

fn answer(question: &str, options: &Options) -> String {
    with_ring(options, |scene, folder| {
        let text = explain(scene, question).unwrap_or_else(|error| scene.report(&error, false));
        // Columns are as wide as the folder's name, which is another in every run.
        let lines = without_folder(&text, folder);
        let narrow = |line: &str| {
            line.split("  ")
                .map(str::trim)
                .filter(|part| !part.is_empty())
                .collect::<Vec<_>>()
                .join("  ")
        };
        lines.lines().map(narrow).collect::<Vec<_>>().join("\n")
    })
}

#[test]
fn says_who_wins_and_why_the_others_lose() {
    assert_snapshot!(answer("/World/Ring.Conductor.roughness", &options()));
    assert_snapshot!(answer("/World/Ring.metal", &options()));
    assert_snapshot!(answer("/World/Camera.fov", &options()));
    assert_snapshot!(answer("/World/Ring.LightLinks.exclude", &options()));
    let set = Options {
        sets: vec!["/World/Camera.fov=50".to_owned()],
        ..options()
    };
    assert_snapshot!(answer("/World/Camera.fov", &set));
}

#[test]
fn columns_stand_below_each_other() {
    let registry = registry();
    let text = "Layer(prims: {\n    \"/_Wide\": Class(Camera: (fov: 60.25)),\n    \"/W\": Def(inherits: [\"/_Wide\"], Camera: (fov: 3)),\n})\n";
    let scene = load_str("scene.ron", text, &schema(&registry), &options()).unwrap();
    assert_snapshot!(explain(&scene, "/W.fov").unwrap());
}

#[test]
fn questions_that_have_no_answer() {
    for question in [
        "/World/Rign.Conductor.roughness",
        "/World/Ring.Condctor.roughness",
        "/World/Ring.Conductor.eta",
        "/World/Ring",
        "/World/Ring.a.b.c",
    ] {
        assert_snapshot!(answer(question, &options()));
    }
}

#[test]
fn a_flat_scene_reads_back_the_same() {
    let checked = Options::default();
    with_ring(&checked, |scene, folder| {
        let text = flatten_ron(scene);
        assert_snapshot!(&text);
        let registry = registry();
        let flat = load_str(
            &folder.join("flat.ron").display().to_string(),
            &text,
            &schema(&registry),
            &checked,
        )
        .unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(flat.hash, scene.hash);
        assert_eq!(flatten_ron(&flat), text);
    });
}
