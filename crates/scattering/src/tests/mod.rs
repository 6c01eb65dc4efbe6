//! Statistical tests of every lobe: all deterministic, since their random numbers are hashes of a counter.

mod chi_square;
mod furnace;
mod layered;
mod reciprocity;
mod robustness;

use crate::{
    Bsdf, ConductorBsdf, ConductorFresnel, DielectricBsdf, Metal, Microsurface, NormalDistribution, PlasticBsdf,
    PrincipledBsdf, PrincipledParameters,
};
use glam::{Vec2, Vec3};
use radiometry::{Rgb, hash_u64, math};

/// Independent random numbers: chi-square wants them, where a low-discrepancy sequence would look too good.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 += 1;
        (hash_u64(self.0) >> 40) as f32 / 16_777_216.0
    }

    fn next_2d(&mut self) -> Vec2 {
        Vec2::new(self.next(), self.next())
    }
}

/// Threshold of S in these tests.
const SPECULAR_ALPHA: f32 = 0.05;

fn surface(alpha: f32, compensated: bool) -> Microsurface {
    Microsurface::from_roughness(alpha.sqrt(), SPECULAR_ALPHA).with_energy_compensation(compensated)
}

fn metal(reflectance: f32, alpha: f32, compensated: bool) -> Bsdf {
    let fresnel = ConductorFresnel::Constant(Rgb::splat(reflectance));
    Bsdf::Conductor(ConductorBsdf::new(fresnel, surface(alpha, compensated)))
}

/// Gold of a Beckmann surface.
fn beckmann(alpha: f32) -> Bsdf {
    let gold = Metal::from_name("gold").expect("a listed metal");
    let bsdf = ConductorBsdf::new(gold.into(), surface(alpha, true));
    Bsdf::Conductor(bsdf.with_distribution(NormalDistribution::Beckmann))
}

fn glass(ior: f32, alpha: f32, compensated: bool) -> Bsdf {
    Bsdf::Dielectric(DielectricBsdf::new(ior, Rgb::WHITE, surface(alpha, compensated)))
}

fn plastic(albedo: Rgb, ior: f32, alpha: f32) -> Bsdf {
    Bsdf::Plastic(PlasticBsdf::new(albedo, ior, surface(alpha, true)))
}

fn principled(parameters: PrincipledParameters) -> Bsdf {
    Bsdf::Principled(PrincipledBsdf::new(&parameters, SPECULAR_ALPHA))
}

/// One of each part of the layered model, and mixtures of them, in colour.
fn principled_zoo(roughness: f32, clearcoat_roughness: f32) -> Vec<(&'static str, PrincipledParameters)> {
    let plain = PrincipledParameters {
        base_color: Rgb::new(0.9, 0.5, 0.2),
        roughness,
        clearcoat_roughness,
        ..PrincipledParameters::default()
    };
    let metal = PrincipledParameters { metallic: 1.0, ..plain };
    let wall = PrincipledParameters {
        transmission: 1.0,
        ..plain
    };
    let solid = PrincipledParameters { solid: true, ..wall };
    let sheen = PrincipledParameters {
        sheen: Rgb::new(0.8, 0.6, 0.9),
        sheen_roughness: 0.4,
        ..plain
    };
    let coated = |p: PrincipledParameters| PrincipledParameters { clearcoat: 1.0, ..p };
    let mixed = |p: PrincipledParameters| PrincipledParameters {
        metallic: 0.3,
        transmission: 0.6,
        clearcoat: 0.5,
        specular: 0.7,
        specular_color: Rgb::new(1.0, 2.0, 0.5),
        ..p
    };
    vec![
        ("opaque", plain),
        ("metal", metal),
        ("wall", wall),
        ("solid", solid),
        ("cloth", sheen),
        ("coated opaque", coated(plain)),
        ("coated metal", coated(metal)),
        ("coated wall", coated(wall)),
        ("coated solid", coated(solid)),
        ("mixed wall", mixed(wall)),
        ("mixed solid", mixed(solid)),
        ("mixed cloth", mixed(sheen)),
    ]
}

/// A direction by the cosine of its polar angle, at an azimuth that no symmetry favours.
fn direction(cos_theta: f32) -> Vec3 {
    let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).max(0.0).sqrt();
    let (sin, cos) = math::sin_cos(0.7);
    Vec3::new(sin_theta * cos, sin_theta * sin, cos_theta)
}
