//! What of a material changes from point to point.

use glam::{Vec2, Vec3};
use radiometry::Rgb;
use scattering::{Bsdf, DiffuseBsdf, PrincipledBsdf, PrincipledParameters};
use spatial::{RayScene, SurfacePoint};
use texture::Texture;

/// A value of a material, the same everywhere or from a texture.
#[derive(Clone, Debug)]
pub enum Input<T> {
    /// The same everywhere.
    Constant(T),
    /// By texture coordinates.
    Texture(Box<Texture>),
}

impl<T> Input<T> {
    fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }
}

impl Input<Rgb> {
    /// The value at a point of a surface.
    #[inline]
    #[must_use]
    pub fn at(&self, rays: &RayScene, point: &SurfacePoint) -> Rgb {
        match self {
            Self::Constant(colour) => *colour,
            Self::Texture(texture) => texture.rgb(rays.uv_set(point, texture.uv_set)),
        }
    }

    /// Mean value. Cost: a look at every texel.
    #[must_use]
    pub fn mean(&self) -> Rgb {
        match self {
            Self::Constant(colour) => *colour,
            Self::Texture(texture) => texture.mean_rgb(),
        }
    }

    /// Greatest value, channel by channel. Cost: a look at every texel.
    #[must_use]
    pub fn max(&self) -> Rgb {
        match self {
            Self::Constant(colour) => *colour,
            Self::Texture(texture) => texture.max_rgb(),
        }
    }
}

impl Input<f32> {
    #[inline]
    fn at(&self, rays: &RayScene, point: &SurfacePoint) -> f32 {
        self.at_coordinates(|set| rays.uv_set(point, set))
    }

    /// - `uv`: gives the coordinates in a set.
    #[inline]
    fn at_coordinates(&self, uv: impl Fn(u32) -> Vec2) -> f32 {
        match self {
            Self::Constant(number) => *number,
            Self::Texture(texture) => texture.value(uv(texture.uv_set)),
        }
    }

    /// Least and greatest value.
    fn range(&self) -> [f32; 2] {
        match self {
            Self::Constant(number) => [*number; 2],
            Self::Texture(texture) => texture.range().into(),
        }
    }
}

/// The parameters of a [`PrincipledBsdf`] that may come from textures.
#[derive(Clone, Debug)]
#[expect(missing_docs, reason = "as in `PrincipledParameters`")]
pub struct PrincipledInputs {
    pub base_color: Input<Rgb>,
    pub metallic: Input<f32>,
    pub roughness: Input<f32>,
    pub specular: Input<f32>,
    pub specular_color: Input<Rgb>,
    pub transmission: Input<f32>,
    pub clearcoat: Input<f32>,
    pub clearcoat_roughness: Input<f32>,
    pub sheen: Input<Rgb>,
    pub sheen_roughness: Input<f32>,
    pub ior: f32,
    pub solid: bool,
    /// The threshold between specular and diffuse of [`scattering::lobe_class`].
    pub specular_alpha: f32,
}

impl PrincipledInputs {
    fn at(&self, rays: &RayScene, point: &SurfacePoint, tint: Rgb) -> PrincipledBsdf {
        let parameters = PrincipledParameters {
            base_color: self.base_color.at(rays, point) * tint,
            metallic: self.metallic.at(rays, point),
            roughness: self.roughness.at(rays, point),
            ior: self.ior,
            specular: self.specular.at(rays, point),
            specular_color: self.specular_color.at(rays, point),
            transmission: self.transmission.at(rays, point),
            solid: self.solid,
            clearcoat: self.clearcoat.at(rays, point),
            clearcoat_roughness: self.clearcoat_roughness.at(rays, point),
            sheen: self.sheen.at(rays, point),
            sheen_roughness: self.sheen_roughness.at(rays, point),
        };
        PrincipledBsdf::new(&parameters, self.specular_alpha)
    }

    fn is_constant(&self) -> bool {
        let colours = [&self.base_color, &self.specular_color, &self.sheen];
        let numbers = [
            &self.metallic,
            &self.roughness,
            &self.specular,
            &self.transmission,
            &self.clearcoat,
            &self.clearcoat_roughness,
            &self.sheen_roughness,
        ];
        colours.into_iter().all(Input::is_constant) && numbers.into_iter().all(Input::is_constant)
    }

    /// Surfaces of all least and greatest values. What any point of the surface has, one of them has: whether a lobe is
    /// there, and of which class, depends on each value by a threshold.
    ///
    /// The first is the clearest.
    fn extremes(&self) -> Vec<PrincipledBsdf> {
        let ranges = [
            &self.metallic,
            &self.transmission,
            &self.roughness,
            &self.clearcoat,
            &self.clearcoat_roughness,
        ]
        .map(Input::range);
        let [metallic, transmission, roughness, clearcoat, clearcoat_roughness] = ranges;
        // All of these look at every texel.
        let (base_color, specular_color, sheen) = (self.base_color.max(), self.specular_color.max(), self.sheen.max());
        let (specular, sheen_roughness) = (self.specular.range()[1], self.sheen_roughness.range()[1]);
        let corner = |choice: usize| {
            let of = |range: [f32; 2], bit: usize| range[choice >> bit & 1];
            let parameters = PrincipledParameters {
                base_color,
                metallic: of(metallic, 0),
                // Counted from the greatest, so that the first corner is the clearest.
                transmission: of([transmission[1], transmission[0]], 1),
                roughness: of(roughness, 2),
                clearcoat: of(clearcoat, 3),
                clearcoat_roughness: of(clearcoat_roughness, 4),
                ior: self.ior,
                specular,
                specular_color,
                solid: self.solid,
                sheen,
                sheen_roughness,
            };
            PrincipledBsdf::new(&parameters, self.specular_alpha)
        };
        (0..1 << ranges.len()).map(corner).collect()
    }
}

/// How a surface scatters, by inputs.
#[derive(Clone, Debug)]
pub enum TexturedBsdf {
    /// A Lambertian surface of this albedo.
    Diffuse(Input<Rgb>),
    /// The layered model of glTF.
    Principled(Box<PrincipledInputs>),
}

/// Normals from a picture.
#[derive(Clone, Debug)]
pub struct NormalMap {
    /// Red, green and blue from 0 to 1 stand for −1 to 1: to the right, upward, outward.
    pub texture: Box<Texture>,
    /// Factor of the first two; negative makes bumps of dents.
    pub scale: f32,
}

/// How much of a surface is there.
#[derive(Clone, Debug)]
pub struct Coverage {
    /// 0 is nothing, 1 all.
    pub alpha: Input<f32>,
    /// Less than this is nothing, and all other everything.
    pub cutoff: Option<f32>,
}

/// The inputs of a material that is not the same everywhere.
#[derive(Clone, Debug)]
pub struct SurfaceInputs {
    /// How it scatters.
    pub bsdf: TexturedBsdf,
    /// Which way it faces.
    pub normal: Option<NormalMap>,
    /// How much of it is there; all of it without.
    pub coverage: Option<Coverage>,
    /// Whether the colours of vertices multiply its albedo or base colour, and their alpha its own.
    pub vertex_colours: bool,
}

/// A surface that changes from point to point, and what it may come to anywhere.
#[derive(Debug)]
pub struct TexturedSurface {
    inputs: SurfaceInputs,
    extremes: Vec<Bsdf>,
    has_alpha: bool,
}

impl TexturedSurface {
    /// Cost: a look at every texel.
    #[must_use]
    pub fn new(inputs: SurfaceInputs) -> Self {
        let extremes = match &inputs.bsdf {
            TexturedBsdf::Diffuse(albedo) => vec![Bsdf::Diffuse(DiffuseBsdf::new(albedo.max()))],
            TexturedBsdf::Principled(layers) => layers.extremes().into_iter().map(Bsdf::Principled).collect(),
        };
        Self {
            has_alpha: inputs.has_alpha(),
            inputs,
            extremes,
        }
    }

    /// How it scatters where it is clearest.
    #[must_use]
    pub fn clearest(&self) -> Bsdf {
        self.extremes.first().copied().unwrap_or_default()
    }

    /// Asks all that the surface can be; may say yes where no point of it is so, never no where one is.
    #[must_use]
    pub fn anywhere(&self, is_so: impl Fn(&Bsdf) -> bool) -> bool {
        self.extremes.iter().any(is_so)
    }

    /// The scattering function and the shading normal at a point.
    #[must_use]
    pub fn at(&self, rays: &RayScene, point: &SurfacePoint) -> (Bsdf, Vec3) {
        let tint = if self.inputs.vertex_colours {
            rays.vertex_colour(point).truncate().into()
        } else {
            Rgb::WHITE
        };
        let bsdf = match &self.inputs.bsdf {
            TexturedBsdf::Diffuse(albedo) => {
                let albedo = albedo.at(rays, point) * tint;
                Bsdf::Diffuse(DiffuseBsdf::new(albedo.map(|share| share.clamp(0.0, 1.0))))
            }
            TexturedBsdf::Principled(inputs) => Bsdf::Principled(inputs.at(rays, point, tint)),
        };
        let normal = self.inputs.normal.as_ref().map_or(point.ns, |map| map.at(rays, point));
        (bsdf, normal)
    }

    /// How much of the surface is there at a point, in [0, 1].
    #[must_use]
    pub fn alpha(&self, rays: &RayScene, point: &SurfacePoint) -> f32 {
        self.alpha_at(|set| rays.uv_set(point, set), || rays.vertex_colour(point).w)
    }

    /// [`TexturedSurface::alpha`] where there is a place, but no hit.
    ///
    /// - `uv`: gives its coordinates in a set.
    /// - `vertex_alpha`: gives the coverage of the vertices there.
    pub(crate) fn alpha_at(&self, uv: impl Fn(u32) -> Vec2, vertex_alpha: impl Fn() -> f32) -> f32 {
        let Some(coverage) = &self.inputs.coverage else {
            return 1.0;
        };
        let mut alpha = coverage.alpha.at_coordinates(uv);
        if self.inputs.vertex_colours {
            alpha *= vertex_alpha();
        }
        coverage.cut(alpha)
    }

    /// True when nothing of the surface is there anywhere. Cost: a look at every texel.
    pub(crate) fn is_nowhere(&self) -> bool {
        let most = |coverage: &Coverage| coverage.cut(coverage.alpha.range()[1]);
        self.inputs
            .coverage
            .as_ref()
            .is_some_and(|coverage| most(coverage) <= 0.0)
    }

    /// True when the surface may be less than whole anywhere.
    #[must_use]
    pub fn has_alpha(&self) -> bool {
        self.has_alpha
    }

    /// True when nothing changes from point to point, and nothing is missing.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        let inputs = &self.inputs;
        let is_constant = match &inputs.bsdf {
            TexturedBsdf::Diffuse(albedo) => albedo.is_constant(),
            TexturedBsdf::Principled(layers) => layers.is_constant(),
        };
        is_constant && inputs.normal.is_none() && !inputs.vertex_colours && !self.has_alpha
    }
}

impl SurfaceInputs {
    /// True when the surface may be less than whole anywhere. Cost: a look at every texel.
    fn has_alpha(&self) -> bool {
        let least = |coverage: &Coverage| coverage.cut(coverage.alpha.range()[0]);
        let coverage = self.coverage.as_ref();
        coverage.is_some_and(|coverage| self.vertex_colours || least(coverage) < 1.0)
    }
}

impl Coverage {
    fn cut(&self, alpha: f32) -> f32 {
        match self.cutoff {
            Some(cutoff) if alpha < cutoff => 0.0,
            Some(_) => 1.0,
            None => alpha.clamp(0.0, 1.0),
        }
    }
}

impl NormalMap {
    fn at(&self, rays: &RayScene, point: &SurfacePoint) -> Vec3 {
        let set = self.texture.uv_set;
        let tangents = rays
            .tangents(point, set)
            .and_then(|(dpdu, dpdv)| self.texture.transform.tangents(dpdu, dpdv));
        let Some((right, up)) = tangents else { return point.ns };
        let stored: Vec3 = self.texture.rgb(rays.uv_set(point, set)).into();
        let leaning = stored * 2.0 - 1.0;
        point.tilted_normal(right, up, leaning * Vec3::new(self.scale, self.scale, 1.0))
    }
}
