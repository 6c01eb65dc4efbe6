//! The share of even light that the D lobes of a surface reflect, `ρ_hd(ω_o) = ∫ f_d cosθ_i dω_i`.

use glam::Vec3;
use radiometry::{Rgb, SampleStream, StageKey, math};
use scattering::{Bsdf, LobeClass, Transport};
use std::array;
use std::f32::consts::{FRAC_PI_2, PI};

/// Key of the random numbers.
const REFLECTANCE_STAGE: StageKey = StageKey::new("reflectance");

/// Cosines of a table.
const COSINES: usize = 48;

/// Directions of each: rings around the normal, and those of half a ring; the other half is its mirror image.
const RINGS: u32 = 32;
const SPOKES: u32 = 32;

/// Directions of a reflectance that is in no table.
const DIRECTIONS: u32 = 8;

/// The cosine that the table begins with; from there, light grazes.
const LEAST_COSINE: f32 = 1e-4;

/// `ρ_hd` of an opaque surface that is alike whichever way it is turned about its normal, by `√cosθ_o`: it changes fastest where light
/// grazes. Off by less than 0.5 % of what it is, or of a tenth where it is less.
pub(crate) struct ReflectanceTable([Rgb; COSINES]);

impl ReflectanceTable {
    /// Integrates. Cost: about 5 ms, once for a material.
    pub(crate) fn of(bsdf: &Bsdf) -> Self {
        Self(array::from_fn(|i| {
            let root = i as f32 / (COSINES - 1) as f32;
            let cos = (root * root).max(LEAST_COSINE);
            let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            integral(bsdf, wo)
        }))
    }

    /// - `cos`: `cosθ_o`, of either sign.
    #[inline]
    pub(crate) fn at(&self, cos: f32) -> Rgb {
        let place = cos.abs().min(1.0).sqrt() * (COSINES - 1) as f32;
        let before = (place as usize).min(COSINES - 2);
        let share = place - before as f32;
        self.0[before] * (1.0 - share) + self.0[before + 1] * share
    }
}

/// `ρ_hd` by the rule of midpoints, in the angle from the normal and that around it. Cells are small towards the horizon and opposite
/// of `wo`, where lobes are sharp when light grazes.
///
/// - `wo`: unit, its x and z ≥ 0, its y zero.
fn integral(bsdf: &Bsdf, wo: Vec3) -> Rgb {
    let cells = (0..RINGS).flat_map(|ring| (0..SPOKES).map(move |spoke| (ring, spoke)));
    let values = cells.map(|(ring, spoke)| {
        let (s, t) = ((ring as f32 + 0.5) / RINGS as f32, (spoke as f32 + 0.5) / SPOKES as f32);
        let (sin, cos) = math::sin_cos(FRAC_PI_2 * (1.0 - s * s));
        let (sin_phi, cos_phi) = math::sin_cos(PI * (1.0 - t * t));
        let wi = Vec3::new(sin * cos_phi, sin * sin_phi, cos);
        // dθ = π s ds, dφ = 2 π t dt, twice for the mirror image.
        bsdf.eval(wo, wi, Transport::Radiance).diffuse * (sin * s * t)
    });
    values.sum::<Rgb>() * (4.0 * PI * PI / (RINGS * SPOKES) as f32)
}

/// Estimates `ρ_hd` from few directions, without bias: the mean of what the D lobes take of those that are drawn.
///
/// - `wo`: toward the eye, unit, in the frame of the surface.
/// - `stream`: random numbers of the path that arrived, `bounce` the vertex.
pub(crate) fn estimate_reflectance(bsdf: &Bsdf, wo: Vec3, stream: &SampleStream, bounce: u32) -> Rgb {
    let weights = (0..DIRECTIONS).map(|i| {
        let stream = stream.split(REFLECTANCE_STAGE, DIRECTIONS, i);
        let drawn = bsdf.sample(
            wo,
            stream.draw_1d(bounce, 0),
            stream.draw_2d(bounce, 1),
            Transport::Radiance,
        );
        let diffuse = drawn.filter(|sample| sample.class == LobeClass::Diffuse);
        diffuse.map_or(Rgb::BLACK, |sample| sample.weight)
    });
    weights.sum::<Rgb>() * (1.0 / DIRECTIONS as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scattering::{ConductorBsdf, ConductorFresnel, Metal, Microsurface, PlasticBsdf, PrincipledBsdf};
    use scattering::{DiffuseBsdf, PrincipledParameters};

    /// From this width on GGX lobes count as D.
    const SPECULAR_ALPHA: f32 = 0.05;

    fn surface(alpha: f32) -> Microsurface {
        Microsurface::from_roughness(alpha.sqrt(), SPECULAR_ALPHA)
    }

    fn principled(change: impl Fn(&mut PrincipledParameters)) -> Bsdf {
        let mut parameters = PrincipledParameters {
            base_color: Rgb::new(0.8, 0.5, 0.2),
            roughness: 0.4_f32.sqrt(),
            ..PrincipledParameters::default()
        };
        change(&mut parameters);
        Bsdf::Principled(PrincipledBsdf::new(&parameters, SPECULAR_ALPHA))
    }

    /// The mean of many estimates.
    fn estimated(bsdf: &Bsdf, wo: Vec3) -> [f32; 3] {
        const SAMPLES: u32 = 1 << 15;
        let mut sum = [0.0_f64; 3];
        for i in 0..SAMPLES {
            let stream = SampleStream::new(1, REFLECTANCE_STAGE, 0, i);
            let estimate = estimate_reflectance(bsdf, wo, &stream, 0).to_array();
            for (sum, value) in sum.iter_mut().zip(estimate) {
                *sum += f64::from(value);
            }
        }
        sum.map(|sum| (sum / f64::from(SAMPLES)) as f32)
    }

    #[test]
    fn tables_agree_with_estimates() {
        let paint = Rgb::new(0.8, 0.5, 0.2);
        let gold = ConductorFresnel::from(Metal::from_name("gold").expect("a metal"));
        let metal = |fresnel, alpha| Bsdf::Conductor(ConductorBsdf::new(fresnel, surface(alpha)));
        let coated = |alpha| Bsdf::Plastic(PlasticBsdf::new(paint, 1.5, surface(alpha)));
        let surfaces = [
            ("matt", Bsdf::Diffuse(DiffuseBsdf::new(paint))),
            ("gold, 0.4", metal(gold, 0.4)),
            ("gold, 1", metal(gold, 1.0)),
            ("Schlick, 0.6", metal(ConductorFresnel::Schlick(paint), 0.6)),
            ("rough coat", coated(0.5)),
            ("smooth coat", coated(0.0)),
            ("glTF", principled(|_| {})),
            ("glTF metal", principled(|p| p.metallic = 1.0)),
            (
                "velvet",
                principled(|p| (p.sheen, p.sheen_roughness) = (Rgb::WHITE, 0.5)),
            ),
            (
                "lacquer",
                principled(|p| (p.clearcoat, p.clearcoat_roughness) = (1.0, 0.7)),
            ),
        ];
        for (name, bsdf) in surfaces {
            let table = ReflectanceTable::of(&bsdf);
            let mut most = 0.0_f32;
            // Of both sides, between the cosines of the table and at its ends.
            for cos in [0.01_f32, -0.07, 0.15, -0.4, 0.7, -1.0] {
                let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                for (found, whole) in table.at(cos).to_array().into_iter().zip(estimated(&bsdf, wo)) {
                    most = most.max((found - whole).abs() / whole.max(0.1));
                }
            }
            assert!(most < 0.005, "{name}: {most}");
        }
    }
}
