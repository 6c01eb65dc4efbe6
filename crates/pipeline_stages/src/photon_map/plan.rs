use super::{CausticPhotonMap, PhotonRun};
use bevy_ecs::prelude::*;
use pipeline_core::{Progress, RenderClock, Report};
use pipeline_data::{ComposedScene, PrimIndex, RenderSettings, TransportScene};
use scene_format::Diagnostic;
use std::f64::consts::PI;
use transport::{CausticMethod, DensitySettings};

/// Bytes a photon takes while the map is built and after: world, tree, columns, and the staging of one run.
const BYTES_PER_PHOTON: u64 = 200;
/// More memory than this for photons is refused.
const MAX_BYTES: u64 = 8 << 30;

/// Decides whether photons are needed, and how they will be gathered.
///
/// The largest radius r holds `nearest` of N photons spread evenly over the diffuse area A: π r² N/A = k.
pub(super) fn plan_photons(
    mut commands: Commands,
    settings: Option<Res<RenderSettings>>,
    transport_scene: Option<Res<TransportScene>>,
    composed: Option<Res<ComposedScene>>,
    prims: Query<(&PrimIndex, &CausticPhotonMap)>,
    progress: Res<Progress>,
    mut clock: ResMut<RenderClock>,
    mut report: ResMut<Report>,
) {
    let (Some(settings), Some(scene), Some(composed)) = (settings, transport_scene, composed) else {
        return;
    };
    let mut map = None;
    for (prim, written) in &prims {
        let place = composed.0.prims[prim.0 as usize]
            .component("CausticPhotonMap")
            .map(|c| c.place);
        let mut warn = |text: &str| {
            let mut diagnostic = Diagnostic::warning("unused-settings", text);
            if let Some(place) = place {
                diagnostic = diagnostic.at(place);
            }
            report.warn(composed.0.report(&diagnostic, false));
        };
        if prim.0 != settings.render_prim {
            warn("`CausticPhotonMap` stands on a prim that carries no `Render`; it has no effect there");
        } else if settings.methods.caustic != CausticMethod::PhotonMap {
            warn("`CausticPhotonMap` has no effect: `LightTransport.caustic` is not `PhotonMap`");
        } else {
            map = Some(written.clone());
        }
    }
    let has_use = settings.methods.caustic == CausticMethod::PhotonMap
        && !scene.0.specular_targets().is_empty()
        && scene.0.diffuse_area() > 0.0
        && !scene.0.lights.is_empty();
    if !has_use {
        return;
    }
    let map = map.unwrap_or_default();
    let bytes = u64::from(map.photons) * BYTES_PER_PHOTON;
    if bytes > MAX_BYTES {
        let mut diagnostic = Diagnostic::error(
            "too-many-photons",
            format!(
                "{} photons would take about {} GiB of memory; at most {} GiB are allowed",
                map.photons,
                bytes >> 30,
                MAX_BYTES >> 30
            ),
        )
        .note(format!("at most {} photons", MAX_BYTES / BYTES_PER_PHOTON));
        let field = composed.0.prims[settings.render_prim as usize]
            .component("CausticPhotonMap")
            .and_then(|c| c.field("photons"));
        if let Some(field) = field {
            diagnostic = diagnostic.at(field.place);
        }
        report.fail(composed.0.report(&diagnostic, false));
        return;
    }
    let even_radius = f64::from(map.nearest) * scene.0.diffuse_area() / (PI * f64::from(map.photons));
    let max_radius = map.max_radius.unwrap_or(even_radius.sqrt() as f32);
    commands.insert_resource(PhotonRun {
        wanted: u64::from(map.photons),
        emitted: 0,
        batch: Vec::new(),
        landed: Vec::new(),
        is_over: false,
        density: DensitySettings {
            nearest: map.nearest as usize,
            max_radius,
            filter: map.filter.into(),
        },
    });
    clock.photons_pending += 1;
    progress.start("photons", "photons", u64::from(map.photons));
}
