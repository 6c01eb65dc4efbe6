use super::plan::CachePlan;
use bevy_ecs::prelude::*;
use pipeline_core::Counters;
use pipeline_data::vocabulary::{Findings, SceneReport};
use pipeline_data::{
    BorrowedRecords, BuiltIrradianceCache, CameraFrame, IrradianceRecord, ProgressivePasses, RecordFileError,
    RecordKeys, RenderSettings, SceneOrigin, StoredRecords, TransportScene, read_records,
};
use scene_format::{Diagnostic, Scene, mix_hash};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// What decides the keys of records, beside the scene.
#[derive(bevy_ecs::system::SystemParam)]
pub(super) struct View<'w> {
    settings: Option<Res<'w, RenderSettings>>,
    camera: Option<Res<'w, CameraFrame>>,
    origin: Res<'w, SceneOrigin>,
}

/// Says what records have to agree with to be of use again, and takes up those of the file that the request names.
pub(super) fn reload_records(
    mut commands: Commands,
    plan: Option<Res<CachePlan>>,
    scene: Option<Res<TransportScene>>,
    view: View,
    passes: Option<Res<ProgressivePasses>>,
    mut counters: ResMut<Counters>,
    report: Option<SceneReport<'_>>,
) {
    commands.remove_resource::<RecordKeys>();
    commands.remove_resource::<BorrowedRecords>();
    let (Some(plan), Some(scene), Some(settings), Some(camera), Some(mut report)) =
        (plan, scene, view.settings, view.camera, report)
    else {
        return;
    };
    let mut findings = Findings::default();
    let file = report.request().records.clone();
    if plan.reads_photons && passes.is_some() {
        if file.is_some() || report.request().saves_records {
            findings.push(
                Diagnostic::error(
                    "bad-records",
                    "records cannot be kept: they read progressive photon maps, and are new in every pass",
                )
                .note("set `progressive: false`, or `IrradianceCache.incoming: PathTrace`"),
            );
        }
    } else {
        let keys = record_keys(report.scene(), &settings, &camera, &view.origin);
        commands.insert_resource(keys);
        if let Some(file) = file {
            match reload(&file, &keys, &plan, &scene) {
                Ok((cache, is_complete, borrowed)) => {
                    let counts = cache.0.each_ref().map(|cache| cache.records().len() as u32);
                    let reused = counts.iter().map(|count| u64::from(*count)).sum();
                    counters.counter("irradiance_cache/reused").add(reused);
                    commands.insert_resource(plan.new_fill(false).after(counts, is_complete));
                    if let Some(borrowed) = borrowed {
                        commands.insert_resource(borrowed);
                    }
                    commands.spawn_batch(entities_of(&cache));
                    commands.insert_resource(cache);
                }
                Err(finding) => findings.push(*finding),
            }
        }
    }
    report.file(findings);
}

/// The light of records: the scene without its view, the seed, and where positions count from. Their view: the camera and the
/// part of the film.
fn record_keys(scene: &Scene, settings: &RenderSettings, camera: &CameraFrame, origin: &SceneOrigin) -> RecordKeys {
    let mut light = settings.light_key(scene, "records");
    for coordinate in origin.0.to_array() {
        mix_hash(&mut light, "origin", &coordinate.to_le_bytes());
    }
    let mut view = light;
    // Shortest decimal texts tell all numbers of one type apart.
    mix_hash(&mut view, "camera", format!("{:?}", camera.0).as_bytes());
    let crop = [settings.crop_min, settings.crop_max];
    for pixel in crop.iter().flat_map(|corner| corner.to_array()) {
        mix_hash(&mut view, "crop", &pixel.to_le_bytes());
    }
    RecordKeys { light, view }
}

/// Reads the records of a file, whether none is missing for this view, and what an image of them depends on.
fn reload(
    path: &Path,
    keys: &RecordKeys,
    plan: &CachePlan,
    scene: &TransportScene,
) -> Result<(BuiltIrradianceCache, bool, Option<BorrowedRecords>), Box<Diagnostic>> {
    let refuse = |reason: String| {
        let message = format!("records cannot be taken from {}: {reason}", path.display());
        Box::new(Diagnostic::error("bad-records", message).note("or leave out `--records`"))
    };
    let StoredRecords {
        is_complete,
        borrowed,
        records,
    } = File::open(path)
        .map_err(RecordFileError::from)
        .and_then(|file| read_records(&mut BufReader::new(file), keys))
        .map_err(|error| refuse(error.to_string()))?;
    let mut cache = plan.empty_cache(scene);
    for ((restored, settings), records) in cache.0.iter_mut().zip(plan.settings).zip(records) {
        *restored = transport::IrradianceCache::restore(settings, &scene.0.rays.bounds(), records)
            .map_err(|error| refuse(format!("it is damaged: {error}; write it anew with `pipeline records`")))?;
    }
    Ok((cache, is_complete, borrowed))
}

/// The entities of the records of a cache.
fn entities_of(cache: &BuiltIrradianceCache) -> Vec<IrradianceRecord> {
    let by_depth = (0..).zip(&cache.0);
    let numbered = by_depth.flat_map(|(depth, cache)| (0..).zip(cache.records()).map(move |row| (depth, row)));
    numbered
        .map(|(depth, (number, record))| IrradianceRecord {
            number,
            depth,
            record: *record,
        })
        .collect()
}
