use super::run::{Aim, EmissionPlan, MapPlan, PhotonPlan, PhotonRun};
use super::settings::{CausticPhotonMap, DirectPhotonMap, IndirectPhotonMap, PhotonMapSettings};
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use glam::Vec2;
use pipeline_core::RenderClock;
use pipeline_data::vocabulary::{Findings, SceneReport, field_place, stage_settings};
use pipeline_data::{
    BuiltPhotonMaps, CameraFrame, PhotonDemand, PhotonFileError, PhotonsOfKind, PrimIndex, ProgressivePasses,
    RenderSettings, TransportScene, read_photons,
};
use radiometry::StageKey;
use scene_format::{Diagnostic, Scene};
use spatial::Ray;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use transport::{DensitySettings, MapKind, MapKinds, PHOTON_STAGE, landing_share, visible_targets};

/// Bytes a photon takes at the peak, while the map is built; afterwards about 150.
const PEAK_BYTES_PER_PHOTON: u64 = 200;
/// More memory than this for photons is refused.
const MOST_BYTES: u64 = 8 << 30;

/// Most samples that each pixel takes in a pass of a progressive render; more passes are made where there are more.
const MOST_SAMPLES_PER_PASS: u32 = 1024;

/// Share of the caustic photons that leaves uniformly, aimed at nothing.
const UNIFORM_SHARE_CAUSTIC: f32 = 0.1;
/// The same of photons that are aimed at what is visible. More than of caustic ones, since light that comes over surfaces
/// out of sight counts as well.
const UNIFORM_SHARE_VISIBLE: f32 = 0.25;
/// Photons are aimed at what is visible where fewer of them than this land there by themselves.
const LANDS_BY_ITSELF: f32 = 0.5;
/// Rays along each side of the film that ask what is visible.
const SIGHT_RAYS: u32 = 48;

/// The settings of all three maps.
#[derive(SystemParam)]
pub(super) struct MapPrims<'w, 's> {
    direct: Query<'w, 's, (&'static PrimIndex, &'static DirectPhotonMap)>,
    caustic: Query<'w, 's, (&'static PrimIndex, &'static CausticPhotonMap)>,
    indirect: Query<'w, 's, (&'static PrimIndex, &'static IndirectPhotonMap)>,
}

/// What the plan depends on beside the settings of the maps. All of it is there unless something was wrong before.
#[derive(SystemParam)]
pub(super) struct Prepared<'w> {
    settings: Option<Res<'w, RenderSettings>>,
    scene: Option<Res<'w, TransportScene>>,
    camera: Option<Res<'w, CameraFrame>>,
}

/// Decides which photons are needed, and how they will be gathered.
///
/// Without use for them (other methods are chosen, nothing diffuse exists) there is no map, and no system of this stage runs.
pub(super) fn plan_photons(
    mut commands: Commands,
    prepared: Prepared,
    mut demand: ResMut<PhotonDemand>,
    prims: MapPrims,
    mut clock: ResMut<RenderClock>,
    report: Option<SceneReport<'_>>,
) {
    commands.remove_resource::<PhotonPlan>();
    commands.remove_resource::<PhotonRun>();
    commands.remove_resource::<BuiltPhotonMaps>();
    commands.remove_resource::<ProgressivePasses>();
    clock.photons_pending = 0;
    let demand = std::mem::take(&mut *demand);
    let Prepared {
        settings,
        scene,
        camera,
    } = prepared;
    let (Some(settings), Some(scene), Some(camera), Some(mut report)) = (settings, scene, camera, report) else {
        return;
    };
    let mut findings = Findings::default();
    let wanted = PhotonDemand {
        kinds: wanted_maps(&settings, demand.kinds.union(report.request().photon_maps)),
        ..demand
    };
    let maps = chosen_maps(&prims, wanted, &settings, &scene.0, report.scene(), &mut findings);
    refuse_too_many(&maps, &settings, report.scene(), &mut findings);
    let is_progressive = maps.iter().any(|(_, is_progressive)| *is_progressive);
    if settings.passes.is_some() && !is_progressive {
        let finding = Diagnostic::warning(
            "unused-settings",
            "`Render.passes` has no effect: no photon map is `progressive`",
        );
        let place = field_place(report.scene(), settings.render_prim, "Render", &["passes"]);
        findings.push_at(place, finding);
    }
    if !findings.has_error() && !maps.is_empty() && !scene.0.lights.is_empty() {
        let mut plan = plan(maps, &settings, &scene.0, &camera);
        if let Some(file) = report.request().photons.clone() {
            plan.reloaded = reload(&file, &plan, &photon_key(report.scene(), &settings), &mut findings);
        }
        commands.insert_resource(plan);
        clock.photons_pending = 1;
        if is_progressive {
            let passes = settings.passes.unwrap_or(settings.samples).max(1);
            commands.insert_resource(ProgressivePasses {
                samples_per_pass: settings.samples.div_ceil(passes).min(MOST_SAMPLES_PER_PASS),
            });
        }
    }
    report.file(findings);
}

/// The maps that methods read, or that other stages ask for.
fn wanted_maps(settings: &RenderSettings, demand: MapKinds) -> MapKinds {
    let read = |kind: &MapKind| settings.methods.reads_map(*kind);
    MapKind::ALL.into_iter().filter(read).fold(demand, MapKinds::with)
}

/// The maps that are wanted and can hold anything, and whether each is progressive, with the settings of the render prim or
/// the defaults. Warns of settings without effect.
fn chosen_maps(
    prims: &MapPrims<'_, '_>,
    wanted: PhotonDemand,
    settings: &RenderSettings,
    scene: &transport::Scene,
    composed: &Scene,
    findings: &mut Findings,
) -> Vec<(MapPlan, bool)> {
    let kinds = [
        chosen(&prims.direct, wanted, settings, scene, composed, findings),
        chosen(&prims.caustic, wanted, settings, scene, composed, findings),
        chosen(&prims.indirect, wanted, settings, scene, composed, findings),
    ];
    kinds.into_iter().flatten().collect()
}

fn chosen<S: PhotonMapSettings>(
    prims: &Query<(&PrimIndex, &S)>,
    wanted: PhotonDemand,
    settings: &RenderSettings,
    scene: &transport::Scene,
    composed: &Scene,
    findings: &mut Findings,
) -> Option<(MapPlan, bool)> {
    let is_wanted = wanted.kinds.wants(S::KIND);
    let unused = (!is_wanted).then_some("no method of `LightTransport` reads this map");
    let written = stage_settings((S::NAME, prims), settings.render_prim, unused, composed, findings);
    let (is_written, chosen) = (written.is_some(), written.unwrap_or_default());
    let photons = match wanted.photons {
        Some(photons) if !is_written && !settings.methods.reads_map(S::KIND) => photons,
        _ => chosen.photons(),
    };
    let can_hold = scene.diffuse_area() > 0.0 && (S::KIND != MapKind::Caustic || !scene.specular_targets().is_empty());
    if !is_wanted || !can_hold {
        return None;
    }
    let even_radius = DensitySettings::even_radius(chosen.nearest(), photons, scene.diffuse_area());
    let plan = MapPlan {
        kind: S::KIND,
        wanted: u64::from(photons),
        density: DensitySettings {
            nearest: chosen.nearest() as usize,
            max_radius: chosen.max_radius().unwrap_or(even_radius),
            filter: chosen.filter().into(),
            shrink: 1.0,
        },
        batches: None,
    };
    Some((plan, chosen.progressive()))
}

fn refuse_too_many(maps: &[(MapPlan, bool)], settings: &RenderSettings, composed: &Scene, findings: &mut Findings) {
    let photons: u64 = maps.iter().map(|(map, _)| map.wanted).sum();
    let bytes = photons * PEAK_BYTES_PER_PHOTON;
    if bytes <= MOST_BYTES {
        return;
    }
    let message = format!(
        "{photons} photons take about {} GiB of memory; at most {} GiB are used",
        bytes >> 30,
        MOST_BYTES >> 30
    );
    let finding = Diagnostic::error("too-many-photons", message).note(format!(
        "at most {} photons, in all maps together",
        MOST_BYTES / PEAK_BYTES_PER_PHOTON
    ));
    let largest = maps.iter().max_by_key(|(map, _)| map.wanted).map(|(map, _)| map.kind);
    let component = match largest {
        Some(MapKind::Direct) => DirectPhotonMap::NAME,
        Some(MapKind::Indirect) => IndirectPhotonMap::NAME,
        _ => CausticPhotonMap::NAME,
    };
    findings.push_at(
        field_place(composed, settings.render_prim, component, &["photons"]),
        finding,
    );
}

/// Groups the maps by what their photons are aimed at and for how long they serve, and sizes the passes of progressive ones.
fn plan(
    maps: Vec<(MapPlan, bool)>,
    settings: &RenderSettings,
    scene: &transport::Scene,
    camera: &CameraFrame,
) -> PhotonPlan {
    let mut plan = PhotonPlan {
        emissions: Vec::new(),
        seed: settings.seed,
        // The eye has an event of its own where the photon is read.
        max_depth: settings.methods.max_depth.saturating_sub(1),
        reloaded: None,
    };
    for is_caustic in [true, false] {
        let mut aim = None;
        for is_progressive in [false, true] {
            let belongs = |(map, progressive): &&(MapPlan, bool)| {
                (map.kind == MapKind::Caustic) == is_caustic && *progressive == is_progressive
            };
            let maps: Vec<MapPlan> = maps.iter().filter(belongs).map(|(map, _)| *map).collect();
            if maps.is_empty() {
                continue;
            }
            let aim = aim.get_or_insert_with(|| {
                if is_caustic {
                    aim_at_specular(scene)
                } else {
                    aim_at_visible(settings, scene, camera)
                }
            });
            let mut emission = EmissionPlan {
                aim: aim.clone(),
                is_progressive,
                maps,
            };
            if is_progressive {
                size_passes(&mut emission, &plan, scene);
            }
            plan.emissions.push(emission);
        }
    }
    plan
}

/// Aims photons at what makes caustics.
fn aim_at_specular(scene: &transport::Scene) -> Aim {
    Aim {
        stage: PHOTON_STAGE,
        targets: scene.specular_targets().to_vec(),
        uniform_share: UNIFORM_SHARE_CAUSTIC,
    }
}

/// Aims photons at what the camera sees, unless most of them land there anyway.
fn aim_at_visible(settings: &RenderSettings, scene: &transport::Scene, camera: &CameraFrame) -> Aim {
    let (low, high) = (settings.crop_min.as_vec2(), settings.crop_max.as_vec2());
    let sight = |i: u32| {
        let cell = Vec2::new((i % SIGHT_RAYS) as f32 + 0.5, (i / SIGHT_RAYS) as f32 + 0.5);
        let ray: Ray = camera.0.ray(low + (high - low) * cell / SIGHT_RAYS as f32, 0.5);
        ray
    };
    let targets = visible_targets(scene, settings.seed, (0..SIGHT_RAYS * SIGHT_RAYS).map(sight));
    let is_needed = landing_share(scene, settings.seed, &targets) < LANDS_BY_ITSELF;
    Aim {
        stage: StageKey::new("photon_map/global"),
        targets: if is_needed { targets } else { Vec::new() },
        uniform_share: UNIFORM_SHARE_VISIBLE,
    }
}

/// Decides how many batches a pass emits for each map, by one batch that is traced for it. The same for every pass.
fn size_passes(emission: &mut EmissionPlan, plan: &PhotonPlan, scene: &transport::Scene) {
    let kinds = emission.maps.iter().map(|map| map.kind);
    let kinds = kinds.fold(MapKinds::default(), MapKinds::with);
    let batch = emission.aim.emit_batch(&scene.lights, plan.seed, 0, 0);
    let landed = emission.aim.trace_batch(scene, &batch, kinds, plan, 0, 0);
    for map in &mut emission.maps {
        let counts = landed.iter().map(|task| task[map.kind as usize].len());
        map.batches = Some(map.batches_for(counts.sum()));
    }
}

/// What photons have to agree with to be taken up again; with the film too, since they are aimed at what it sees.
#[must_use]
pub fn photon_key(scene: &Scene, settings: &RenderSettings) -> [u8; 32] {
    settings.key(scene, "photons")
}

/// Reads the photons of a file, in place of tracing them. It must hold every map of the plan, none of them progressive.
fn reload(path: &Path, plan: &PhotonPlan, key: &[u8; 32], findings: &mut Findings) -> Option<Vec<PhotonsOfKind>> {
    let refuse = |reason: String, note: &str| {
        let message = format!("photons cannot be taken from {}: {reason}", path.display());
        Diagnostic::error("bad-photons", message).note(note)
    };
    if plan.emissions.iter().any(|emission| emission.is_progressive) {
        let note = "leave out `--photons`, or set `progressive: false`";
        findings.push(refuse("progressive maps are new in every pass".into(), note));
        return None;
    }
    let read = File::open(path)
        .map_err(PhotonFileError::from)
        .and_then(|file| read_photons(&mut BufReader::new(file), key));
    let maps = match read {
        Ok(maps) => maps,
        Err(error) => {
            findings.push(refuse(error.to_string(), "or leave out `--photons`"));
            return None;
        }
    };
    let planned = plan.emissions.iter().flat_map(|emission| &emission.maps);
    for map in planned {
        if !maps.iter().any(|(kind, _)| *kind == map.kind) {
            let reason = format!("it has no {} map, which this render reads", map.kind.name());
            findings.push(refuse(reason, "write it anew with `pipeline photons` and every map"));
            return None;
        }
    }
    Some(maps)
}
