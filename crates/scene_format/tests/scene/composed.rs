//! What right scenes become.

use bevy_reflect::Reflect;
use glam::{DVec3, UVec2, Vec3};
use scene_format::{FieldState, Scene, Specifier};

use crate::vocabulary::{
    Camera, Emission, Film, Filter, LightLinks, Render, Transform, load_with, options, registry, scene, schema,
};

const CORNELL: &str = include_str!("cornell.ron");

fn built<T: Reflect>(scene: &Scene, path: &str, component: &str, time: f64) -> T {
    let registry = registry();
    let value = scene
        .prim(path)
        .and_then(|prim| prim.component(component))
        .unwrap_or_else(|| panic!("{path}.{component}"))
        .build(&schema(&registry), time);
    value.take::<T>().unwrap_or_else(|_| panic!("{component}"))
}

fn paths(scene: &Scene) -> String {
    let paths: Vec<&str> = scene.prims.iter().map(|prim| prim.path.as_str()).collect();
    paths.join(" ")
}

#[test]
fn reads_the_least_scene() {
    let found = scene("Layer()");
    assert!(found.prims.is_empty());
    assert_eq!(found.time.fps, 24.0);
}

#[test]
fn reads_a_scene_of_the_product() {
    let found = scene(CORNELL);
    assert_eq!(found.prims.len(), 11);
    assert_eq!(found.default_prim.as_deref(), Some("/Scene"));
    assert!(found.prims.iter().all(|prim| prim.rendered));
    let film: Film = built(&found, "/Render", "Film", 0.0);
    assert_eq!(film.resolution, UVec2::splat(256));
    assert_eq!(film.filter, Filter::Box);
    assert_eq!(film.edges, [1.0, 2.0, 3.0]);
    let lamp: Emission = built(&found, "/Scene/lamp", "Emission", 0.0);
    assert_eq!(lamp.radiance, Vec3::new(18.4, 15.6, 8.0));
    let render: Render = built(&found, "/Render", "Render", 0.0);
    assert_eq!(render.camera.0, "/Scene/Camera");
    assert_eq!(render.max_depth, Some(64));
    let camera = found.prim("/Scene/Camera").unwrap();
    assert_eq!(camera.parent, found.index_of("/Scene"));
    let position = camera.component("Transform").unwrap().field("translate").unwrap();
    assert_eq!(position.get_at::<DVec3>(0.0), Some(DVec3::new(0.0, 1.0, 3.9)));
    assert_eq!(found.sources.describe(position.place).to_string(), "scene.ron:8:40");
}

#[test]
fn missing_parents_become_overs_and_are_not_rendered() {
    let found = scene(r#"Layer(prims: {"/A/B/C": Def(), "/A/D": Def(), "/E": Class(children: {"F": Def()})})"#);
    assert_eq!(paths(&found), "/A /A/B /A/B/C /A/D /E /E/F");
    assert_eq!(found.prims[0].specifier, Specifier::Over);
    assert_eq!(found.prims[0].place, None);
    assert!(found.prims.iter().all(|prim| !prim.rendered));
}

#[test]
fn a_path_may_come_before_its_parent() {
    let found = scene(r#"Layer(prims: {"/A/B": Def(), "/A": Def(children: {"C": Def()})})"#);
    assert_eq!(paths(&found), "/A /A/B /A/C");
    assert!(found.prims.iter().all(|prim| prim.rendered));
}

#[test]
fn inactive_prims_lose_their_children() {
    let found = scene(r#"Layer(prims: {"/A": Def(active: false, children: {"B": Def(Camera: ())}), "/C": Def()})"#);
    assert_eq!(paths(&found), "/A /C");
    assert!(!found.prims[0].active && !found.prims[0].rendered);
}

#[test]
fn order_moves_blocks() {
    let found = scene(
        r#"Layer(order: ["Z"], prims: {
            "/W": Def(order: ["D", "B"], children: {"A": Def(), "B": Def(), "C": Def(), "D": Def(), "E": Def()}),
            "/Z": Def(),
        })"#,
    );
    assert_eq!(paths(&found), "/W /W/A /W/D /W/E /W/B /W/C /Z");
    let odd = scene(r#"Layer(prims: {"/W": Def(order: ["X"], without: ["Film"])})"#);
    let codes: Vec<&str> = odd.warnings.iter().map(|warning| warning.code).collect();
    assert_eq!(codes, ["order-without-effect", "without-effect"]);
}

#[test]
fn samples_are_mixed_and_blocks_give_defaults() {
    let found = scene(
        r#"Layer(time: (start: 1, end: 48), prims: {"/W": Def(
            Transform: (translate: Samples({0: (0, 1, 6), 24: (1, 1, 5)}), scale: Block),
            Camera: (fov: Samples({10: 20, 0: 10}), fstop: 2.8),
            Film: (filter: Samples({0: Box, 2: Triangle}), edges: []),
        )})"#,
    );
    assert_eq!(found.frame, 1.0);
    let at = |time| built::<Transform>(&found, "/W", "Transform", time).translate;
    assert_eq!(at(-1.0), DVec3::new(0.0, 1.0, 6.0));
    assert_eq!(at(6.0), DVec3::new(0.25, 1.0, 5.75));
    assert_eq!(built::<Transform>(&found, "/W", "Transform", 0.0).scale, Vec3::ONE);
    let camera: Camera = built(&found, "/W", "Camera", 5.0);
    assert_eq!((camera.fov, camera.fstop), (15.0, Some(2.8)));
    assert_eq!(built::<Film>(&found, "/W", "Film", 1.9).filter, Filter::Box);
    assert_eq!(built::<Film>(&found, "/W", "Film", 2.0).filter, Filter::Triangle);
    assert!(built::<Film>(&found, "/W", "Film", 0.0).edges.is_empty());
    let field = found.prims[0].component("Transform").unwrap().field("scale").unwrap();
    assert!(matches!(field.state, FieldState::Blocked));
}

#[test]
fn relationships_become_absolute() {
    let found = scene(
        r#"Layer(prims: {"/W": Def(children: {
            "A": Def(LightLinks: (include: ["../B", "."], exclude: Edit(prepend: ["/W/B", "../B"]))),
            "B": Def(LightLinks: (include: None, exclude: "/W")),
        })})"#,
    );
    let links: LightLinks = built(&found, "/W/A", "LightLinks", 0.0);
    assert_eq!(links.include.unwrap().0, ["/W/B", "/W/A"]);
    assert_eq!(links.exclude.0, ["/W/B"]);
    let links: LightLinks = built(&found, "/W/B", "LightLinks", 0.0);
    assert!(links.include.is_none());
    assert_eq!(links.exclude.0, ["/W"]);
}

#[test]
fn components_may_repeat_their_name_and_be_empty() {
    let found =
        scene("/* first */ Layer( // then\n prims: {\"/W\": Def(Camera: Camera(fov: /* c */ 35 // d\n), Marker: ())})");
    assert_eq!(built::<Camera>(&found, "/W", "Camera", 0.0).fov, 35.0);
    let field = found.prims[0].component("Camera").unwrap().field("fov").unwrap();
    assert_eq!(found.sources.text(field.place), "35");
    assert!(found.prims[0].component("Marker").unwrap().fields.is_empty());
}

#[test]
fn files_are_found_below_the_root() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.ron");
    std::fs::create_dir(folder.path().join("lib")).unwrap();
    std::fs::write(folder.path().join("lib/ring.obj"), "").unwrap();
    let text = r#"Layer(prims: {"/W": Def(Mesh: (file: "lib/ring.obj"))})"#;
    std::fs::write(&path, text).unwrap();
    let registry = registry();
    let load = |path: &std::path::Path| {
        let options = scene_format::Options::default();
        scene_format::load(path, &schema(&registry), &options).unwrap()
    };
    let found = load(&path);
    let canonical = folder.path().canonicalize().unwrap().join("lib/ring.obj");
    assert_eq!(found.assets[0].path, canonical);
    let again = built::<crate::vocabulary::Mesh>(&found, "/W", "Mesh", 0.0);
    assert_eq!(again.file.0, canonical.to_str().unwrap());
    let place = found.assets[0].place;
    assert_eq!(found.resolve_asset(place, "lib/./ring.obj"), Ok(canonical));
    assert_eq!(found.resolve_asset(place, "../x").unwrap_err().code, "path-escape");

    let elsewhere = tempfile::tempdir().unwrap();
    std::fs::create_dir(elsewhere.path().join("lib")).unwrap();
    std::fs::write(elsewhere.path().join("lib/ring.obj"), "").unwrap();
    std::fs::write(elsewhere.path().join("scene.ron"), text).unwrap();
    assert_eq!(load(&elsewhere.path().join("scene.ron")).hash, found.hash);
}

#[test]
fn the_hash_is_that_of_the_result() {
    let hash = |text: &str| load_with(text, &options()).unwrap().hash;
    let plain = hash(r#"Layer(prims: {"/W": Def(Camera: (fov: 35, fstop: 2.0))})"#);
    let same = hash(
        "#![enable(implicit_some)]\nLayer(doc: \"a\", prims: { // b\n \"/W\": Def(type: \"x\", Camera: (fstop: Some(2), fov: 35.0)) })",
    );
    assert_eq!(plain, same);
    for other in [
        r#"Layer(prims: {"/W": Def(Camera: (fov: 36, fstop: 2.0))})"#,
        r#"Layer(prims: {"/W": Def(Camera: (fov: 35, fstop: None))})"#,
        r#"Layer(prims: {"/W": Over(Camera: (fov: 35, fstop: 2.0))})"#,
        r#"Layer(prims: {"/V": Def(Camera: (fov: 35, fstop: 2.0))})"#,
        r#"Layer(prims: {"/W": Def(Camera: (fov: 35, fstop: 2.0), Marker: ())})"#,
        r#"Layer(time: (fps: 25), prims: {"/W": Def(Camera: (fov: 35, fstop: 2.0))})"#,
    ] {
        assert_ne!(plain, hash(other), "{other}");
    }
    let mut mixed = plain;
    scene_format::mix_hash(&mut mixed, "ring.obj", b"v 0 0 0");
    assert_ne!(mixed, plain);
}
