use super::*;
use crate::{DiffuseBsdf, Transport};
use radiometry::{SampleStream, StageKey};

const KEY: StageKey = StageKey::new("furnace");

/// Share of light that is scattered at all: the mean weight of flux, over `side`³ points jittered in all three numbers.
pub(super) fn scattered(bsdf: Bsdf, wo: Vec3, side: usize) -> f32 {
    let mut numbers = Numbers(21 << 40);
    let mut sum = 0.0_f64;
    for i in 0..side * side * side {
        let mut stratum = |k: usize| ((k % side) as f32 + numbers.next()) / side as f32;
        let (u_lobe, u) = (stratum(i), Vec2::new(stratum(i / side), stratum(i / side / side)));
        let sample = bsdf.sample(wo, u_lobe, u, Transport::Flux);
        sum += sample.map_or(0.0, |s| f64::from(s.weight.mean()));
    }
    (sum / (side * side * side) as f64) as f32
}

const COSINES: [f32; 8] = [1.0, 0.8, 0.5, 0.25, 0.1, 0.03, 0.005, 1e-4];
const ALPHAS: [f32; 9] = [0.0, 0.001, 0.004, 0.02, 0.09, 0.25, 0.5, 0.8, 1.0];
/// More of both, at no node of a table.
const COSINES_BETWEEN: [f32; 5] = [0.93, 0.67, 0.39, 0.071, 0.017_452];
const ALPHAS_BETWEEN: [f32; 6] = [0.0013, 0.009, 0.043, 0.16, 0.37, 0.71];

/// What a lossless surface may lose or gain: the tables' interpolation, and noise.
pub(super) const HALF_A_PERCENT: f32 = 0.005;

fn alphas() -> impl Iterator<Item = f32> {
    ALPHAS.into_iter().chain(ALPHAS_BETWEEN)
}

fn cosines() -> impl Iterator<Item = f32> {
    COSINES.into_iter().chain(COSINES_BETWEEN)
}

#[test]
fn white_metal_reflects_all_light() {
    for alpha in alphas() {
        for cos_o in cosines() {
            let share = scattered(metal(1.0, alpha, true), direction(cos_o), 32);
            assert!((share - 1.0).abs() < HALF_A_PERCENT, "α {alpha} at {cos_o}: {share}");
        }
    }
}

#[test]
fn beckmann_loses_little_where_it_is_narrow_and_never_gains() {
    for cos_o in COSINES {
        let white = |alpha| {
            let Bsdf::Conductor(metal) = metal(1.0, alpha, true) else {
                return Bsdf::Black;
            };
            Bsdf::Conductor(metal.with_distribution(NormalDistribution::Beckmann))
        };
        for alpha in ALPHAS {
            let share = scattered(white(alpha), direction(cos_o), 24);
            assert!(share < 1.002, "α {alpha} at {cos_o}: {share}");
        }
        let narrow = scattered(white(0.02), direction(cos_o), 24);
        assert!(cos_o < 0.1 || narrow > 0.99, "at {cos_o}: {narrow}");
    }
}

#[test]
fn a_tint_is_a_factor_for_all_that_a_metal_reflects() {
    for alpha in [0.0, 0.3] {
        let wo = direction(0.6);
        let tinted = |bsdf: Bsdf| match bsdf {
            Bsdf::Conductor(metal) => Bsdf::Conductor(metal.with_tint(Rgb::splat(0.3))),
            other => other,
        };
        let plain = metal(0.8, alpha, true);
        let (share, whole) = (scattered(tinted(plain), wo, 16), scattered(plain, wo, 16));
        assert!((share - 0.3 * whole).abs() < 1e-6, "α {alpha}: {share} of {whole}");
        assert!((tinted(plain).albedo(wo).r - 0.3 * plain.albedo(wo).r).abs() < 1e-6);
    }
}

#[test]
fn clear_glass_loses_no_light() {
    for ior in [1.02, 1.1, 1.33, 1.47, 1.5, 2.0, 3.0, 3.7, 0.7, 0.887] {
        for alpha in alphas() {
            for cos_o in cosines().flat_map(|c| [c, -c]) {
                let share = scattered(glass(ior, alpha, true), direction(cos_o), 24);
                assert!(
                    (share - 1.0).abs() < HALF_A_PERCENT,
                    "index {ior}, α {alpha} at {cos_o}: {share}"
                );
            }
        }
    }
}

/// Follows radiance from the eye through a slab with two parallel faces, until it leaves: its mean must be what
/// surrounds the slab, since factors of 1/η² on entering and η² on leaving cancel.
fn seen_through_slab(bsdf: Bsdf, cos_o: f32, n: u32) -> f64 {
    let mut sum = 0.0;
    for i in 0..n {
        let stream = SampleStream::new(1, KEY, 0, i);
        let mut throughput = 1.0_f64;
        // Both faces have their outside up in the local frame: the far one is the near one turned over.
        let mut wo = direction(cos_o);
        for bounce in 0..200 {
            let u_lobe = stream.draw_1d(bounce, 0);
            let Some(s) = bsdf.sample(wo, u_lobe, stream.draw_2d(bounce, 1), Transport::Radiance) else {
                break;
            };
            throughput *= f64::from(s.weight.r);
            if s.wi.z > 0.0 {
                sum += throughput;
                break;
            }
            // Inside, towards the other face, in whose frame this ray comes from below again.
            wo = Vec3::new(-s.wi.x, -s.wi.y, s.wi.z);
        }
    }
    sum / f64::from(n)
}

#[test]
fn a_slab_in_uniform_radiance_can_not_be_seen() {
    for ior in [1.5, 0.7] {
        for cos_o in [1.0, 0.7, 0.2] {
            let smooth = seen_through_slab(glass(ior, 0.0, true), cos_o, 1 << 10);
            assert!((smooth - 1.0).abs() < 1e-5, "smooth, index {ior} at {cos_o}: {smooth}");
            let rough = seen_through_slab(glass(ior, 0.4, true), cos_o, 1 << 15);
            assert!((rough - 1.0).abs() < 0.03, "rough, index {ior} at {cos_o}: {rough}");
        }
    }
}

#[test]
fn a_clear_pane_loses_no_light_and_a_tinted_one_what_crosses() {
    let wo = direction(0.4);
    let pane = |tint| Bsdf::Dielectric(DielectricBsdf::thin(1.5, Rgb::splat(tint)));
    assert!((scattered(pane(1.0), wo, 16) - 1.0).abs() < 1e-5);
    // Summed by hand: the first reflection, and two crossings with any number of reflections between them.
    let (r, _) = crate::fresnel_dielectric(0.4, 1.5);
    let (t, mut expected) = (0.5_f32, r);
    let mut carried = t * t * (1.0 - r) * (1.0 - r);
    for _ in 0..60 {
        expected += carried;
        carried *= r;
    }
    let share = scattered(pane(t), wo, 24);
    assert!((share - expected).abs() < 2e-3, "{share} against {expected}");
    assert!((pane(t).albedo(wo).r - expected).abs() < 1e-5);
}

#[test]
fn nothing_gains_energy() {
    for alpha in ALPHAS {
        for cos_o in COSINES {
            for compensated in [false, true] {
                for bsdf in [metal(0.7, alpha, compensated), glass(1.5, alpha, compensated)] {
                    let share = scattered(bsdf, direction(cos_o), 16);
                    assert!(share < 1.0 + HALF_A_PERCENT, "{bsdf:?} at {cos_o}: {share}");
                }
            }
        }
    }
}

#[test]
fn albedo_estimates_the_scattered_share() {
    /// The albedo takes the Fresnel term at the macroscopic normal; this is how far that may be off.
    const TOLERANCE: f32 = 0.05;
    let gold = Metal::from_name("gold").expect("a listed metal");
    for alpha in [0.0, 0.1, 0.3, 0.7] {
        for compensated in [false, true] {
            let gold = ConductorBsdf::new(gold.into(), surface(alpha, compensated));
            let tinted = DielectricBsdf::new(1.5, Rgb::splat(0.8), surface(alpha, compensated));
            for bsdf in [Bsdf::Conductor(gold), Bsdf::Dielectric(tinted)] {
                for cos_o in [1.0, 0.6] {
                    let wo = direction(cos_o);
                    let (share, albedo) = (scattered(bsdf, wo, 20), bsdf.albedo(wo).mean());
                    assert!(
                        (share - albedo).abs() < TOLERANCE,
                        "{bsdf:?} at {cos_o}: {share}, {albedo}"
                    );
                }
            }
        }
    }
    let matte = Bsdf::Diffuse(DiffuseBsdf::new(Rgb::new(0.2, 0.4, 0.6)));
    assert_eq!(matte.albedo(Vec3::Z), Rgb::new(0.2, 0.4, 0.6));
    assert!((scattered(matte, Vec3::NEG_Z, 4) - 0.4).abs() < 1e-6);
}
