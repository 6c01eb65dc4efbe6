//! White furnace and bookkeeping of surfaces with several lobes.

use super::furnace::{HALF_A_PERCENT, scattered};
use super::*;
use crate::{LobeClass, Transport};
use std::f32::consts::PI;

/// The grazing angle of 89°, and others.
const MANY_COSINES: [f32; 9] = [1.0, 0.8, 0.5, 0.25, 0.1, 0.05, 0.017_452, 0.005, 1e-4];
const ROUGHNESSES: [f32; 9] = [0.0, 0.032, 0.06, 0.1, 0.25, 0.4, 0.55, 0.8, 1.0];

fn assert_lossless(name: &str, bsdf: Bsdf, tolerance: f32) {
    let mut sides = vec![1.0];
    if bsdf.transmits() {
        sides.push(-1.0);
    }
    for cos_o in MANY_COSINES.into_iter().flat_map(|c| sides.iter().map(move |s| s * c)) {
        let share = scattered(bsdf, direction(cos_o), 32);
        assert!((share - 1.0).abs() < tolerance, "{name} at {cos_o}: {share}");
    }
}

#[test]
fn white_plastic_loses_no_light() {
    for ior in [1.0, 1.1, 1.5, 2.2, 4.0] {
        for roughness in ROUGHNESSES {
            let name = format!("plastic of index {ior}, roughness {roughness}");
            assert_lossless(&name, plastic(Rgb::WHITE, ior, roughness * roughness), HALF_A_PERCENT);
        }
    }
}

#[test]
fn plastic_has_the_formula_of_the_smooth_coat() {
    let (albedo, ior) = (0.7, 1.5);
    let (wo, wi) = (direction(0.6), direction(0.3));
    let f = |mu| crate::fresnel_dielectric(mu, ior).0;
    let internal = crate::average_fresnel_dielectric(1.0 / ior);
    let expected = (1.0 - f(0.6)) * (1.0 - f(0.3)) * albedo / (PI * ior * ior * (1.0 - albedo * internal));
    let value = plastic(Rgb::splat(albedo), ior, 0.0).eval(wo, wi, Transport::Radiance);
    assert!((value.diffuse.r / 0.3 - expected).abs() < 1e-5 && value.specular.is_black());
}

#[test]
fn white_parts_of_the_layered_model_lose_no_light() {
    for roughness in [0.0, 0.06, 0.25, 0.5, 1.0] {
        for (clearcoat, clearcoat_roughness) in [(0.0, 0.0), (1.0, 0.0), (0.5, 0.7)] {
            for (metallic, transmission) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)] {
                let parameters = PrincipledParameters {
                    metallic,
                    roughness,
                    transmission,
                    clearcoat,
                    clearcoat_roughness,
                    ..PrincipledParameters::default()
                };
                assert_lossless(&format!("{parameters:?}"), principled(parameters), HALF_A_PERCENT);
            }
        }
    }
}

#[test]
fn clear_solids_lose_no_light() {
    for roughness in ROUGHNESSES {
        let parameters = PrincipledParameters {
            roughness,
            ior: 1.4,
            transmission: 1.0,
            solid: true,
            clearcoat: 0.5,
            clearcoat_roughness: 0.2,
            ..PrincipledParameters::default()
        };
        assert_lossless(&format!("{parameters:?}"), principled(parameters), HALF_A_PERCENT);
    }
}

#[test]
fn colours_and_cloth_gain_no_energy() {
    for roughness in [0.0, 0.2, 0.6, 1.0] {
        for (name, parameters) in principled_zoo(roughness, 0.5) {
            for sheen_roughness in [0.0, 0.6] {
                let white = PrincipledParameters {
                    base_color: Rgb::WHITE,
                    specular_color: Rgb::WHITE,
                    sheen_roughness,
                    ..parameters
                };
                for cos_o in MANY_COSINES {
                    let share = scattered(principled(white), direction(cos_o), 20);
                    assert!(
                        share < 1.0 + HALF_A_PERCENT,
                        "{name}, {roughness}, {sheen_roughness} at {cos_o}: {share}"
                    );
                }
            }
        }
    }
}

#[test]
fn albedos_of_layers_estimate_what_they_scatter() {
    /// The solid takes its Fresnel term at the macroscopic normal, and sheen takes more from what is below it than the
    /// albedo knows: min of both directions.
    const TOLERANCE: f32 = 0.08;
    for cos_o in [1.0, 0.5] {
        let wo = direction(cos_o);
        for (name, parameters) in principled_zoo(0.5, 0.3) {
            let (share, albedo) = (
                scattered(principled(parameters), wo, 24),
                principled(parameters).albedo(wo).mean(),
            );
            assert!(
                (share - albedo).abs() < TOLERANCE,
                "{name} at {cos_o}: {share}, {albedo}"
            );
        }
        let bsdf = plastic(Rgb::new(0.9, 0.4, 0.1), 1.5, 0.2);
        let (share, albedo) = (scattered(bsdf, wo, 24), bsdf.albedo(wo).mean());
        assert!((share - albedo).abs() < 5e-3, "{share}, {albedo}");
    }
}

/// Mean weight of the samples of each class against the integral of the lobes of that class.
#[test]
fn each_class_gets_what_its_lobes_reflect() {
    let mixed = PrincipledParameters {
        metallic: 0.5,
        roughness: 0.2,
        base_color: Rgb::new(0.9, 0.5, 0.2),
        clearcoat: 0.5,
        clearcoat_roughness: 0.5,
        ..PrincipledParameters::default()
    };
    for bsdf in [plastic(Rgb::new(0.9, 0.3, 0.1), 1.8, 0.04), principled(mixed)] {
        let wo = direction(0.7);
        let (mut credited, mut integrated) = ([Rgb::BLACK; 2], [Rgb::BLACK; 2]);
        let mut numbers = Numbers(77 << 40);
        let n = 200_000;
        for _ in 0..n {
            let Some(s) = bsdf.sample(wo, numbers.next(), numbers.next_2d(), Transport::Radiance) else {
                continue;
            };
            let values = bsdf.eval(wo, s.wi, Transport::Radiance);
            credited[usize::from(s.class == LobeClass::Diffuse)] += s.weight / n as f32;
            integrated[0] += values.specular / (s.pdf * n as f32);
            integrated[1] += values.diffuse / (s.pdf * n as f32);
        }
        for class in 0..2 {
            let difference = (credited[class] - integrated[class]).map(f32::abs).max_element();
            assert!(
                credited[class].r > 0.05 && difference < 5e-3,
                "{credited:?} {integrated:?}"
            );
        }
    }
}
