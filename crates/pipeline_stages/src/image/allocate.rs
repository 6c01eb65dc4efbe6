use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use film::{Film, FilmWindow};
use pipeline_core::Report;
use pipeline_data::{
    BorrowedRecords, ChosenBlocks, ComposedScene, FilmSums, PixelChoice, RenderRequest, RenderSettings,
};
use scene_format::mix_hash;
use std::fs::File;
use std::io::{BufReader, ErrorKind};
use std::path::PathBuf;

/// Where an interrupted render keeps what it has: beside its first output.
pub(super) fn checkpoint_path(request: &RenderRequest) -> Option<PathBuf> {
    let first = request.outputs.first()?;
    let mut name = first.file_name()?.to_owned();
    name.push(".partial");
    Some(first.with_file_name(name))
}

/// What decides the bits of an image.
#[derive(SystemParam)]
pub(super) struct Provenance<'w> {
    pub(super) settings: Res<'w, RenderSettings>,
    pub(super) scene: Res<'w, ComposedScene>,
    borrowed: Option<Res<'w, BorrowedRecords>>,
}

impl Provenance<'_> {
    /// What a checkpoint has to agree with.
    pub(super) fn key(&self) -> [u8; 32] {
        let mut key = self.settings.key(&self.scene.0, "version");
        if let Some(borrowed) = &self.borrowed {
            mix_hash(&mut key, "records", &borrowed.0.to_le_bytes());
        }
        key
    }
}

/// Makes an empty film, or takes up the one that an interrupted render left.
pub(super) fn allocate_film(
    mut commands: Commands,
    request: Res<RenderRequest>,
    provenance: Option<Provenance<'_>>,
    mut report: ResMut<Report>,
) {
    let (Some(provenance), false) = (provenance, report.failed()) else {
        return;
    };
    let settings = &provenance.settings;
    let window = FilmWindow {
        resolution: settings.resolution,
        crop_min: settings.crop_min,
        crop_max: settings.crop_max,
    };
    if let Some(choice) = request.pixels {
        return allocate_chosen(&mut commands, choice, window, &mut report);
    }
    let layout = || FilmSums::layout(settings.variance, &settings.debug_layers);
    let mut resumed = None;
    if let (true, Some(path)) = (request.resume, checkpoint_path(&request)) {
        match File::open(&path) {
            Ok(file) => {
                match Film::load(
                    &mut BufReader::new(file),
                    &provenance.key(),
                    window,
                    layout(),
                    request.tile_size,
                ) {
                    Ok(film) => resumed = Some(film),
                    Err(error) => {
                        report.fail(format!(
                            "error[bad-checkpoint]: cannot resume from {}: {error}\n  = remove it, or render without --resume",
                            path.display()
                        ));
                        return;
                    }
                }
            }
            Err(error) if error.kind() == ErrorKind::NotFound => report.warn(format!(
                "warning[no-checkpoint]: there is no {} to resume from; starting anew",
                path.display()
            )),
            Err(error) => {
                report.fail(format!(
                    "error[bad-checkpoint]: cannot read {}: {error}",
                    path.display()
                ));
                return;
            }
        }
    }
    match resumed.map_or_else(|| Film::new(window, layout(), request.tile_size), Ok) {
        Ok(film) => commands.insert_resource(FilmSums(film)),
        Err(error) => report.fail(format!("error[film]: {error}")),
    }
}

/// Makes an empty film of the pixels that were chosen.
fn allocate_chosen(commands: &mut Commands<'_, '_>, choice: PixelChoice, window: FilmWindow, report: &mut Report) {
    let chosen = ChosenBlocks(choice.blocks(&window));
    match Film::of_pixels(window, FilmSums::layout_by_layer(), &chosen.pixels()) {
        Ok(film) => {
            commands.insert_resource(FilmSums(film));
            commands.insert_resource(chosen);
        }
        Err(error) => report.fail(format!("error[film]: {error}")),
    }
}
