//! From the fields of a material to inputs, which may be textures.

use pipeline_data::vocabulary::{Diffuse, Findings, Principled, TextureMap, field_place};
use pipeline_data::{TextureRole, TextureStore};
use radiometry::Rgb;
use scene_format::{Diagnostic, FieldState, Scene};
use texture::Texture;
use transport::{Coverage, Input, NormalMap, PrincipledInputs, SurfaceInputs, TexturedBsdf};

/// The material component of a prim, on its way to inputs.
pub(super) struct Fields<'a> {
    pub(super) scene: &'a Scene,
    pub(super) store: &'a TextureStore,
    pub(super) prim: u32,
    pub(super) component: &'static str,
}

impl Fields<'_> {
    /// True when the scene has a value for a field.
    fn is_written(&self, field: &str) -> bool {
        let component = self.scene.prims[self.prim as usize].component(self.component);
        component
            .and_then(|component| component.field(field))
            .is_some_and(|field| !matches!(field.state, FieldState::Blocked))
    }

    /// The texture in place of a plain field. One that could not be read was reported when it was.
    fn texture(
        &self,
        plain: &str,
        map: Option<&TextureMap>,
        role: TextureRole,
        findings: &mut Findings,
    ) -> Option<Box<Texture>> {
        let texture = self.store.texture(map?, role)?;
        if self.is_written(plain) {
            let field = format!("{plain}_texture");
            let message = format!("`{}.{plain}` has no effect beside `{field}`", self.component);
            let finding = Diagnostic::warning("without-effect", message)
                .note("the texture takes its place; its `factor` multiplies what the picture says");
            findings.push_at(field_place(self.scene, self.prim, self.component, &[plain]), finding);
        }
        Some(Box::new(texture))
    }

    fn colour(&self, plain: &str, value: glam::Vec3, map: Option<&TextureMap>, findings: &mut Findings) -> Input<Rgb> {
        match self.texture(plain, map, TextureRole::Colour, findings) {
            Some(texture) => Input::Texture(texture),
            None => Input::Constant(value.into()),
        }
    }

    fn number(&self, plain: &str, value: f32, map: Option<&TextureMap>, findings: &mut Findings) -> Input<f32> {
        match self.texture(plain, map, TextureRole::Data, findings) {
            Some(texture) => Input::Texture(texture),
            None => Input::Constant(value),
        }
    }

    pub(super) fn diffuse(&self, diffuse: &Diffuse, findings: &mut Findings) -> SurfaceInputs {
        let albedo = self.colour("albedo", diffuse.albedo, diffuse.albedo_texture.as_ref(), findings);
        SurfaceInputs {
            bsdf: TexturedBsdf::Diffuse(albedo),
            normal: None,
            coverage: None,
            vertex_colours: false,
        }
    }

    pub(super) fn principled(
        &self,
        principled: &Principled,
        specular_alpha: f32,
        findings: &mut Findings,
    ) -> SurfaceInputs {
        let p = principled;
        let mut number = |plain, value, map: &Option<_>| self.number(plain, value, map.as_ref(), findings);
        let metallic = number("metallic", p.metallic, &p.metallic_texture);
        let roughness = number("roughness", p.roughness, &p.roughness_texture);
        let specular = number("specular", p.specular, &p.specular_texture);
        let transmission = number("transmission", p.transmission, &p.transmission_texture);
        let clearcoat = number("clearcoat", p.clearcoat, &p.clearcoat_texture);
        let coat = &p.clearcoat_roughness_texture;
        let clearcoat_roughness = number("clearcoat_roughness", p.clearcoat_roughness, coat);
        let sheen_roughness = number("sheen_roughness", p.sheen_roughness, &p.sheen_roughness_texture);
        let mut colour = |plain, value, map: &Option<_>| self.colour(plain, value, map.as_ref(), findings);
        let layers = PrincipledInputs {
            base_color: colour("base_color", p.base_color, &p.base_color_texture),
            specular_color: colour("specular_color", p.specular_color, &p.specular_color_texture),
            sheen: colour("sheen", p.sheen, &p.sheen_texture),
            metallic,
            roughness,
            specular,
            transmission,
            clearcoat,
            clearcoat_roughness,
            sheen_roughness,
            ior: p.ior,
            solid: p.thickness > 0.0,
            specular_alpha,
        };
        SurfaceInputs {
            bsdf: TexturedBsdf::Principled(Box::new(layers)),
            normal: self.normal(p, findings),
            coverage: self.coverage(p, findings),
            vertex_colours: false,
        }
    }

    /// What a `Principled` emits.
    pub(super) fn emission(&self, principled: &Principled, findings: &mut Findings) -> Input<Rgb> {
        let map = principled.emission_texture.as_ref();
        self.colour("emission", principled.emission, map, findings)
    }

    fn normal(&self, principled: &Principled, findings: &mut Findings) -> Option<NormalMap> {
        let map = principled.normal_texture.as_ref();
        if map.is_none() && self.is_written("normal_scale") {
            let message = "`Principled.normal_scale` has no effect without `normal_texture`";
            let place = field_place(self.scene, self.prim, self.component, &["normal_scale"]);
            findings.push_at(place, Diagnostic::warning("without-effect", message));
        }
        Some(NormalMap {
            texture: self.texture("normal", map, TextureRole::Data, findings)?,
            scale: principled.normal_scale,
        })
    }

    /// None where the scene says nothing of alpha: then the colours of vertices have none either.
    fn coverage(&self, principled: &Principled, findings: &mut Findings) -> Option<Coverage> {
        let fields = ["alpha", "alpha_texture", "alpha_cutoff"];
        if !fields.into_iter().any(|field| self.is_written(field)) {
            return None;
        }
        let map = principled.alpha_texture.as_ref();
        Some(Coverage {
            alpha: self.number("alpha", principled.alpha, map, findings),
            cutoff: principled.alpha_cutoff,
        })
    }
}

/// The textures that inputs read, for checks of the coordinates that they need.
pub(super) fn highest_uv_set(
    textures: &mut dyn Iterator<Item = (&'static str, &TextureMap)>,
) -> Option<(&'static str, u32)> {
    textures
        .map(|(field, map)| (field, map.uv_set))
        .reduce(|most, next| if next.1 > most.1 { next } else { most })
}
