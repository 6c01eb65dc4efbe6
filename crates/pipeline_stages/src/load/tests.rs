use super::LoadPlugin;
use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use pipeline_core::{CorePlugin, Counters, Load, Report};
use pipeline_data::vocabulary::{Camera, Mesh, Sphere, Transform};
use pipeline_data::{ComposedScene, MeshStore, PrimIndex, RenderRequest};
use scene_format::AssetPath;
use std::path::Path;
use tempfile::TempDir;

/// A component as a plug-in would bring it.
#[derive(Component, Reflect, Clone, Debug, Default)]
#[reflect(Component, Default)]
struct Glitter {
    grains: u32,
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn load_with(scene: &Path, adjust: impl FnOnce(&mut RenderRequest)) -> App {
    let mut app = App::empty();
    app.add_plugins((CorePlugin, LoadPlugin)).register_type::<Glitter>();
    let mut request = RenderRequest {
        scene: scene.to_path_buf(),
        ..RenderRequest::default()
    };
    adjust(&mut request);
    app.insert_resource(request);
    app.world_mut().run_schedule(Load);
    app
}

/// Loads `scene.ron` of a folder with some more files.
fn load(text: &str, files: &[(&str, &str)]) -> App {
    let folder = folder(files);
    let scene = folder.path().join("scene.ron");
    std::fs::write(&scene, text).unwrap();
    load_with(&scene, |_| ())
}

fn errors(app: &App) -> String {
    app.world().resource::<Report>().errors().join("\n")
}

fn warnings(app: &App) -> String {
    app.world().resource::<Report>().warnings().join("\n")
}

/// Paths of the prims with a component, in order.
fn prims_with<C: Component>(app: &mut App) -> Vec<String> {
    let world = app.world_mut();
    let mut rows: Vec<PrimIndex> = world
        .query_filtered::<&PrimIndex, With<C>>()
        .iter(world)
        .copied()
        .collect();
    rows.sort_unstable();
    let scene = &world.resource::<ComposedScene>().0;
    rows.iter()
        .map(|row| scene.prims[row.0 as usize].path.clone())
        .collect()
}

#[test]
fn rendered_prims_become_entities_with_their_components() {
    let mut app = load(
        r#"Layer(time: (start: 5, end: 10), prims: {
            "/Group": Def(Transform: (translate: Samples({0: (0, 0, 0), 10: (10, 0, 0)})), children: {
                "Ball": Def(Sphere: (radius: 2), Glitter: (grains: 7)),
                "Off": Def(active: false, Sphere: ()),
            }),
            "/Class": Class(Sphere: ()),
            "/Over": Over(Sphere: ()),
        })"#,
        &[],
    );
    assert_eq!(errors(&app), "");
    assert_eq!(prims_with::<PrimIndex>(&mut app), ["/Group", "/Group/Ball"]);
    let world = app.world_mut();
    let (sphere, glitter) = world.query::<(&Sphere, &Glitter)>().single(world).unwrap();
    assert_eq!((sphere.radius, glitter.grains), (2.0, 7));
    let transform = world.query::<&Transform>().single(world).unwrap();
    assert_eq!(transform.translate.x, 5.0, "samples are taken at the frame");
    assert_eq!(
        transform.scale,
        glam::DVec3::ONE,
        "fields that are not written have their defaults"
    );
    assert_eq!(world.resource::<Counters>().get("load/prims"), 2);
}

#[test]
fn loading_again_replaces_the_entities() {
    let mut app = load(r#"Layer(prims: {"/A": Def(Sphere: ())})"#, &[]);
    app.world_mut().run_schedule(Load);
    // The folder is gone by now, so the second load fails and leaves no scene to take for the new one.
    assert!(errors(&app).contains("error[missing-file]"), "{}", errors(&app));
    assert!(!app.world().contains_resource::<ComposedScene>());

    let folder = folder(&[("scene.ron", r#"Layer(prims: {"/A": Def(Sphere: ())})"#)]);
    let mut app = load_with(&folder.path().join("scene.ron"), |_| ());
    app.world_mut().run_schedule(Load);
    assert_eq!(prims_with::<Sphere>(&mut app), ["/A"]);
}

#[test]
fn what_the_command_line_sets_wins() {
    let folder = folder(&[("scene.ron", r#"Layer(prims: {"/Camera": Def(Camera: (fov: 30))})"#)]);
    let mut app = load_with(&folder.path().join("scene.ron"), |request| {
        request.options.sets = vec!["/Camera.Camera.fov=50".to_owned()];
    });
    let world = app.world_mut();
    assert_eq!(world.query::<&Camera>().single(world).unwrap().fov, 50.0);
}

#[test]
fn mistakes_in_a_scene_are_reported_with_their_place() {
    let app = load(
        "Layer(prims: {\n  \"/Ball\": Def(Sphere: (radus: 2), Spere: ()),\n})",
        &[],
    );
    let errors = app.world().resource::<Report>().errors();
    assert_eq!(errors.len(), 2, "{errors:?}");
    assert!(
        errors[0].contains("scene.ron:2:25") && errors[0].contains("did you mean `radius`?"),
        "{}",
        errors[0]
    );
    assert!(errors[1].contains("did you mean `Sphere`?"), "{}", errors[1]);
    assert!(!app.world().contains_resource::<ComposedScene>());
}

#[test]
fn components_of_the_ecs_are_not_for_scenes() {
    let mut app = App::new();
    app.add_plugins((CorePlugin, LoadPlugin));
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let schema = scene_format::Schema::new(&registry, pipeline_data::vocabulary::is_scene_component).unwrap();
    assert!(schema.component("Camera").is_some() && schema.component("Name").is_none());
}

#[test]
fn each_mesh_file_is_loaded_once() {
    let text = r#"Layer(prims: {
        "/A": Def(Mesh: (file: "a.obj")), "/B": Def(Mesh: (file: "./a.obj", smooth: false)),
    })"#;
    let app = load(text, &[("a.obj", TRIANGLE)]);
    assert_eq!(errors(&app), "");
    let store = app.world().resource::<MeshStore>();
    let [mesh] = store.meshes() else { panic!("{store:?}") };
    assert!(mesh.mesh.normals.is_some(), "one of the two prims uses the normals");
    assert_eq!(mesh.origin, glam::DVec3::new(0.5, 0.5, 0.0));
    assert_eq!(
        mesh.bounds,
        (glam::Vec3::new(-0.5, -0.5, 0.0), glam::Vec3::new(0.5, 0.5, 0.0))
    );
    assert!(!mesh.is_closed());
    let named = Mesh {
        file: AssetPath(mesh.key.path.display().to_string()),
        ..Mesh::default()
    };
    assert_eq!(store.row_of(&named), Some(0));
    assert_eq!(app.world().resource::<Counters>().get("load/triangles"), 1);
}

#[test]
fn normals_that_no_prim_uses_are_dropped() {
    let app = load(
        r#"Layer(prims: {"/A": Def(Mesh: (file: "a.obj", smooth: false))})"#,
        &[("a.obj", TRIANGLE)],
    );
    assert!(app.world().resource::<MeshStore>().meshes()[0].mesh.normals.is_none());
}

#[test]
fn the_bytes_of_meshes_are_part_of_the_hash() {
    let text = r#"Layer(prims: {"/A": Def(Mesh: (file: "a.obj"))})"#;
    let hash = |obj: &str| load(text, &[("a.obj", obj)]).world().resource::<ComposedScene>().0.hash;
    assert_eq!(hash(TRIANGLE), hash(TRIANGLE));
    assert_ne!(hash(TRIANGLE), hash(&TRIANGLE.replace("v 1 0 0", "v 2 0 0")));
}

#[test]
fn bad_meshes_name_the_field_and_the_line_of_the_file() {
    let text = "Layer(prims: {\n  \"/A\": Def(Mesh: (file: \"a.obj\")),\n  \"/B\": Def(Mesh: (file: \"b.obj\")),\n})";
    let app = load(text, &[("a.obj", "v 0 0 0\nv 1 0\n"), ("b.obj", "v 0 0 0\n")]);
    let errors = app.world().resource::<Report>().errors();
    assert_eq!(errors.len(), 2, "{errors:?}");
    assert!(
        errors[0].contains("a.obj:2: ") && errors[0].contains("scene.ron:2:26"),
        "{}",
        errors[0]
    );
    assert!(
        errors[1].contains("has no faces") && errors[1].contains("scene.ron:3:26"),
        "{}",
        errors[1]
    );
}

#[test]
fn files_that_cannot_be_meshes_are_refused() {
    let app = load(
        r#"Layer(prims: {"/A": Def(Mesh: (file: "a.obj"))})"#,
        &[("b.obj", TRIANGLE)],
    );
    assert!(errors(&app).contains("error[missing-file]") && errors(&app).contains("did you mean `b.obj`?"));
    let app = load(
        r#"Layer(prims: {"/A": Def(Mesh: (file: "a.ply"))})"#,
        &[("a.ply", "ply")],
    );
    assert!(
        errors(&app).contains("error[not-supported-yet]: only `.obj`"),
        "{}",
        errors(&app)
    );
}

#[test]
fn oddities_of_a_mesh_are_warnings() {
    let odd = format!("{TRIANGLE}f 1 1 2\n");
    let app = load(
        r#"Layer(prims: {"/A": Def(Mesh: (file: "a.obj"))})"#,
        &[("a.obj", &odd)],
    );
    assert_eq!(errors(&app), "");
    assert!(
        warnings(&app).contains("warning[odd-mesh]") && warnings(&app).contains("line 6"),
        "{}",
        warnings(&app)
    );
}

/// A `.gltf` file of two triangles at z = 0 and z = 1 that share a buffer, the second in a mesh of its own.
fn two_triangles() -> (String, Vec<u8>) {
    let mut bytes = Vec::new();
    for z in [0.0_f32, 1.0] {
        for [x, y] in [[0.0_f32, 0.0], [1.0, 0.0], [0.0, 1.0]] {
            for number in [x, y, z] {
                bytes.extend(number.to_le_bytes());
            }
        }
    }
    let view = |offset: usize| format!(r#"{{"buffer": 0, "byteOffset": {offset}, "byteLength": 36}}"#);
    let accessor =
        |view: usize| format!(r#"{{"bufferView": {view}, "componentType": 5126, "count": 3, "type": "VEC3"}}"#);
    let mesh = |name: &str, accessor: usize| {
        format!(r#"{{"name": "{name}", "primitives": [{{"attributes": {{"POSITION": {accessor}}}}}]}}"#)
    };
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"uri": "two.bin", "byteLength": 72}}],
            "bufferViews": [{}, {}], "accessors": [{}, {}], "meshes": [{}, {}]}}"#,
        view(0),
        view(36),
        accessor(0),
        accessor(1),
        mesh("Near", 0),
        mesh("Far", 1)
    );
    (text, bytes)
}

fn load_two_triangles(scene: &str, change: impl FnOnce(&mut Vec<u8>)) -> App {
    let (text, mut bytes) = two_triangles();
    change(&mut bytes);
    let folder = folder(&[("scene.ron", scene), ("two.gltf", &text)]);
    std::fs::write(folder.path().join("two.bin"), bytes).unwrap();
    load_with(&folder.path().join("scene.ron"), |_| ())
}

const TWO_PRIMS: &str = r#"Layer(prims: {
    "/A": Def(Mesh: (file: "two.gltf", mesh: "Far")), "/B": Def(Mesh: (file: "two.gltf", mesh: "Near", primitive: 0)),
    "/C": Def(Mesh: (file: "two.gltf", mesh: "Far")),
})"#;

#[test]
fn meshes_of_a_gltf_file_are_told_apart() {
    let app = load_two_triangles(TWO_PRIMS, |_| ());
    assert_eq!(errors(&app), "");
    let store = app.world().resource::<MeshStore>();
    let origins: Vec<f64> = store.meshes().iter().map(|mesh| mesh.origin.z).collect();
    assert_eq!(origins, [1.0, 0.0]);
    assert_eq!(store.meshes()[1].key.part.primitive, Some(0));
}

#[test]
fn the_bytes_of_buffers_are_part_of_the_hash() {
    let hash = |change: fn(&mut Vec<u8>)| {
        let app = load_two_triangles(TWO_PRIMS, change);
        app.world().resource::<ComposedScene>().0.hash
    };
    assert_eq!(hash(|_| ()), hash(|_| ()));
    assert_ne!(hash(|_| ()), hash(|bytes| bytes[3] = 1));
}

#[test]
fn a_mesh_that_is_not_in_its_file_is_an_error_and_one_without_area_a_warning() {
    let scene = "Layer(prims: {\n  \"/A\": Def(Mesh: (file: \"two.gltf\", mesh: \"Fur\")),\n})";
    let app = load_two_triangles(scene, |_| ());
    let found = errors(&app);
    assert!(
        found.contains("did you mean \"Far\"?") && found.contains("scene.ron:2:"),
        "{found}"
    );
    let app = load_two_triangles(TWO_PRIMS, |bytes| bytes[36..].fill(0));
    assert_eq!(errors(&app), "");
    assert!(warnings(&app).contains("warning[flat-mesh]"), "{}", warnings(&app));
    assert_eq!(app.world().resource::<MeshStore>().meshes().len(), 1);
}
