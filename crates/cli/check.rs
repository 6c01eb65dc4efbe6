//! `pipeline check`: loads and prepares a scene, renders nothing.

use crate::args::CheckArgs;
use crate::exit::Failure;
use crate::session;
use crate::terminal::print;
use bevy_app::App;
use pipeline_data::{ComposedScene, InstancePrims, RenderRequest, RenderSettings};
use std::fmt::Write;

pub(crate) fn execute(options: &CheckArgs) -> Result<(), Failure> {
    let app = session::check(RenderRequest {
        strict: options.strict,
        ..session::scene_request(&options.scene)
    })?;
    print(&summary(&app))
}

/// `ok: 12 prims, 8 shapes, 512x512 pixels, 64 samples a pixel`: prims that are rendered, and those with geometry.
fn summary(app: &App) -> String {
    let world = app.world();
    let mut text = String::from("ok");
    if let Some(ComposedScene(scene)) = world.get_resource() {
        let rendered = scene.rendered().count();
        let _ = write!(text, ": {}", counted(rendered, "prim"));
    }
    if let Some(InstancePrims(prims)) = world.get_resource() {
        let _ = write!(text, ", {}", counted(prims.len(), "shape"));
    }
    if let Some(settings) = world.get_resource::<RenderSettings>() {
        let _ = write!(
            text,
            ", {}x{} pixels, {} a pixel",
            settings.resolution.x,
            settings.resolution.y,
            counted(settings.samples as usize, "sample")
        );
    }
    text.push('\n');
    text
}

fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}
