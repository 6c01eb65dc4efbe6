use bevy_ecs::prelude::*;
use pipeline_core::{Progress, RenderClock};
use pipeline_data::{FilmSums, RenderRequest};

/// The estimated relative error of the image after the last whole pass. Written by `estimate_error`.
#[derive(Resource, Clone, Copy, Debug)]
pub struct EstimatedError(pub f64);

/// At the end of a pass, estimates the error of the image, and is content once it is what was asked for.
pub(super) fn estimate_error(
    mut commands: Commands,
    request: Res<RenderRequest>,
    film: Res<FilmSums>,
    progress: Res<Progress>,
    mut clock: ResMut<RenderClock>,
) {
    let Some(wanted) = request.until else { return };
    if !(clock.waves_done + 1).is_multiple_of(clock.waves_per_pass) {
        return;
    }
    if let Some(error) = film.0.relative_error() {
        commands.insert_resource(EstimatedError(error));
        progress.set_note(&format!("error {:.2} % of {:.2} %", 100.0 * error, 100.0 * wanted));
        clock.is_converged = error <= wanted;
    }
}
