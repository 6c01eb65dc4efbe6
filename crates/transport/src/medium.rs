use crate::scene::{Material, Scene};
use glam::Vec3;
use radiometry::{Rgb, math};
use scattering::{Bsdf, Crossing, Interior, InteriorList, SampledWavelength};
use spatial::{Ray, SurfacePoint, spawn_origin};

/// What a path travels in, from the eye or from a light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathMedium {
    /// The materials around it, by row.
    interiors: InteriorList,
    /// In nm, once it has met a surface that tells wavelengths apart; 0 before, when it stands for all of them.
    wavelength: f32,
}

impl PathMedium {
    /// Nothing, and all wavelengths.
    pub const VACUUM: Self = Self {
        interiors: InteriorList::VACUUM,
        wavelength: 0.0,
    };

    /// The media around a place where a path begins.
    ///
    /// All surfaces with an inside that lie on the way out, in a direction that is always the same, are passed from the
    /// outermost on. Where two media of equal priority overlap, the one entered last on that way counts.
    ///
    /// Cost: nothing where no box around such a geometry holds the place; else a ray for each surface on the way.
    #[must_use]
    pub fn at(scene: &Scene, p: Vec3, time: f32) -> Self {
        /// Unit, and along nothing that scenes are built along.
        const PROBE: Vec3 = Vec3::new(0.365_148_37, 0.547_722_6, 0.752_772_6);
        let mut medium = Self::VACUUM;
        if !scene.may_be_inside(p) {
            return medium;
        }
        let mut ray = Ray {
            time,
            ..Ray::new(p, PROBE)
        };
        let mut passed = Vec::new();
        while let Some(hit) = scene.rays.intersect(&ray) {
            let point = scene.rays.surface(&ray, &hit);
            if let Some(interior) = scene.interior(&point) {
                passed.push((interior, PROBE.dot(point.ng) > 0.0));
            }
            ray.origin = spawn_origin(point.p, point.error, point.ng, PROBE);
        }
        for (interior, entering) in passed.into_iter().rev() {
            medium.interiors.pass(interior, entering);
        }
        medium
    }

    /// True from the first dispersive surface on.
    #[must_use]
    pub fn has_wavelength(&self) -> bool {
        self.wavelength > 0.0
    }

    /// Draws the wavelength where a path that stands for all of them meets a surface that tells them apart.
    ///
    /// - `u`: gives a number in [0, 1).
    /// - returns the factor for what the path carries.
    #[inline]
    pub(crate) fn disperse(&mut self, scene: &Scene, point: &SurfacePoint, u: impl FnOnce() -> f32) -> Option<Rgb> {
        if !scene.passage(point).is_dispersive || self.has_wavelength() {
            return None;
        }
        let drawn = SampledWavelength::new(u());
        self.wavelength = drawn.wavelength;
        Some(drawn.weight)
    }

    /// True in no material; there is nothing to keep account of then.
    #[inline]
    fn is_vacuum(&self) -> bool {
        self.interiors.current().is_none()
    }

    /// Tells that the path goes through the surface at `point` in direction `wi`.
    #[inline]
    pub(crate) fn pass(&mut self, scene: &Scene, point: &SurfacePoint, wi: Vec3) {
        if let Some(interior) = scene.interior(point) {
            self.interiors.pass(interior, wi.dot(point.ng) < 0.0);
        }
    }

    /// True when there is no interface at `point`, because a medium of higher priority fills both sides of it.
    #[inline]
    pub(crate) fn hides(&self, scene: &Scene, point: &SurfacePoint, direction: Vec3) -> bool {
        scene
            .interior(point)
            .is_some_and(|interior| self.crossing(interior, direction.dot(point.ng) < 0.0) == Crossing::Hidden)
    }

    #[inline]
    fn crossing(&self, interior: Interior, entering: bool) -> Crossing {
        self.interiors.crossing(interior, entering)
    }

    /// What a ray of this path sees less for the medium, over `distance` metres; up to `point`, where it ends there.
    ///
    /// A path may not know that it is inside of glass, where it was in too many media at once; it arrives at the inner
    /// side of the surface, which tells.
    #[inline]
    pub(crate) fn transmittance(&self, scene: &Scene, ray: &Ray, point: Option<&SurfacePoint>, distance: f32) -> Rgb {
        let absorption = match (self.interiors.current(), point) {
            (Some(row), _) => scene.material_by_row(row).absorption,
            (None, Some(point)) if scene.passage(point).has_inside && ray.direction.dot(point.ng) > 0.0 => {
                scene.material(point).absorption
            }
            (None, _) => return Rgb::WHITE,
        };
        transmittance(absorption, distance)
    }

    /// The scattering function of an interface, for the media that lie on its two sides and for the wavelength.
    ///
    /// - `bsdf`: that of `material` in the vacuum.
    /// - `wo`: the side that the path arrives from.
    #[inline]
    pub(crate) fn adapt(&self, scene: &Scene, material: &Material, bsdf: Bsdf, point: &SurfacePoint, wo: Vec3) -> Bsdf {
        if self.is_vacuum() && !self.has_wavelength() {
            return bsdf;
        }
        let Some(interior) = scene.interior(point) else {
            return bsdf;
        };
        let entering = wo.dot(point.ng) > 0.0;
        let outside = match self.crossing(interior, entering) {
            Crossing::Interface { from, .. } if entering => from,
            Crossing::Interface { to, .. } => to,
            Crossing::Hidden => return bsdf,
        };
        if outside.is_none() && material.dispersion.is_none() {
            return bsdf;
        }
        let outside = outside.map_or(1.0, |row| self.ior_of(scene.material_by_row(row)));
        bsdf.with_relative_ior(self.ior_of(material) / outside)
    }

    /// Index of refraction of the inside of a material at the wavelength of the path.
    fn ior_of(&self, material: &Material) -> f32 {
        match &material.dispersion {
            Some(dispersion) if self.has_wavelength() => dispersion.ior_at(self.wavelength),
            _ => material.bsdf.interior_ior().unwrap_or(1.0),
        }
    }
}

/// exp(−σ t) per channel: the law of Beer and Lambert. A coefficient of zero lets everything through at any distance.
fn transmittance(absorption: Rgb, distance: f32) -> Rgb {
    if absorption.is_black() {
        return Rgb::WHITE;
    }
    absorption.map(|sigma| if sigma > 0.0 { math::exp(-sigma * distance) } else { 1.0 })
}

/// Follows a ray to the first surface that is there for it.
///
/// Surfaces that are hidden in a medium of higher priority are passed, and the medium is told. A surface that is not
/// whole is passed as often as it is not there.
///
/// - `u`: gives a number in [0, 1) for each surface that is not whole, counted from 0.
/// - returns the surface, or `None` where the ray leaves the scene, and the share of light that is not absorbed on the way.
#[inline]
pub(crate) fn follow(
    scene: &Scene,
    medium: &mut PathMedium,
    ray: &Ray,
    u: impl Fn(u32) -> f32,
) -> (Option<SurfacePoint>, Rgb) {
    let mut segment = *ray;
    let mut left = Rgb::WHITE;
    let mut cutouts = 0;
    loop {
        let Some(hit) = scene.rays.intersect(&segment) else {
            left *= medium.transmittance(scene, &segment, None, f32::INFINITY);
            return (None, left);
        };
        let point = scene.rays.surface(&segment, &hit);
        if medium.is_vacuum() && scene.passage(&point).is_plain() {
            return (Some(point), left);
        }
        left *= medium.transmittance(scene, &segment, Some(&point), hit.t);
        if scene.passage(&point).has_alpha {
            let alpha = scene.alpha(&point);
            cutouts += 1;
            if alpha < 1.0 && u(cutouts - 1) >= alpha {
                // What is behind a hole in glass is the inside of it all the same.
                medium.pass(scene, &point, segment.direction);
                segment.origin = spawn_origin(point.p, point.error, point.ng, segment.direction);
                continue;
            }
        }
        if !medium.hides(scene, &point, segment.direction) {
            return (Some(point), left);
        }
        medium.pass(scene, &point, segment.direction);
        segment.origin = spawn_origin(point.p, point.error, point.ng, segment.direction);
    }
}

/// The share of light that goes along a ray up to its end; `None` where something is in the way. Surfaces that are not
/// whole let through what they do on average.
///
/// - `medium`: where the ray starts.
#[inline]
pub(crate) fn unblocked(scene: &Scene, mut medium: PathMedium, ray: &Ray) -> Option<Rgb> {
    if !scene.rays.occluded(ray) {
        return Some(medium.transmittance(scene, ray, None, ray.t_max));
    }
    if !(scene.may_hide_surfaces() || scene.has_alpha()) {
        return None;
    }
    let end = ray.t_max.is_finite().then(|| ray.at(ray.t_max));
    let mut segment = *ray;
    let mut left = Rgb::WHITE;
    while let Some(hit) = scene.rays.intersect(&segment) {
        let point = scene.rays.surface(&segment, &hit);
        left *= medium.transmittance(scene, &segment, Some(&point), hit.t);
        if medium.hides(scene, &point, segment.direction) {
            medium.pass(scene, &point, segment.direction);
        } else if scene.passage(&point).has_alpha {
            left *= 1.0 - scene.alpha(&point).clamp(0.0, 1.0);
            medium.pass(scene, &point, segment.direction);
        } else {
            return None;
        }
        if left.is_black() {
            return None;
        }
        segment.origin = spawn_origin(point.p, point.error, point.ng, segment.direction);
        if let Some(end) = end {
            let rest = end - segment.origin;
            if rest.dot(ray.direction) <= 0.0 {
                break;
            }
            segment.t_max = rest.length() * (1.0 - 2.0 * f32::EPSILON);
            segment.direction = rest.normalize();
        }
    }
    left *= medium.transmittance(scene, &segment, None, segment.t_max);
    Some(left)
}
