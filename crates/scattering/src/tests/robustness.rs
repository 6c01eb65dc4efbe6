use super::*;
use crate::{DiffuseBsdf, LobeClass, Metal, PrincipledParameters, Transport};
use proptest::prelude::*;

const TRANSPORTS: [Transport; 2] = [Transport::Radiance, Transport::Flux];

/// What must hold of any sample at any surface, whatever the input.
fn assert_sane(bsdf: &Bsdf, wo: Vec3, u_lobe: f32, u: Vec2) {
    for transport in TRANSPORTS {
        let Some(s) = bsdf.sample(wo, u_lobe, u, transport) else {
            continue;
        };
        assert!((s.wi.length() - 1.0).abs() < 1e-4, "{bsdf:?} {wo}: {s:?}");
        assert!(
            s.weight.is_finite() && s.weight.r >= 0.0 && s.weight.b >= 0.0,
            "{bsdf:?} {wo}: {s:?}"
        );
        assert_eq!(s.transmitted, s.wi.z * wo.z < 0.0, "{bsdf:?} {wo}: {s:?}");
        assert!(s.eta_sq_scale > 0.0 && (s.transmitted || s.eta_sq_scale == 1.0));
        assert!(if s.class == LobeClass::Specular {
            bsdf.has_specular()
        } else {
            bsdf.has_diffuse()
        });
        let (value, pdf) = (bsdf.eval(wo, s.wi, transport), bsdf.pdf(wo, s.wi, transport));
        if s.is_delta() {
            let alone = !matches!(bsdf, Bsdf::Plastic(_) | Bsdf::Principled(_));
            assert!(
                !alone || (value.total().is_black() && pdf == 0.0),
                "{bsdf:?} {wo}: {s:?}"
            );
            continue;
        }
        assert!(bsdf.needs_light_sampling());
        assert_eq!(bsdf.eval_and_pdf(wo, s.wi, transport), (value, pdf));
        assert!((pdf - s.pdf).abs() <= 1e-5 * s.pdf, "{bsdf:?} {wo}: {s:?} {pdf}");
        let of_class = if s.class == LobeClass::Specular {
            value.specular
        } else {
            value.diffuse
        };
        // One of the two classes is drawn, by what they carry.
        let weight = of_class * (value.total().mean() / of_class.mean() / pdf);
        if value.total().is_black() {
            assert_eq!(s.weight, Rgb::BLACK);
            continue;
        }
        assert!(
            (weight - s.weight).map(f32::abs).max_element() <= 1e-4 * weight.max_element(),
            "{bsdf:?} {wo}: {s:?}"
        );
    }
}

fn assert_finite(bsdf: &Bsdf, wo: Vec3, wi: Vec3) {
    for transport in TRANSPORTS {
        let (value, pdf) = (bsdf.eval(wo, wi, transport).total(), bsdf.pdf(wo, wi, transport));
        assert!(
            value.is_finite() && value.r >= 0.0 && value.g >= 0.0 && value.b >= 0.0,
            "{bsdf:?} {wo} {wi}"
        );
        assert!(pdf.is_finite() && pdf >= 0.0, "{bsdf:?} {wo} {wi}: {pdf}");
    }
    assert!(bsdf.albedo(wo).is_finite());
}

/// Directions with a fair share at the poles and the horizon.
fn any_direction() -> impl Strategy<Value = Vec3> {
    let z = prop_oneof![
        -1.0_f32..1.0,
        -1e-5_f32..1e-5,
        Just(1e-6),
        Just(-1e-6),
        Just(1.0),
        Just(-1.0),
        Just(0.0)
    ];
    (z, 0.0_f32..1.0).prop_map(|(z, phi)| {
        let (sin, cos) = math::sin_cos(std::f32::consts::TAU * phi);
        let r = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
        Vec3::new(r * cos, r * sin, z)
    })
}

fn any_bsdf() -> impl Strategy<Value = Bsdf> {
    let roughness = prop_oneof![0.0_f32..=1.0, Just(0.0), Just(1.0), 0.03_f32..0.04];
    let ior = prop_oneof![0.3_f32..4.0, Just(1.0), 0.999_f32..1.001, Just(1e-2), Just(100.0)];
    (roughness, ior, any::<bool>(), 0..10_usize, 0.0_f32..=1.0).prop_map(|(roughness, ior, compensated, kind, tone)| {
        let surface = Microsurface::from_roughness(roughness, SPECULAR_ALPHA).with_energy_compensation(compensated);
        let rgb = Rgb::new(tone, 1.0, 0.5 * tone);
        let metal = |fresnel| Bsdf::Conductor(ConductorBsdf::new(fresnel, surface));
        match kind {
            0 => Bsdf::Diffuse(DiffuseBsdf::new(rgb)),
            1 => metal(ConductorFresnel::Schlick(rgb)),
            2 => metal(ConductorFresnel::Complex {
                eta: rgb * ior,
                k: rgb * (8.0 * tone),
            }),
            3 => metal(Metal::ALL[(tone * 9.99) as usize].into()),
            4 => Bsdf::Dielectric(DielectricBsdf::thin(ior, rgb)),
            5 => plastic(rgb, ior, surface.alpha()),
            6 => {
                let zoo = principled_zoo(roughness, 1.0 - roughness);
                let (_, parameters) = zoo[(tone * 11.99) as usize];
                principled(PrincipledParameters {
                    base_color: rgb,
                    ior,
                    ..parameters
                })
            }
            7 => beckmann(surface.alpha()),
            8 => principled(PrincipledParameters {
                base_color: rgb,
                metallic: 0.5 * tone,
                roughness,
                ior,
                transmission: 1.0 - tone,
                solid: compensated,
                clearcoat: roughness,
                clearcoat_roughness: tone,
                sheen: rgb * roughness,
                sheen_roughness: tone,
                ..PrincipledParameters::default()
            }),
            _ => Bsdf::Dielectric(DielectricBsdf::new(ior, rgb, surface)),
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn nothing_is_ever_nan(bsdf in any_bsdf(), wo in any_direction(), wi in any_direction()) {
        assert_finite(&bsdf, wo, wi);
        assert_finite(&bsdf, wo, -wo);
        assert_finite(&bsdf, wo, wo);
    }

    #[test]
    fn samples_are_sane(
        bsdf in any_bsdf(), wo in any_direction(), u_lobe in 0.0_f32..1.0, x in 0.0_f32..1.0, y in 0.0_f32..1.0,
    ) {
        assert_sane(&bsdf, wo, u_lobe, Vec2::new(x, y));
        let last = 1.0 - f32::EPSILON / 2.0;
        for corner in [Vec2::ZERO, Vec2::splat(last), Vec2::new(0.0, last)] {
            assert_sane(&bsdf, wo, 0.0, corner);
            assert_sane(&bsdf, wo, last, corner);
        }
    }
}

#[test]
fn opaque_surfaces_scatter_to_one_side_only() {
    for bsdf in [Bsdf::Diffuse(DiffuseBsdf::new(Rgb::WHITE)), metal(1.0, 0.5, true)] {
        for (wo, wi) in [(0.5, -0.5), (-1e-6, 1e-6)] {
            let (wo, wi) = (direction(wo), direction(wi));
            assert_eq!(bsdf.eval(wo, wi, Transport::Radiance).total(), Rgb::BLACK);
            assert_eq!(bsdf.pdf(wo, wi, Transport::Radiance), 0.0);
        }
        let below = bsdf.sample(direction(-0.5), 0.5, Vec2::splat(0.3), Transport::Radiance);
        assert!(below.is_some_and(|s| s.wi.z < 0.0 && !s.transmitted));
    }
}

#[test]
fn grazing_light_keeps_its_weight() {
    let wo = direction(1e-6);
    for bsdf in [metal(1.0, 0.2, true), glass(1.5, 0.2, true)] {
        let mut numbers = Numbers(3 << 40);
        for _ in 0..1000 {
            let s = bsdf.sample(wo, numbers.next(), numbers.next_2d(), Transport::Flux);
            assert!(s.is_none_or(|s| s.weight.r < 4.0), "{s:?}");
        }
    }
}

#[test]
fn classes_are_those_of_the_threshold() {
    let mirror = metal(1.0, 0.0, true);
    assert!(mirror.has_specular() && !mirror.has_diffuse() && !mirror.needs_light_sampling());
    let glossy = metal(1.0, 0.04, true);
    assert!(glossy.has_specular() && !glossy.has_diffuse() && glossy.needs_light_sampling());
    let frosted = glass(1.5, 0.2, true);
    assert!(!frosted.has_specular() && frosted.has_diffuse() && frosted.needs_light_sampling());
    assert!(!Bsdf::Black.has_diffuse() && !Bsdf::Black.has_specular() && !Bsdf::Black.needs_light_sampling());
    assert_eq!(
        Bsdf::Black.sample(Vec3::Z, 0.5, Vec2::splat(0.5), Transport::Flux),
        None
    );
    let value = glossy.eval(direction(0.5), direction(0.5), Transport::Radiance);
    assert!(value.specular.r > 0.0 && value.diffuse.is_black());
}

#[test]
fn a_rough_interface_without_contrast_is_smooth() {
    let bsdf = glass(1.0, 0.5, true);
    let s = bsdf
        .sample(direction(0.3), 0.2, Vec2::splat(0.1), Transport::Radiance)
        .expect("passes");
    assert!(s.is_delta() && s.transmitted && (s.wi + direction(0.3)).length() < 1e-6 && s.weight == Rgb::WHITE);
}
