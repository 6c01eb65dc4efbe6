use film::ExrDecodeError;

/// Why bytes are no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TextureError {
    /// The first bytes are those of no kind that is read.
    #[error("it is no PNG, JPEG, Radiance HDR or OpenEXR file; convert it to one of them")]
    UnknownKind,
    /// It claims to be larger than the limits allow.
    #[error(
        "{width}x{height} pixels are more than {limit}; scale the picture down, or raise the limit `texture_pixels`"
    )]
    TooLarge {
        /// Width that the file claims.
        width: u32,
        /// Height that the file claims.
        height: u32,
        /// What is allowed, in words.
        limit: String,
    },
    /// There are no pixels in it.
    #[error("the picture has no pixels; make it again")]
    Empty,
    /// An EXR file of channels that are neither colour nor brightness.
    #[error("it has the channels {found}; a picture has R, G and B, or Y")]
    NoColour {
        /// Names of the channels.
        found: String,
    },
    /// A value that is infinite or not a number.
    #[error("the pixel {x}, {y} from the upper left is not finite; repair the picture, or render it again")]
    NotFinite {
        /// Column, from 0.
        x: u32,
        /// Row, from 0.
        y: u32,
    },
    /// The number of values is not that of the pixels.
    #[error("{found} values are not {expected}, those of the pixels")]
    WrongCount {
        /// Values given.
        found: usize,
        /// Values that width and height need.
        expected: usize,
    },
    /// An EXR file that cannot be read.
    #[error(transparent)]
    Exr(#[from] ExrDecodeError),
    /// A kind of file that is known, with a feature that is not.
    #[error("{what} is not supported; save the picture as an 8-bit PNG")]
    Unsupported {
        /// The feature.
        what: String,
    },
    /// It is cut off or contradicts itself.
    #[error("the file is damaged or cut off ({what}); copy or save it again")]
    Malformed {
        /// What the decoder says.
        what: String,
    },
}

impl TextureError {
    pub(crate) fn malformed(what: impl ToString) -> Self {
        Self::Malformed { what: what.to_string() }
    }
}
