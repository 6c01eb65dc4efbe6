use super::*;
use crate::{DiffuseBsdf, Transport};
use radiometry::warp;

/// Pairs of directions away from the horizon, where the ratio of two small numbers would be compared.
fn pairs(n: usize) -> impl Iterator<Item = (Vec3, Vec3)> {
    let mut numbers = Numbers(99 << 40);
    let mut draw = move || warp::sample_uniform_sphere(numbers.next_2d());
    std::iter::repeat_with(move || (draw(), draw()))
        .filter(|(a, b)| a.z.abs() > 0.02 && b.z.abs() > 0.02)
        .take(n)
}

/// f from both ends: `eval(ω_o, ω_i, Flux)/|cosθ_i|` and `eval(ω_i, ω_o, Radiance)/|cosθ_o|`.
fn both_ways(bsdf: &Bsdf, wo: Vec3, wi: Vec3) -> (Rgb, Rgb) {
    (
        bsdf.eval(wo, wi, Transport::Flux).total() / wi.z.abs(),
        bsdf.eval(wi, wo, Transport::Radiance).total() / wo.z.abs(),
    )
}

fn is_same(a: f32, b: f32) -> bool {
    /// Relative; the half-vector of refraction cancels when the indices are close.
    const TOLERANCE: f32 = 2e-3;
    /// Absolute; what rounding makes of a transmittance that vanishes at the critical angle.
    const TINY: f32 = 1e-5;
    (a - b).abs() <= TOLERANCE * a.max(b) + TINY
}

fn assert_reciprocal(name: &str, bsdf: &Bsdf) {
    let mut positive = 0;
    for (wo, wi) in pairs(4000) {
        let (flux, radiance) = both_ways(bsdf, wo, wi);
        positive += usize::from(flux.r > 0.0);
        for channel in 0..3 {
            let (a, b) = (flux[channel], radiance[channel]);
            assert!(is_same(a, b), "{name}: {wo} {wi}: {a} {b}");
        }
    }
    assert!(positive > 1000, "{name}: only {positive} pairs scatter");
}

#[test]
fn matt_surfaces_and_sheen_are_reciprocal() {
    assert_reciprocal("diffuse", &Bsdf::Diffuse(DiffuseBsdf::new(Rgb::new(0.9, 0.5, 0.1))));
    for sheen_roughness in [0.2, 0.6, 1.0] {
        let cloth = PrincipledParameters {
            base_color: Rgb::new(0.5, 0.9, 0.1),
            sheen: Rgb::new(0.9, 0.4, 1.0),
            sheen_roughness,
            ..PrincipledParameters::default()
        };
        assert_reciprocal("cloth", &principled(cloth));
    }
}

/// The comparison finds what is not reciprocal: glass without the η² of radiance.
#[test]
#[should_panic(expected = "forgetful")]
fn a_missing_square_of_eta_is_noticed() {
    let bsdf = glass(1.2, 0.4, true);
    for (wo, wi) in pairs(4000).filter(|(a, b)| a.z * b.z < 0.0) {
        let f = |a: Vec3, b: Vec3| bsdf.eval(a, b, Transport::Flux).total().r / b.z.abs();
        assert!(is_same(f(wo, wi), f(wi, wo)), "forgetful glass");
    }
}

#[test]
fn delta_lobes_send_light_back_where_it_came_from() {
    let gold = Metal::from_name("gold").expect("a listed metal");
    let mirror = Bsdf::Conductor(ConductorBsdf::new(gold.into(), surface(0.0, true)));
    let pane = Bsdf::Dielectric(DielectricBsdf::thin(1.5, Rgb::splat(0.8)));
    for (bsdf, u_lobe) in [(mirror, 0.5), (pane, 0.0), (pane, 0.999)] {
        for cos_o in [0.9, 0.3, -0.6] {
            let wo = direction(cos_o);
            let draw = |wo| {
                bsdf.sample(wo, u_lobe, Vec2::ZERO, Transport::Radiance)
                    .expect("a delta lobe")
            };
            let there = draw(wo);
            let back = draw(there.wi);
            assert!((back.wi - wo).length() < 1e-6 && back.transmitted == there.transmitted);
            assert!((back.weight - there.weight).map(f32::abs).max_element() < 1e-6);
        }
    }
}

#[test]
fn metals_are_reciprocal() {
    let gold = Metal::from_name("gold").expect("a listed metal");
    for alpha in [0.1, 0.4, 1.0] {
        for compensated in [false, true] {
            let bsdf = Bsdf::Conductor(ConductorBsdf::new(gold.into(), surface(alpha, compensated)));
            assert_reciprocal("gold", &bsdf);
        }
    }
    for alpha in [0.2, 0.4, 1.0] {
        assert_reciprocal("gold of Beckmann", &beckmann(alpha));
    }
}

#[test]
fn flux_through_glass_is_the_adjoint_of_radiance() {
    for ior in [1.2, 1.5, 2.4, 0.7] {
        for alpha in [0.1, 0.4, 1.0] {
            for compensated in [false, true] {
                assert_reciprocal(&format!("glass {ior}, α {alpha}"), &glass(ior, alpha, compensated));
            }
        }
    }
}

#[test]
fn plastics_are_reciprocal() {
    for ior in [1.2, 2.4] {
        for alpha in [0.0, 0.1, 1.0] {
            assert_reciprocal("plastic", &plastic(Rgb::new(0.9, 0.5, 0.1), ior, alpha));
        }
    }
}

#[test]
fn all_parts_of_the_layered_model_are_reciprocal() {
    for (roughness, clearcoat_roughness) in [(0.5, 0.3), (0.35, 1.0), (0.9, 0.0)] {
        for (name, parameters) in principled_zoo(roughness, clearcoat_roughness) {
            // A smooth coat of glass leaves nothing to evaluate.
            if principled(parameters).needs_light_sampling() {
                assert_reciprocal(name, &principled(parameters));
            }
        }
    }
}

#[test]
fn smooth_refraction_is_reversible_and_carries_the_square_of_eta() {
    let bsdf = glass(1.5, 0.0, false);
    let wo = direction(0.6);
    let radiance = bsdf
        .sample(wo, 0.999, Vec2::ZERO, Transport::Radiance)
        .expect("refracts");
    assert!(radiance.transmitted && radiance.is_delta() && radiance.wi.z < 0.0);
    assert!((radiance.weight.r - 1.0 / 2.25).abs() < 1e-6 && radiance.eta_sq_scale == radiance.weight.r);
    // Snell: the tangential part shrinks by 1/1.5.
    assert!((radiance.wi.truncate() * 1.5 + wo.truncate()).length() < 1e-6);
    let flux = bsdf.sample(wo, 0.999, Vec2::ZERO, Transport::Flux).expect("refracts");
    assert_eq!(
        (flux.weight, flux.eta_sq_scale, flux.wi),
        (Rgb::WHITE, 1.0, radiance.wi)
    );
    let back = bsdf
        .sample(radiance.wi, 0.999, Vec2::ZERO, Transport::Radiance)
        .expect("refracts");
    assert!((back.wi - wo).length() < 1e-6 && (back.weight.r - 2.25).abs() < 1e-5);
}

#[test]
fn beyond_the_critical_angle_glass_only_reflects() {
    for alpha in [0.0, 0.01] {
        let bsdf = glass(1.5, alpha, false);
        let wo = direction(-0.5);
        let mut numbers = Numbers(5 << 40);
        for _ in 0..1000 {
            let sample = bsdf.sample(wo, numbers.next(), numbers.next_2d(), Transport::Radiance);
            assert!(sample.is_none_or(|s| !s.transmitted && s.wi.z < 0.0 && s.eta_sq_scale == 1.0));
        }
    }
}

#[test]
fn a_nearly_smooth_surface_tends_to_the_smooth_one() {
    // Means of weight and direction of a narrow lobe against the delta lobe, both sides, both transports.
    for transport in [Transport::Radiance, Transport::Flux] {
        for cos_o in [0.8, -0.9] {
            let wo = direction(cos_o);
            let mean = |bsdf: Bsdf| {
                let mut numbers = Numbers(8 << 40);
                let mut sum = (0.0, Vec3::ZERO);
                for _ in 0..20_000 {
                    if let Some(s) = bsdf.sample(wo, numbers.next(), numbers.next_2d(), transport) {
                        let w = s.weight.r / 20_000.0;
                        sum = (sum.0 + w, sum.1 + w * s.wi);
                    }
                }
                sum
            };
            let (smooth, narrow) = (mean(glass(1.5, 0.0, true)), mean(glass(1.5, 0.003, true)));
            assert!((smooth.0 - narrow.0).abs() < 0.01, "{smooth:?} {narrow:?}");
            assert!((smooth.1 - narrow.1).length() < 0.01, "{smooth:?} {narrow:?}");
        }
    }
}
