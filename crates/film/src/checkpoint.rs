//! Films on disk, so that an interrupted render can go on.
//!
//! Little-endian throughout:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `PIPEFILM` |
//! | 4 | version, 2 |
//! | 32 | key: a hash of whatever makes two renders the same |
//! | 24 | resolution, first pixel and end of the crop, as pairs of u32 |
//! | 4 + n | length and text of the channel list |
//! | 24 | dropped samples: not a number, negative, infinite |
//! | (4 + 16 c + 8 b) p | per pixel in *raster* order: sample count, c sums of 128 bits, b sums of batches of 64 bits |
//! | 8 | checksum of everything before |
//!
//! Raster order, so that a render resumed with other tiles continues with the same bits.

use std::io::{self, Read, Write};

use glam::UVec2;

use crate::accumulate::Film;
use crate::batch::{BatchSum, PixelBatches};
use crate::error::FilmError;
use crate::fixed_sum::FixedSum;
use crate::guard::RejectedCounts;
use crate::layout::ChannelLayout;
use crate::window::FilmWindow;

const MAGIC: [u8; 8] = *b"PIPEFILM";
const VERSION: u32 = 2;

/// Why a checkpoint cannot be continued.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The source could not be read.
    #[error("the checkpoint cannot be read: {0}; check the file and the disk")]
    Io(#[source] io::Error),
    /// The source ended early.
    #[error("the checkpoint is cut off; delete it and render anew")]
    Truncated,
    /// The first bytes are something else.
    #[error("this is not a film checkpoint; check the path")]
    NotACheckpoint,
    /// It was written by another version of the program.
    #[error(
        "the checkpoint has format {found}, this program reads {VERSION}; resume with the program that wrote it, or render anew"
    )]
    Version {
        /// The format of the file.
        found: u32,
    },
    /// It belongs to another scene or other settings.
    #[error("the checkpoint belongs to another scene, or to other settings; undo the change, or render anew")]
    Key,
    /// It has another resolution or crop.
    #[error(
        "the checkpoint covers {found:?}, this render {expected:?}; give the same resolution and crop, or render anew"
    )]
    Window {
        /// What the checkpoint covers.
        found: FilmWindow,
        /// What was asked for.
        expected: FilmWindow,
    },
    /// It has other channels.
    #[error("the checkpoint has other channels than this render; switch on the same layers, or render anew")]
    Layout,
    /// The checksum is wrong.
    #[error("the checkpoint is damaged: its checksum is wrong; delete it and render anew")]
    Damaged,
    /// The film that it would fill cannot be made.
    #[error(transparent)]
    Film(#[from] FilmError),
}

impl From<io::Error> for CheckpointError {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::UnexpectedEof => Self::Truncated,
            _ => Self::Io(error),
        }
    }
}

impl Film {
    /// Writes the film so that [`Film::load`] can restore it.
    ///
    /// - `key`: a hash of everything that must agree for samples to belong together.
    ///
    /// The bytes depend on the samples alone, not on the tile size.
    ///
    /// # Errors
    ///
    /// Whatever the writer reports. Give it a buffered one, within
    /// [`atomic_write`](crate::atomic_write), so that a full disk cannot destroy the previous file.
    pub fn save(&self, writer: &mut impl Write, key: &[u8; 32]) -> io::Result<()> {
        let mut checksum = Checksum::default();
        let mut put = |bytes: &[u8]| {
            checksum.update(bytes);
            writer.write_all(bytes)
        };
        put(&MAGIC)?;
        put(&VERSION.to_le_bytes())?;
        put(key)?;
        put(&window_bytes(self.window()))?;
        let layout = layout_bytes(self.layout());
        put(&(layout.len() as u32).to_le_bytes())?;
        put(&layout)?;
        put(&counts_bytes(self.rejected()))?;
        let mut pixel = Vec::with_capacity(pixel_bytes(self.layout()));
        if self.is_chosen() {
            return Err(io::Error::new(
                io::ErrorKind::Unsupported,
                "a film of chosen pixels has no checkpoint; render the whole window",
            ));
        }
        for (_, storage) in self.raster() {
            pixel.clear();
            self.put_pixel(storage, &mut pixel);
            put(&pixel)?;
        }
        let value = checksum.0;
        writer.write_all(&value.to_le_bytes())
    }

    fn put_pixel(&self, storage: usize, bytes: &mut Vec<u8>) {
        let channels = self.layout().channel_count();
        bytes.extend_from_slice(&self.samples[storage].to_le_bytes());
        for sum in &self.sums[storage * channels..][..channels] {
            bytes.extend_from_slice(&sum.to_le_bytes());
        }
        let sets = self.layout().batch_sets();
        let batches = self.batches[storage * sets..][..sets].as_flattened();
        for sum in batches.as_flattened() {
            bytes.extend_from_slice(&sum.to_le_bytes());
        }
    }

    fn take_pixel(&mut self, storage: usize, bytes: &[u8]) {
        let channels = self.layout().channel_count();
        let (count, rest) = bytes.split_at(4);
        let (sums, batches) = rest.split_at(16 * channels);
        self.samples[storage] = u32_at(count, 0);
        let targets = &mut self.sums[storage * channels..][..channels];
        for (target, bytes) in targets.iter_mut().zip(sums.as_chunks::<16>().0) {
            *target = FixedSum::from_le_bytes(*bytes);
        }
        let sets = self.layout().batch_sets();
        let targets = self.batches[storage * sets..][..sets].as_flattened_mut();
        for (target, bytes) in targets.as_flattened_mut().iter_mut().zip(batches.as_chunks::<8>().0) {
            *target = BatchSum::from_le_bytes(*bytes);
        }
    }

    /// Restores a film that [`Film::save`] wrote.
    ///
    /// - `key`, `window`, `layout`: what this render has; the checkpoint must agree.
    /// - `tile_size`: free, as for [`Film::new`].
    ///
    /// Reads exactly the checkpoint and leaves what follows it to the caller. Allocates what the window
    /// and layout of this render need, never what the file claims.
    ///
    /// # Errors
    ///
    /// A [`CheckpointError`] that names what disagrees.
    pub fn load(
        reader: &mut impl Read,
        key: &[u8; 32],
        window: FilmWindow,
        layout: ChannelLayout,
        tile_size: u32,
    ) -> Result<Self, CheckpointError> {
        let mut source = Source {
            reader,
            checksum: Checksum::default(),
        };
        source.check_header(key, &window, &layout)?;
        let rejected = source.counts()?;
        let mut film = Self::new(window, layout, tile_size)?;
        film.rejected.add(rejected);
        let mut pixel = vec![0; pixel_bytes(film.layout())];
        let order: Vec<usize> = film.raster().map(|(_, storage)| storage).collect();
        for storage in order {
            source.fill(&mut pixel)?;
            film.take_pixel(storage, &pixel);
        }
        let expected = source.checksum.0;
        let found = source.array::<8>()?;
        if u64::from_le_bytes(found) == expected {
            Ok(film)
        } else {
            Err(CheckpointError::Damaged)
        }
    }
}

/// A reader that keeps the checksum of what it has read.
struct Source<'r, R> {
    reader: &'r mut R,
    checksum: Checksum,
}

impl<R: Read> Source<'_, R> {
    fn fill(&mut self, bytes: &mut [u8]) -> Result<(), CheckpointError> {
        self.reader.read_exact(bytes)?;
        self.checksum.update(bytes);
        Ok(())
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], CheckpointError> {
        let mut bytes = [0; N];
        self.fill(&mut bytes)?;
        Ok(bytes)
    }

    fn check_header(
        &mut self,
        key: &[u8; 32],
        window: &FilmWindow,
        layout: &ChannelLayout,
    ) -> Result<(), CheckpointError> {
        if self.array()? != MAGIC {
            return Err(CheckpointError::NotACheckpoint);
        }
        let found = u32::from_le_bytes(self.array()?);
        if found != VERSION {
            return Err(CheckpointError::Version { found });
        }
        if self.array::<32>()? != *key {
            return Err(CheckpointError::Key);
        }
        let found = window_from(&self.array()?);
        if found != *window {
            return Err(CheckpointError::Window {
                found,
                expected: *window,
            });
        }
        let expected = layout_bytes(layout);
        if u32::from_le_bytes(self.array()?) as usize != expected.len() {
            return Err(CheckpointError::Layout);
        }
        let mut found = vec![0; expected.len()];
        self.fill(&mut found)?;
        if found == expected {
            Ok(())
        } else {
            Err(CheckpointError::Layout)
        }
    }

    fn counts(&mut self) -> Result<RejectedCounts, CheckpointError> {
        let mut next = || Ok::<_, CheckpointError>(u64::from_le_bytes(self.array()?));
        Ok(RejectedCounts {
            nan: next()?,
            negative: next()?,
            infinite: next()?,
        })
    }
}

/// Detects accidents, not malice. Multiplication by an odd number and rotation are one-to-one, so that
/// any single damaged word changes the result.
struct Checksum(u64);

impl Default for Checksum {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Checksum {
    fn update(&mut self, bytes: &[u8]) {
        let (words, rest) = bytes.as_chunks::<8>();
        let mut last = [0; 8];
        last[..rest.len()].copy_from_slice(rest);
        for word in words.iter().chain((!rest.is_empty()).then_some(&last)) {
            let mixed = (self.0 ^ u64::from_le_bytes(*word)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            self.0 = mixed.rotate_left(29);
        }
    }
}

fn pixel_bytes(layout: &ChannelLayout) -> usize {
    4 + 16 * layout.channel_count() + layout.batch_sets() * size_of::<PixelBatches>()
}

fn u32_at(bytes: &[u8], index: usize) -> u32 {
    u32::from_le_bytes(std::array::from_fn(|i| bytes[4 * index + i]))
}

fn window_bytes(window: &FilmWindow) -> Vec<u8> {
    let pairs = [window.resolution, window.crop_min, window.crop_max];
    pairs
        .iter()
        .flat_map(|p| [p.x, p.y])
        .flat_map(u32::to_le_bytes)
        .collect()
}

fn window_from(bytes: &[u8; 24]) -> FilmWindow {
    let pair = |index: usize| UVec2::new(u32_at(bytes, 2 * index), u32_at(bytes, 2 * index + 1));
    FilmWindow {
        resolution: pair(0),
        crop_min: pair(1),
        crop_max: pair(2),
    }
}

fn counts_bytes(counts: RejectedCounts) -> Vec<u8> {
    [counts.nan, counts.negative, counts.infinite]
        .iter()
        .flat_map(|c| c.to_le_bytes())
        .collect()
}

/// The resolved channel names say everything about a layout but the split between layers and groups.
fn layout_bytes(layout: &ChannelLayout) -> Vec<u8> {
    let names = layout.image_channel_names().join(" ");
    let batches = match layout.layer_variance {
        true => "layers".into(),
        false => layout.variance.to_string(),
    };
    format!("{} {batches} {names}", layout.layers.len()).into_bytes()
}

#[cfg(test)]
mod tests;
