use super::PathGuiding;
use bevy_ecs::prelude::*;
use pipeline_data::vocabulary::{Findings, SceneReport, component_place};
use pipeline_data::{PhotonDemand, PrimIndex, RenderSettings};
use scene_format::Diagnostic;
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
    for (prim, written) in &prims {
        let unused = if prim.0 != settings.render_prim {
            "`PathGuiding` stands on a prim that carries no `Render`; it has no effect there"
        } else if methods.indirect != IndirectMethod::PathTrace {
            "`PathGuiding` has no effect: `LightTransport.indirect` is not `PathTrace`"
        } else {
            let mut kinds = MapKinds::default().with(MapKind::Indirect);
            if methods.caustic == CausticMethod::Trace {
                kinds = kinds.with(MapKind::Caustic);
            }
            demand.kinds = demand.kinds.union(kinds);
            demand.photons = Some(written.photons);
            commands.insert_resource(GuidePlan {
                mix: written.mix,
                kinds,
            });
            continue;
        };
        let place = component_place(report.scene(), prim.0, "PathGuiding");
        findings.push_at(place, Diagnostic::warning("unused-settings", unused));
    }
    report.file(findings);
}
