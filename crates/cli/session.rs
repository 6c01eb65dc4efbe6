//! The application with its scene: what every command that loads one shares.

use crate::args::{RenderArgs, SceneArgs};
use crate::exit::{Failure, titled};
use crate::terminal::{say, use_colour};
use bevy_app::App;
use bevy_ecs::reflect::AppTypeRegistry;
use pipeline_core::{CorePlugin, Outcome, RenderClock, Report};
use pipeline_data::RenderRequest;
use pipeline_data::vocabulary::is_scene_component;
use pipeline_stages::DefaultStages;
use scene_format::{Diagnostics, Limits, Options, Scene, Schema};
use std::path::PathBuf;

/// The renderer with all its stages and no scene.
pub(crate) fn new_app() -> App {
    let mut app = App::empty();
    app.add_plugins((CorePlugin, DefaultStages));
    app.finish();
    app.cleanup();
    app
}

/// How the options ask for a scene to be composed.
fn composition_options(scene: &SceneArgs) -> Options {
    let mut limits = Limits::default();
    for (name, value) in &scene.limit {
        let known = limits.set(name, *value);
        debug_assert!(known, "the parser lets known names through only");
    }
    Options {
        sets: scene.set.clone(),
        variants: scene.variant.clone(),
        root: scene.root.clone(),
        frame: scene.frame,
        load_payloads: !scene.no_payloads,
        limits,
        ..Options::default()
    }
}

/// Composes a scene and nothing more; tells the warnings.
///
/// # Errors
/// The vocabulary is unsound. What is wrong with the scene is the inner result.
pub(crate) fn compose(scene: &SceneArgs) -> Result<Result<Scene, Diagnostics>, Failure> {
    let app = new_app();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let schema = Schema::new(&registry, is_scene_component).map_err(|error| Failure::failed(error.to_string()))?;
    let composed = scene_format::load(&scene.scene, &schema, &composition_options(scene));
    if let Ok(scene) = &composed {
        for warning in &scene.warnings {
            say(&titled("warning", &scene.report(warning, use_colour())));
        }
    }
    Ok(composed)
}

/// Why a scene was not composed.
pub(crate) fn refused(refusal: &Diagnostics) -> Failure {
    Failure::bad_input(refusal.render(use_colour()))
}

/// What the options ask of a scene.
pub(crate) fn scene_request(scene: &SceneArgs) -> RenderRequest {
    RenderRequest {
        scene: scene.scene.clone(),
        options: composition_options(scene),
        colour: use_colour(),
        ..RenderRequest::default()
    }
}

/// What the options ask of a render.
pub(crate) fn render_request(scene: &SceneArgs, render: &RenderArgs, outputs: Vec<PathBuf>) -> RenderRequest {
    RenderRequest {
        samples: render.samples,
        until: render.until,
        seed: render.seed,
        resolution: render.resolution.map(Into::into),
        crop: render.crop,
        tile_size: render.tile_size,
        outputs,
        photons: render.photons.clone(),
        records: render.records.clone(),
        resume: render.resume,
        strict: render.strict,
        ..scene_request(scene)
    }
}

/// Uses this many threads for everything that runs in parallel; without a number, one for each processor.
///
/// # Errors
/// The system does not grant them.
pub(crate) fn use_threads(threads: Option<u16>) -> Result<(), Failure> {
    let Some(threads) = threads else { return Ok(()) };
    rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(threads))
        .build_global()
        .map_err(|error| {
            Failure::failed(format!(
                "cannot start {threads} threads: {error}; give fewer with --threads"
            ))
        })
}

/// Loads and prepares a scene, renders nothing, and tells the warnings.
///
/// # Errors
/// A bad scene; or, when `strict`, one with warnings.
pub(crate) fn check(request: RenderRequest) -> Result<App, Failure> {
    let mut app = new_app();
    let strict = request.strict;
    app.insert_resource(request).insert_resource(RenderClock {
        check_only: true,
        strict,
        ..RenderClock::default()
    });
    let outcome = pipeline_core::render(&mut app);
    tell_warnings(&app);
    match outcome {
        Outcome::BadScene => Err(bad_scene(&app)),
        _ => Ok(app),
    }
}

/// Tells each warning once.
pub(crate) fn tell_warnings(app: &App) {
    for warning in app.world().resource::<Report>().warnings() {
        say(&titled("warning", warning));
    }
}

/// Why the render did not begin.
pub(crate) fn bad_scene(app: &App) -> Failure {
    let report = app.world().resource::<Report>();
    if report.failed() {
        Failure::bad_scene(report.errors())
    } else {
        strict_failure(report)
    }
}

/// Why a render with warnings fails under `--strict`.
pub(crate) fn strict_failure(report: &Report) -> Failure {
    let count = match report.warnings().len() {
        1 => "there is a warning".to_owned(),
        count => format!("there are {count} warnings"),
    };
    Failure::bad_input(format!(
        "{count}, and --strict makes that an error; see above, or leave out --strict"
    ))
}
