use super::run::PhotonPlan;
use bevy_ecs::prelude::*;
use pipeline_core::RenderClock;

/// At the end of a pass of a progressive render, asks for the photons of the next.
pub(super) fn ask_for_photons(plan: Res<PhotonPlan>, mut clock: ResMut<RenderClock>) {
    let done = clock.waves_done + 1;
    let is_progressive = plan.emissions.iter().any(|emission| emission.is_progressive);
    if is_progressive && done < clock.waves_total && done.is_multiple_of(clock.waves_per_pass.max(1)) {
        clock.photons_pending += 1;
    }
}
