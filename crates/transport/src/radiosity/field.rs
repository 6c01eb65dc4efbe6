use crate::scene::Scene;
use glam::Vec3;
use radiometry::Rgb;
use spatial::{NearestScratch, PhotonTree, Ray};

/// A patch: one side of a part of a diffuse surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Patch {
    /// The point that stands for it, world space, metres.
    pub position: Vec3,
    /// Unit geometric normal, on its side.
    pub normal: Vec3,
    /// Bound on the error of `position`, metres.
    pub error: f32,
    /// m².
    pub area: f32,
    /// Row of the instance.
    pub instance: u32,
    /// Share of the light that its D lobes reflect, averaged over directions and over the patch.
    pub albedo: Rgb,
    /// Irradiance by light that comes from the lights straight or over S surfaces, W·m⁻².
    pub direct: Rgb,
    /// Irradiance by light that other patches reflect, W·m⁻².
    pub indirect: Rgb,
}

/// The patches of a scene, and how to find them.
///
/// Rows are two a point: that on the side of the surface's normal, then that on the other.
#[derive(Clone, Debug)]
pub struct PatchField {
    pub(super) patches: Vec<Patch>,
    /// Over the points.
    pub(super) tree: PhotonTree,
    /// Side of a patch, metres: the root of the mean area.
    pub(super) spacing: f32,
}

/// Memory that look-ups reuse; one a thread.
#[derive(Clone, Debug, Default)]
pub struct PatchScratch {
    pub(super) nearest: NearestScratch,
    /// Patch and squared distance.
    pub(super) found: Vec<(u32, f32)>,
}

/// Least cosine between the normals of a place and of a patch that stands for it.
const MIN_NORMAL_COSINE: f32 = 0.7;
/// The same where no patch is as near as that: on small round things.
const LOOSE_COSINE: f32 = 0.05;
/// Patches further than this many spacings say nothing of a place.
const REACH: f32 = 4.0;

impl PatchField {
    /// All patches, by row.
    #[must_use]
    pub fn patches(&self) -> &[Patch] {
        &self.patches
    }

    /// All patches, to write what was found of them.
    pub fn patches_mut(&mut self) -> &mut [Patch] {
        &mut self.patches
    }

    /// Side of a patch, metres.
    #[must_use]
    pub fn spacing(&self) -> f32 {
        self.spacing
    }

    /// The patch next to a place of which a place can be seen: the one that the place is part of.
    ///
    /// - `instance`: of the place; `normal`: unit, on the side that is asked about; `error`: of `position`, metres.
    /// - returns its row; none where there is no patch near, such as on moving surfaces.
    #[must_use]
    pub fn patch_at(
        &self,
        scene: &Scene,
        instance: u32,
        position: Vec3,
        normal: Vec3,
        error: f32,
        scratch: &mut PatchScratch,
    ) -> Option<u32> {
        const CANDIDATES: usize = 4;
        self.find(scene, instance, position, normal, error, CANDIDATES, scratch);
        scratch.found.first().map(|(row, _)| *row)
    }

    /// Finds patches around a place, nearest first; those behind something only where there are no others.
    ///
    /// Normals have to agree, and the instance, since another may lie in the same plane with an edge between.
    #[expect(clippy::too_many_arguments, reason = "the place and where to look")]
    pub(super) fn find(
        &self,
        scene: &Scene,
        instance: u32,
        position: Vec3,
        normal: Vec3,
        error: f32,
        count: usize,
        scratch: &mut PatchScratch,
    ) {
        for cosine in [MIN_NORMAL_COSINE, LOOSE_COSINE] {
            self.candidates(instance, position, normal, cosine, count, scratch);
            if !scratch.found.is_empty() {
                break;
            }
        }
        let is_seen = |row: u32| {
            let patch = &self.patches[row as usize];
            !is_between(scene, position, normal, error, patch)
        };
        let seen = scratch.found.iter().filter(|(row, _)| is_seen(*row)).count();
        if seen > 0 && seen < scratch.found.len() {
            scratch.found.retain(|(row, _)| is_seen(*row));
        }
    }

    fn candidates(
        &self,
        instance: u32,
        position: Vec3,
        normal: Vec3,
        min_cosine: f32,
        count: usize,
        scratch: &mut PatchScratch,
    ) {
        let rows = self.tree.rows();
        let side = |slot: u32| {
            let front = 2 * rows[slot as usize];
            let patch = &self.patches[front as usize];
            let cosine = patch.normal.dot(normal);
            (patch.instance == instance && cosine.abs() >= min_cosine).then_some(front + u32::from(cosine < 0.0))
        };
        let accept = |slot: u32, _: Vec3, _: f32| side(slot).is_some();
        let reach = REACH * self.spacing;
        let found = self
            .tree
            .nearest_where(position, count, reach, accept, &mut scratch.nearest);
        scratch.found.clear();
        let with_row = |slot: u32| side(slot).unwrap_or(0);
        scratch
            .found
            .extend(found.iter().map(|near| (with_row(near.slot), near.dist_sq)));
        scratch
            .found
            .sort_unstable_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    }
}

/// True when something stands between a place and a patch of the same surface.
fn is_between(scene: &Scene, position: Vec3, normal: Vec3, error: f32, patch: &Patch) -> bool {
    /// Both ends are lifted by this share of their distance, so that the surface itself is not in the way.
    const LIFT: f32 = 0.05;
    let distance = position.distance(patch.position);
    let lift = |p: Vec3, n: Vec3, error: f32| p + n * (LIFT * distance + 4.0 * error);
    let from = lift(position, normal, error);
    let way = lift(patch.position, patch.normal, patch.error) - from;
    let length = way.length();
    if length <= 0.0 || length.is_nan() {
        return false;
    }
    scene.rays.occluded(&Ray {
        t_max: length,
        ..Ray::new(from, way / length)
    })
}
