//! Light transport against closed forms: what any correct implementation shows.

mod common;

use common::{at, black, diffuse, floor, glass, point_light, radiance, radiance_with, scene};
use glam::{DAffine3, Vec3};
use radiometry::{Rgb, SampleStream, StageKey};
use scattering::{Bsdf, ConductorBsdf, ConductorFresnel, DielectricBsdf, Microsurface};
use spatial::{PhotonTree, Ray, Shape};
use std::sync::Arc;
use transport::{
    CausticMethod, DensityFilter, DensityScratch, DensitySettings, EmissionSampler, Environment, Event, Layer,
    LightSource, MapKind, MapKinds, Material, Methods, PHOTON_STAGE, Path, PathMedium, PhotonColumns, PhotonMap,
    PhotonMaps, PhotonSurface, Scene, TargetSphere, Vertex, arrive, emitted_light, scatter, trace_photon,
};

/// The caustic photons of `emitted` paths.
fn caustic_map(scene: &Scene, emitted: u32, density: DensitySettings) -> PhotonMaps {
    let sampler = EmissionSampler::aimed(&scene.lights, scene.specular_targets(), 0.1);
    let mut landed = Vec::new();
    for path in 0..emitted {
        let stream = SampleStream::new(3, PHOTON_STAGE, 0, path);
        if let Some(photon) = sampler.emit(&stream) {
            trace_photon(scene, &photon, MapKinds::CAUSTIC, 64, path, &stream, |deposit| {
                landed.push(deposit)
            });
        }
    }
    let tree = PhotonTree::from_fn(landed.len(), |row| landed[row].position).expect("finite positions");
    let rows = || tree.rows().iter().map(|row| &landed[*row as usize]);
    let columns = PhotonColumns {
        flux: rows().map(|d| d.flux * (1.0 / emitted as f32)).collect(),
        direction: rows().map(|d| radiometry::pack_direction(d.direction)).collect(),
        surface: rows().map(|d| PhotonSurface::open(d.normal)).collect(),
    };
    let mut maps = PhotonMaps::default();
    maps.insert(MapKind::Caustic, PhotonMap { tree, columns, density });
    maps
}

#[test]
fn frosted_glass_shows_a_caustic_from_behind() {
    // A lamp behind a frosted pane shines away from it, onto a mirror that sends the light back through the pane.
    let surface = Microsurface::from_roughness(0.8, 0.05);
    let frosted = Bsdf::Dielectric(DielectricBsdf::new(1.5, Rgb::WHITE, surface));
    let mirror = Bsdf::Conductor(ConductorBsdf::new(
        ConductorFresnel::Constant(Rgb::splat(0.9)),
        Microsurface::SMOOTH,
    ));
    let material = |bsdf| Material {
        bsdf,
        ..Material::default()
    };
    let shapes = [
        (
            Shape::Cuboid {
                size: Vec3::new(4.0, 4.0, 0.1),
            },
            DAffine3::IDENTITY,
            material(frosted),
        ),
        (
            Shape::Quad {
                size: glam::Vec2::splat(6.0),
            },
            at(0.0, 0.0, -2.0),
            material(mirror),
        ),
        (
            Shape::Quad {
                size: glam::Vec2::splat(0.8),
            },
            at(0.9, 0.0, -1.0) * DAffine3::from_rotation_x(std::f64::consts::PI),
            black(),
        ),
    ];
    let light = LightSource::Area {
        instance: 2,
        radiance: Rgb::splat(10.0),
        texture: None,
        two_sided: false,
    };
    let scene = scene(&shapes, vec![light]);
    let ray = Ray::new(Vec3::new(0.0, 0.0, 3.0), Vec3::NEG_Z);
    let traced: f64 = radiance(&scene, &Methods::TRACED, ray, 1 << 16).iter().sum();
    let density = DensitySettings {
        nearest: 200,
        max_radius: 0.5,
        filter: DensityFilter::Cone,
        shrink: 1.0,
    };
    let maps = caustic_map(&scene, 1 << 17, density);
    let methods = Methods {
        caustic: CausticMethod::PhotonMap,
        ..Methods::TRACED
    };
    let mapped: f64 = radiance_with(&scene, &methods, &maps, ray, 1 << 14).iter().sum();
    // Without what comes through from behind hardly anything is left; noise and blur are a few per cent.
    assert!(
        (mapped / traced - 1.0).abs() < 0.06,
        "photon map {mapped}, traced {traced}"
    );
}

#[test]
fn point_light_over_a_plane_gives_flux_over_four_pi_h_squared() {
    let (flux, height, albedo) = (100.0_f32, 2.0, 0.5);
    let intensity = Rgb::splat(flux / (4.0 * std::f32::consts::PI));
    let plane = (
        Shape::Quad {
            size: glam::Vec2::splat(10.0),
        },
        floor(),
        diffuse(albedo),
    );
    let scene = scene(&[plane], vec![point_light(Vec3::new(0.0, height, 0.0), intensity)]);
    let ray = Ray::new(Vec3::new(1.0, 1.0, 0.0), Vec3::new(-1.0, -1.0, 0.0).normalize());
    let seen = radiance(&scene, &Methods::TRACED, ray, 1);
    let irradiance = f64::from(flux) / (4.0 * std::f64::consts::PI * f64::from(height * height));
    let expected = irradiance * f64::from(albedo) / std::f64::consts::PI;
    assert!(
        (seen[Layer::Direct as usize] - expected).abs() < 1e-5 * expected,
        "{seen:?}, expected {expected}"
    );
}

#[test]
fn a_closed_furnace_shines_alike_everywhere() {
    let albedo = 0.5;
    let room = (Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY, diffuse(albedo));
    let light = LightSource::Area {
        instance: 0,
        radiance: Rgb::splat(1.0 - albedo),
        texture: None,
        two_sided: true,
    };
    let scene = scene(&[room], vec![light]);
    let seen = radiance(
        &scene,
        &Methods::TRACED,
        Ray::new(Vec3::new(0.1, 0.2, 0.0), Vec3::X),
        16_384,
    );
    let (total, emission) = (seen.iter().sum::<f64>(), seen[Layer::Emission as usize]);
    assert!((total - 1.0).abs() < 0.005, "{seen:?}");
    assert!((emission - 0.5).abs() < 1e-6);
    // One reflection in a furnace: ρ L_e, the rest is indirect.
    assert!((seen[Layer::Direct as usize] - 0.25).abs() < 0.005, "{seen:?}");
}

#[test]
fn glass_absorbs_by_the_length_of_the_way() {
    let sphere = (Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY, glass(0.7));
    let scene = scene(
        &[sphere],
        vec![LightSource::Environment(Environment::uniform(Rgb::WHITE))],
    );
    let seen: f64 = radiance(
        &scene,
        &Methods::TRACED,
        Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z),
        65_536,
    )
    .iter()
    .sum();
    // Through the centre: R + (1−R)² T / (1 − R T), with T over the diameter and R = 0.04 at every interface.
    let (r, t) = (0.04_f64, libm_exp(-1.4));
    let expected = r + (1.0 - r) * (1.0 - r) * t / (1.0 - r * t);
    assert!((seen - expected).abs() < 0.004, "{seen} against {expected}");
}

fn libm_exp(x: f64) -> f64 {
    // A test may use the series: 40 terms are exact to the last bit here.
    (1..40)
        .fold((1.0, 1.0), |(sum, term), n| {
            (sum + term * x / f64::from(n), term * x / f64::from(n))
        })
        .0
}

/// Sum of the flux that lands inside a closed black box, over many photons.
fn flux_in_black_box(light: LightSource, extra: &[(Shape, DAffine3, Material)]) -> Rgb {
    let mut shapes = vec![(
        Shape::Cuboid { size: Vec3::splat(4.0) },
        DAffine3::IDENTITY,
        diffuse(0.0),
    )];
    shapes.extend_from_slice(extra);
    let scene = scene(&shapes, vec![light]);
    let sampler = EmissionSampler::uniform(&scene.lights);
    let emitted = 1 << 14;
    let mut sum = Rgb::BLACK;
    for path in 0..emitted {
        let stream = SampleStream::new(0, PHOTON_STAGE, 0, path);
        if let Some(photon) = sampler.emit(&stream) {
            let wanted = MapKinds {
                direct: true,
                caustic: true,
                indirect: true,
            };
            trace_photon(&scene, &photon, wanted, 100, path, &stream, |deposit| {
                sum += deposit.flux
            });
        }
    }
    sum * (1.0 / emitted as f32)
}

#[test]
fn photons_in_a_closed_black_box_carry_the_flux_of_the_light() {
    let four_pi = 4.0 * std::f32::consts::PI;
    let intensity = Rgb::new(1.0, 2.0, 3.0);
    let point = flux_in_black_box(point_light(Vec3::new(0.5, 0.3, 0.1), intensity), &[]);
    for c in 0..3 {
        assert!(
            (point[c] - four_pi * intensity[c]).abs() < 1e-3 * four_pi * intensity[c],
            "{point:?}"
        );
    }
    let lamp = (
        Shape::Quad {
            size: glam::Vec2::new(1.0, 0.5),
        },
        at(0.0, 0.0, -1.0),
        black(),
    );
    for (two_sided, sides) in [(false, 1.0), (true, 2.0)] {
        let light = LightSource::Area {
            instance: 1,
            radiance: Rgb::WHITE,
            texture: None,
            two_sided,
        };
        let flux = flux_in_black_box(light, std::slice::from_ref(&lamp));
        let expected = std::f32::consts::PI * 0.5 * sides;
        assert!(
            (flux.g - expected).abs() < 2e-3 * expected,
            "{flux:?} against {expected}"
        );
    }
}

#[test]
fn photons_of_a_picture_carry_its_mean() {
    let values = vec![0.0, 1.0, 2.0, 4.0, 1.0, 0.0];
    let picture = texture::Picture::from_rgb(2, 1, values).expect("two texels");
    let texture = texture::Texture::new(Arc::new(picture));
    let mean = texture.mean_rgb();
    let size = glam::Vec2::new(1.0, 0.5);
    let lamp = (Shape::Quad { size }, at(0.0, 0.0, -1.0), black());
    let light = LightSource::Area {
        instance: 1,
        radiance: mean,
        texture: Some(Arc::new(texture)),
        two_sided: false,
    };
    let flux = flux_in_black_box(light, &[lamp]);
    for c in 0..3 {
        let expected = std::f32::consts::PI * 0.5 * mean[c];
        assert!(
            (flux[c] - expected).abs() < 5e-3 * expected,
            "{flux:?} against {mean:?}"
        );
    }
}

#[test]
fn aimed_emission_lands_the_same_flux_as_uniform_emission() {
    let target = TargetSphere {
        centre: Vec3::new(1.0, -0.4, 0.3),
        radius: 0.5,
    };
    let ball = (Shape::Sphere { radius: 0.5 }, at(1.0, -0.4, 0.3), diffuse(0.0));
    let lamp = (
        Shape::Disc { radius: 0.3 },
        at(0.0, 0.0, 2.0) * DAffine3::from_rotation_x(2.5),
        black(),
    );
    let sources = [
        vec![point_light(Vec3::new(-1.0, 1.0, 1.0), Rgb::WHITE)],
        vec![LightSource::Area {
            instance: 1,
            radiance: Rgb::WHITE,
            texture: None,
            two_sided: true,
        }],
        vec![LightSource::Environment(Environment::uniform(Rgb::WHITE))],
    ];
    for lights in sources {
        let scene = scene(&[ball.clone(), lamp.clone()], lights);
        let landed = |sampler: &EmissionSampler<'_>| {
            let emitted = 1 << 16;
            let (mut flux, mut count) = (0.0_f64, 0);
            for path in 0..emitted {
                let stream = SampleStream::new(1, PHOTON_STAGE, 0, path);
                if let Some(photon) = sampler.emit(&stream) {
                    let wanted = MapKinds {
                        direct: true,
                        caustic: false,
                        indirect: false,
                    };
                    trace_photon(&scene, &photon, wanted, 1, path, &stream, |deposit| {
                        flux += f64::from(deposit.flux.g);
                        count += 1;
                    });
                }
            }
            (flux / f64::from(emitted), count)
        };
        let (uniform, few) = landed(&EmissionSampler::uniform(&scene.lights));
        let (aimed, many) = landed(&EmissionSampler::aimed(&scene.lights, &[target], 0.1));
        assert!(many > 2 * few, "aiming does not help: {many} against {few}");
        // Uniform emission lands a few hundred photons of 65,536: one or two percent of noise.
        assert!((aimed - uniform).abs() < 0.04 * uniform, "{aimed} against {uniform}");
    }
}

/// `n` photons of equal flux spread evenly at random over the unit square of the plane z = 0, coming straight down.
fn uniform_field(n: u32, seed: u64, density: DensitySettings) -> PhotonMap {
    let position = |i: usize| {
        // Independent points: each path number is a domain of its own.
        let u = SampleStream::new(seed, StageKey::new("field"), i as u64, 0).draw_2d(0, 0);
        Vec3::new(u.x, u.y, 0.0)
    };
    let tree = PhotonTree::from_fn(n as usize, position).expect("finite positions");
    let up = radiometry::pack_direction(Vec3::Z);
    let columns = PhotonColumns {
        flux: vec![Rgb::splat(1.0 / n as f32); n as usize],
        direction: vec![up; n as usize],
        surface: vec![PhotonSurface::open(Vec3::Z); n as usize],
    };
    PhotonMap { tree, columns, density }
}

#[test]
fn a_uniform_photon_field_returns_one_with_every_filter_and_k() {
    let plane = (
        Shape::Quad {
            size: glam::Vec2::splat(4.0),
        },
        DAffine3::IDENTITY,
        diffuse(1.0),
    );
    let scene = scene(&[plane], vec![]);
    let mut path = Path::from_eye(0, SampleStream::new(0, StageKey::new("field"), 0, 0));
    let mut scratch = DensityScratch::default();
    for filter in [
        DensityFilter::Disc,
        DensityFilter::Cone,
        DensityFilter::Gaussian,
        DensityFilter::Epanechnikov,
    ] {
        for (nearest, max_radius, shrink) in [
            (4, 1.0, 1.0),
            (10, 1.0, 1.0),
            (50, 1.0, 1.0),
            (500, 1.0, 1.0),
            (500, 0.02, 1.0),
            (50, 1.0, 0.5),
            (500, 0.04, 0.5),
        ] {
            let fields = 100_u64;
            let estimates: Vec<f64> = (0..fields)
                .map(|seed| {
                    let density = DensitySettings {
                        nearest,
                        max_radius,
                        filter,
                        shrink,
                    };
                    let map = uniform_field(8000, seed, density);
                    let ray = Ray::new(Vec3::new(0.5, 0.5, 1.0), Vec3::NEG_Z);
                    let hit = arrive(&scene, &mut path, &ray).expect("the plane is there");
                    let vertex = Vertex::new(&scene, &hit, Vec3::Z, &PathMedium::VACUUM);
                    // Irradiance 1 on albedo 1 reflects 1/π.
                    f64::from(map.estimate_radiance(&scene, &vertex, &mut scratch).value.g) * std::f64::consts::PI
                })
                .collect();
            let n = fields as f64;
            let mean = estimates.iter().sum::<f64>() / n;
            let variance = estimates.iter().map(|e| (e - mean) * (e - mean)).sum::<f64>() / (n - 1.0);
            let standard_error = (variance / n).sqrt();
            // 28 combinations at four standard errors: one false alarm in 560 changes of the random numbers.
            assert!(
                (mean - 1.0).abs() < 4.0 * standard_error,
                "{filter:?} k = {nearest}: {mean} ± {standard_error}"
            );
        }
    }
}

#[test]
fn photons_and_paths_agree_on_a_caustic() {
    // A point light over a glass ball over a floor cannot be traced; a small lamp can.
    let lamp = (Shape::Sphere { radius: 0.25 }, at(0.3, 3.0, 0.0), black());
    let ball = (Shape::Sphere { radius: 0.5 }, at(0.0, 0.8, 0.0), glass(0.3));
    let ground = (
        Shape::Quad {
            size: glam::Vec2::splat(8.0),
        },
        floor(),
        diffuse(0.6),
    );
    let light = LightSource::Area {
        instance: 0,
        radiance: Rgb::splat(20.0),
        texture: None,
        two_sided: false,
    };
    let scene = scene(&[lamp, ball, ground], vec![light]);
    // Flux of the caustic on the floor: by photons, and by reversing paths from the floor through the ball.
    let emitted = 1 << 19;
    let sampler = EmissionSampler::aimed(&scene.lights, scene.specular_targets(), 0.1);
    let mut by_photons = 0.0_f64;
    for path in 0..emitted {
        let stream = SampleStream::new(3, PHOTON_STAGE, 0, path);
        if let Some(photon) = sampler.emit(&stream) {
            trace_photon(&scene, &photon, MapKinds::CAUSTIC, 64, path, &stream, |deposit| {
                assert_eq!(deposit.kind, MapKind::Caustic);
                if deposit.position.x.abs() < 1.0 && deposit.position.z.abs() < 1.0 {
                    by_photons += f64::from(deposit.flux.g);
                }
            });
        }
    }
    by_photons /= f64::from(emitted);
    let samples = 1 << 21;
    let mut by_paths = 0.0_f64;
    for sample in 0..samples {
        let stream = SampleStream::new(4, StageKey::new("floor"), 0, sample);
        let u = stream.draw_2d(99, 99);
        let mut path = Path::from_eye(0, stream);
        let on_floor = Vec3::new(2.0 * u.x - 1.0, 0.0, 2.0 * u.y - 1.0);
        let mut ray = Ray::new(on_floor + Vec3::Y * 0.01, Vec3::NEG_Y);
        while let Some(hit) = arrive(&scene, &mut path, &ray) {
            if let Some((Layer::Caustic, light)) = emitted_light(&scene, &Methods::TRACED, &path, &ray, Some(&hit)) {
                by_paths += f64::from(light.g);
            }
            match scatter(&scene, &Methods::TRACED, &mut path, &ray, &hit) {
                Some(next) => ray = next,
                None => break,
            }
        }
    }
    // Radiosity of albedo 0.6 over 4 m² back to flux: Φ = L π A / ρ.
    by_paths *= std::f64::consts::PI * 4.0 / 0.6 / f64::from(samples);
    assert!(
        (by_photons - by_paths).abs() < 0.02 * by_paths,
        "photons {by_photons} W, paths {by_paths} W"
    );
}

#[test]
fn photons_caught_in_lossless_glass_end() {
    // A quarter of the directions inside a cube of glass meet total reflection on all of its faces.
    let cube = (Shape::Cuboid { size: Vec3::ONE }, DAffine3::IDENTITY, glass(0.0));
    let ground = (
        Shape::Quad {
            size: glam::Vec2::splat(8.0),
        },
        at(0.0, -1.0, 0.0) * floor(),
        diffuse(0.5),
    );
    let light = point_light(Vec3::new(0.1, 0.2, 0.05), Rgb::WHITE);
    let scene = scene(&[cube, ground], vec![light]);
    let sampler = EmissionSampler::aimed(&scene.lights, scene.specular_targets(), 0.1);
    let mut stored = 0;
    for path in 0..4096 {
        let stream = SampleStream::new(0, PHOTON_STAGE, 0, path);
        if let Some(photon) = sampler.emit(&stream) {
            trace_photon(&scene, &photon, MapKinds::CAUSTIC, u32::MAX, path, &stream, |_| {
                stored += 1
            });
        }
    }
    assert!(stored > 0);
}

#[test]
fn the_state_machine_of_photons_never_leaves_indirect() {
    let events = [Event::Specular, Event::Diffuse, Event::Volume];
    for a in events {
        for b in events {
            let kind = MapKind::Direct.after(a).after(b);
            let expected = if a == Event::Specular && b == Event::Specular {
                MapKind::Caustic
            } else {
                MapKind::Indirect
            };
            assert_eq!(kind, expected);
        }
    }
}
