use super::*;
use crate::{DiffuseBsdf, Transport};
use std::f32::consts::{PI, TAU};

const THETA_BINS: usize = 24;
const PHI_BINS: usize = 32;
/// Points a side over which the density is integrated in a bin.
const SUB: usize = 24;
const SAMPLES: usize = 200_000;
/// Standard normal deviate that the statistic may reach: one in 30,000 correct samplers would exceed it.
const LARGEST_DEVIATE: f64 = 4.0;

/// Expected share of samples in each bin of the sphere, and in a last one for draws without a direction and those of
/// delta lobes.
///
/// The points are a lattice with no two neighbours on a parallel: the density of rough glass jumps along one, which rows
/// of points would misjudge.
fn expected(bsdf: &Bsdf, wo: Vec3) -> Vec<f64> {
    let mut shares = vec![0.0; THETA_BINS * PHI_BINS + 1];
    let (rows, columns) = (THETA_BINS * SUB, PHI_BINS * SUB);
    let shifts: Vec<f32> = (0..columns).map(|c| math::fract(c as f32 * 0.618_034)).collect();
    for row in 0..rows {
        for (column, shift) in shifts.iter().enumerate() {
            let theta = PI * (row as f32 + shift) / rows as f32;
            let (sin, cos) = math::sin_cos(TAU * (column as f32 + 0.5) / columns as f32);
            let (sin_theta, cos_theta) = math::sin_cos(theta);
            let wi = Vec3::new(sin_theta * cos, sin_theta * sin, cos_theta);
            let density = bsdf.pdf(wo, wi, Transport::Radiance) * sin_theta;
            shares[row / SUB * PHI_BINS + column / SUB] += f64::from(density);
        }
    }
    let area = f64::from(PI / rows as f32) * f64::from(TAU / columns as f32);
    shares.iter_mut().for_each(|share| *share *= area);
    let rest = 1.0 - shares.iter().sum::<f64>();
    shares[THETA_BINS * PHI_BINS] = rest;
    shares
}

fn observed(bsdf: &Bsdf, wo: Vec3, seed: u64) -> Vec<f64> {
    let mut counts = vec![0.0; THETA_BINS * PHI_BINS + 1];
    let mut numbers = Numbers(seed << 40);
    for _ in 0..SAMPLES {
        let sample = bsdf.sample(wo, numbers.next(), numbers.next_2d(), Transport::Radiance);
        let bin = sample.filter(|s| !s.is_delta()).map_or(THETA_BINS * PHI_BINS, |s| {
            let row = (math::acos(s.wi.z) / PI * THETA_BINS as f32) as usize;
            let phi = math::fract(math::atan2(s.wi.y, s.wi.x) / TAU + 1.0);
            row.min(THETA_BINS - 1) * PHI_BINS + ((phi * PHI_BINS as f32) as usize).min(PHI_BINS - 1)
        });
        counts[bin] += 1.0;
    }
    counts
}

/// Pearson's statistic as a standard normal deviate (Wilson and Hilferty 1931); bins that expect little are pooled.
fn deviate(expected: &[f64], observed: &[f64]) -> f64 {
    let (mut statistic, mut degrees) = (0.0, -1.0);
    let mut pool = (0.0, 0.0);
    for (share, count) in expected.iter().zip(observed) {
        let e = share * SAMPLES as f64;
        if e < 10.0 {
            pool = (pool.0 + e, pool.1 + count);
        } else {
            statistic += (count - e) * (count - e) / e;
            degrees += 1.0;
        }
    }
    if pool.0.max(pool.1) > 10.0 {
        statistic += (pool.1 - pool.0) * (pool.1 - pool.0) / pool.0.max(1.0);
        degrees += 1.0;
    }
    if degrees < 1.0 {
        return 0.0;
    }
    let spread = 2.0 / (9.0 * degrees);
    (math::powf_f64(statistic / degrees, 1.0 / 3.0) - (1.0 - spread)) / spread.sqrt()
}

fn assert_sampled_as_promised(name: &str, bsdf: &Bsdf, cosines: &[f32]) {
    for (i, cos_o) in cosines.iter().enumerate() {
        let wo = direction(*cos_o);
        let shares = expected(bsdf, wo);
        let failed = shares.last().copied().unwrap_or(0.0);
        assert!(
            failed > -3e-3,
            "{name} at {cos_o}: the density integrates to {}",
            1.0 - failed
        );
        let z = deviate(&shares, &observed(bsdf, wo, i as u64 + 1));
        assert!(z < LARGEST_DEVIATE, "{name} at {cos_o}: deviate {z}");
    }
}

#[test]
fn a_slightly_wrong_density_is_noticed() {
    let wo = direction(0.6);
    let shares = expected(&metal(1.0, 0.21, true), wo);
    let z = deviate(&shares, &observed(&metal(1.0, 0.2, true), wo, 1));
    assert!(z > 2.0 * LARGEST_DEVIATE, "deviate {z}");
}

/// How often a surface of delta lobes reflects and transmits, against its shares of flux.
#[test]
fn delta_lobes_are_drawn_by_what_they_carry() {
    let gold = Metal::from_name("gold").expect("a listed metal");
    let mirror = Bsdf::Conductor(ConductorBsdf::new(gold.into(), surface(0.0, true)));
    let pane = Bsdf::Dielectric(DielectricBsdf::thin(1.5, Rgb::WHITE));
    for (name, bsdf) in [("mirror", mirror), ("glass", glass(1.5, 0.0, true)), ("pane", pane)] {
        for cos_o in [1.0, 0.8, 0.2, -0.9, -0.3] {
            let wo = direction(cos_o);
            let (once, _) = crate::fresnel_dielectric(cos_o, if cos_o > 0.0 { 1.5 } else { 1.0 / 1.5 });
            let (of_pane, _) = crate::fresnel_dielectric(cos_o, 1.5);
            let reflected = match name {
                "mirror" => 1.0,
                "glass" => once,
                _ => 2.0 * of_pane / (1.0 + of_pane),
            };
            let mut numbers = Numbers(4 << 40);
            let n = 20_000;
            let mut transmitted = 0;
            for _ in 0..n {
                let sample = bsdf.sample(wo, numbers.next(), numbers.next_2d(), Transport::Flux);
                let s = sample.expect("a delta lobe always answers");
                assert!(
                    s.is_delta() && bsdf.pdf(wo, s.wi, Transport::Flux) == 0.0,
                    "{name}: {s:?}"
                );
                transmitted += u32::from(s.transmitted);
            }
            let share = 1.0 - f64::from(reflected);
            let spread = (f64::from(n) * share * (1.0 - share)).sqrt();
            let off = (f64::from(transmitted) - f64::from(n) * share).abs();
            assert!(
                off <= LARGEST_DEVIATE * spread + 0.5,
                "{name} at {cos_o}: {transmitted} of {n}"
            );
        }
    }
}

/// ∫pdf is the share of draws that find a direction: all of them where no microfacet can send one below the horizon, and
/// all but what single scattering sends there elsewhere.
#[test]
fn densities_integrate_to_the_share_of_draws_that_succeed() {
    /// Of draws: what the lattice of the integral and 200,000 draws are off by.
    const TOLERANCE: f64 = 3e-3;
    let diffuse = Bsdf::Diffuse(DiffuseBsdf::new(Rgb::splat(0.5)));
    let sheen = principled(PrincipledParameters {
        sheen: Rgb::WHITE,
        sheen_roughness: 0.5,
        base_color: Rgb::BLACK,
        specular: 0.0,
        ..PrincipledParameters::default()
    });
    let complete = [("diffuse", diffuse), ("sheen", sheen)];
    let partial = [
        ("metal", metal(1.0, 0.5, true)),
        ("Beckmann", beckmann(0.5)),
        ("glass", glass(1.5, 0.5, true)),
        ("plastic", plastic(Rgb::WHITE, 1.5, 0.5)),
    ];
    for (name, bsdf) in complete.into_iter().chain(partial) {
        for cos_o in [0.9, 0.3] {
            let failed = expected(&bsdf, direction(cos_o))[THETA_BINS * PHI_BINS];
            let drawn = observed(&bsdf, direction(cos_o), 9)[THETA_BINS * PHI_BINS] / SAMPLES as f64;
            assert!(
                (failed - drawn).abs() < TOLERANCE,
                "{name} at {cos_o}: {failed} {drawn}"
            );
            assert!(
                drawn == 0.0 || complete.iter().all(|(all, _)| *all != name),
                "{name}: {drawn}"
            );
        }
    }
}

#[test]
fn diffuse() {
    let bsdf = Bsdf::Diffuse(DiffuseBsdf::new(Rgb::splat(0.5)));
    assert_sampled_as_promised("diffuse", &bsdf, &[1.0, 0.3, -0.6]);
}

#[test]
fn metals() {
    for alpha in [0.06, 0.2, 0.5, 1.0] {
        for compensated in [false, true] {
            let name = format!("metal of α {alpha}, compensated {compensated}");
            assert_sampled_as_promised(&name, &metal(1.0, alpha, compensated), &[1.0, 0.6, 0.1, -0.3]);
        }
    }
    let gold = Metal::from_name("gold").expect("a listed metal");
    let bsdf = Bsdf::Conductor(ConductorBsdf::new(gold.into(), surface(0.3, true)));
    assert_sampled_as_promised("gold", &bsdf, &[0.7]);
}

#[test]
fn metals_of_beckmann() {
    for alpha in [0.06, 0.2, 0.5, 1.0] {
        let name = format!("Beckmann metal of α {alpha}");
        assert_sampled_as_promised(&name, &beckmann(alpha), &[1.0, 0.6, 0.1, -0.3]);
    }
}

#[test]
fn glass_from_both_sides() {
    for ior in [1.33, 2.4, 0.7] {
        for alpha in [0.1, 0.4, 1.0] {
            for compensated in [false, true] {
                let name = format!("glass of index {ior}, α {alpha}, compensated {compensated}");
                assert_sampled_as_promised(&name, &glass(ior, alpha, compensated), &[0.9, 0.2, -0.95, -0.4]);
            }
        }
    }
}

#[test]
fn plastics() {
    for ior in [1.1, 1.5, 2.4] {
        for alpha in [0.0, 0.06, 0.2, 1.0] {
            let name = format!("plastic of index {ior}, α {alpha}");
            let bsdf = plastic(Rgb::new(0.9, 0.4, 0.1), ior, alpha);
            assert_sampled_as_promised(&name, &bsdf, &[1.0, 0.6, 0.1, -0.3]);
        }
    }
}

#[test]
fn all_parts_of_the_layered_model() {
    for (roughness, clearcoat_roughness) in [(0.5, 0.0), (0.35, 0.8), (0.0, 0.6)] {
        for (name, parameters) in principled_zoo(roughness, clearcoat_roughness) {
            let name = format!("{name} of roughness {roughness}, coat {clearcoat_roughness}");
            assert_sampled_as_promised(&name, &principled(parameters), &[0.8, -0.2]);
        }
    }
}
