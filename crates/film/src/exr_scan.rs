//! A first look at the header of an EXR file, before any of it is believed.
//!
//! The decoder allocates and computes from what a header claims. So the few claims that decide about
//! that are read here beforehand, with every length checked, and files that are too large, too strange
//! or impossibly small for their content are refused.

use crate::exr_read::ExrDecodeError;

/// Largest number of values in an image, over all channels: 2^28, or 1 GiB of floats.
pub(crate) const MAX_VALUES: u64 = 1 << 28;

/// Largest magnitude of a window coordinate.
const MAX_COORDINATE: i32 = 1 << 24;

const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
const TILED: u32 = 1 << 9;
const DEEP: u32 = 1 << 11;
const MULTI_PART: u32 = 1 << 12;

/// Checks that an EXR file is of a supported kind and that its claims are affordable.
///
/// - `most_values`: over all channels.
pub(crate) fn check_header(bytes: &[u8], most_values: u64) -> Result<(), ExrDecodeError> {
    let (claims, is_tiled, rest) = read_claims(bytes)?;
    claims.check(is_tiled, rest, most_values)
}

/// Width and height of the image in an EXR file, before anything of it is decoded.
///
/// # Errors
///
/// An [`ExrDecodeError`] for bytes that are not such a file.
pub fn exr_size(bytes: &[u8]) -> Result<(u32, u32), ExrDecodeError> {
    read_claims(bytes)?.0.size()
}

/// Reads the header; with it come whether the image is tiled, and the number of bytes after the header.
fn read_claims(bytes: &[u8]) -> Result<(Claims, bool, u64), ExrDecodeError> {
    let mut cursor = Cursor(bytes);
    if cursor.take::<4>() != Some(MAGIC) {
        return Err(ExrDecodeError::NotExr);
    }
    let flags = cursor.u32().ok_or(CUT_OFF)?;
    if flags & MULTI_PART != 0 {
        return Err(ExrDecodeError::Unsupported { what: "several parts" });
    }
    if flags & DEEP != 0 {
        return Err(ExrDecodeError::Unsupported { what: "deep pixels" });
    }
    let mut claims = Claims::default();
    loop {
        let name = cursor.string().ok_or(CUT_OFF)?;
        if name.is_empty() {
            break;
        }
        let _kind = cursor.string().ok_or(CUT_OFF)?;
        let size = cursor.u32().ok_or(CUT_OFF)? as usize;
        claims.read(name, cursor.slice(size).ok_or(CUT_OFF)?)?;
    }
    Ok((claims, flags & TILED != 0, cursor.0.len() as u64))
}

const CUT_OFF: ExrDecodeError = ExrDecodeError::Malformed { what: String::new() };

/// What the decoder would believe.
#[derive(Default)]
struct Claims {
    window: Option<[i32; 4]>,
    channels: Option<u64>,
    tile: Option<(u32, u32)>,
    lines_per_block: Option<u64>,
}

impl Claims {
    fn read(&mut self, name: &[u8], value: &[u8]) -> Result<(), ExrDecodeError> {
        let mut cursor = Cursor(value);
        match name {
            b"dataWindow" | b"displayWindow" => {
                let window = cursor.window().ok_or(CUT_OFF)?;
                let fits = |v: &i32| v.unsigned_abs() <= MAX_COORDINATE.unsigned_abs();
                if !window.iter().all(fits) || window[0] > window[2] || window[1] > window[3] {
                    return Err(malformed("a window is empty or out of range"));
                }
                if name == b"dataWindow" && self.window.replace(window).is_some() {
                    return Err(malformed("two data windows"));
                }
            }
            b"channels" => {
                let channels = cursor.count_channels()?;
                let duplicate = self.channels.replace(channels).is_some();
                return if duplicate {
                    Err(malformed("two channel lists"))
                } else {
                    Ok(())
                };
            }
            b"compression" => {
                let code = cursor.take::<1>().ok_or(CUT_OFF)?[0];
                let lines = [1, 1, 1, 16, 32, 16, 32, 32, 32, 256];
                let lines = lines.get(usize::from(code)).copied();
                self.lines_per_block = Some(lines.ok_or(ExrDecodeError::Unsupported {
                    what: "unknown compression",
                })?);
            }
            b"tiles" => {
                self.tile = Some((cursor.u32().ok_or(CUT_OFF)?, cursor.u32().ok_or(CUT_OFF)?));
                if cursor.take::<1>().ok_or(CUT_OFF)?[0] & 0x0f > 2 {
                    return Err(malformed("unknown tile levels"));
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn size(&self) -> Result<(u32, u32), ExrDecodeError> {
        let [x0, y0, x1, y1] = self.window.ok_or_else(|| malformed("no data window"))?;
        Ok((x0.abs_diff(x1) + 1, y0.abs_diff(y1) + 1))
    }

    /// Compares the claims with the limits, and with the `rest` bytes that follow the header.
    fn check(&self, tiled: bool, rest: u64, most_values: u64) -> Result<(), ExrDecodeError> {
        let (width, height) = self.size()?;
        let channels = self.channels.ok_or_else(|| malformed("no channel list"))?;
        let lines = self.lines_per_block.ok_or_else(|| malformed("no compression"))?;
        let values = u64::from(width) * u64::from(height) * channels;
        if values > most_values {
            return Err(ExrDecodeError::TooLarge {
                width,
                height,
                channels,
                most: most_values,
            });
        }
        let blocks = match self.tile {
            // Tile sizes are bounded so that a block fits in memory however few pixels there are.
            Some((w, h)) if w == 0 || h == 0 || u64::from(w) * u64::from(h) * channels > most_values => {
                return Err(malformed("a tile size is out of range"));
            }
            Some((w, h)) if tiled => u64::from(width.div_ceil(w)) * u64::from(height.div_ceil(h)),
            None if tiled => return Err(malformed("no tile size")),
            _ => u64::from(height).div_ceil(lines),
        };
        // Each block has eight bytes in the table and eight before its content.
        if blocks * 16 > rest { Err(CUT_OFF) } else { Ok(()) }
    }
}

fn malformed(what: &str) -> ExrDecodeError {
    ExrDecodeError::Malformed { what: what.to_owned() }
}

/// Takes values off the front of a slice; nothing once it is too short.
struct Cursor<'b>(&'b [u8]);

impl<'b> Cursor<'b> {
    fn slice(&mut self, count: usize) -> Option<&'b [u8]> {
        let (head, tail) = self.0.split_at_checked(count)?;
        self.0 = tail;
        Some(head)
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.slice(N)?.try_into().ok()
    }

    fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn window(&mut self) -> Option<[i32; 4]> {
        let mut next = || self.take().map(i32::from_le_bytes);
        Some([next()?, next()?, next()?, next()?])
    }

    /// A text of at most 255 bytes up to its terminating zero, which is taken as well.
    fn string(&mut self) -> Option<&'b [u8]> {
        let length = self.0.iter().take(256).position(|&b| b == 0)?;
        let text = self.slice(length)?;
        self.slice(1)?;
        Some(text)
    }

    fn count_channels(&mut self) -> Result<u64, ExrDecodeError> {
        let mut count = 0;
        loop {
            if self.string().ok_or(CUT_OFF)?.is_empty() {
                break;
            }
            // Type, linearity, three unused bytes, sampling in x and y.
            let _type_and_linearity = self.slice(8).ok_or(CUT_OFF)?;
            if (self.u32(), self.u32()) != (Some(1), Some(1)) {
                return Err(ExrDecodeError::Unsupported {
                    what: "subsampled channels",
                });
            }
            count += 1;
        }
        if count == 0 {
            Err(malformed("no channels"))
        } else {
            Ok(count)
        }
    }
}
