//! `check`, `schema`, `stages`: what the renderer knows.

use crate::program::{BALLS, Folder};

#[test]
fn check_summarises_a_good_scene() {
    let folder = Folder::with_scene(BALLS);
    let ran = folder.succeed("check scene.ron");
    assert_eq!(ran.stderr, "");
    assert_eq!(ran.stdout, "ok: 7 prims, 5 shapes, 32x32 pixels, 4 samples a pixel\n");
    assert_eq!(folder.names(), ["scene.ron"]);
}

#[test]
fn check_takes_set() {
    let folder = Folder::with_scene(BALLS);
    let ran = folder.succeed("check scene.ron --set /Render.Render.samples=9");
    assert!(ran.stdout.contains(" 9 samples"), "{}", ran.stdout);
    let ran = folder.run("check scene.ron --set /Camera.Camera.fov=400");
    assert_eq!(ran.code, Some(2));
    insta::assert_snapshot!(ran.stderr, @"
    error[out-of-range]: `Camera.fov` must be 0.01 to 179 degrees, but is 400
      --> --set
       |
       | /Camera.Camera.fov=400
       |                    ^^^
    ");
}

#[test]
fn schema_describes_a_component() {
    let ran = Folder::new().succeed("schema Sphere");
    assert!(ran.stdout.starts_with("Sphere\n"), "{}", ran.stdout);
    assert!(ran.stdout.contains("  radius: a number"), "{}", ran.stdout);
    let all = Folder::new().succeed("schema").stdout;
    assert!(all.contains(&ran.stdout));
    for component in [
        "Camera",
        "Render",
        "Film",
        "LightTransport",
        "CausticPhotonMap",
        "Dielectric",
        "Mesh",
    ] {
        assert!(all.lines().any(|line| line == component), "{component}");
    }
}

#[test]
fn stages_lists_the_systems_of_each_schedule() {
    let folder = Folder::with_scene(BALLS);
    let ran = folder.succeed("stages");
    let schedules: Vec<&str> = ran.stdout.lines().filter(|line| !line.starts_with(' ')).collect();
    assert_eq!(
        schedules,
        [
            "Load",
            "Prepare",
            "PhotonPass",
            "CachePass",
            "RenderPass",
            "Bounce",
            "Finish"
        ]
    );
    let mut systems = Vec::new();
    for line in ran.stdout.lines() {
        match line.strip_prefix("    ") {
            Some(_) => *systems.last_mut().unwrap() += 1,
            None if !line.starts_with(' ') => systems.push(0),
            None => {}
        }
    }
    assert!(systems.iter().all(|count| *count > 0), "{systems:?}");
    for system in [
        "load::",
        "geometry::",
        "tables::",
        "camera::",
        "photon_map::",
        "path_tracing::",
        "image::",
    ] {
        assert!(
            ran.stdout.contains(&format!("    {system}")),
            "{system}\n{}",
            ran.stdout
        );
    }
    assert!(!ran.stdout.contains("(in no set)"), "{}", ran.stdout);
    assert_eq!(folder.succeed("stages scene.ron").stdout, ran.stdout);
    let dot = folder.succeed("stages --dot").stdout;
    assert!(dot.starts_with("digraph stages {") && dot.ends_with("}\n"), "{dot}");
    assert!(dot.contains("subgraph cluster_5"), "{dot}");
}
