use super::strata::{Joined, Strata};
use super::{Hemisphere, HemisphereSample, RgbGradient};
use glam::Vec3;
use radiometry::{Rgb, math};
use std::f32::consts::TAU;

/// How irradiance changes as the normal turns, in the frame of the normal: `E(n + ω × n) ≈ E + ω · ∇_r E`.
///
/// `∇_r E = π/(T P) Σ_p v_p Σ_t tanθ_t L_{t,p}`, `v_p` the unit tangent a quarter turn beyond `φ_p`.
///
/// Source: Ward and Heckbert, "Irradiance Gradients", EGWR 1992. Differs: the mean of tanθ over each ring in place of its
/// value at a sample, which has no bound; and the sign, since the angle leads from the record's normal.
///
/// - `samples`: ring by ring.
pub(super) fn rotational(hemisphere: &Hemisphere, samples: &[HemisphereSample]) -> RgbGradient {
    let (rings, cells) = (hemisphere.rings(), hemisphere.cells());
    // ∫ √(s/(1 − s)) ds, s = sin²θ.
    let integral = |ring: u32| {
        let s = ring as f32 / rings as f32;
        math::asin(s.sqrt()) - (s * (1.0 - s)).max(0.0).sqrt()
    };
    let tangents: Vec<f32> = (0..rings)
        .map(|ring| rings as f32 * (integral(ring + 1) - integral(ring)))
        .collect();
    let mut gradient = RgbGradient::default();
    for cell in 0..cells {
        let column = |ring: u32| samples[(ring * cells + cell) as usize].radiance * tangents[ring as usize];
        let light: Rgb = (0..rings).map(column).sum();
        let (sin, cos) = math::sin_cos(TAU * (cell as f32 + 0.5) / cells as f32);
        gradient.add(Vec3::new(-sin, cos, 0.0), light * hemisphere.weight());
    }
    gradient
}

/// How irradiance changes as the place moves within the surface, in the frame of the normal.
///
/// What is seen at distance r moves by sin- and cosine-weighted angles, so cells grow at the expense of their neighbours:
/// `∇_t E = Σ_p (u_p Δφ Σ_t sinθ_t cos²θ_t (L_{t,p} − L_{t−1,p})/min(r_{t,p}, r_{t−1,p}) + v_p Σ_t (sinθ_{t+1} − sinθ_t)
/// (L_{t,p} − L_{t,p−1})/min(r_{t,p}, r_{t,p−1}))`, angles at the borders of cells, `u_p` the unit tangent at the middle of
/// cell p, `v_p` that a quarter turn beyond its border.
///
/// Noise makes gradients longer: of the square of the length, what the spread of samples within cells would make by itself is
/// taken off, `∇_t E · max(0, 1 − σ²/|∇_t E|²)`.
///
/// Source: Ward and Heckbert, "Irradiance Gradients", EGWR 1992. Differs: by strata that are joined before they are compared,
/// and by the noise.
pub(super) fn translational(hemisphere: &Hemisphere, strata: &Strata) -> RgbGradient {
    let (rings, cells) = (hemisphere.rings(), hemisphere.cells());
    let (along_theta, along_phi) = (&strata.along_theta, &strata.along_phi);
    let sin_sq = |ring: u32| ring as f32 / rings as f32;
    let angle = |cell: f32| math::sin_cos(TAU * cell / cells as f32);
    let (mut gradient, mut noise_sq) = (RgbGradient::default(), 0.0);
    let mut compare = |along: Vec3, weight: f32, one: &Joined, other: &Joined| {
        let share = weight * one.near.max(other.near);
        gradient.add(along, (one.light + other.light * -1.0) * share);
        noise_sq += share * share * (one.variance + other.variance);
    };
    for (p, cell) in along_phi.iter().enumerate() {
        let before = p.checked_sub(1).unwrap_or(along_phi.len() - 1);
        let at = |t: usize| strata.cell(t, p);
        let width = TAU * (cell.end - cell.first) as f32 / cells as f32;
        let (sin_mid, cos_mid) = angle(0.5 * (cell.first + cell.end) as f32);
        let (sin_border, cos_border) = angle(cell.first as f32);
        for (t, ring) in along_theta.iter().enumerate() {
            let (inner, outer) = (sin_sq(ring.first), sin_sq(ring.end));
            if t > 0 {
                let weight = width * inner.sqrt() * (1.0 - inner);
                compare(Vec3::new(cos_mid, sin_mid, 0.0), weight, at(t), at(t - 1));
            }
            let weight = outer.sqrt() - inner.sqrt();
            compare(
                Vec3::new(-sin_border, cos_border, 0.0),
                weight,
                at(t),
                strata.cell(t, before),
            );
        }
    }
    let length_sq = gradient.mean().length_squared();
    let kept = if length_sq > noise_sq {
        1.0 - noise_sq / length_sq
    } else {
        0.0
    };
    gradient.map(|channel| channel * kept)
}
