use bevy_ecs::prelude::*;
use pipeline_data::FilmSums;

/// The image in memory. Written by `resolve_film`, read by `write_images`.
#[derive(Resource, Debug)]
pub(super) struct ResolvedImage(pub film::Image);

/// Divides the sums of the film by their sample counts.
pub(super) fn resolve_film(mut commands: Commands, film: Option<Res<FilmSums>>) {
    if let Some(film) = film {
        commands.insert_resource(ResolvedImage(film.0.resolve()));
    }
}
