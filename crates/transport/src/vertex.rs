use crate::guide::Guide;
use crate::medium::PathMedium;
use crate::reflectance::estimate_reflectance;
use crate::scene::Scene;
use glam::{Vec2, Vec3};
use radiometry::{Frame, Rgb, SampleStream};
use scattering::{Bsdf, BsdfSample, LobeValues, Transport};
use spatial::SurfacePoint;

/// A surface point with its scattering function, seen from one direction.
///
/// Textures, vertex colours and normal maps of the material are in it already. Rules for shading normals that differ from the geometric one, all in this file:
/// - directions that the two normals see on different sides carry nothing;
/// - where the view itself is such a direction, the geometric normal shades, so that silhouettes do not turn black
///   (photons that leave in such a direction are lost all the same: there the two methods differ a little);
/// - diffuse reflection is softened towards the terminator by the factor of Chiang, Li and Burley, "Taming the Shadow
///   Terminator", SIGGRAPH Talks 2019;
/// - photons get the factor of Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, eq. 5.19.
pub struct Vertex<'a> {
    /// Where it is.
    pub point: &'a SurfacePoint,
    /// Unit direction back along the ray that arrived.
    pub wo: Vec3,
    /// The scattering function.
    pub bsdf: Bsdf,
    frame: Frame,
    wo_local: Vec3,
    /// Cosine between the two normals; 1 on flat surfaces.
    cos_normals: f32,
    /// Where light comes from, if that is known.
    guide: Option<&'a Guide>,
}

impl<'a> Vertex<'a> {
    /// - `wo`: unit direction back along the ray that arrived.
    /// - `medium`: what the path that arrived travels in.
    #[inline]
    #[must_use]
    pub fn new(scene: &Scene, point: &'a SurfacePoint, wo: Vec3, medium: &PathMedium) -> Self {
        let material = scene.material(point);
        let (bsdf, ns) = material.at(&scene.rays, point);
        let same_side = (ns.dot(wo) > 0.0) == (point.ng.dot(wo) > 0.0);
        let normal = if same_side { ns } else { point.ng };
        let frame = Frame::from_normal(normal);
        Self {
            point,
            wo,
            bsdf: medium.adapt(scene, material, bsdf, point, wo),
            wo_local: frame.local_from_world(wo),
            cos_normals: normal.dot(point.ng),
            frame,
            guide: None,
        }
    }

    /// The same vertex, its directions drawn with the help of a guide.
    #[inline]
    #[must_use]
    pub fn guided(mut self, guide: Option<&'a Guide>) -> Self {
        self.guide = guide.filter(|guide| guide.is_known() && self.diffuse_value().is_some());
        self
    }

    /// A direction in the shading frame, turned so that the eye is on the side of +z.
    #[inline]
    pub(crate) fn to_local(&self, direction: Vec3) -> Vec3 {
        self.toward_eye(self.frame.local_from_world(direction))
    }

    /// Turns a local direction from the side of the eye to +z, and back.
    #[inline]
    fn toward_eye(&self, local: Vec3) -> Vec3 {
        if self.wo_local.z < 0.0 {
            Vec3::new(local.x, local.y, -local.z)
        } else {
            local
        }
    }

    /// `f(ω_o, ω_i)·|cosθ_i|` by class, and the density with which [`Vertex::sample`] returns `wi`.
    #[inline]
    #[must_use]
    pub fn eval_and_pdf(&self, wi: Vec3) -> (LobeValues, f32) {
        let wi_local = self.frame.local_from_world(wi);
        if (wi_local.z > 0.0) != (self.point.ng.dot(wi) > 0.0) {
            return (LobeValues::default(), 0.0);
        }
        let (mut values, mut pdf) = self.bsdf.eval_and_pdf(self.wo_local, wi_local, Transport::Radiance);
        if let Some(guide) = self.guide {
            pdf = guide.mixed_pdf(self.toward_eye(wi_local), pdf);
        }
        values.diffuse *= self.terminator(wi, wi_local.z);
        (values, pdf)
    }

    /// `f(ω_o, ω_i)·|cosθ_i|` of the diffuse lobes over the geometric `|cosθ_i|`: what weighs the flux of a photon that
    /// came from `wi`.
    #[inline]
    #[must_use]
    pub fn eval_diffuse_flux(&self, wi: Vec3) -> Rgb {
        let wi_local = self.frame.local_from_world(wi);
        let cos_geometric = self.point.ng.dot(wi);
        if (wi_local.z > 0.0) != (cos_geometric > 0.0) {
            return Rgb::BLACK;
        }
        if cos_geometric == 0.0 {
            return Rgb::BLACK;
        }
        // The quotient of the cosines grows towards the horizon, but the terminator factor falls as fast.
        let diffuse = self.bsdf.eval(self.wo_local, wi_local, Transport::Radiance).diffuse;
        diffuse * (self.terminator(wi, wi_local.z) / cos_geometric.abs())
    }

    /// The unit geometric normal on the side of `wo`.
    #[inline]
    #[must_use]
    pub fn facing_normal(&self) -> Vec3 {
        if self.point.ng.dot(self.wo) < 0.0 {
            -self.point.ng
        } else {
            self.point.ng
        }
    }

    /// The unit shading normal on the side of `wo`; the geometric one where the two disagree about that side.
    #[inline]
    #[must_use]
    pub fn facing_shading_normal(&self) -> Vec3 {
        if self.wo_local.z < 0.0 {
            -self.frame.z
        } else {
            self.frame.z
        }
    }

    /// True where a normal map, or a view that the shading normal does not see, turned the normal away from that of the
    /// point.
    #[inline]
    #[must_use]
    pub fn has_turned_normal(&self) -> bool {
        self.frame.z.dot(self.point.ns) < FLAT
    }

    /// The share of even light from the side of the eye that the D lobes reflect, `ρ_hd = ∫ f_d cosθ_i dω_i`.
    ///
    /// Of one Lambertian lobe it is the albedo, of a material that is the same everywhere it stands in a table; else it is estimated
    /// from some directions, without bias.
    ///
    /// - `scene`: that the point is of.
    /// - `stream`: random numbers of the path that arrived, `bounce` the vertex.
    #[inline]
    #[must_use]
    pub fn diffuse_reflectance(&self, scene: &Scene, stream: &SampleStream, bounce: u32) -> Rgb {
        if let Bsdf::Diffuse(diffuse) = &self.bsdf {
            return diffuse.albedo();
        }
        match scene.reflectance_table(self.point) {
            Some(table) => table.at(self.wo_local.z),
            None => estimate_reflectance(&self.bsdf, self.wo_local, stream, bounce),
        }
    }

    /// The value of a Lambertian reflection, albedo/π, where the surface is one and flat; `None` elsewhere.
    #[inline]
    #[must_use]
    pub fn lambertian(&self) -> Option<Rgb> {
        self.diffuse_value().filter(|_| self.cos_normals >= FLAT)
    }

    /// albedo/π where the surface scatters by one Lambertian lobe, however its normals are shaded; `None` elsewhere.
    #[inline]
    #[must_use]
    pub fn diffuse_value(&self) -> Option<Rgb> {
        match &self.bsdf {
            Bsdf::Diffuse(diffuse) => Some(diffuse.albedo() * std::f32::consts::FRAC_1_PI),
            _ => None,
        }
    }

    /// Chooses a direction to go on in, by importance of the scattering function.
    ///
    /// Returns the sample with its direction in world space; `None` ends the path.
    #[inline]
    #[must_use]
    pub fn sample(&self, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        let mut sample = match self.guide {
            Some(guide) if transport == Transport::Radiance => self.sample_guided(guide, u_lobe, u)?,
            _ => self.bsdf.sample(self.wo_local, u_lobe, u, transport)?,
        };
        let cos_shading = sample.wi.z;
        sample.wi = self.frame.world_from_local(sample.wi).normalize();
        let cos_geometric = self.point.ng.dot(sample.wi);
        if (cos_shading > 0.0) != (cos_geometric > 0.0) {
            return None;
        }
        match transport {
            Transport::Radiance => {
                if sample.class == scattering::LobeClass::Diffuse {
                    sample.weight *= self.terminator(sample.wi, cos_shading);
                }
            }
            Transport::Flux => {
                let wo_geometric = self.point.ng.dot(self.wo);
                let denominator = (wo_geometric * cos_shading).abs();
                if denominator <= 0.0 {
                    return None;
                }
                if self.cos_normals < FLAT {
                    sample.weight *= (self.wo_local.z * cos_geometric).abs() / denominator;
                }
            }
        }
        Some(sample)
    }

    /// A local direction from the guide or from the scattering function, weighed by the density of both.
    #[inline]
    fn sample_guided(&self, guide: &Guide, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let own = || self.bsdf.sample(self.wo_local, u_lobe, u, Transport::Radiance);
        let wi = match guide.sample(u_lobe, u) {
            Some(local) => self.toward_eye(local),
            None => own()?.wi,
        };
        let (values, pdf) = self.bsdf.eval_and_pdf(self.wo_local, wi, Transport::Radiance);
        let pdf = guide.mixed_pdf(self.toward_eye(wi), pdf);
        (pdf > 0.0).then(|| BsdfSample {
            wi,
            weight: values.diffuse * (1.0 / pdf),
            pdf,
            class: scattering::LobeClass::Diffuse,
            transmitted: false,
            eta_sq_scale: 1.0,
        })
    }

    #[inline]
    fn terminator(&self, wi: Vec3, cos_shading: f32) -> f32 {
        soften_terminator(self.point.ng.dot(wi).abs(), cos_shading.abs(), self.cos_normals)
    }
}

/// 1 on flat surfaces; falls smoothly to 0 where the surface would shadow itself.
///
/// - `cos_geometric`, `cos_shading`: of the direction with the two normals, ≥ 0; `cos_normals`: between these.
#[inline]
pub(crate) fn soften_terminator(cos_geometric: f32, cos_shading: f32, cos_normals: f32) -> f32 {
    if cos_normals >= FLAT {
        return 1.0;
    }
    let g = cos_geometric / (cos_shading * cos_normals.max(1e-3));
    if g >= 1.0 { 1.0 } else { g * (1.0 + g - g * g) }
}

/// Normals closer than this cosine (0.08°) count as one.
const FLAT: f32 = 0.999_999;
