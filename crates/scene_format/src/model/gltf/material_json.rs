//! The JSON of materials, as in [`json`](super::json). Textures are boxed: most materials have few.

use serde::Deserialize;
use serde::de::IgnoredAny;

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Material {
    pub(super) name: String,
    pub(super) pbr_metallic_roughness: Metallic,
    pub(super) normal_texture: MaybeTexture,
    pub(super) occlusion_texture: MaybeTexture,
    pub(super) emissive_texture: MaybeTexture,
    pub(super) emissive_factor: Option<[f64; 3]>,
    pub(super) alpha_mode: AlphaMode,
    pub(super) alpha_cutoff: Option<f64>,
    pub(super) double_sided: bool,
    pub(super) extensions: Option<Box<MaterialExtensions>>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) enum AlphaMode {
    #[default]
    Opaque,
    Mask,
    Blend,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Metallic {
    pub(super) base_color_factor: Option<[f64; 4]>,
    pub(super) base_color_texture: MaybeTexture,
    pub(super) metallic_factor: Option<f64>,
    pub(super) roughness_factor: Option<f64>,
    pub(super) metallic_roughness_texture: MaybeTexture,
}

pub(super) type MaybeTexture = Option<Box<TextureInfo>>;

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureInfo {
    pub(super) index: u32,
    #[serde(default)]
    pub(super) tex_coord: u32,
    /// Of normal textures.
    pub(super) scale: Option<f64>,
    #[serde(default)]
    pub(super) extensions: TextureInfoExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct TextureInfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub(super) transform: Option<Box<TextureTransform>>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct TextureTransform {
    pub(super) offset: [f64; 2],
    pub(super) rotation: f64,
    pub(super) scale: [f64; 2],
    pub(super) tex_coord: Option<u32>,
}

impl Default for TextureTransform {
    fn default() -> Self {
        Self {
            offset: [0.0; 2],
            rotation: 0.0,
            scale: [1.0; 2],
            tex_coord: None,
        }
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_emissive_strength")]
    pub(super) emissive_strength: EmissiveStrength,
    #[serde(rename = "KHR_materials_ior")]
    pub(super) ior: Ior,
    #[serde(rename = "KHR_materials_specular")]
    pub(super) specular: Specular,
    #[serde(rename = "KHR_materials_transmission")]
    pub(super) transmission: Transmission,
    #[serde(rename = "KHR_materials_volume")]
    pub(super) volume: Volume,
    #[serde(rename = "KHR_materials_clearcoat")]
    pub(super) clearcoat: Clearcoat,
    #[serde(rename = "KHR_materials_sheen")]
    pub(super) sheen: Sheen,
    #[serde(rename = "KHR_materials_unlit")]
    pub(super) unlit: Option<IgnoredAny>,
    #[serde(rename = "KHR_materials_iridescence")]
    pub(super) iridescence: Option<IgnoredAny>,
    #[serde(rename = "KHR_materials_anisotropy")]
    pub(super) anisotropy: Option<IgnoredAny>,
    #[serde(rename = "KHR_materials_dispersion")]
    pub(super) dispersion: Option<IgnoredAny>,
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub(super) specular_glossiness: Option<IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct EmissiveStrength {
    pub(super) emissive_strength: Option<f64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Ior {
    pub(super) ior: Option<f64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Specular {
    pub(super) specular_factor: Option<f64>,
    pub(super) specular_texture: MaybeTexture,
    pub(super) specular_color_factor: Option<[f64; 3]>,
    pub(super) specular_color_texture: MaybeTexture,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Transmission {
    pub(super) transmission_factor: f64,
    pub(super) transmission_texture: MaybeTexture,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Volume {
    pub(super) thickness_factor: f64,
    pub(super) thickness_texture: MaybeTexture,
    pub(super) attenuation_distance: Option<f64>,
    pub(super) attenuation_color: Option<[f64; 3]>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Clearcoat {
    pub(super) clearcoat_factor: f64,
    pub(super) clearcoat_texture: MaybeTexture,
    pub(super) clearcoat_roughness_factor: f64,
    pub(super) clearcoat_roughness_texture: MaybeTexture,
    pub(super) clearcoat_normal_texture: MaybeTexture,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Sheen {
    pub(super) sheen_color_factor: [f64; 3],
    pub(super) sheen_color_texture: MaybeTexture,
    pub(super) sheen_roughness_factor: f64,
    pub(super) sheen_roughness_texture: MaybeTexture,
}
