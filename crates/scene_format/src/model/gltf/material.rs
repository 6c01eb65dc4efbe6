//! Materials: the nearest component for each. This is the one place that decides what a material becomes.
//!
//! Metal becomes `Conductor`, what lets light through `Dielectric`, everything else `Diffuse`; what glows gives the
//! prims that use it an `Emission`. A texture counts as its middle, 0.5, until textures are read; one that says where a
//! surface glows counts as 0, since a lamp must not shine all over.

use std::collections::BTreeSet;

use glam::DVec3;

use super::super::error::Fault;
use super::super::write::Component;
use super::graph::no_such;
use super::json::{Material, MaterialExtensions, Root, TextureInfo, Volume};

/// A material on its way to a prim.
#[derive(Debug)]
pub(super) struct PrimMaterial {
    /// Of its prim.
    pub(super) name: String,
    /// For the prim of the material.
    pub(super) surface: Component,
    /// For each prim that uses it: light has to be on the geometry.
    pub(super) emission: Option<Component>,
}

/// What a texture counts as.
const TEXTURE_MEAN: f64 = 0.5;

/// The largest number that a component holds.
const LARGEST: f64 = 3e38;

/// Converts a material that `at` names.
pub(super) fn convert(
    material: &Material,
    root: &Root,
    at: &str,
    name: String,
    left_out: &mut BTreeSet<&'static str>,
) -> Result<PrimMaterial, Fault> {
    check_textures(material, root, at)?;
    note_absences(material, left_out);
    let none = MaterialExtensions::default();
    let extensions = material.extensions.as_deref().unwrap_or(&none);
    Ok(PrimMaterial {
        name,
        surface: surface(material, extensions, left_out),
        emission: emission(material, extensions),
    })
}

fn surface(material: &Material, extensions: &MaterialExtensions, left_out: &mut BTreeSet<&'static str>) -> Component {
    let pbr = &material.pbr_metallic_roughness;
    let [r, g, b, _] = pbr.base_color_factor.unwrap_or([1.0; 4]);
    let base = unit_range(DVec3::new(r, g, b)) * mean_of(pbr.base_color_texture.as_ref());
    let rough = pbr.roughness_factor.unwrap_or(1.0) * mean_of(pbr.metallic_roughness_texture.as_ref());
    let roughness = rough.clamp(0.0, 1.0);
    let metallic = pbr.metallic_factor.unwrap_or(1.0) * mean_of(pbr.metallic_roughness_texture.as_ref());
    let transmission = extensions.transmission.as_ref().map_or(0.0, |transmission| {
        transmission.transmission_factor * mean_of(transmission.transmission_texture.as_ref())
    });
    if extensions.unlit.is_some() {
        left_out.insert("unlit materials (they are lit)");
        return Component::new("Diffuse").vector("albedo", base);
    }
    if metallic > 0.5 {
        return Component::new("Conductor")
            .vector("f0", base)
            .number("roughness", roughness);
    }
    if transmission > 0.5 {
        let ior = extensions
            .ior
            .as_ref()
            .and_then(|ior| ior.ior)
            .unwrap_or(1.5)
            .clamp(1.0, 4.0);
        let glass = Component::new("Dielectric").number("ior", ior).vector("tint", base);
        return match &extensions.volume {
            Some(volume) if volume.thickness_factor > 0.0 => {
                let glass = glass.number("roughness", roughness);
                match absorption(volume) {
                    Some(absorption) => glass.vector("absorption", absorption),
                    None => glass,
                }
            }
            _ => {
                if roughness > 0.0 {
                    left_out.insert("roughness of thin glass");
                }
                glass.flag("thin", true)
            }
        };
    }
    Component::new("Diffuse").vector("albedo", base)
}

/// The absorption that leaves `attenuationColor` after `attenuationDistance`: −ln(colour) / distance.
fn absorption(volume: &Volume) -> Option<DVec3> {
    let distance = volume.attenuation_distance.filter(|distance| *distance > 0.0)?;
    let colour = DVec3::from_array(volume.attenuation_color.unwrap_or([1.0; 3]));
    // Black is not reached in finite glass.
    let absorption = colour
        .clamp(DVec3::splat(1e-6), DVec3::ONE)
        .map(|c| (0.0 - libm::log(c)) / distance);
    Some(absorption.min(DVec3::splat(LARGEST)))
}

fn emission(material: &Material, extensions: &MaterialExtensions) -> Option<Component> {
    let strength = extensions.emissive_strength.as_ref();
    let strength = strength.and_then(|found| found.emissive_strength).unwrap_or(1.0);
    let factor = DVec3::from_array(material.emissive_factor?);
    let radiance = (factor * strength).clamp(DVec3::ZERO, DVec3::splat(LARGEST));
    if radiance == DVec3::ZERO || material.emissive_texture.is_some() {
        return None;
    }
    let emission = Component::new("Emission").vector("radiance", radiance);
    Some(if material.double_sided {
        emission.flag("two_sided", true)
    } else {
        emission
    })
}

fn unit_range(colour: DVec3) -> DVec3 {
    colour.clamp(DVec3::ZERO, DVec3::ONE)
}

fn mean_of(texture: Option<&TextureInfo>) -> f64 {
    if texture.is_some() { TEXTURE_MEAN } else { 1.0 }
}

fn check_textures(material: &Material, root: &Root, at: &str) -> Result<(), Fault> {
    let pbr = &material.pbr_metallic_roughness;
    for (name, texture) in [
        ("pbrMetallicRoughness.baseColorTexture", &pbr.base_color_texture),
        (
            "pbrMetallicRoughness.metallicRoughnessTexture",
            &pbr.metallic_roughness_texture,
        ),
        ("normalTexture", &material.normal_texture),
        ("occlusionTexture", &material.occlusion_texture),
        ("emissiveTexture", &material.emissive_texture),
    ] {
        let count = root.textures.len();
        if let Some(texture) = texture.as_ref().filter(|texture| texture.index as usize >= count) {
            return Err(no_such(&format!("{at}.{name}.index"), "texture", texture.index, count));
        }
    }
    Ok(())
}

fn note_absences(material: &Material, left_out: &mut BTreeSet<&'static str>) {
    let none = MaterialExtensions::default();
    let extensions = material.extensions.as_deref().unwrap_or(&none);
    let pbr = &material.pbr_metallic_roughness;
    let transmission = extensions.transmission.as_ref();
    let textures = [
        &pbr.base_color_texture,
        &pbr.metallic_roughness_texture,
        &material.normal_texture,
    ];
    let more = [&material.occlusion_texture, &material.emissive_texture];
    let textured = textures.into_iter().chain(more).any(Option::is_some)
        || transmission.is_some_and(|transmission| transmission.transmission_texture.is_some());
    for (absent, what) in [
        (textured, "textures"),
        (
            material.alpha_mode.as_deref().is_some_and(|mode| mode != "OPAQUE"),
            "transparency by alpha",
        ),
        (extensions.clearcoat.is_some(), "clearcoat"),
        (extensions.sheen.is_some(), "sheen"),
        (extensions.specular.is_some(), "specular strength and colour"),
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
