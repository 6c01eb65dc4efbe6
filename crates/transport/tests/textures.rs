//! Lights and surfaces that show pictures.
#![allow(clippy::unwrap_used, reason = "a test that meets an error should fail")]

use glam::{DAffine3, Vec2, Vec3, Vec4};
use radiometry::{Rgb, SampleStream, StageKey};
use spatial::{Geometry, Instance, Ray, RayScene, TriangleMesh};
use std::sync::Arc;
use texture::{Filter, Picture, Texture};
use transport::{Coverage, EmissionSampler, Input, LightSource, Material, Scene, SurfaceInputs, TexturedBsdf};

/// Four texels, each of its own colour, by the second set of texture coordinates.
fn four() -> Texture {
    let values = (0..12).map(|i| i as f32 + 1.0).collect();
    let mut texture = Texture::new(Arc::new(Picture::from_rgb(2, 2, values).unwrap()));
    (texture.filter, texture.uv_set) = (Filter::Nearest, 1);
    texture
}

/// A square in XY from 0 to 1, its second set of texture coordinates turned against the first.
fn square() -> TriangleMesh {
    let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    TriangleMesh {
        positions: corners.map(|c| c.extend(0.0)).to_vec(),
        uvs: Some(corners.to_vec()),
        more_uvs: vec![corners.map(|c| Vec2::new(c.y, 1.0 - c.x)).to_vec()],
        colours: Some(vec![Vec4::new(1.0, 0.5, 0.25, 0.5); 4]),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..TriangleMesh::default()
    }
}

fn scene(material: Material, lights: Vec<LightSource>) -> Scene {
    let geometry = Geometry::Mesh(Arc::new(square()));
    let instance = Instance::fixed(0, DAffine3::IDENTITY);
    let rays = RayScene::build(vec![geometry], vec![instance]).unwrap();
    Scene::new(rays, vec![material], vec![0], lights)
}

/// Multiple importance sampling needs both ways to agree on every point.
#[test]
fn a_lamp_sends_the_same_light_met_or_sampled() {
    let texture = four();
    let light = LightSource::Area {
        instance: 0,
        radiance: texture.mean_rgb(),
        texture: Some(Arc::new(texture)),
        two_sided: true,
    };
    let scene = scene(Material::default(), vec![light]);
    let mut seen = Vec::new();
    for i in 0..200 {
        let stream = SampleStream::new(0, StageKey::new("textures"), 0, i);
        let from = Vec3::new(0.2, 0.3, 1.5);
        let sample = scene
            .lights
            .sample(from, 0.0, stream.draw_2d(0, 0), stream.draw_2d(0, 1));
        let Some(sample) = sample else { continue };
        let ray = Ray::new(from, sample.wi);
        let point = scene.rays.surface(&ray, &scene.rays.intersect(&ray).unwrap());
        let met = scene.lights.emitted(&point, -sample.wi);
        let expected = four().rgb(Vec2::new(point.uv.y, 1.0 - point.uv.x));
        if (point.uv - 0.5).abs().min_element() < 1e-3 {
            continue;
        }
        assert_eq!(met, sample.radiance);
        assert_eq!(met, expected);
        if !seen.contains(&met) {
            seen.push(met);
        }
    }
    assert_eq!(seen.len(), 4, "{seen:?}");
}

#[test]
fn inputs_that_are_the_same_everywhere_leave_a_plain_material() {
    let inputs = SurfaceInputs {
        bsdf: TexturedBsdf::Diffuse(Input::Constant(Rgb::splat(0.5))),
        normal: None,
        coverage: Some(Coverage {
            alpha: Input::Constant(1.0),
            cutoff: None,
        }),
        vertex_colours: false,
    };
    assert!(Material::from_inputs(inputs.clone()).textured.is_none());
    let coloured = Material::from_inputs(SurfaceInputs {
        vertex_colours: true,
        ..inputs
    });
    assert!(coloured.has_alpha() && coloured.has_diffuse() && !coloured.has_specular());
    let scene = scene(coloured, Vec::new());
    let ray = Ray::new(Vec3::new(0.3, 0.4, 2.0), -Vec3::Z);
    let point = scene.rays.surface(&ray, &scene.rays.intersect(&ray).unwrap());
    let (bsdf, normal) = scene.material(&point).at(&scene.rays, &point);
    assert_eq!(bsdf.albedo(Vec3::Z), Rgb::new(0.5, 0.25, 0.125));
    assert_eq!(normal, point.ns);
    assert_eq!(scene.alpha(&point), 0.5);
    assert!(scene.has_alpha());
}

/// A lamp of which a part is there lights as much as rays that meet it say, whether sampled or by photons.
#[test]
fn a_lamp_that_is_not_whole_sends_less_light() {
    let light = || LightSource::Area {
        instance: 0,
        radiance: Rgb::splat(2.0),
        texture: None,
        two_sided: true,
    };
    let lamp = |alpha: f32, vertex_colours: bool| {
        let inputs = SurfaceInputs {
            bsdf: TexturedBsdf::Diffuse(Input::Constant(Rgb::BLACK)),
            normal: None,
            coverage: Some(Coverage {
                alpha: Input::Constant(alpha),
                cutoff: None,
            }),
            vertex_colours,
        };
        scene(Material::from_inputs(inputs), vec![light()])
    };
    let whole = scene(Material::default(), vec![light()]);
    // The vertices of the square are half there.
    for (alpha, vertex_colours, expected) in [(0.5, false, 0.5), (0.5, true, 0.25), (1.0, true, 0.5)] {
        let part = lamp(alpha, vertex_colours);
        assert!((part.lights.power() / whole.lights.power() - f64::from(expected)).abs() < 1e-6);
        let stream = SampleStream::new(0, StageKey::new("textures"), 0, 1);
        let from = Vec3::new(0.2, 0.3, 1.5);
        let (u, v) = (stream.draw_2d(0, 0), stream.draw_2d(0, 1));
        let sampled = part.lights.sample(from, 0.0, u, v).unwrap();
        assert!((sampled.radiance.r - 2.0 * expected).abs() < 1e-6);
        // Rays that meet it are thinned on their way.
        let ray = Ray::new(from, sampled.wi);
        let point = part.rays.surface(&ray, &part.rays.intersect(&ray).unwrap());
        assert_eq!(part.lights.emitted(&point, -sampled.wi), Rgb::splat(2.0));
        let photon = EmissionSampler::uniform(&part.lights).emit(&stream).unwrap();
        assert!((photon.flux.mean() / part.lights.power() as f32 - 1.0).abs() < 1e-5);
    }
    assert!(lamp(0.0, false).lights.is_empty());
}
