//! What files of photons and of records have in common: a head that says what they are, and a checksum at the end.

use std::io::{self, Read, Write};

/// Rows that room is made for at a time: memory grows with what a file holds, not with what it claims.
const CHUNK: u64 = 4096;

/// A kind of file, and the command that writes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FileKind {
    pub(crate) magic: [u8; 8],
    pub(crate) version: u32,
    /// What it holds, in the singular.
    pub(crate) noun: &'static str,
    /// The command that writes it; its files end like that.
    pub(crate) command: &'static str,
}

/// Why a file of photons or of records cannot be used, whichever it is.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckedFileError {
    /// The source could not be read.
    #[error("it cannot be read: {0}; check the file and the disk")]
    Io(#[source] io::Error),
    /// The source ended early.
    #[error("it is cut off; write it anew with `pipeline {command}`")]
    Truncated {
        /// The command that writes such files.
        command: &'static str,
    },
    /// The first bytes are something else.
    #[error("this is no {noun} file; write one with `pipeline {command} SCENE -o FILE.{command}`")]
    Foreign {
        /// What the file should hold.
        noun: &'static str,
        /// The command that writes such files.
        command: &'static str,
    },
    /// It was written by another version of the program.
    #[error("it has format {found}, this program reads {expected}; write it anew with `pipeline {command}`")]
    Version {
        /// The format of the file.
        found: u32,
        /// The one that is read.
        expected: u32,
        /// The command that writes such files.
        command: &'static str,
    },
    /// The checksum is wrong.
    #[error("it is damaged: its checksum is wrong; write it anew with `pipeline {command}`")]
    Damaged {
        /// The command that writes such files.
        command: &'static str,
    },
}

/// FNV-1a, 64 bits.
struct Checksum(u64);

impl Checksum {
    const NEW: Self = Self(0xcbf2_9ce4_8422_2325);

    fn update(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

/// Writes a file and keeps the checksum of what was written.
pub(crate) struct CheckedWriter<'w, W> {
    writer: &'w mut W,
    checksum: Checksum,
}

impl<'w, W: Write> CheckedWriter<'w, W> {
    /// Begins a file: eight bytes that say what it is, and its version.
    pub(crate) fn begin(writer: &'w mut W, kind: &FileKind) -> io::Result<Self> {
        let checksum = Checksum::NEW;
        let mut begun = Self { writer, checksum };
        begun.put(&kind.magic)?;
        begun.put(&kind.version.to_le_bytes())?;
        Ok(begun)
    }

    pub(crate) fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.checksum.update(bytes);
        self.writer.write_all(bytes)
    }

    /// Ends the file with the checksum.
    pub(crate) fn end(self) -> io::Result<()> {
        self.writer.write_all(&self.checksum.0.to_le_bytes())
    }
}

/// Reads a file and keeps the checksum of what was read.
pub(crate) struct CheckedReader<'r, R> {
    reader: &'r mut R,
    kind: FileKind,
    checksum: Checksum,
}

impl<'r, R: Read> CheckedReader<'r, R> {
    /// Reads the head of a file, which has to be of this kind and version.
    pub(crate) fn begin(reader: &'r mut R, kind: FileKind) -> Result<Self, CheckedFileError> {
        let (noun, command, expected) = (kind.noun, kind.command, kind.version);
        let checksum = Checksum::NEW;
        let mut begun = Self { reader, kind, checksum };
        if begun.take()? != kind.magic {
            return Err(CheckedFileError::Foreign { noun, command });
        }
        match u32::from_le_bytes(begun.take()?) {
            found if found == expected => Ok(begun),
            found => Err(CheckedFileError::Version {
                found,
                expected,
                command,
            }),
        }
    }

    pub(crate) fn take<const N: usize>(&mut self) -> Result<[u8; N], CheckedFileError> {
        let mut bytes = [0; N];
        let command = self.kind.command;
        self.reader.read_exact(&mut bytes).map_err(|error| match error.kind() {
            io::ErrorKind::UnexpectedEof => CheckedFileError::Truncated { command },
            _ => CheckedFileError::Io(error),
        })?;
        self.checksum.update(&bytes);
        Ok(bytes)
    }

    /// Reads a number of rows and that many rows of `N` bytes.
    ///
    /// - `row_of`: makes a row of its bytes and its place.
    pub(crate) fn rows<const N: usize, T, E: From<CheckedFileError>>(
        &mut self,
        row_of: impl Fn(&[u8; N], u64) -> Result<T, E>,
    ) -> Result<Vec<T>, E> {
        let count = u64::from_le_bytes(self.take()?);
        let mut rows = Vec::new();
        for row in 0..count {
            if row.is_multiple_of(CHUNK) {
                rows.reserve(CHUNK.min(count - row) as usize);
            }
            rows.push(row_of(&self.take()?, row)?);
        }
        Ok(rows)
    }

    /// Compares the checksum at the end, and returns it.
    pub(crate) fn end(mut self) -> Result<u64, CheckedFileError> {
        let expected = self.checksum.0;
        if u64::from_le_bytes(self.take()?) == expected {
            Ok(expected)
        } else {
            let command = self.kind.command;
            Err(CheckedFileError::Damaged { command })
        }
    }
}
