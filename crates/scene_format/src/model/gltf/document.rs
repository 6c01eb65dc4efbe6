//! From bytes to the JSON of a glTF 2.0 file that can be served.

use std::ops::Range;

use serde::de::DeserializeOwned;

use super::super::error::{Fault, ModelWarning, quote_some};
use super::super::{ModelFile, ModelLimits};
use super::container;
use super::json::{Header, Root};

/// A file whose JSON was read.
#[derive(Debug)]
pub(in crate::model) struct Document {
    pub(super) root: Root,
    /// The chunk of data in the file.
    pub(super) bin: Option<Range<usize>>,
    pub(super) warnings: Vec<ModelWarning>,
}

/// Extensions that a file may require: without effect on what is read, or read.
const SUPPORTED: [&str; 17] = [
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",
    "EXT_texture_webp",
];

/// Extensions without effect on the picture, or noted where they are used.
const NOTED: [&str; 2] = ["EXT_mesh_gpu_instancing", "KHR_xmp"];

impl Document {
    /// Reads the JSON.
    pub(in crate::model) fn parse(file: &ModelFile<'_>, limits: &ModelLimits) -> Result<Self, Fault> {
        if file.bytes.len() as u64 > limits.bytes {
            return Err(Fault::limit(
                "",
                format!("the file has more than {} bytes", limits.bytes),
            ));
        }
        let parts = container::split(file.bytes)?;
        let json = &file.bytes[parts.json];
        if json.len() > limits.text_bytes {
            let message = format!("the JSON has more than {} bytes", limits.text_bytes);
            return Err(Fault::limit("", message).remedy("move data from the JSON to a `.bin` or `.glb` file"));
        }
        if json.iter().filter(|&&byte| byte == b'{').count() > limits.objects {
            return Err(Fault::limit(
                "",
                format!("the JSON has more than {} objects", limits.objects),
            ));
        }
        check_version(&read(json)?)?;
        let root: Root = read(json)?;
        let mut warnings = Vec::new();
        check_extensions(&root, &mut warnings)?;
        Ok(Self {
            root,
            bin: parts.bin,
            warnings,
        })
    }
}

fn read<T: DeserializeOwned>(json: &[u8]) -> Result<T, Fault> {
    let mut reader = serde_json::Deserializer::from_slice(json);
    let value = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let path = error.path().to_string();
        // Where a value is cut off, its own name is not known.
        Fault::invalid(path.trim_end_matches(['.', '?']), error.into_inner())
    })?;
    reader.end().map_err(|error| Fault::invalid("", error))?;
    Ok(value)
}

fn check_version(header: &Header) -> Result<(), Fault> {
    let asset = header.asset.as_ref();
    let Some(version) = asset.and_then(|asset| asset.version.as_deref()) else {
        return Err(Fault::invalid("asset.version", "it is missing")
            .remedy("this is not a glTF file, or one that is incomplete"));
    };
    let too_old = |at: &str, version: &str| {
        Fault::unsupported(at, format!("version {version:?} of glTF")).remedy("convert the model to glTF 2.0")
    };
    if numbers_of(version).is_none_or(|(major, _)| major != 2) {
        return Err(too_old("asset.version", version));
    }
    match asset.and_then(|asset| asset.min_version.as_deref()) {
        Some(least) if numbers_of(least).is_none_or(|least| least > (2, 0)) => Err(too_old("asset.minVersion", least)),
        _ => Ok(()),
    }
}

/// Reads `2.0`.
fn numbers_of(version: &str) -> Option<(u32, u32)> {
    let (major, minor) = version.split_once('.')?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}

fn check_extensions(root: &Root, warnings: &mut Vec<ModelWarning>) -> Result<(), Fault> {
    for (number, name) in root.extensions_required.iter().enumerate() {
        if !SUPPORTED.contains(&name.as_str()) {
            let remedy = match name.as_str() {
                "KHR_draco_mesh_compression" | "EXT_meshopt_compression" => "export the model without compression",
                "KHR_texture_basisu" => "export the model with PNG or JPEG textures",
                _ => "export the model without this extension",
            };
            let at = format!("extensionsRequired[{number}]");
            return Err(Fault::unsupported(&at, format!("the extension {name:?} is not supported")).remedy(remedy));
        }
    }
    let names = root.extensions_used.iter().map(String::as_str);
    let unknown = quote_some(names.filter(|name| !SUPPORTED.contains(name) && !NOTED.contains(name)));
    if !unknown.is_empty() {
        warnings.push(ModelWarning {
            at: "extensionsUsed".to_owned(),
            message: format!("not supported, so without effect: {}", unknown),
        });
    }
    Ok(())
}
