use super::PathGuiding;
use bevy_ecs::prelude::*;
use pipeline_data::vocabulary::{Findings, SceneReport, stage_settings};
use pipeline_data::{PhotonDemand, PrimIndex, RenderSettings};
use transport::{CausticMethod, IndirectMethod, MapKind, MapKinds};

/// How paths are guided. Written by `plan_guiding`; present where they are.
#[derive(Resource, Clone, Copy, Debug)]
pub(super) struct GuidePlan {
    /// Share of the directions that photons choose.
    pub(super) mix: f32,
    /// Kinds of photons that do.
    pub(super) kinds: MapKinds,
}

/// Takes up the settings, and asks for the photons.
pub(super) fn plan_guiding(
    mut commands: Commands,
    settings: Option<Res<RenderSettings>>,
    prims: Query<(&PrimIndex, &PathGuiding)>,
    mut demand: ResMut<PhotonDemand>,
    report: Option<SceneReport<'_>>,
) {
    commands.remove_resource::<GuidePlan>();
    let (Some(settings), Some(mut report)) = (settings, report) else {
        return;
    };
    if report.request().traced {
        return;
    }
    let methods = &settings.methods;
    let mut findings = Findings::default();
    let is_chosen = methods.indirect == IndirectMethod::PathTrace;
    let unused = (!is_chosen).then_some("`LightTransport.indirect` is not `PathTrace`");
    let written = ("PathGuiding", &prims);
    let chosen = stage_settings(written, settings.render_prim, unused, report.scene(), &mut findings);
    if let Some(chosen) = chosen {
        let mut kinds = MapKinds::default().with(MapKind::Indirect);
        if methods.caustic == CausticMethod::Trace {
            kinds = kinds.with(MapKind::Caustic);
        }
        demand.kinds = demand.kinds.union(kinds);
        demand.photons = Some(chosen.photons);
        commands.insert_resource(GuidePlan { mix: chosen.mix, kinds });
    }
    report.file(findings);
}
