use super::{encoded, exr, hdr, png, read};
use crate::{PictureLimits, TextureError, decode};
use image::{ColorType, ImageFormat};

fn samples() -> [Vec<u8>; 4] {
    let noise: Vec<u8> = (0..8 * 8 * 3_u32).map(|i| (i * i % 251) as u8).collect();
    let values: Vec<f32> = (0..64).map(|i| i as f32).collect();
    let colours: Vec<[f32; 3]> = values.iter().map(|v| [*v, v * 2.0, 1.0]).collect();
    [
        png(8, 8, ColorType::Rgb8, &noise),
        encoded(ImageFormat::Jpeg, 8, 8, ColorType::Rgb8, &noise),
        hdr(8, &colours),
        exr(8, &[("R", &values), ("G", &values), ("B", &values)]),
    ]
}

#[test]
fn files_that_are_cut_off_are_errors_at_every_length() {
    for file in samples() {
        assert!(read(&file).is_ok());
        // Decoders may do without the last bytes of a PNG, which hold no pixels.
        for length in 0..file.len() - 16 {
            assert!(read(&file[..length]).is_err(), "{length} of {}", file.len());
        }
        for length in file.len() - 16..file.len() {
            let _ = read(&file[..length]);
        }
    }
}

#[test]
fn changed_bytes_never_panic_or_pass_the_limits() {
    let limits = PictureLimits {
        side: 1 << 12,
        pixels: 1 << 16,
    };
    for file in samples() {
        for at in 0..file.len() {
            for bits in [0x01, 0x80, 0xff] {
                let mut changed = file.clone();
                changed[at] ^= bits;
                if let Ok(picture) = decode(&changed, &limits) {
                    assert!(u64::from(picture.width()) * u64::from(picture.height()) <= limits.pixels);
                }
            }
        }
    }
}

fn refused_as_too_large(bytes: &[u8], limits: &PictureLimits) -> bool {
    matches!(decode(bytes, limits), Err(TextureError::TooLarge { .. }))
}

#[test]
fn limits_hold_for_every_kind() {
    for file in samples() {
        let limits = |side, pixels| PictureLimits { side, pixels };
        assert!(decode(&file, &limits(8, 64)).is_ok());
        assert!(refused_as_too_large(&file, &limits(7, 64)));
        assert!(refused_as_too_large(&file, &limits(8, 63)));
    }
}

/// The head of a PNG that claims 65,535 by 65,535 pixels, and nothing else.
#[test]
fn a_bomb_is_refused_by_what_it_claims() {
    let mut bomb = png(8, 8, ColorType::Rgb8, &[0; 192]);
    bomb[16..24].copy_from_slice(&[0, 0, 255, 255, 0, 0, 255, 255]);
    assert!(refused_as_too_large(&bomb, &PictureLimits::default()));
    let message = read(&bomb).unwrap_err().to_string();
    assert!(
        message.contains("65535x65535") && message.contains("`texture_pixels`"),
        "{message}"
    );
    let mut claims = hdr(8, &[[1.0; 3]; 8]);
    let at = claims.windows(2).position(|pair| pair == b"+X").unwrap();
    claims.splice(at..at + 4, *b"+X 60000");
    assert!(read(&claims).is_err());
    let text = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 65000 +X 2000\n\x02\x02\x07\xd0";
    assert!(matches!(read(text), Err(TextureError::Malformed { .. })));
}

#[test]
fn a_picture_without_pixels_is_refused() {
    let mut none = png(8, 8, ColorType::L8, &[0; 64]);
    none[16..20].fill(0);
    assert!(read(&none).is_err());
    assert!(crate::Picture::from_rgb(0, 4, Vec::new()).is_err());
    assert!(crate::Picture::from_rgb(1, 1, vec![0.0; 4]).is_err());
}

/// Fill bytes may stand before any mark (ITU-T T.81, B.1.1.2), and the end must be found all the same.
#[test]
fn fill_bytes_before_marks_of_jpeg_are_skipped() {
    let [_, file, ..] = samples();
    let plain = read(&file).unwrap();
    let mut filled = file[..2].to_vec();
    filled.extend([0xff, 0xff]);
    filled.extend(&file[2..]);
    assert_eq!(read(&filled).unwrap(), plain);
}

/// 11,000 by 11,000 pixels in a few hundred bytes: no scan is that short.
#[test]
fn a_jpeg_too_short_for_its_blocks_is_refused() {
    let [_, mut file, ..] = samples();
    let frame = file.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
    file[frame + 5..frame + 9].copy_from_slice(&[0x2a, 0xf8, 0x2a, 0xf8]);
    assert!(matches!(read(&file), Err(TextureError::Malformed { .. })));
}
