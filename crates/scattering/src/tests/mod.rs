//! Statistical tests of every lobe: all deterministic, since their random numbers are hashes of a counter.

mod chi_square;
mod furnace;
mod reciprocity;
mod robustness;

use crate::{Bsdf, ConductorBsdf, ConductorFresnel, DielectricBsdf, Microsurface};
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

fn glass(ior: f32, alpha: f32, compensated: bool) -> Bsdf {
    Bsdf::Dielectric(DielectricBsdf::new(ior, Rgb::WHITE, surface(alpha, compensated)))
}

/// A direction by the cosine of its polar angle, at an azimuth that no symmetry favours.
fn direction(cos_theta: f32) -> Vec3 {
    let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).max(0.0).sqrt();
    let (sin, cos) = math::sin_cos(0.7);
    Vec3::new(sin_theta * cos, sin_theta * sin, cos_theta)
}
