//! Every kind of light against closed forms, by light sampling, by chance and by photons.

mod common;

use common::{at, black, colour, diffuse, floor, frame, point_light, scene};
use glam::{DAffine3, DQuat, Mat3, Vec2, Vec3};
use radiometry::{Rgb, SampleStream, StageKey, math, warp};
use scattering::{Bsdf, ConductorBsdf, ConductorFresnel, Microsurface};
use spatial::{Ray, Shape};
use std::f64::consts::PI;
use std::sync::Arc;
use transport::{
    EmissionSampler, Environment, EnvironmentMap, LightSource, MapKinds, Material, PHOTON_STAGE, Scene, SpotCone,
    TargetSphere, trace_photon,
};

/// Shines straight down.
fn down() -> DQuat {
    DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2)
}

fn plane(albedo: f32) -> (Shape, DAffine3, Material) {
    let size = Vec2::splat(20.0);
    (Shape::Quad { size }, floor(), diffuse(albedo))
}

fn spot(inner: f32, outer: f32) -> LightSource {
    LightSource::Spot {
        frame: frame(Vec3::new(0.0, 2.0, 0.0), down()),
        intensity: Rgb::new(1.0, 2.0, 3.0),
        cone: SpotCone::from_half_angles(inner.to_radians(), outer.to_radians()),
    }
}

fn distant(degrees: f32) -> LightSource {
    LightSource::Distant {
        frame: frame(Vec3::ZERO, down()),
        irradiance: Rgb::new(1.0, 2.0, 3.0),
        half_angle: 0.5 * degrees.to_radians(),
    }
}

/// Looks at (x, 0, 0) from above.
fn look_at_floor(x: f32) -> Ray {
    let origin = Vec3::new(x + 0.3, 1.0, 0.4);
    Ray::new(origin, (Vec3::new(x, 0.0, 0.0) - origin).normalize())
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance * expected.abs(),
        "{found} instead of {expected}"
    );
}

#[test]
fn a_spot_fades_by_a_smoothstep_in_the_cosine() {
    let (inner, outer) = (20.0_f32, 35.0_f32);
    let scene = scene(&[plane(0.5)], vec![spot(inner, outer)]);
    for degrees in [0.0_f32, 15.0, 22.0, 27.0, 33.0, 36.0] {
        let (sin, cos) = math::sin_cos(degrees.to_radians());
        let seen = colour(&scene, look_at_floor(2.0 * sin / cos), 1);
        let (ci, co) = (math::cos(inner.to_radians()), math::cos(outer.to_radians()));
        let t = f64::from(((cos - co) / (ci - co)).clamp(0.0, 1.0));
        let irradiance = f64::from(cos).powi(3) / 4.0 * t * t * (3.0 - 2.0 * t);
        for (channel, intensity) in seen.into_iter().zip([1.0, 2.0, 3.0]) {
            let expected = irradiance * intensity * 0.5 / PI;
            assert!((channel - expected).abs() < 2e-4, "{degrees}: {channel} {expected}");
        }
    }
}

#[test]
fn a_spot_may_be_as_narrow_as_a_laser() {
    for outer in [0.01_f32, 0.03, 0.3] {
        // Others, so that the tree has to choose.
        let scene = scene(&[plane(0.5)], vec![spot(0.5 * outer, outer), spot(0.5 * outer, outer)]);
        let radians = f64::from(outer).to_radians();
        // π I ((1 − cos inner) + (1 − cos outer)), of both.
        let power = 2.0 * 2.0 * PI * 0.5 * radians * radians * 1.25;
        close(scene.lights.power(), power, 1e-3);
        // In the middle of the ramp by the cosine, where a smoothstep is one half.
        let x = 2.0 * (0.5 * (1.0 + 0.25_f32)).sqrt() * outer.to_radians();
        let seen = colour(&scene, look_at_floor(x), 256)[0];
        close(seen, 2.0 * 0.5 / 4.0 * 0.5 / PI, 0.02);
        // All photons are found within the cone.
        let sampler = EmissionSampler::uniform(&scene.lights);
        let flux: f64 = (0..4096)
            .filter_map(|i| sampler.emit(&SampleStream::new(0, PHOTON_STAGE, 0, i)))
            .map(|photon| f64::from(photon.flux.mean()))
            .sum();
        close(flux / 4096.0, power, 0.02);
    }
}

#[test]
fn photons_of_every_light_carry_its_flux() {
    let flux_into = |light: LightSource, targets: &[TargetSphere]| {
        let room = (Shape::Sphere { radius: 8.0 }, DAffine3::IDENTITY, diffuse(0.0));
        let scene = scene(&[room], vec![light]);
        let sampler = EmissionSampler::aimed(&scene.lights, targets, 0.5);
        let emitted = 1 << 15;
        let mut sum = 0.0;
        for path in 0..emitted {
            let stream = SampleStream::new(0, PHOTON_STAGE, 0, path);
            if let Some(photon) = sampler.emit(&stream) {
                sum += f64::from(photon.flux.g);
            }
        }
        sum / f64::from(emitted)
    };
    let target = [TargetSphere {
        centre: Vec3::new(0.5, -1.0, 0.0),
        radius: 1.0,
    }];
    let (ci, co) = (
        f64::from(math::cos(20_f32.to_radians())),
        f64::from(math::cos(35_f32.to_radians())),
    );
    for targets in [&[][..], &target] {
        close(flux_into(spot(20.0, 35.0), targets), 2.0 * PI * (2.0 - ci - co), 0.01);
        close(flux_into(spot(35.0, 35.0), targets), 2.0 * PI * (2.0 - 2.0 * co), 0.01);
        close(
            flux_into(point_light(Vec3::X, Rgb::splat(2.0)), targets),
            8.0 * PI,
            0.01,
        );
    }
    // Through a ball of radius 1, from outside.
    let ball = |light: LightSource, targets: &[TargetSphere]| {
        let shape = (Shape::Sphere { radius: 1.0 }, at(0.5, -1.0, 0.0), diffuse(0.0));
        let far = (Shape::Sphere { radius: 0.1 }, at(3.0, 3.0, 0.0), diffuse(0.0));
        let scene = scene(&[shape, far], vec![light]);
        landed_on(&scene, targets, 0)
    };
    for targets in [&[][..], &target] {
        close(ball(distant(0.0), targets), 2.0 * PI, 0.02);
        close(ball(distant(10.0), targets), 2.0 * PI, 0.02);
        close(ball(LightSource::Environment(sky()), targets), sky_fluence() * PI, 0.03);
    }
}

/// Flux that lands directly on an instance.
fn landed_on(scene: &Scene, targets: &[TargetSphere], instance: usize) -> f64 {
    let sampler = EmissionSampler::aimed(&scene.lights, targets, 0.5);
    let emitted = 1 << 16;
    let wanted = MapKinds {
        direct: true,
        caustic: false,
        indirect: false,
    };
    let bounds = scene.rays.instance_bounds(instance as u32);
    let mut sum = 0.0;
    for path in 0..emitted {
        let stream = SampleStream::new(0, PHOTON_STAGE, 0, path);
        if let Some(photon) = sampler.emit(&stream) {
            trace_photon(scene, &photon, wanted, 1, path, &stream, |deposit| {
                if deposit.position.clamp(bounds.min, bounds.max) == deposit.position {
                    sum += f64::from(deposit.flux.g);
                }
            });
        }
    }
    sum / f64::from(emitted)
}

#[test]
fn a_distant_light_gives_its_irradiance_however_wide_it_is() {
    for degrees in [0.0_f32, 0.53, 20.0] {
        let scene = scene(&[plane(0.5)], vec![distant(degrees)]);
        let seen = colour(&scene, look_at_floor(0.0), 1 << 12);
        for (channel, irradiance) in seen.into_iter().zip([1.0, 2.0, 3.0]) {
            close(channel, irradiance * 0.5 / PI, 2e-3);
        }
        // Its disc is seen by whoever looks there, its point is not.
        let up = colour(&scene, Ray::new(Vec3::Y, Vec3::Y), 1);
        let sin = f64::from(math::sin((0.5_f32 * degrees).to_radians()));
        let expected = if degrees > 0.0 { 2.0 / (PI * sin * sin) } else { 0.0 };
        assert!((up[1] - expected).abs() <= 1e-3 * expected, "{up:?} {expected}");
        let beside = colour(&scene, Ray::new(Vec3::Y, Vec3::new(0.3, 1.0, 0.0).normalize()), 1);
        assert_eq!(beside, [0.0; 3]);
    }
}

/// Blue above, a warm patch, dark below; turned.
fn sky() -> Environment {
    let (width, height) = (64, 32);
    let texel = |i: usize| {
        let (x, y) = (i % width, i / width);
        match (x, y) {
            (20..24, 4..8) => Rgb::new(40.0, 30.0, 20.0),
            (_, 0..16) => Rgb::new(0.5, 0.7, 1.0),
            _ => Rgb::new(0.1, 0.08, 0.05),
        }
    };
    Environment {
        radiance: Rgb::splat(0.5),
        map: Some(Arc::new(EnvironmentMap::new(
            width,
            height,
            (0..width * height).map(texel).collect(),
        ))),
        map_from_world: Mat3::from_quat(glam::Quat::from_rotation_y(0.7) * glam::Quat::from_rotation_x(0.3)),
    }
}

/// ∫ L dω of the green channel by brute force.
fn sky_fluence() -> f64 {
    let sky = sky();
    let n = 1 << 18;
    let sum: f64 = (0..n).map(|i| f64::from(sky.radiance_from(uniform(i)).g)).sum();
    sum / f64::from(n) * 4.0 * PI
}

fn uniform(i: u32) -> Vec3 {
    warp::sample_uniform_sphere(SampleStream::new(9, StageKey::new("uniform"), 0, i).draw_2d(0, 0)).normalize()
}

#[test]
fn an_environment_map_lights_a_plane_as_its_integral_says() {
    let sky = sky();
    let n = 1 << 18;
    let mut irradiance = [0.0; 3];
    for i in 0..n {
        let direction = uniform(i);
        for (sum, value) in irradiance.iter_mut().zip(sky.radiance_from(direction).to_array()) {
            *sum += f64::from(value * direction.y.max(0.0)) * 4.0 * PI / f64::from(n);
        }
    }
    let scene = scene(&[plane(0.5)], vec![LightSource::Environment(sky.clone())]);
    let seen = colour(&scene, look_at_floor(0.0), 1 << 14);
    for (channel, irradiance) in seen.into_iter().zip(irradiance) {
        close(channel, irradiance * 0.5 / PI, 0.01);
    }
    // Seen directly, and in a rough mirror against the same without light sampling.
    let up = Vec3::new(0.2, 0.9, -0.3).normalize();
    let direct = colour(&scene, Ray::new(Vec3::Y, up), 1);
    close(direct[0], f64::from(sky.radiance_from(up).r), 1e-4);
}

#[test]
fn a_rough_mirror_sees_a_sun_by_both_techniques() {
    // In a white furnace of a sky with a disc, a lossless mirror of any roughness shows the mean of what it reflects.
    for roughness in [0.2, 0.5, 1.0] {
        let mirror = Material {
            bsdf: Bsdf::Conductor(ConductorBsdf::new(
                ConductorFresnel::Constant(Rgb::WHITE),
                Microsurface::from_roughness(roughness, 0.05),
            )),
            ..Material::default()
        };
        let shape = Shape::Quad {
            size: Vec2::splat(20.0),
        };
        let lights = vec![
            LightSource::Environment(Environment::uniform(Rgb::WHITE)),
            distant(30.0),
        ];
        let both = scene(&[(shape, floor(), mirror.clone())], lights);
        let sun = scene(&[(shape, floor(), mirror)], vec![distant(30.0)]);
        let ray = Ray::new(Vec3::new(0.0, 1.0, 0.0), Vec3::NEG_Y);
        let (both, sun) = (colour(&both, ray, 1 << 14)[1], colour(&sun, ray, 1 << 14)[1]);
        close(both, sun + 1.0, 0.01);
    }
}

/// Lamps of three kinds around a point, some facing away.
fn many_lights(n: u32) -> (Vec<(Shape, DAffine3, Material)>, Vec<LightSource>) {
    let mut shapes = vec![plane(0.5)];
    let mut lights = Vec::new();
    for i in 0..n {
        let s = SampleStream::new(6, StageKey::new("many"), 0, i);
        let place = warp::sample_uniform_sphere(s.draw_2d(0, 0)) * (4.0 * s.draw_1d(0, 1)) + Vec3::Y * 5.0;
        let strength = Rgb::splat(0.1 + 2.0 * s.draw_1d(0, 2));
        if i % 3 == 0 {
            lights.push(point_light(place, strength));
            continue;
        }
        let shape = match i % 3 {
            1 => Shape::Sphere { radius: 0.1 },
            _ => Shape::Disc { radius: 0.2 },
        };
        let turn = DAffine3::from_rotation_x(f64::from(6.0 * s.draw_1d(0, 3)));
        let place = place.as_dvec3();
        shapes.push((shape, at(place.x, place.y, place.z) * turn, black()));
        lights.push(LightSource::Area {
            instance: shapes.len() as u32 - 1,
            radiance: strength * 20.0,
            texture: None,
            two_sided: i % 5 == 0,
        });
    }
    (shapes, lights)
}

#[test]
fn many_lights_add_up_and_the_tree_is_less_noisy_than_chance() {
    let (shapes, lights) = many_lights(90);
    let ray = look_at_floor(0.5);
    // One by one, each alone in the scene of all.
    let expected: f64 = lights
        .iter()
        .map(|light| colour(&scene(&shapes, vec![light.clone()]), ray, 256)[1])
        .sum();
    let all = scene(&shapes, lights.clone());
    let seen = colour(&all, ray, 1 << 14)[1];
    close(seen, expected, 0.01);
    // Variance of one light sample against that of a light chosen evenly.
    let (mut tree, mut even) = (Moments::default(), Moments::default());
    let point = all
        .rays
        .intersect(&ray)
        .map(|hit| all.rays.surface(&ray, &hit))
        .expect("the floor");
    let alone: Vec<Scene> = lights.iter().map(|light| scene(&shapes, vec![light.clone()])).collect();
    for i in 0..1 << 13 {
        let s = SampleStream::new(1, StageKey::new("variance"), 0, i);
        let (choice, u) = (s.draw_2d(0, 0), s.draw_2d(0, 1));
        let value = |scene: &Scene, probability: f64| {
            scene.lights.sample(point.p, 0.0, choice, u).map_or(0.0, |light| {
                let lit = !scene.rays.occluded(&light.shadow_ray(&point));
                f64::from(light.radiance.g * light.wi.y.max(0.0) / light.pdf) * f64::from(u8::from(lit)) / probability
            })
        };
        tree.add(value(&all, 1.0));
        let chosen = ((s.draw_1d(0, 2) * alone.len() as f32) as usize).min(alone.len() - 1);
        even.add(value(&alone[chosen], 1.0 / alone.len() as f64));
    }
    close(tree.mean(), even.mean(), 0.1);
    assert!(
        tree.variance() < 0.5 * even.variance(),
        "{} {}",
        tree.variance(),
        even.variance()
    );
}

#[derive(Default)]
struct Moments {
    n: f64,
    sum: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, x: f64) {
        self.n += 1.0;
        self.sum += x;
        self.squares += x * x;
    }

    fn mean(&self) -> f64 {
        self.sum / self.n
    }

    fn variance(&self) -> f64 {
        self.squares / self.n - self.mean() * self.mean()
    }
}
