use super::allocate::{Provenance, checkpoint_path};
use super::resolve::ResolvedImage;
use bevy_ecs::prelude::*;
use film::{Image, Metadata};
use pipeline_core::{RenderClock, Report};
use pipeline_data::vocabulary::{Findings, field_place};
use pipeline_data::{FilmSums, RenderRequest, RenderSettings};
use scene_format::{Diagnostic, Scene};
use std::fmt::Write as _;

/// Writes the files that the request names; a checkpoint beside them when samples are missing.
pub(super) fn write_images(
    request: Res<RenderRequest>,
    provenance: Provenance,
    film: Res<FilmSums>,
    image: Res<ResolvedImage>,
    clock: Res<RenderClock>,
    mut report: ResMut<Report>,
) {
    let (settings, scene) = (&provenance.settings, &provenance.scene.0);
    let hash = scene.hash.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    });
    // Samples of the pixel that has the fewest: what the whole image has for sure.
    let samples = (0..film.0.pixel_count())
        .map(|i| film.0.sample_count(i))
        .min()
        .unwrap_or(0);
    let metadata = Metadata {
        scene_hash: hash,
        seed: settings.seed,
        samples: u64::from(samples),
        version: env!("CARGO_PKG_VERSION").into(),
        extra: Vec::new(),
    };
    if clock.waves_done >= clock.waves_total {
        warn_of_black_image(&image.0, scene, settings, &request, &mut report);
    }
    let has_samples = (0..film.0.pixel_count()).any(|i| film.0.sample_count(i) > 0);
    for path in &request.outputs {
        if !has_samples && path.exists() {
            report.warn(format!(
                "warning[no-samples]: interrupted before the first sample; {} is left as it was",
                path.display()
            ));
            continue;
        }
        let is_png = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        let written = if is_png {
            image.0.rgb("").map_or(Ok(()), |beauty| {
                film::write_png(path, &beauty, settings.exposure, settings.tone_map).map_err(|e| e.to_string())
            })
        } else {
            film::write_exr(path, &image.0, &metadata).map_err(|e| e.to_string())
        };
        if let Err(error) = written {
            report.fail(format!("error[write]: {error}"));
        }
    }
    let Some(checkpoint) = checkpoint_path(&request) else {
        return;
    };
    if clock.waves_done < clock.waves_total {
        let key = provenance.key();
        if let Err(error) = film::atomic_write(&checkpoint, |out| film.0.save(out, &key)) {
            report.fail(format!("error[write]: {error}"));
        }
    } else if request.resume && checkpoint.exists() {
        // The render is whole: what it was resumed from is of no use any more.
        if let Err(error) = std::fs::remove_file(&checkpoint) {
            report.warn(format!(
                "warning[checkpoint]: cannot remove {}: {error}",
                checkpoint.display()
            ));
        }
    }
}

/// A black image is hardly ever what was meant, so it never comes without a word.
fn warn_of_black_image(
    image: &Image,
    scene: &Scene,
    settings: &RenderSettings,
    request: &RenderRequest,
    report: &mut Report,
) {
    let is_zero = |name: &str| {
        let channel = image.channels.iter().find(|channel| channel.name == name);
        channel.is_none_or(|channel| channel.samples.iter().all(|value| *value == 0.0))
    };
    if !["R", "G", "B"].into_iter().all(is_zero) {
        return;
    }
    let finding = Diagnostic::warning("black-image", "the whole image is black");
    let finding = if is_zero("A") {
        finding
            .note("the camera sees neither geometry nor an environment")
            .note("turn it with `LookAt`, or move it; it looks along its -Z")
    } else {
        finding
            .note("the camera sees geometry, but no light comes from it")
            .note("is the camera or every light inside of something, or on the dark side of it?")
            .note("an `Emission` shines on the side of the normal, unless it is `two_sided`")
    };
    let mut findings = Findings::default();
    findings.push_at(field_place(scene, settings.render_prim, "Render", &["camera"]), finding);
    findings.file(scene, request, report);
}
