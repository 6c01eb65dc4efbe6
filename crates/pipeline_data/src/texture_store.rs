use crate::vocabulary::{TextureChannel, TextureEncoding, TextureFilter, TextureMap, TextureWrap};
use bevy_ecs::resource::Resource;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use texture::{Channel, Encoding, Filter, Picture, Texture, TextureTransform, Wrap};

/// Which picture a [`TextureMap`] names.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PictureKey {
    /// The file, absolute and canonical.
    pub path: PathBuf,
    /// Number of the image, in a glTF file.
    pub image: Option<u32>,
}

impl From<&TextureMap> for PictureKey {
    fn from(map: &TextureMap) -> Self {
        Self {
            path: PathBuf::from(&map.file.0),
            image: map.image,
        }
    }
}

/// What the numbers of a field mean, which decides how `encoding: Auto` reads them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureRole {
    /// Colours.
    Colour,
    /// Anything else.
    Data,
}

/// Every picture that a material names, each once. Written by `load`, read by `tables`.
#[derive(Resource, Clone, Debug, Default)]
pub struct TextureStore {
    pictures: BTreeMap<PictureKey, Arc<Picture>>,
}

impl TextureStore {
    /// Adds a picture, or replaces the one of the same key.
    pub fn insert(&mut self, key: PictureKey, picture: Picture) {
        self.pictures.insert(key, Arc::new(picture));
    }

    /// How many pictures there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.pictures.len()
    }

    /// True when there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.pictures.is_empty()
    }

    /// The picture that a field names, laid out as it says; none if it could not be read.
    #[must_use]
    pub fn texture(&self, map: &TextureMap, role: TextureRole) -> Option<Texture> {
        let picture = Arc::clone(self.pictures.get(&PictureKey::from(map))?);
        let encoding = match (map.encoding, role) {
            (TextureEncoding::Srgb, _) => Encoding::Srgb,
            (TextureEncoding::Linear, _) | (TextureEncoding::Auto, TextureRole::Data) => Encoding::Linear,
            (TextureEncoding::Auto, TextureRole::Colour) => picture.encoding(),
        };
        let rotate = f64::from(map.rotate).to_radians();
        Some(Texture {
            picture,
            wrap: [map.wrap_u, map.wrap_v].map(Wrap::from),
            filter: match map.filter {
                TextureFilter::Linear => Filter::Linear,
                TextureFilter::Nearest => Filter::Nearest,
            },
            transform: TextureTransform::new(map.translate.as_dvec2(), rotate, map.scale.as_dvec2()),
            uv_set: map.uv_set,
            encoding,
            channel: match map.channel {
                TextureChannel::R => Channel::R,
                TextureChannel::G => Channel::G,
                TextureChannel::B => Channel::B,
                TextureChannel::A => Channel::A,
            },
            factor: map.factor.into(),
        })
    }
}

impl From<TextureWrap> for Wrap {
    fn from(wrap: TextureWrap) -> Self {
        match wrap {
            TextureWrap::Repeat => Self::Repeat,
            TextureWrap::Mirror => Self::Mirror,
            TextureWrap::Clamp => Self::Clamp,
        }
    }
}
