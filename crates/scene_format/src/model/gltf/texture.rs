//! Textures as values of fields: which image, and how it lies on the surface.

use glam::DVec3;

use super::super::error::{Fault, ModelWarning};
use super::super::write::{Component, numbers};
use super::graph::no_such;
use super::json::{Material, MaybeTexture, Root, Sampler, TextureInfo};
use super::material::LARGEST;

const NEAREST: u32 = 9728;
const LINEAR: u32 = 9729;
const CLAMP: u32 = 33071;
const MIRROR: u32 = 33648;
const REPEAT: u32 = 10497;

/// What of a texture multiplies the factor: its colour, or one channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Colour,
    R,
    G,
    B,
    A,
}

impl Part {
    /// None for what a field reads of itself.
    fn channel(self) -> Option<&'static str> {
        match self {
            Self::Colour | Self::R => None,
            Self::G => Some("G"),
            Self::B => Some("B"),
            Self::A => Some("A"),
        }
    }
}

/// Writes a texture as the value of a field. None if it has no image in a format that glTF itself has.
///
/// - `file`: the name of the model, which holds or names the image.
pub(super) fn texture_map(root: &Root, file: &str, info: &TextureInfo, part: Part, factor: DVec3) -> Option<String> {
    let texture = root.textures.get(info.index as usize)?;
    let image = texture.source?;
    let sampler = texture.sampler.and_then(|sampler| root.samplers.get(sampler as usize));
    let map = Component::new("TextureMap")
        .text("file", file)
        .raw("image", image.to_string());
    let map = with_sampler(with_place(map, info), sampler);
    let map = match part.channel() {
        Some(channel) => map.raw("channel", channel.to_owned()),
        None => map,
    };
    let map = if factor == DVec3::ONE {
        map
    } else {
        map.vector("factor", factor)
    };
    Some(map.value())
}

fn with_place(mut map: Component, info: &TextureInfo) -> Component {
    let none = Default::default();
    let transform = info.extensions.transform.as_deref().unwrap_or(&none);
    let uv_set = transform.tex_coord.unwrap_or(info.tex_coord);
    if uv_set != 0 {
        map = map.raw("uv_set", uv_set.to_string());
    }
    let bounded = |pair: [f64; 2]| numbers(&pair.map(|number| number.clamp(-LARGEST, LARGEST)));
    if transform.offset != [0.0; 2] {
        map = map.raw("translate", bounded(transform.offset));
    }
    if transform.rotation != 0.0 {
        let degrees = transform.rotation.to_degrees();
        map = map.number("rotate", degrees.clamp(-LARGEST, LARGEST));
    }
    if transform.scale != [1.0; 2] {
        map = map.raw("scale", bounded(transform.scale));
    }
    map
}

fn with_sampler(mut map: Component, sampler: Option<&Sampler>) -> Component {
    let Some(sampler) = sampler else {
        return map;
    };
    for (field, wrap) in [("wrap_u", sampler.wrap_s), ("wrap_v", sampler.wrap_t)] {
        map = match wrap {
            Some(CLAMP) => map.raw(field, "Clamp".to_owned()),
            Some(MIRROR) => map.raw(field, "Mirror".to_owned()),
            _ => map,
        };
    }
    if sampler.mag_filter == Some(NEAREST) {
        map = map.raw("filter", "Nearest".to_owned());
    }
    map
}

/// Warns of samplers that say what the format does not know; the default counts.
pub(super) fn check_samplers(root: &Root) -> Vec<ModelWarning> {
    let mut warnings = Vec::new();
    for (number, sampler) in root.samplers.iter().enumerate() {
        for (field, value, known) in [
            ("magFilter", sampler.mag_filter, &[NEAREST, LINEAR][..]),
            ("wrapS", sampler.wrap_s, &[CLAMP, MIRROR, REPEAT]),
            ("wrapT", sampler.wrap_t, &[CLAMP, MIRROR, REPEAT]),
        ] {
            if let Some(value) = value.filter(|value| !known.contains(value)) {
                warnings.push(ModelWarning {
                    at: format!("samplers[{number}].{field}"),
                    message: format!("{value} is none of {known:?}, so the default is used"),
                });
            }
        }
    }
    warnings
}

/// Refuses textures that point nowhere.
pub(super) fn check_textures(root: &Root) -> Result<(), Fault> {
    for (number, texture) in root.textures.iter().enumerate() {
        for (field, what, index, count) in [
            ("source", "image", texture.source, root.images.len()),
            ("sampler", "sampler", texture.sampler, root.samplers.len()),
        ] {
            if let Some(index) = index.filter(|index| *index as usize >= count) {
                return Err(no_such(&format!("textures[{number}].{field}"), what, index, count));
            }
        }
    }
    Ok(())
}

/// Refuses a material that names textures which do not exist.
pub(super) fn check_uses(material: &Material, root: &Root, at: &str) -> Result<(), Fault> {
    let count = root.textures.len();
    for (name, texture) in uses(material) {
        if let Some(texture) = texture.as_ref().filter(|texture| texture.index as usize >= count) {
            return Err(no_such(&format!("{at}.{name}.index"), "texture", texture.index, count));
        }
    }
    Ok(())
}

/// Every texture of a material, with its place.
fn uses(material: &Material) -> Vec<(&'static str, &MaybeTexture)> {
    let pbr = &material.pbr_metallic_roughness;
    let mut all = vec![
        ("pbrMetallicRoughness.baseColorTexture", &pbr.base_color_texture),
        (
            "pbrMetallicRoughness.metallicRoughnessTexture",
            &pbr.metallic_roughness_texture,
        ),
        ("normalTexture", &material.normal_texture),
        ("occlusionTexture", &material.occlusion_texture),
        ("emissiveTexture", &material.emissive_texture),
    ];
    if let Some(extensions) = material.extensions.as_deref() {
        let (specular, coat, sheen) = (&extensions.specular, &extensions.clearcoat, &extensions.sheen);
        all.extend([
            (
                "extensions.KHR_materials_specular.specularTexture",
                &specular.specular_texture,
            ),
            (
                "extensions.KHR_materials_specular.specularColorTexture",
                &specular.specular_color_texture,
            ),
            (
                "extensions.KHR_materials_transmission.transmissionTexture",
                &extensions.transmission.transmission_texture,
            ),
            (
                "extensions.KHR_materials_volume.thicknessTexture",
                &extensions.volume.thickness_texture,
            ),
            (
                "extensions.KHR_materials_clearcoat.clearcoatTexture",
                &coat.clearcoat_texture,
            ),
            (
                "extensions.KHR_materials_clearcoat.clearcoatRoughnessTexture",
                &coat.clearcoat_roughness_texture,
            ),
            (
                "extensions.KHR_materials_clearcoat.clearcoatNormalTexture",
                &coat.clearcoat_normal_texture,
            ),
            (
                "extensions.KHR_materials_sheen.sheenColorTexture",
                &sheen.sheen_color_texture,
            ),
            (
                "extensions.KHR_materials_sheen.sheenRoughnessTexture",
                &sheen.sheen_roughness_texture,
            ),
        ]);
    }
    all
}
