//! Whole scenes through `Load` and `Prepare`, one mistake each.

mod broken;
mod keys;
mod lights;
mod materials;
mod settings;
mod textures;

use crate::DefaultStages;
use bevy_app::App;
use glam::Vec3;
use pipeline_core::{CorePlugin, Load, Prepare, Report};
use pipeline_data::{ComposedScene, RenderRequest, SceneOrigin, TransportScene};
use radiometry::Rgb;
use spatial::Ray;
use std::path::Path;
use transport::Material;

const SKY: &str = "\"/Sky\": Def(EnvironmentLight: ()),\n";
const BALL: &str = "\"/Ball\": Def(Sphere: ()),\n";
const CAMERA: &str = "\"/Camera\": Def(Camera: (), Transform: (translate: (0, 0, 5))),\n";
const RENDER: &str = "\"/Render\": Def(Render: (camera: \"/Camera\"), Film: (resolution: (4, 4))),\n";
/// One quad, 1 m².
const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

fn prepare_with(prims: &[&str], adjust: impl FnOnce(&mut RenderRequest)) -> App {
    let app = prepare_files(prims, |_| (), adjust);
    assert!(
        app.world().contains_resource::<ComposedScene>(),
        "while loading: {}",
        errors(&app)
    );
    app
}

/// - `write`: puts files beside the scene.
fn prepare_files(prims: &[&str], write: impl FnOnce(&Path), adjust: impl FnOnce(&mut RenderRequest)) -> App {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.ron");
    std::fs::write(&scene, format!("Layer(prims: {{\n{}}})", prims.concat())).unwrap();
    std::fs::write(folder.path().join("quad.obj"), QUAD).unwrap();
    write(folder.path());
    let mut app = App::empty();
    app.add_plugins((CorePlugin, DefaultStages));
    let mut request = RenderRequest {
        scene,
        ..RenderRequest::default()
    };
    adjust(&mut request);
    app.insert_resource(request);
    app.world_mut().run_schedule(Load);
    app.world_mut().run_schedule(Prepare);
    app
}

fn prepare(prims: &[&str]) -> App {
    prepare_with(prims, |_| ())
}

/// Prepares a scene that is right but for these prims.
fn with_rest(prims: &str) -> App {
    prepare(&[prims, SKY, CAMERA, RENDER])
}

fn errors(app: &App) -> String {
    app.world().resource::<Report>().errors().join("\n")
}

fn warnings(app: &App) -> String {
    app.world().resource::<Report>().warnings().join("\n")
}

/// The material of what a ray from +Z meets at (x, y), and the radiance that it emits towards the ray.
fn seen_at(app: &App, x: f32, y: f32) -> (Material, Rgb) {
    assert_eq!(errors(app), "");
    let scene = &app.world().resource::<TransportScene>().0;
    let origin = app.world().resource::<SceneOrigin>().0.as_vec3();
    let ray = Ray::new(Vec3::new(x, y, 100.0) - origin, -Vec3::Z);
    let point = scene.rays.surface(&ray, &scene.rays.intersect(&ray).unwrap());
    (scene.material(&point).clone(), scene.lights.emitted(&point, Vec3::Z))
}

/// The message about a scene that is right but for these prims.
fn refusal(prims: &str) -> String {
    let app = with_rest(prims);
    assert!(
        !app.world().contains_resource::<TransportScene>(),
        "{prims} is accepted"
    );
    errors(&app)
}
