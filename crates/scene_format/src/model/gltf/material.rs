//! Materials: all become `Principled`, which is the format's own model. This is the one place that decides how.
//!
//! A texture is a field of its own in place of the plain one, with the factor that the file gives. Occlusion textures
//! do nothing, since light transport finds occlusion, and neither do thickness textures, since light takes its real
//! way through a solid. What is unlit shines of itself and reflects nothing.
//!
//! Source: Khronos Group, glTF 2.0 specification, section 3.9 and the extensions that the fields are named after.

use std::collections::BTreeSet;

use glam::DVec3;

use super::super::error::Fault;
use super::super::write::Component;
use super::Translation;
use super::json::{AlphaMode, Clearcoat, Material, MaterialExtensions, MaybeTexture, Root, Sheen, TextureInfo, Volume};
use super::texture::{Part, check_uses, texture_map};
use crate::schema::ComponentInfo;

/// A material on its way to a prim.
#[derive(Debug)]
pub(super) struct PrimMaterial {
    /// Of its prim.
    pub(super) name: String,
    pub(super) surface: Component,
}

/// The component that a material becomes.
pub(super) const SURFACE: &str = "Principled";

/// The largest number that a component holds.
pub(super) const LARGEST: f64 = 3e38;

/// The least distance in which a clear solid absorbs, so that it is not 0 in single precision.
const LEAST_DISTANCE: f64 = 1e-30;

/// The range of `Principled.ior`.
const IOR: std::ops::RangeInclusive<f64> = 1.0..=4.0;

impl Translation<'_> {
    /// Converts a material that `at` names; `info` describes its component.
    pub(super) fn convert_material(
        &mut self,
        material: &Material,
        info: &ComponentInfo,
        at: &str,
        name: String,
    ) -> Result<PrimMaterial, Fault> {
        check_uses(material, self.root, at)?;
        let none = MaterialExtensions::default();
        let extensions = material.extensions.as_deref().unwrap_or(&none);
        note_absences(material, extensions, &mut self.left_out);
        let ior = extensions.ior.ior;
        let shown = ior.map(|ior| if ior == 0.0 { *IOR.end() } else { clamped(ior, IOR) });
        if let (Some(ior), Some(shown)) = (ior, shown)
            && ior != shown
        {
            let message = format!("an index of refraction of {ior} is out of range, {shown} is used");
            self.warn(&format!("{at}.extensions.KHR_materials_ior.ior"), message);
        }
        let mut surface = Surface {
            component: Component::new(SURFACE),
            info,
            root: self.root,
            file_name: self.file_name,
            left_out: &mut self.left_out,
        };
        if extensions.unlit.is_some() {
            surface.unlit(material);
        } else {
            surface.lit(material, extensions, shown);
        }
        surface.alpha(material);
        Ok(PrimMaterial {
            name,
            surface: surface.component,
        })
    }
}

/// A component that is being written, of the fields that the vocabulary has.
struct Surface<'t> {
    component: Component,
    info: &'t ComponentInfo,
    root: &'t Root,
    file_name: &'t str,
    left_out: &'t mut BTreeSet<&'static str>,
}

impl Surface<'_> {
    fn unlit(&mut self, material: &Material) {
        self.colour("base_color", DVec3::ZERO, &None);
        self.plain("specular", 0.0);
        let texture = &material.pbr_metallic_roughness.base_color_texture;
        self.colour("emission", base_color(material), texture);
    }

    fn lit(&mut self, material: &Material, extensions: &MaterialExtensions, ior: Option<f64>) {
        let pbr = &material.pbr_metallic_roughness;
        self.colour("base_color", base_color(material), &pbr.base_color_texture);
        let texture = &pbr.metallic_roughness_texture;
        self.share("metallic", pbr.metallic_factor.unwrap_or(1.0), texture, Part::B);
        self.share("roughness", pbr.roughness_factor.unwrap_or(1.0), texture, Part::G);
        if let Some(ior) = ior {
            self.plain("ior", ior);
        }
        let specular = &extensions.specular;
        if specular.specular_factor.is_some() || specular.specular_texture.is_some() {
            let factor = specular.specular_factor.unwrap_or(1.0);
            self.share("specular", factor, &specular.specular_texture, Part::A);
        }
        if specular.specular_color_factor.is_some() || specular.specular_color_texture.is_some() {
            let factor = radiance(specular.specular_color_factor.unwrap_or([1.0; 3]), 1.0);
            self.colour("specular_color", factor, &specular.specular_color_texture);
        }
        let transmission = &extensions.transmission;
        if transmission.transmission_factor > 0.0 {
            let (factor, texture) = (transmission.transmission_factor, &transmission.transmission_texture);
            self.share("transmission", factor, texture, Part::R);
            self.volume(&extensions.volume);
        }
        self.clearcoat(&extensions.clearcoat);
        self.sheen(&extensions.sheen);
        self.emission(material, extensions.emissive_strength.emissive_strength.unwrap_or(1.0));
        self.normal(material);
    }

    fn volume(&mut self, volume: &Volume) {
        if volume.thickness_factor <= 0.0 {
            return;
        }
        self.plain("thickness", volume.thickness_factor);
        if let Some(distance) = volume.attenuation_distance.filter(|distance| *distance > 0.0) {
            let colour = unit_range(volume.attenuation_color.unwrap_or([1.0; 3]));
            self.colour("attenuation_color", colour, &None);
            self.plain("attenuation_distance", distance.max(LEAST_DISTANCE));
        }
    }

    fn clearcoat(&mut self, coat: &Clearcoat) {
        if coat.clearcoat_factor > 0.0 {
            self.share("clearcoat", coat.clearcoat_factor, &coat.clearcoat_texture, Part::R);
            let (factor, texture) = (coat.clearcoat_roughness_factor, &coat.clearcoat_roughness_texture);
            self.share("clearcoat_roughness", factor, texture, Part::G);
        }
    }

    fn sheen(&mut self, sheen: &Sheen) {
        let colour = unit_range(sheen.sheen_color_factor);
        if colour != DVec3::ZERO {
            self.colour("sheen", colour, &sheen.sheen_color_texture);
            let (factor, texture) = (sheen.sheen_roughness_factor, &sheen.sheen_roughness_texture);
            self.share("sheen_roughness", factor, texture, Part::A);
        }
    }

    fn emission(&mut self, material: &Material, strength: f64) {
        let emitted = radiance(material.emissive_factor.unwrap_or([0.0; 3]), strength);
        if emitted != DVec3::ZERO {
            self.colour("emission", emitted, &material.emissive_texture);
            if material.double_sided {
                self.left_out.insert("light from the backs of double-sided materials");
            }
        }
    }

    fn normal(&mut self, material: &Material) {
        let Some(texture) = &material.normal_texture else {
            return;
        };
        if self.texture("normal", texture, Part::Colour, DVec3::ONE)
            && let Some(scale) = texture.scale.filter(|scale| *scale != 1.0)
        {
            self.plain("normal_scale", scale);
        }
    }

    /// Coverage, where it can be less than all: a vocabulary without textures of it does not have that.
    fn alpha(&mut self, material: &Material) {
        if material.alpha_mode == AlphaMode::Opaque {
            return;
        }
        if self.info.field("alpha_cutoff").is_none() {
            self.left_out.insert("transparency by alpha");
            return;
        }
        let pbr = &material.pbr_metallic_roughness;
        let [_, _, _, alpha] = pbr.base_color_factor.unwrap_or([1.0; 4]);
        self.share("alpha", alpha, &pbr.base_color_texture, Part::A);
        if material.alpha_mode == AlphaMode::Mask {
            self.plain("alpha_cutoff", material.alpha_cutoff.unwrap_or(0.5).clamp(0.0, 1.0));
        }
    }

    fn colour(&mut self, field: &'static str, factor: DVec3, texture: &MaybeTexture) {
        if !self.textured(field, texture, Part::Colour, factor) {
            self.add(|component| component.vector(field, factor));
        }
    }

    /// Writes a number from 0 to 1.
    fn share(&mut self, field: &'static str, factor: f64, texture: &MaybeTexture, part: Part) {
        let factor = factor.clamp(0.0, 1.0);
        if !self.textured(field, texture, part, DVec3::splat(factor)) {
            self.plain(field, factor);
        }
    }

    fn plain(&mut self, field: &'static str, value: f64) {
        self.add(|component| component.number(field, value.clamp(-LARGEST, LARGEST)));
    }

    /// Writes a texture in place of a field, if there is one that does something.
    fn textured(&mut self, field: &str, texture: &MaybeTexture, part: Part, factor: DVec3) -> bool {
        let texture = texture.as_deref().filter(|_| factor != DVec3::ZERO);
        texture.is_some_and(|texture| self.texture(field, texture, part, factor))
    }

    fn texture(&mut self, field: &str, texture: &TextureInfo, part: Part, factor: DVec3) -> bool {
        let Some(known) = self.info.field(&format!("{field}_texture")) else {
            self.left_out.insert("textures");
            return false;
        };
        match texture_map(self.root, self.file_name, texture, part, factor) {
            Some(map) => self.add(|component| component.raw(known.name, map)),
            None => {
                self.left_out.insert("textures that are neither PNG nor JPEG");
                return false;
            }
        }
        true
    }

    fn add(&mut self, field: impl FnOnce(Component) -> Component) {
        let component = std::mem::replace(&mut self.component, Component::new(SURFACE));
        self.component = field(component);
    }
}

fn base_color(material: &Material) -> DVec3 {
    let [r, g, b, _] = material.pbr_metallic_roughness.base_color_factor.unwrap_or([1.0; 4]);
    unit_range([r, g, b])
}

fn unit_range(colour: [f64; 3]) -> DVec3 {
    DVec3::from_array(colour).clamp(DVec3::ZERO, DVec3::ONE)
}

/// A colour without an upper end.
fn radiance(colour: [f64; 3], strength: f64) -> DVec3 {
    (DVec3::from_array(colour) * strength).clamp(DVec3::ZERO, DVec3::splat(LARGEST))
}

fn clamped(number: f64, range: std::ops::RangeInclusive<f64>) -> f64 {
    number.clamp(*range.start(), *range.end())
}

fn note_absences(material: &Material, extensions: &MaterialExtensions, left_out: &mut BTreeSet<&'static str>) {
    let glows_behind = extensions.unlit.is_some() && material.double_sided;
    for (absent, what) in [
        (glows_behind, "light from the backs of double-sided materials"),
        (
            extensions.clearcoat.clearcoat_normal_texture.is_some(),
            "normal textures of clear coats",
        ),
        (extensions.iridescence.is_some(), "iridescence"),
        (extensions.anisotropy.is_some(), "anisotropy"),
        (extensions.dispersion.is_some(), "dispersion"),
        (
            extensions.specular_glossiness.is_some(),
            "specular-glossiness materials",
        ),
    ] {
        if absent {
            left_out.insert(what);
        }
    }
}
