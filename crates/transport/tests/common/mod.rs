//! Small scenes, and the radiance along a ray of them.

#![allow(dead_code, reason = "every test file uses a part")]
#![allow(clippy::expect_used, reason = "a test that meets an error should fail")]

use glam::{Affine3A, DAffine3, DQuat, DVec3, Vec3};
use radiometry::{Rgb, SampleStream, StageKey};
use scattering::{Bsdf, DielectricBsdf, DiffuseBsdf, Microsurface};
use spatial::{Geometry, Instance, Ray, RayScene, Shape};
use transport::{
    Layer, LightSource, MapKind, Material, Methods, MovingFrame, Path, PathMedium, PhotonMaps, PhotonMapsScratch,
    Scene, Vertex, arrive, emitted_light, sample_direct_light, scatter,
};

pub(crate) fn diffuse(albedo: f32) -> Material {
    Material {
        bsdf: Bsdf::Diffuse(DiffuseBsdf::new(Rgb::splat(albedo))),
        ..Material::default()
    }
}

pub(crate) fn point_light(position: Vec3, intensity: Rgb) -> LightSource {
    LightSource::Point {
        frame: frame(position, DQuat::IDENTITY),
        intensity,
    }
}

pub(crate) fn frame(position: Vec3, rotation: DQuat) -> MovingFrame {
    MovingFrame::fixed(Affine3A::from_rotation_translation(rotation.as_quat(), position))
}

pub(crate) fn black() -> Material {
    Material {
        bsdf: Bsdf::Black,
        ..Material::default()
    }
}

pub(crate) fn glass(absorption: f32) -> Material {
    let bsdf = Bsdf::Dielectric(DielectricBsdf::new(1.5, Rgb::WHITE, Microsurface::SMOOTH));
    Material {
        bsdf,
        absorption: Rgb::splat(absorption),
        ..Material::default()
    }
}

/// One shape an instance, each with a material of its own.
pub(crate) fn scene(shapes: &[(Shape, DAffine3, Material)], lights: Vec<LightSource>) -> Scene {
    let geometries = shapes.iter().map(|(shape, ..)| Geometry::Shape(*shape)).collect();
    let instances = shapes
        .iter()
        .enumerate()
        .map(|(i, (_, placed, _))| Instance::fixed(i as u32, *placed))
        .collect();
    let rays = RayScene::build(geometries, instances).expect("valid scene");
    let materials = shapes.iter().map(|(.., material)| material.clone()).collect();
    Scene::new(rays, materials, (0..shapes.len() as u32).collect(), lights)
}

pub(crate) fn at(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, z))
}

/// A quad in the plane y = 0, facing up.
pub(crate) fn floor() -> DAffine3 {
    DAffine3::from_rotation_x(-std::f64::consts::FRAC_PI_2)
}

/// Radiance along a ray, all terms, averaged over `samples`; by layer.
pub(crate) fn radiance(scene: &Scene, methods: &Methods, ray: Ray, samples: u32) -> [f64; Layer::COUNT] {
    radiance_with(scene, methods, &PhotonMaps::default(), ray, samples)
}

/// The same, with photon maps that are read as `methods` say.
pub(crate) fn radiance_with(
    scene: &Scene,
    methods: &Methods,
    maps: &PhotonMaps,
    ray: Ray,
    samples: u32,
) -> [f64; Layer::COUNT] {
    trace(scene, methods, maps, ray, samples).map(|sum| sum[1])
}

/// Radiance along a ray, all terms and layers together, by channel.
pub(crate) fn colour(scene: &Scene, ray: Ray, samples: u32) -> [f64; 3] {
    let layers = trace(scene, &Methods::TRACED, &PhotonMaps::default(), ray, samples);
    [0, 1, 2].map(|channel| layers.iter().map(|layer| layer[channel]).sum())
}

fn trace(scene: &Scene, methods: &Methods, maps: &PhotonMaps, ray: Ray, samples: u32) -> [[f64; 3]; Layer::COUNT] {
    let mut sums = [[0.0; 3]; Layer::COUNT];
    let mut scratch = PhotonMapsScratch::default();
    for sample in 0..samples {
        let mut path = Path::from_eye(0, SampleStream::new(7, StageKey::new("closed forms"), 0, sample));
        let mut ray = ray;
        loop {
            let hit = arrive(scene, &mut path, &ray);
            let mut add = |layer: Layer, light: Rgb| {
                for (sum, value) in sums[layer as usize].iter_mut().zip(light.to_array()) {
                    *sum += f64::from(value);
                }
            };
            if let Some((layer, light)) = emitted_light(scene, methods, &path, &ray, hit.as_ref()) {
                add(layer, light);
            }
            let Some(hit) = hit else { break };
            let vertex = Vertex::new(scene, &hit, -ray.direction, &PathMedium::VACUUM);
            for kind in MapKind::ALL.into_iter().filter(|_| vertex.bsdf.has_diffuse()) {
                if let Some(layer) = methods.map_layer(kind, path.class) {
                    let estimate = maps.estimate_radiance(scene, kind, &vertex, &mut scratch);
                    add(layer, path.throughput * estimate.value);
                }
            }
            sample_direct_light(scene, methods, &path, &ray, &hit, &mut add);
            match scatter(scene, methods, &mut path, &ray, &hit) {
                Some(next) => ray = next,
                None => break,
            }
        }
    }
    sums.map(|layer| layer.map(|sum| sum / f64::from(samples)))
}
