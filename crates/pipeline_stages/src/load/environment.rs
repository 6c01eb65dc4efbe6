use super::import::shown_path;
use super::textures::read_picture;
use bevy_ecs::prelude::*;
use pipeline_core::Report;
use pipeline_data::vocabulary::{EnvironmentLight, Findings, field_place};
use pipeline_data::{ComposedScene, EnvironmentMaps, PrimIndex, RenderRequest};
use radiometry::Rgb;
use scene_format::Diagnostic;
use std::path::Path;
use std::sync::Arc;
use texture::{Picture, PictureLimits, decode};
use transport::EnvironmentMap;

/// Loads the picture of each `EnvironmentLight` and makes it ready for sampling; its bytes go into the scene's hash.
pub(super) fn import_environments(
    mut commands: Commands,
    request: Res<RenderRequest>,
    mut composed: ResMut<ComposedScene>,
    mut report: ResMut<Report>,
    lights: Query<(&PrimIndex, &EnvironmentLight)>,
) {
    let mut findings = Findings::default();
    let mut maps = EnvironmentMaps::default();
    let limits = PictureLimits::of_pixels(request.options.limits.texture_pixels as u64);
    let mut rows: Vec<_> = lights.iter().collect();
    rows.sort_by_key(|(index, _)| **index);
    for (index, light) in rows {
        let Some(file) = &light.file else { continue };
        let path = Path::new(&file.0);
        let decoded = read_picture(path, &limits).and_then(|bytes| {
            composed.0.mix_file("environment", &bytes);
            decode(&bytes, &limits).map_err(|error| error.to_string())
        });
        match decoded {
            Ok(picture) => {
                maps.0.insert(*index, Arc::new(map_of(&picture)));
            }
            Err(error) => {
                let place = field_place(&composed.0, index.0, "EnvironmentLight", &["file"]);
                let message = format!("{}: {error}", shown_path(path, &request.scene));
                findings.push_at(place, Diagnostic::error("bad-picture", message));
            }
        }
    }
    findings.file(&composed.0, &request, &mut report);
    commands.insert_resource(maps);
}

fn map_of(picture: &Picture) -> EnvironmentMap {
    let (width, height) = (picture.width(), picture.height());
    let texels: Vec<Rgb> = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| picture.rgb(x, y))
        .collect();
    EnvironmentMap::new(width as usize, height as usize, texels)
}
