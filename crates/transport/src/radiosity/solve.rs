use super::cast::PatchRow;
use super::field::{Patch, PatchField};
use radiometry::Rgb;
use rayon::prelude::*;

/// The form factors of all patches, row by row.
#[derive(Clone, Debug, Default)]
pub struct FormFactors {
    /// Where the links of each row end; those of row 0 begin at 0.
    ends: Vec<usize>,
    links: Vec<(u32, Rgb)>,
}

/// How a solution went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// Times that the light went around.
    pub rounds: u32,
    /// Share of the reflected flux that further rounds would have brought, by estimate, and that was added by it.
    pub estimated: f64,
}

/// Rounds at most; rooms that reflect 99 % of the light are done to a thousandth after 700.
const MOST_ROUNDS: u32 = 2000;

impl FormFactors {
    /// Puts rows together; a patch whose row is empty sees nothing.
    #[must_use]
    pub fn new(rows: Vec<PatchRow>) -> Self {
        let mut factors = Self::default();
        for mut row in rows {
            factors.links.append(&mut row.links);
            factors.ends.push(factors.links.len());
        }
        factors
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.links.len()
    }

    /// True when nothing sees anything.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.links.is_empty()
    }

    /// Row of each patch that a patch sees, with the form factor.
    #[must_use]
    pub fn row(&self, patch: usize) -> &[(u32, Rgb)] {
        let start = patch.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.links[start..self.ends[patch]]
    }

    /// Lets light go around until no more than `tolerance` of it is missing, and writes `indirect` of all patches.
    ///
    /// `E_i ← Σ_j F_ij ρ_j (E_direct,j + E_j)`, for all patches at once; each round adds one more reflection. What the
    /// rounds to come would add follows from how much less each adds than the one before, a geometric series in the end;
    /// that estimate is added where the last round added, and only its own error, a small part of it, stays.
    ///
    /// - `reflections`: most that light makes on patches; `u32::MAX` for any number.
    ///
    /// Cost: one multiplication a link and round. Sums have a fixed order, so threads change no bit.
    pub fn solve(&self, field: &mut PatchField, tolerance: f64, reflections: u32) -> Solution {
        let mut added_before = f64::INFINITY;
        for patch in &mut field.patches {
            patch.indirect = Rgb::BLACK;
        }
        let rounds = reflections.min(MOST_ROUNDS);
        for round in 1..=rounds {
            let sent: Vec<Rgb> = field.patches.par_iter().map(sent).collect();
            let arrived: Vec<Rgb> = (0..field.patches.len())
                .into_par_iter()
                .map(|row| {
                    self.row(row)
                        .iter()
                        .map(|(from, factor)| *factor * sent[*from as usize])
                        .sum()
                })
                .collect();
            let flux =
                |patch: &Patch, irradiance: Rgb| f64::from(patch.area) * f64::from((patch.albedo * irradiance).mean());
            let pairs = || field.patches.iter().zip(&arrived);
            let total: f64 = pairs().map(|(patch, arrived)| flux(patch, *arrived)).sum();
            let before: f64 = pairs().map(|(patch, _)| flux(patch, patch.indirect)).sum();
            let added = (total - before).max(0.0);
            let ratio = added / added_before;
            let rest = if ratio < 1.0 {
                ratio / (1.0 - ratio) * (1.0 - kept(ratio, reflections - round))
            } else {
                f64::INFINITY
            };
            let is_done = added == 0.0 || round > 1 && added * rest <= tolerance * total;
            for (patch, arrived) in field.patches.iter_mut().zip(&arrived) {
                let last = *arrived - patch.indirect;
                patch.indirect = *arrived;
                if is_done && added > 0.0 {
                    patch.indirect += positive(last) * rest as f32;
                }
            }
            if is_done {
                let estimated = if added > 0.0 { added * rest / total } else { 0.0 };
                return Solution {
                    rounds: round,
                    estimated,
                };
            }
            added_before = added;
        }
        Solution { rounds, estimated: 0.0 }
    }
}

/// What is left of light after so many more reflections.
fn kept(ratio: f64, reflections: u32) -> f64 {
    if reflections < MOST_ROUNDS {
        std::iter::repeat_n(ratio, reflections as usize).product()
    } else {
        0.0
    }
}

/// Radiosity of a patch: what it reflects, W·m⁻².
fn sent(patch: &Patch) -> Rgb {
    patch.albedo * (patch.direct + patch.indirect)
}

fn positive(value: Rgb) -> Rgb {
    Rgb::new(value.r.max(0.0), value.g.max(0.0), value.b.max(0.0))
}
