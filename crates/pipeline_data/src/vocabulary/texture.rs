use bevy_reflect::std_traits::ReflectDefault;
use bevy_reflect::{Reflect, ReflectDeserialize};
use glam::{Vec2, Vec3};
use scene_format::{AssetPath, Shorthand};
use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Unexpected, Visitor};
use std::fmt;

/// A picture laid over a surface by its texture coordinates, in place of one value.
///
/// Written as a file alone, `"wood.png"`, or with more: `(file: "orm.png", channel: G, scale: (4, 4))`.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Deserialize, @Shorthand("file"))]
pub struct TextureMap {
    /// A `.png`, `.jpg`, `.jpeg`, `.exr` or `.hdr` file, relative to the file that names it; or a `.gltf` or `.glb` file, with
    /// `image`.
    pub file: AssetPath,
    /// Which image of a glTF file: its number in the list of images, from 0.
    pub image: Option<u32>,
    /// Which set of texture coordinates of the mesh, from 0. Shapes have one.
    pub uv_set: u32,
    /// What lies to the left and right of the picture.
    pub wrap_u: TextureWrap,
    /// What lies above and below it.
    pub wrap_v: TextureWrap,
    /// How values between the pixels come about.
    pub filter: TextureFilter,
    /// Moves the coordinates, last of the three, in widths and heights of the picture from its upper left, v downward; as
    /// in `KHR_texture_transform`.
    pub translate: Vec2,
    /// Turns the coordinates counter-clockwise, and so the picture clockwise, in degrees.
    pub rotate: f32,
    /// Scales the coordinates, first of the three: 2 shows the picture twice.
    pub scale: Vec2,
    /// What the numbers in the file stand for.
    pub encoding: TextureEncoding,
    /// The channel that is read by a field of one number.
    pub channel: TextureChannel,
    /// Multiplies what the picture says, at least 0; a field of one number takes the first.
    pub factor: Vec3,
}

impl Default for TextureMap {
    fn default() -> Self {
        Self {
            file: AssetPath::default(),
            image: None,
            uv_set: 0,
            wrap_u: TextureWrap::default(),
            wrap_v: TextureWrap::default(),
            filter: TextureFilter::default(),
            translate: Vec2::ZERO,
            rotate: 0.0,
            scale: Vec2::ONE,
            encoding: TextureEncoding::default(),
            channel: TextureChannel::default(),
            factor: Vec3::ONE,
        }
    }
}

/// What is beside a picture.
#[derive(Reflect, Deserialize, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Deserialize)]
pub enum TextureWrap {
    /// The picture again.
    #[default]
    Repeat,
    /// Its mirror image, then the picture again.
    Mirror,
    /// Its outermost pixels.
    Clamp,
}

/// How values between the pixels of a picture come about.
#[derive(Reflect, Deserialize, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Deserialize)]
pub enum TextureFilter {
    /// From the four nearest, in linear light.
    #[default]
    Linear,
    /// From the nearest alone.
    Nearest,
}

/// What the numbers in the file of a picture stand for.
#[derive(Reflect, Deserialize, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Deserialize)]
pub enum TextureEncoding {
    /// Colours of PNG and JPEG files are sRGB; all else is linear.
    #[default]
    Auto,
    /// Colours by the curve of sRGB.
    Srgb,
    /// Linear light, or data.
    Linear,
}

/// A channel of a picture.
#[derive(Reflect, Deserialize, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Deserialize)]
pub enum TextureChannel {
    /// Red, or grey.
    #[default]
    R,
    /// Green, or grey.
    G,
    /// Blue, or grey.
    B,
    /// Alpha; 1 where the picture has none.
    A,
}

impl<'de> Deserialize<'de> for TextureMap {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(FileOrFields)
    }
}

struct FileOrFields;

impl<'de> Visitor<'de> for FileOrFields {
    type Value = TextureMap;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a file in quotes, or `(file: ..)`")
    }

    fn visit_str<E: Error>(self, file: &str) -> Result<TextureMap, E> {
        Ok(TextureMap {
            file: AssetPath(file.to_owned()),
            ..TextureMap::default()
        })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<TextureMap, A::Error> {
        Fields::deserialize(MapAccessDeserializer::new(map))?.checked()
    }
}

/// The fields of a [`TextureMap`] as they are written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    file: AssetPath,
    #[serde(default)]
    image: Option<u32>,
    #[serde(default)]
    uv_set: u32,
    #[serde(default)]
    wrap_u: TextureWrap,
    #[serde(default)]
    wrap_v: TextureWrap,
    #[serde(default)]
    filter: TextureFilter,
    #[serde(default)]
    translate: (f32, f32),
    #[serde(default)]
    rotate: f32,
    #[serde(default = "one_by_one")]
    scale: (f32, f32),
    #[serde(default)]
    encoding: TextureEncoding,
    #[serde(default)]
    channel: TextureChannel,
    #[serde(default = "white")]
    factor: (f32, f32, f32),
}

fn one_by_one() -> (f32, f32) {
    (1.0, 1.0)
}

fn white() -> (f32, f32, f32) {
    (1.0, 1.0, 1.0)
}

impl Fields {
    fn checked<E: Error>(self) -> Result<TextureMap, E> {
        let factor: Vec3 = self.factor.into();
        // Not a number is refused with all other values that are not finite.
        if let Some(bad) = factor.to_array().into_iter().find(|part| *part < 0.0) {
            return Err(E::invalid_value(
                Unexpected::Float(bad.into()),
                &"a `factor` of at least 0",
            ));
        }
        Ok(TextureMap {
            file: self.file,
            image: self.image,
            uv_set: self.uv_set,
            wrap_u: self.wrap_u,
            wrap_v: self.wrap_v,
            filter: self.filter,
            translate: self.translate.into(),
            rotate: self.rotate,
            scale: self.scale.into(),
            encoding: self.encoding,
            channel: self.channel,
            factor,
        })
    }
}
