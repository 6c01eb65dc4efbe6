use super::{FinalGather, GatherSource};
use bevy_ecs::prelude::*;
use pipeline_core::RenderClock;
use pipeline_data::vocabulary::{Findings, SceneReport, stage_settings};
use pipeline_data::{BuiltPhotonMaps, PatchDemand, PhotonDemand, PrimIndex, ProgressivePasses, RenderSettings};
use transport::{GatherMethods, IndirectMethod, MapKind, MapKinds};

/// How the render gathers. Written by `plan_gathering`; present where it does.
#[derive(Resource, Clone, Copy, Debug)]
pub(super) struct GatherPlan {
    pub(super) rays: u32,
    pub(super) methods: GatherMethods,
    pub(super) incoming: GatherSource,
    pub(super) precomputed: bool,
}

/// Takes up the settings, and asks for the photon maps.
pub(super) fn plan_gathering(
    mut commands: Commands,
    settings: Option<Res<RenderSettings>>,
    prims: Query<(&PrimIndex, &FinalGather)>,
    mut demand: ResMut<PhotonDemand>,
    mut patches: ResMut<PatchDemand>,
    report: Option<SceneReport<'_>>,
) {
    commands.remove_resource::<GatherPlan>();
    let (Some(settings), Some(mut report)) = (settings, report) else {
        return;
    };
    let is_chosen = settings.methods.indirect == IndirectMethod::FinalGather;
    let mut findings = Findings::default();
    let unused = (!is_chosen).then_some("`LightTransport.indirect` is not `FinalGather`");
    let written = ("FinalGather", &prims);
    let chosen =
        stage_settings(written, settings.render_prim, unused, report.scene(), &mut findings).unwrap_or_default();
    report.file(findings);
    if !is_chosen {
        return;
    }
    let reads_photons = chosen.incoming == GatherSource::Photons;
    if reads_photons {
        demand.kinds = MapKind::ALL.into_iter().fold(demand.kinds, MapKinds::with);
        // As many as their settings say.
        demand.photons = None;
    }
    patches.0 |= chosen.incoming == GatherSource::Radiosity;
    commands.insert_resource(GatherPlan {
        rays: chosen.rays,
        methods: GatherMethods::new(&settings.methods, reads_photons),
        incoming: chosen.incoming,
        precomputed: chosen.precomputed,
    });
}

/// True when photon maps have just been built whose irradiance is to be computed beforehand.
///
/// Not of progressive ones: the distance between records would not shrink with the radius, and its blur would stay.
pub(super) fn precomputes(
    plan: Option<Res<GatherPlan>>,
    maps: Option<Res<BuiltPhotonMaps>>,
    clock: Res<RenderClock>,
    progressive: Option<Res<ProgressivePasses>>,
) -> bool {
    plan.is_some_and(|plan| plan.precomputed && plan.incoming == GatherSource::Photons)
        && maps.is_some_and(|maps| maps.0.irradiance.is_none())
        && clock.photons_pending == 0
        && progressive.is_none()
}
