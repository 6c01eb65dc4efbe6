//! Materials of OBJ files: the nearest component for each. This is the one place that decides what they become.

use glam::DVec3;

use super::super::write::Component;
use super::mtl::MtlMaterial;

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

/// Converts a material; `name` is that of its prim.
///
/// - `has_textures`: whether `Diffuse` can have a texture.
pub(super) fn convert(material: &MtlMaterial, name: String, has_textures: bool) -> PrimMaterial {
    let radiance = material
        .emission
        .unwrap_or(DVec3::ZERO)
        .clamp(DVec3::ZERO, DVec3::splat(3e38));
    PrimMaterial {
        name,
        surface: surface(material, has_textures),
        emission: (radiance != DVec3::ZERO).then(|| Component::new("Emission").vector("radiance", radiance)),
    }
}

/// Illumination models 4, 6, 7 and 9 are of glass, 3 and 5 of mirrors.
fn surface(material: &MtlMaterial, has_textures: bool) -> Component {
    let diffuse = unit_range(material.diffuse.unwrap_or(DVec3::splat(0.8)));
    let specular = unit_range(material.specular.unwrap_or(DVec3::ZERO));
    let is_model = |models: &[f64]| material.illumination.is_some_and(|model| models.contains(&model));
    if material.metallic.unwrap_or(0.0) > 0.5 {
        return Component::new("Conductor")
            .vector("f0", diffuse)
            .number("roughness", roughness(material));
    }
    let ior = material.ior.unwrap_or(1.0);
    if is_model(&[4.0, 6.0, 7.0, 9.0]) && ior > 1.0 {
        return Component::new("Dielectric")
            .number("ior", ior.clamp(1.0, 4.0))
            .number("roughness", roughness(material))
            .vector("tint", unit_range(material.filter.unwrap_or(DVec3::ONE)));
    }
    let opacity = material.opacity.unwrap_or(1.0).clamp(0.0, 1.0);
    if opacity < 0.5 {
        // What covers a part of the view lets the rest through as it is.
        let tint = DVec3::ONE.lerp(diffuse, opacity);
        return Component::new("Dielectric")
            .number("ior", 1.0)
            .vector("tint", tint)
            .flag("thin", true);
    }
    if is_model(&[3.0, 5.0]) && specular.element_sum() > diffuse.element_sum() {
        return Component::new("Conductor")
            .vector("f0", specular)
            .number("roughness", roughness(material));
    }
    match &material.diffuse_texture {
        Some(texture) if has_textures => {
            Component::new("Diffuse").raw("albedo_texture", texture_map(material, texture))
        }
        _ => Component::new("Diffuse").vector("albedo", diffuse),
    }
}

fn texture_map(material: &MtlMaterial, file: &str) -> String {
    let map = Component::new("TextureMap").text("file", file);
    match unit_range(material.diffuse.unwrap_or(DVec3::ONE)) {
        DVec3::ONE => map.value(),
        factor => map.vector("factor", factor).value(),
    }
}

/// The roughness of a highlight: α² = 2 / (exponent + 2), and α is the roughness squared. Above 1000 it is a mirror.
///
/// Source: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, the exponent of Phong.
fn roughness(material: &MtlMaterial) -> f64 {
    if let Some(roughness) = material.roughness {
        return roughness.clamp(0.0, 1.0);
    }
    match material.exponent {
        Some(exponent) if exponent < 1000.0 => (2.0 / (exponent.max(0.0) + 2.0)).sqrt().sqrt(),
        _ => 0.0,
    }
}

fn unit_range(colour: DVec3) -> DVec3 {
    colour.clamp(DVec3::ZERO, DVec3::ONE)
}
