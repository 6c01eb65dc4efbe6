//! Reduces an EXR image to the means over blocks of 8×8 pixels, as the references of large scenes are kept:
//! `cargo run --release -p film --example block_means -- IMAGE.exr BLOCKS.exr`.

use film::{Image, Metadata, block_means, read_exr, write_exr};
use std::error::Error;
use std::path::Path;

const SIDE: u32 = 8;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [image, blocks] = &arguments[..] else {
        return Err("usage: block_means IMAGE.exr BLOCKS.exr".into());
    };
    let image = read_exr(Path::new(image))?.rgb("").ok_or("the image has no R, G, B")?;
    let means = block_means(&image, SIDE);
    write_exr(Path::new(blocks), &Image::from_rgb(&means), &Metadata::default())?;
    Ok(())
}
