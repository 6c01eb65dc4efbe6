//! The bytes of buffers, read when a mesh or an image needs them, each file once.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;

use super::super::ModelFile;
use super::super::error::Fault;
use super::super::files::{Located, locate, read_bytes};
use super::json::Root;

/// Where the bytes of a buffer are.
#[derive(Clone, Debug)]
enum Source {
    /// In the model file.
    Chunk(Range<usize>),
    /// In a file, by row.
    File(usize),
    /// From a data URI.
    Data(Vec<u8>),
}

/// All buffers of a file.
#[derive(Debug)]
pub(super) struct Buffers {
    sources: Vec<Option<Source>>,
    files: Vec<(PathBuf, Vec<u8>)>,
    row_of_file: BTreeMap<PathBuf, usize>,
    /// Bytes that may still be read.
    left: u64,
}

impl Buffers {
    /// - `limit`: bytes that the files may have together.
    pub(super) fn new(root: &Root, limit: u64) -> Self {
        Self {
            sources: vec![None; root.buffers.len()],
            files: Vec::new(),
            row_of_file: BTreeMap::new(),
            left: limit,
        }
    }

    /// Files that were read.
    pub(super) fn files(&self) -> &[(PathBuf, Vec<u8>)] {
        &self.files
    }

    /// Reads a buffer, if that was not done yet; it has its declared length at least.
    pub(super) fn load(
        &mut self,
        buffer: usize,
        root: &Root,
        chunk: Option<&Range<usize>>,
        model: &ModelFile<'_>,
    ) -> Result<(), Fault> {
        if self.sources[buffer].is_some() {
            return Ok(());
        }
        let declared = &root.buffers[buffer];
        let at = format!("buffers[{buffer}]");
        let source = match (&declared.uri, chunk) {
            (Some(uri), _) => {
                let at = format!("{at}.uri");
                match locate(uri, &at, model)? {
                    Located::Data(data) => Source::Data(data),
                    Located::File(path) => Source::File(self.load_file(path, &at)?),
                }
            }
            (None, Some(chunk)) if buffer == 0 => Source::Chunk(chunk.clone()),
            (None, _) => {
                let message = "it has no `uri`, and the file has no chunk of data for it";
                return Err(Fault::invalid(&at, message));
            }
        };
        let found = self.bytes_of(&source, model).len();
        if (found as u64) < declared.byte_length {
            let message = format!("{} bytes are declared, but there are {found}", declared.byte_length);
            return Err(Fault::invalid(&format!("{at}.byteLength"), message)
                .remedy("the data is cut off or damaged: copy or export it again"));
        }
        self.sources[buffer] = Some(source);
        Ok(())
    }

    /// Reads what a URI means, which is no buffer. Files count like those of buffers.
    pub(super) fn read_uri(&mut self, uri: &str, at: &str, model: &ModelFile<'_>) -> Result<Vec<u8>, Fault> {
        match locate(uri, at, model)? {
            Located::Data(data) => Ok(data),
            Located::File(path) => {
                let row = self.load_file(path, at)?;
                Ok(self.files[row].1.clone())
            }
        }
    }

    fn load_file(&mut self, path: PathBuf, at: &str) -> Result<usize, Fault> {
        if let Some(row) = self.row_of_file.get(&path) {
            return Ok(*row);
        }
        let bytes = read_bytes(&path, self.left, at)?;
        self.left -= bytes.len() as u64;
        let row = self.files.len();
        self.row_of_file.insert(path.clone(), row);
        self.files.push((path, bytes));
        Ok(row)
    }

    fn bytes_of<'b>(&'b self, source: &'b Source, model: &ModelFile<'b>) -> &'b [u8] {
        match source {
            Source::Chunk(range) => &model.bytes[range.clone()],
            Source::File(row) => &self.files[*row].1,
            Source::Data(data) => data,
        }
    }

    /// The bytes of a buffer that was loaded.
    pub(super) fn bytes<'b>(&'b self, buffer: usize, model: &ModelFile<'b>) -> &'b [u8] {
        match &self.sources[buffer] {
            Some(source) => self.bytes_of(source, model),
            None => &[],
        }
    }
}
