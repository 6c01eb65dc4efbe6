//! The binary container: a header, a chunk of JSON, and at most one chunk of data.

use std::ops::Range;

use super::super::error::Fault;

const MAGIC: &[u8] = b"glTF";
const JSON: u32 = 0x4e4f_534a;
const BIN: u32 = 0x004e_4942;

/// Where the parts of a file lie.
#[derive(Debug, PartialEq)]
pub(super) struct Parts {
    pub(super) json: Range<usize>,
    pub(super) bin: Option<Range<usize>>,
}

/// Finds the parts of a file, of which a file without the magic number is all JSON.
pub(super) fn split(bytes: &[u8]) -> Result<Parts, Fault> {
    if !bytes.starts_with(MAGIC) {
        return Ok(Parts {
            json: 0..bytes.len(),
            bin: None,
        });
    }
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err(truncated("header", 12, bytes.len()));
    };
    if version != 2 {
        return Err(
            Fault::unsupported("header", format!("binary glTF of version {version}"))
                .remedy("convert the model to glTF 2.0"),
        );
    }
    let length = length as usize;
    if length > bytes.len() {
        return Err(truncated("header", length, bytes.len()));
    }
    if length < bytes.len() {
        let message = format!(
            "the file says that it has {length} bytes, but there are {}",
            bytes.len()
        );
        return Err(Fault::invalid("header", message));
    }
    let mut parts = (None, None);
    let mut at = 12;
    while at < length {
        let (Some(size), Some(kind)) = (word(bytes, at), word(bytes, at + 4)) else {
            return Err(truncated(&format!("chunk at byte {at}"), at + 8, length));
        };
        let start = at + 8;
        let end = start.checked_add(size as usize).filter(|end| *end <= length);
        let Some(end) = end else {
            return Err(truncated(
                &format!("chunk at byte {at}"),
                start.saturating_add(size as usize),
                length,
            ));
        };
        match (kind, &parts) {
            (JSON, (None, None)) => parts.0 = Some(start..end),
            (BIN, (Some(_), None)) => parts.1 = Some(start..end),
            (JSON | BIN, _) => {
                let message = "there must be one chunk of JSON and behind it at most one of data";
                return Err(Fault::invalid(&format!("chunk at byte {at}"), message));
            }
            // Others are for extensions.
            _ => {}
        }
        at = end;
    }
    match parts {
        (Some(json), bin) => Ok(Parts { json, bin }),
        (None, _) => Err(Fault::invalid("", "there is no chunk of JSON")),
    }
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let word = bytes.get(at..)?.first_chunk()?;
    Some(u32::from_le_bytes(*word))
}

fn truncated(at: &str, needed: usize, found: usize) -> Fault {
    Fault::invalid(at, format!("{needed} bytes are needed, but there are {found}"))
        .remedy("the file is cut off or damaged: copy or export it again")
}
