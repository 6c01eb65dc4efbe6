use super::frame::moving_frame;
use bevy_ecs::prelude::*;
use film::FilmWindow;
use glam::UVec2;
use pipeline_data::vocabulary::{
    Camera, Film, Findings, LightTransport, Render, SceneReport, SpecularMethod, component_place, field_place,
};
use pipeline_data::{
    CameraFrame, DebugLayers, FilmSums, PrimIndex, RenderRequest, RenderSettings, SceneOrigin, WorldMotion,
    WorldTransform,
};
use scene_format::{Diagnostic, Scene};

/// A film that would take more memory than this is refused: it is a slip of the pen, not a picture.
const MOST_FILM_BYTES: u64 = 16 << 30;

/// Samples of a pixel at most.
const MOST_SAMPLES: u32 = 1 << 24;

type RenderPrim<'a> = (&'a PrimIndex, &'a Render, Option<&'a Film>, Option<&'a LightTransport>);
type CameraPrim<'a> = (
    &'a PrimIndex,
    &'a Camera,
    Option<&'a WorldTransform>,
    Option<&'a WorldMotion>,
);
type Stray<'a> = (&'a PrimIndex, Has<Film>, Has<LightTransport>);
/// Prims with settings that no `Render` stands beside.
type IsStray = (Without<Render>, Or<(With<Film>, With<LightTransport>)>);

/// Joins what scene and request say about the render, and checks it.
pub(super) fn resolve_settings(
    mut commands: Commands,
    mut check: SceneReport,
    origin: Res<SceneOrigin>,
    debug_layers: Option<Res<DebugLayers>>,
    renders: Query<RenderPrim<'_>>,
    cameras: Query<CameraPrim<'_>>,
    strays: Query<Stray<'_>, IsStray>,
) {
    commands.remove_resource::<RenderSettings>();
    commands.remove_resource::<CameraFrame>();
    let (scene, request) = (check.scene(), check.request());
    let mut findings = Findings::default();
    let mut cameras: Vec<_> = cameras.iter().collect();
    cameras.sort_by_key(|(index, ..)| **index);
    if let Some((index, render, film, methods)) = the_render(scene, request, &renders, &cameras, &mut findings) {
        let default = Film::default();
        let mut settings = settings(*index, render, film.unwrap_or(&default), methods, request);
        settings.debug_layers = debug_layers.map_or_else(Vec::new, |layers| layers.shown(&settings));
        check_film(scene, &settings, request, &mut findings);
        let frame = find_camera(scene, &settings, render, &cameras, &origin, &mut findings);
        if let (Some((camera_prim, frame)), false) = (frame, findings.has_error()) {
            settings.camera_prim = camera_prim;
            commands.insert_resource(frame);
            commands.insert_resource(settings);
        }
    }
    warn_of_strays(scene, &strays, &mut findings);
    check.file(findings);
}

/// Finds the one prim that carries `Render`.
fn the_render<'a>(
    scene: &Scene,
    request: &RenderRequest,
    renders: &'a Query<RenderPrim<'_>>,
    cameras: &[CameraPrim<'_>],
    findings: &mut Findings,
) -> Option<RenderPrim<'a>> {
    let mut all: Vec<RenderPrim<'a>> = renders.iter().collect();
    all.sort_by_key(|(index, ..)| **index);
    let Some(first) = all.first() else {
        let camera = cameras
            .first()
            .map_or("/Camera", |(index, ..)| &scene.prims[index.0 as usize].path);
        let message = format!(
            "{} has no prim with `Render`, so there is nothing to render",
            request.scene.display()
        );
        findings.push(
            Diagnostic::error("no-render", message)
                .note("write, for example:")
                .note(format!(
                    "    \"/Render\": Def(Render: (camera: \"{camera}\"), Film: (resolution: (512, 512))),"
                )),
        );
        return None;
    };
    let first_path = &scene.prims[first.0.0 as usize].path;
    for (index, ..) in &all[1..] {
        let path = &scene.prims[index.0 as usize].path;
        let mut finding = Diagnostic::error(
            "two-renders",
            format!("both `{first_path}` and `{path}` carry `Render`"),
        )
        .note("one prim is rendered; `active: false` switches the other off");
        if let Some(place) = component_place(scene, first.0.0, "Render") {
            finding = finding.also(place, format!("`Render` of `{first_path}`"));
        }
        findings.push_at(component_place(scene, index.0, "Render"), finding);
    }
    (all.len() == 1).then_some(*first)
}

fn settings(
    index: PrimIndex,
    render: &Render,
    film: &Film,
    methods: Option<&LightTransport>,
    request: &RenderRequest,
) -> RenderSettings {
    let default = LightTransport::default();
    let methods = methods.unwrap_or(&default);
    let resolution = request.resolution.unwrap_or(film.resolution);
    let [x0, y0, x1, y1] = request.crop.unwrap_or([0, 0, resolution.x, resolution.y]);
    let methods = transport::Methods {
        direct: methods.direct.into(),
        specular: methods.specular == SpecularMethod::Trace,
        caustic: methods.caustic.into(),
        indirect: methods.indirect.into(),
        specular_alpha: methods.specular_alpha,
        max_depth: render.max_depth.unwrap_or(u32::MAX),
    };
    let samples = match (request.samples, request.until) {
        (Some(samples), _) => samples,
        (None, Some(_)) => MOST_SAMPLES,
        (None, None) => render.samples,
    };
    // Chosen pixels are there to be judged, which takes all batches.
    let is_chosen = request.pixels.is_some();
    RenderSettings {
        methods: if request.traced { methods.traced() } else { methods },
        samples: if is_chosen {
            samples.max(film::LEAST_AUDIT_SAMPLES)
        } else {
            samples
        },
        passes: render.passes,
        seed: request.seed.unwrap_or(render.seed),
        resolution,
        crop_min: UVec2::new(x0, y0),
        crop_max: UVec2::new(x1, y1),
        filter: film.filter.into(),
        filter_radius: film.filter_radius,
        variance: film.variance || is_chosen,
        debug_layers: Vec::new(),
        exposure: film.exposure,
        tone_map: film.tone_map.into(),
        render_prim: index.0,
        camera_prim: index.0,
    }
}

/// Checks what the command line may say, which has no place, and what only shows together.
fn check_film(scene: &Scene, settings: &RenderSettings, request: &RenderRequest, findings: &mut Findings) {
    let RenderSettings {
        resolution,
        crop_min,
        crop_max,
        ..
    } = settings;
    let window = FilmWindow {
        resolution: *resolution,
        crop_min: *crop_min,
        crop_max: *crop_max,
    };
    if request.until.is_some() && !settings.variance {
        let finding = Diagnostic::error(
            "no-variance",
            "`--until` needs the error of each pixel, which `Film.variance: false` leaves out",
        )
        .note("leave `variance` at its default");
        findings.push_at(field_place(scene, settings.render_prim, "Film", &["variance"]), finding);
    }
    if settings.samples == 0 {
        findings.push(Diagnostic::error(
            "out-of-range",
            "the number of samples must be at least 1, but is 0",
        ));
    }
    if FilmWindow::full(*resolution).validate().is_err() {
        let message = format!(
            "the resolution must be 1 to {} in width and height, but is {} × {}",
            film::MAX_SIDE,
            resolution.x,
            resolution.y
        );
        findings.push(Diagnostic::error("out-of-range", message));
    } else if window.validate().is_err() {
        let message = format!(
            "the crop from ({}, {}) to ({}, {}) holds no pixel of the film of {} × {}, or reaches beyond it",
            crop_min.x, crop_min.y, crop_max.x, crop_max.y, resolution.x, resolution.y
        );
        let note = "a crop is x0 y0 x1 y1 in pixels from the top left; the last two are one beyond its last pixel";
        findings.push(Diagnostic::error("bad-crop", message).note(note));
    } else {
        let bytes = film_bytes(&window, settings, request);
        if bytes > MOST_FILM_BYTES {
            let message = format!(
                "a film of {} × {} pixels takes {} GiB of memory; at most {} GiB are used",
                window.size().x,
                window.size().y,
                bytes >> 30,
                MOST_FILM_BYTES >> 30
            );
            let finding = Diagnostic::error("too-large", message).note("render parts of it with `--crop`");
            let written = request.resolution.is_none();
            let place = field_place(scene, settings.render_prim, "Film", &["resolution"]);
            findings.push_at(place.filter(|_| written), finding);
        }
    }
}

/// Memory of the film: of the whole window, or of the pixels that were chosen.
fn film_bytes(window: &FilmWindow, settings: &RenderSettings, request: &RenderRequest) -> u64 {
    let Some(choice) = request.pixels else {
        return film::memory_bytes(window, &FilmSums::layout(settings.variance, &settings.debug_layers));
    };
    let most = u64::from(choice.count) * u64::from(choice.side) * u64::from(choice.side);
    let pixels = window.pixel_count().min(usize::try_from(most).unwrap_or(usize::MAX));
    film::memory_of_pixels(pixels, &FilmSums::layout_by_layer())
}

/// Finds the camera that `Render` names: the row of its prim, and its place.
fn find_camera(
    scene: &Scene,
    settings: &RenderSettings,
    render: &Render,
    cameras: &[CameraPrim<'_>],
    origin: &SceneOrigin,
    findings: &mut Findings,
) -> Option<(u32, CameraFrame)> {
    let path = &render.camera.0;
    let Some((index, camera, world, motion)) = cameras
        .iter()
        .find(|(index, ..)| scene.prims[index.0 as usize].path == *path)
    else {
        let rendered = scene.prim(path).is_some_and(|prim| prim.rendered);
        let finding = if rendered {
            Diagnostic::error(
                "no-camera",
                format!("`{path}` has no `Camera`, so nothing can be seen through it"),
            )
        } else {
            Diagnostic::error(
                "no-camera",
                format!("`{path}` is not rendered, so nothing can be seen through it"),
            )
            .note("it and every prim above it must be an active `Def`")
        };
        let names: Vec<&str> = cameras
            .iter()
            .map(|(index, ..)| scene.prims[index.0 as usize].path.as_str())
            .collect();
        let note = if names.is_empty() {
            format!("no prim has one; write, for example, `\"{path}\": Def(Camera: (fov: 40), ..)`")
        } else {
            format!("prims with `Camera`: {}", names.join(", "))
        };
        findings.push_at(
            field_place(scene, settings.render_prim, "Render", &["camera"]),
            finding.note(note),
        );
        return None;
    };
    // A camera that could not be placed was reported where that was found.
    let world = (*world)?;
    let Some(frame) = moving_frame(world, *motion, origin.0) else {
        let message = format!("`{path}` is too far from the scene's geometry for single precision");
        findings.push_at(
            component_place(scene, index.0, "Transform"),
            Diagnostic::error("too-far", message),
        );
        return None;
    };
    let resolution = settings.resolution.as_vec2();
    let camera = transport::Camera::new(frame, camera.fov.to_radians(), resolution);
    Some((index.0, CameraFrame(camera)))
}

fn warn_of_strays(scene: &Scene, strays: &Query<Stray<'_>, IsStray>, findings: &mut Findings) {
    let mut strays: Vec<_> = strays.iter().collect();
    strays.sort_by_key(|(index, ..)| **index);
    for (index, film, methods) in strays {
        for (name, _) in [("Film", film), ("LightTransport", methods)]
            .into_iter()
            .filter(|(_, there)| *there)
        {
            let path = &scene.prims[index.0 as usize].path;
            let message = format!("`{name}` of `{path}` has no effect");
            let finding = Diagnostic::warning("without-effect", message)
                .note(format!("`{name}` counts on the prim that carries `Render`"));
            findings.push_at(component_place(scene, index.0, name), finding);
        }
    }
}
