//! The bytes of an image, as its file or buffer holds them: PNG or JPEG, not decoded.

use super::super::ModelFile;
use super::super::error::Fault;
use super::accessor::check_view;
use super::buffers::Buffers;
use super::document::Document;
use super::graph::no_such;

/// Reads an image.
pub(super) fn read(
    number: u32,
    document: &Document,
    buffers: &mut Buffers,
    file: &ModelFile<'_>,
) -> Result<Vec<u8>, Fault> {
    let root = &document.root;
    let image = root
        .images
        .get(number as usize)
        .ok_or_else(|| no_such("images", "image", number, root.images.len()))?;
    let at = format!("images[{number}]");
    match (&image.uri, image.buffer_view) {
        (Some(uri), None) => buffers.read_uri(uri, &format!("{at}.uri"), file),
        (None, Some(view)) => {
            let at = format!("{at}.bufferView");
            read_view(view, &at, document, buffers, file)
        }
        (Some(_), Some(_)) => Err(Fault::invalid(&at, "it has a `uri` and a `bufferView`")),
        (None, None) => Err(Fault::invalid(&at, "it has neither a `uri` nor a `bufferView`")),
    }
}

fn read_view(
    number: u32,
    at: &str,
    document: &Document,
    buffers: &mut Buffers,
    file: &ModelFile<'_>,
) -> Result<Vec<u8>, Fault> {
    let root = &document.root;
    let view = root
        .buffer_views
        .get(number as usize)
        .ok_or_else(|| no_such(at, "buffer view", number, root.buffer_views.len()))?;
    check_view(root, number as usize)?;
    let buffer = view.buffer as usize;
    buffers.load(buffer, root, document.bin.as_ref(), file)?;
    // The view lies in the declared length of the buffer, which has that many bytes at least.
    let start = view.byte_offset as usize;
    Ok(buffers.bytes(buffer, file)[start..start + view.byte_length as usize].to_vec())
}
