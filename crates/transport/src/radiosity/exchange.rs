use super::cast::{PatchRow, cast_row, direct_irradiance};
use super::field::{PatchField, PatchScratch};
use super::solve::FormFactors;
use crate::scene::Scene;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Patches that are worked on between two looks at whether to go on.
const STEP: usize = 1024;

/// How form factors are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExchangeSettings {
    /// Rays of each patch, and light samples, at least 1.
    pub rays: u32,
    /// Of all random numbers.
    pub seed: u64,
    /// Form factors to keep at most, 16 bytes each.
    pub most_links: usize,
}

/// Why there are no form factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExchangeError {
    /// They would take more memory than is allowed.
    TooMany,
    /// Somebody asked to stop.
    Stopped,
}

/// Finds the irradiance that each patch gets straight from the lights, as far as light sampling counts it; the rest comes
/// with the form factors.
///
/// - `step`: told how many patches are done, now and then; false stops.
///
/// # Errors
/// [`ExchangeError::Stopped`].
pub fn find_direct(
    scene: &Scene,
    field: &mut PatchField,
    settings: &ExchangeSettings,
    mut step: impl FnMut(usize) -> bool,
) -> Result<(), ExchangeError> {
    let ExchangeSettings { rays, seed, .. } = *settings;
    let mut done = 0;
    for chunk in field.patches.chunks_mut(STEP) {
        chunk.par_iter_mut().enumerate().for_each(|(i, patch)| {
            patch.direct = direct_irradiance(scene, patch, (done + i) as u32, rays, seed);
        });
        done += chunk.len();
        if !step(done) {
            return Err(ExchangeError::Stopped);
        }
    }
    Ok(())
}

/// Finds the form factors of all patches that light can reach, and adds the lights that rays meet to their direct irradiance.
///
/// Begins with the sides of surfaces that are lit directly, anywhere, and goes on to those that are seen from there: the
/// insides of closed things take no time. Where nothing is lit directly, or light may come over S surfaces from anywhere, all sides are
/// looked at.
///
/// - `step`: told how many patches are done, now and then; false stops.
///
/// # Errors
/// As [`ExchangeError`].
pub fn find_form_factors(
    scene: &Scene,
    field: &mut PatchField,
    settings: &ExchangeSettings,
    mut step: impl FnMut(usize) -> bool,
) -> Result<FormFactors, ExchangeError> {
    let ExchangeSettings { rays, seed, most_links } = *settings;
    let mut rows = vec![PatchRow::default(); field.patches.len()];
    let mut reached = BTreeSet::new();
    let side = |field: &PatchField, row: u32| (field.patches[row as usize].instance, row % 2);
    let all = 0..field.patches.len() as u32;
    let is_lit = |row: &u32| !field.patches[*row as usize].direct.is_black();
    let mut wave: BTreeSet<_> = all.clone().filter(is_lit).map(|row| side(field, row)).collect();
    if wave.is_empty() || !scene.specular_targets().is_empty() {
        wave = all.clone().map(|row| side(field, row)).collect();
    }
    let (mut done, mut links) = (0, 0);
    while !wave.is_empty() {
        let todo: Vec<u32> = all.clone().filter(|row| wave.contains(&side(field, *row))).collect();
        reached.append(&mut wave);
        for chunk in todo.chunks(STEP) {
            let cast = |scratch: &mut PatchScratch, row: &u32| cast_row(scene, field, *row, rays, seed, scratch);
            let found: Vec<PatchRow> = chunk.par_iter().map_init(PatchScratch::default, cast).collect();
            for (row, found) in chunk.iter().zip(found) {
                links += found.links.len();
                wave.extend(found.links.iter().map(|(seen, _)| side(field, *seen)));
                rows[*row as usize] = found;
            }
            if links > most_links {
                return Err(ExchangeError::TooMany);
            }
            done += chunk.len();
            if !step(done) {
                return Err(ExchangeError::Stopped);
            }
        }
        wave = wave.difference(&reached).copied().collect();
    }
    for (patch, row) in field.patches.iter_mut().zip(&rows) {
        patch.direct += row.met;
    }
    Ok(FormFactors::new(rows))
}
