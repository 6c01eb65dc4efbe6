use super::{CausticMap, CausticPhotonMap, PhotonRun};
use bevy_ecs::prelude::*;
use pipeline_core::{Progress, RenderClock};
use pipeline_data::vocabulary::{Findings, SceneReport, component_place, field_place};
use pipeline_data::{PrimIndex, RenderSettings, TransportScene};
use scene_format::Diagnostic;
use transport::{CausticMethod, DensitySettings};

/// Name of the settings component, as it stands in scene files.
const COMPONENT: &str = "CausticPhotonMap";
/// Bytes a photon takes at the peak, while the map is built; afterwards about 150.
const PEAK_BYTES_PER_PHOTON: u64 = 200;
/// More memory than this for photons is refused.
const MOST_BYTES: u64 = 8 << 30;

/// Decides whether photons are needed, and how they will be gathered.
///
/// Without use for it (another method is chosen, nothing specular or nothing diffuse exists) there is no map, and no
/// system of this stage runs.
pub(super) fn plan_photons(
    mut commands: Commands,
    settings: Option<Res<RenderSettings>>,
    scene: Option<Res<TransportScene>>,
    prims: Query<(&PrimIndex, &CausticPhotonMap)>,
    progress: Res<Progress>,
    mut clock: ResMut<RenderClock>,
    report: Option<SceneReport<'_>>,
) {
    commands.remove_resource::<PhotonRun>();
    commands.remove_resource::<CausticMap>();
    clock.photons_pending = 0;
    let (Some(settings), Some(scene), Some(mut report)) = (settings, scene, report) else {
        return;
    };
    let mut findings = Findings::default();
    let map = chosen_settings(&prims, &settings, &report, &mut findings);
    let bytes = u64::from(map.photons) * PEAK_BYTES_PER_PHOTON;
    if bytes > MOST_BYTES {
        let message = format!(
            "{} photons take about {} GiB of memory; at most {} GiB are used",
            map.photons,
            bytes >> 30,
            MOST_BYTES >> 30
        );
        let finding = Diagnostic::error("too-many-photons", message)
            .note(format!("at most {} photons", MOST_BYTES / PEAK_BYTES_PER_PHOTON));
        findings.push_at(
            field_place(report.scene(), settings.render_prim, COMPONENT, &["photons"]),
            finding,
        );
    }
    let has_use = settings.methods.caustic == CausticMethod::PhotonMap
        && !scene.0.specular_targets().is_empty()
        && scene.0.diffuse_area() > 0.0
        && !scene.0.lights.is_empty();
    if has_use && !findings.has_error() {
        let even_radius = DensitySettings::even_radius(map.nearest, map.photons, scene.0.diffuse_area());
        let density = DensitySettings {
            nearest: map.nearest as usize,
            max_radius: map.max_radius.unwrap_or(even_radius),
            filter: map.filter.into(),
        };
        commands.insert_resource(PhotonRun::new(u64::from(map.photons), density));
        clock.photons_pending += 1;
        progress.start("photons", "photons", u64::from(map.photons));
    }
    report.file(findings);
}

/// The settings on the render prim, or the defaults; warns of settings that have no effect.
fn chosen_settings(
    prims: &Query<(&PrimIndex, &CausticPhotonMap)>,
    settings: &RenderSettings,
    report: &SceneReport<'_>,
    findings: &mut Findings,
) -> CausticPhotonMap {
    let mut chosen = CausticPhotonMap::default();
    for (prim, written) in prims {
        let unused = if prim.0 != settings.render_prim {
            "`CausticPhotonMap` stands on a prim that carries no `Render`; it has no effect there"
        } else if settings.methods.caustic != CausticMethod::PhotonMap {
            "`CausticPhotonMap` has no effect: `LightTransport.caustic` is not `PhotonMap`"
        } else {
            chosen = written.clone();
            continue;
        };
        let place = component_place(report.scene(), prim.0, COMPONENT);
        findings.push_at(place, Diagnostic::warning("unused-settings", unused));
    }
    chosen
}
