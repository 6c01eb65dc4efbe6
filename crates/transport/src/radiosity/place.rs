use super::field::{Patch, PatchField, PatchScratch};
use crate::medium::PathMedium;
use crate::scene::Scene;
use crate::vertex::Vertex;
use glam::{Vec2, Vec3};
use radiometry::{Frame, Rgb, SampleStream, StageKey, warp};
use rayon::prelude::*;
use spatial::{PhotonTree, SurfacePoint, SurfaceSample, SurfaceSampler};
use std::f32::consts::PI;

/// Key of the places of patches.
const PLACE_STAGE: StageKey = StageKey::new("radiosity places");
/// Fewest points on an instance, so that small ones are not dark.
const LEAST_POINTS: f64 = 8.0;
/// Points of a texture that are averaged for a patch.
const TEXTURE_POINTS: u32 = 16;

/// How patches are laid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceSettings {
    /// Side of a patch, metres, above 0; none: so that there are about as many as [`PlaceSettings::usual`].
    pub size: Option<f32>,
    /// Points to lay where no size is given.
    pub usual: u32,
    /// Points at most.
    pub most: u32,
}

/// Why no patches can be laid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaceError {
    /// There would be too many.
    TooMany {
        /// How many.
        points: f64,
        /// A size that is possible, metres; `None` where there are too many surfaces for any.
        possible_size: Option<f32>,
    },
    /// Places are not finite.
    Broken,
}

impl PatchField {
    /// Lays patches over all diffuse surfaces that stay where they are, and averages their albedo.
    ///
    /// Cost: a microsecond a patch, thirty times that where a texture is averaged; deterministic on any number of threads.
    ///
    /// # Errors
    /// As [`PlaceError`].
    pub fn place(scene: &Scene, settings: &PlaceSettings) -> Result<Self, PlaceError> {
        let instances: Vec<(u32, SurfaceSampler)> = (0..scene.rays.instance_count() as u32)
            .filter(|i| scene.material_of(*i).has_diffuse() && !scene.rays.instance_moves(*i))
            .filter_map(|i| Some((i, SurfaceSampler::new(&scene.rays, i)?)))
            .collect();
        let area: f64 = instances.iter().map(|(_, sampler)| sampler.area()).sum();
        let usual = area / f64::from(settings.usual.max(1));
        let patch_area = settings.size.map_or(usual, |size| f64::from(size) * f64::from(size));
        let points_by =
            |sampler: &SurfaceSampler, patch_area: f64| (sampler.area() / patch_area).ceil().max(LEAST_POINTS);
        let points_of = |sampler: &SurfaceSampler| points_by(sampler, patch_area);
        let all_by = |patch_area| -> f64 { instances.iter().map(|(_, s)| points_by(s, patch_area)).sum() };
        let (points, most) = (all_by(patch_area), f64::from(settings.most));
        if points > most {
            let mut larger = std::iter::successors(Some(1.2 * area / most), |area| Some(area * 1.5)).take(64);
            let possible = larger.find(|area| all_by(*area) <= most);
            return Err(PlaceError::TooMany {
                points,
                possible_size: possible.map(|area| area.sqrt() as f32),
            });
        }
        let patches: Vec<Patch> = instances
            .par_iter()
            .flat_map_iter(|(instance, sampler)| {
                let count = points_of(sampler) as u32;
                let area = (sampler.area() / f64::from(count)) as f32;
                (0..count).flat_map(move |number| {
                    let point = point(sampler, *instance, number);
                    [point.ng, -point.ng].map(|normal| Patch {
                        position: point.p,
                        normal,
                        error: point.error,
                        area,
                        instance: *instance,
                        albedo: albedo(scene, &point, normal),
                        ..Patch::default()
                    })
                })
            })
            .collect();
        let tree = PhotonTree::from_fn(patches.len() / 2, |row| patches[2 * row].position);
        let mut field = Self {
            tree: tree.map_err(|_| PlaceError::Broken)?,
            spacing: patch_area.sqrt() as f32,
            patches,
        };
        field.average_textures(scene, &instances, points_of);
        Ok(field)
    }

    /// Replaces the albedo of patches whose material changes from point to point by the mean over what lies next to them.
    fn average_textures(
        &mut self,
        scene: &Scene,
        instances: &[(u32, SurfaceSampler)],
        points_of: impl Fn(&SurfaceSampler) -> f64,
    ) {
        let mut scratch = PatchScratch::default();
        let mut sums = vec![(Rgb::BLACK, 0.0_f32); self.patches.len()];
        for (instance, sampler) in instances {
            if scene.material_of(*instance).textured.is_none() {
                continue;
            }
            let points = points_of(sampler) as u32;
            // The first of them are the patches themselves.
            for number in 0..points.saturating_mul(TEXTURE_POINTS) {
                let point = point(sampler, *instance, number);
                for normal in [point.ng, -point.ng] {
                    let row = self.patch_at(scene, *instance, point.p, normal, point.error, &mut scratch);
                    if let Some(row) = row {
                        let sum = &mut sums[row as usize];
                        sum.0 += albedo(scene, &point, normal);
                        sum.1 += 1.0;
                    }
                }
            }
        }
        for (patch, (sum, count)) in self.patches.iter_mut().zip(sums) {
            if count > 0.0 {
                patch.albedo = sum * (1.0 / count);
            }
        }
    }
}

/// Point `number` of the sequence that covers an instance.
fn point(sampler: &SurfaceSampler, instance: u32, number: u32) -> SurfacePoint {
    let u = SampleStream::new(0, PLACE_STAGE, u64::from(instance), number).draw_2d(0, 0);
    let SurfaceSample {
        p,
        error,
        ng,
        uv,
        primitive,
        ..
    } = sampler.sample_area(u, 0.0);
    SurfacePoint {
        p,
        error,
        ng,
        ns: ng,
        uv,
        instance,
        primitive,
        time: 0.0,
    }
}

/// The share of evenly arriving light that the D lobes of a point reflect, seen from all around: `∫∫ f_d cosθ_i cosθ_o / π`.
///
/// Exact for Lambertian surfaces; within some percent, by a few fixed directions, for others.
fn albedo(scene: &Scene, point: &SurfacePoint, normal: Vec3) -> Rgb {
    let frame = Frame::from_normal(normal);
    let directions =
        |offset: u32| (0..4_u32).map(move |i| Vec2::new((i as f32 + 0.5) / 4.0, (0.618 * (i + offset) as f32).fract()));
    let world = |u: Vec2| frame.world_from_local(warp::sample_cosine_hemisphere(u));
    let mut sum = Rgb::BLACK;
    for out in directions(0) {
        let vertex = Vertex::new(scene, point, world(out), &PathMedium::VACUUM);
        if let Some(value) = vertex.diffuse_value() {
            return value * PI;
        }
        for into in directions(7) {
            sum += vertex.eval_diffuse_flux(world(into)) * (PI / 16.0);
        }
    }
    // Nothing sends out more than it gets.
    Rgb::new(sum.r.min(1.0), sum.g.min(1.0), sum.b.min(1.0))
}
