use super::Radiosity;
use bevy_ecs::prelude::*;
use pipeline_data::vocabulary::{Findings, SceneReport, stage_settings};
use pipeline_data::{PatchDemand, PrimIndex, RenderSettings, SolvedPatches};
use transport::{IndirectMethod, Methods};

/// How radiosity is solved. Written by `plan_radiosity`; present where it is.
#[derive(Resource, Clone, Debug)]
pub(super) struct RadiosityPlan {
    pub(super) settings: Radiosity,
    pub(super) seed: u64,
    /// Most that light makes on patches.
    pub(super) reflections: u32,
}

/// Takes up the settings, where somebody wants the solution.
pub(super) fn plan_radiosity(
    mut commands: Commands,
    settings: Option<Res<RenderSettings>>,
    prims: Query<(&PrimIndex, &Radiosity)>,
    mut demand: ResMut<PatchDemand>,
    report: Option<SceneReport<'_>>,
) {
    commands.remove_resource::<RadiosityPlan>();
    commands.remove_resource::<SolvedPatches>();
    let is_demanded = std::mem::take(&mut demand.0);
    let (Some(settings), Some(mut report)) = (settings, report) else {
        return;
    };
    let is_chosen = is_demanded || settings.methods.indirect == IndirectMethod::Radiosity;
    let mut findings = Findings::default();
    let unused = (!is_chosen).then_some("neither `LightTransport.indirect` nor `FinalGather.incoming` is `Radiosity`");
    let written = ("Radiosity", &prims);
    let chosen =
        stage_settings(written, settings.render_prim, unused, report.scene(), &mut findings).unwrap_or_default();
    report.file(findings);
    if is_chosen {
        commands.insert_resource(RadiosityPlan {
            settings: chosen,
            seed: settings.seed,
            reflections: reflections(&settings.methods),
        });
    }
}

/// The reflections that are left to patches: one is at the surface that the eye sees, and one more where gather rays end
/// on patches, whose own is not counted here.
fn reflections(methods: &Methods) -> u32 {
    let outside = if methods.indirect == IndirectMethod::Radiosity {
        1
    } else {
        2
    };
    match methods.max_depth {
        u32::MAX => u32::MAX,
        most => most.saturating_sub(outside),
    }
}
