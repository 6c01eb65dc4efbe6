use super::{exr, hdr, png, read};
use crate::{Encoding, TextureError};
use image::{ColorType, ImageFormat};

#[test]
fn srgb_is_decoded_as_its_definition_says() {
    let values: Vec<u8> = (0..=255).collect();
    let picture = read(&png(256, 1, ColorType::L8, &values)).unwrap();
    for x in 0..256_u32 {
        let encoded = f64::from(x) / 255.0;
        let expected = if encoded <= 0.040_45 {
            encoded / 12.92
        } else {
            radiometry::math::powf_f64((encoded + 0.055) / 1.055, 2.4)
        };
        assert_eq!(picture.rgb(x, 0).g, expected as f32);
        assert_eq!(picture.rgba(x, 0, Encoding::Linear)[2], x as f32 / 255.0);
    }
}

#[test]
fn every_layout_of_png_is_read() {
    let texel = |kind, bytes: &[u8]| read(&png(1, 1, kind, bytes)).unwrap().rgba(0, 0, Encoding::Linear);
    let of_8_bit = |v: u8| f32::from(v) / 255.0;
    let [a, b, c, d] = [51, 102, 153, 204].map(of_8_bit);
    assert_eq!(texel(ColorType::L8, &[51]), [a, a, a, 1.0]);
    assert_eq!(texel(ColorType::La8, &[51, 204]), [a, a, a, d]);
    assert_eq!(texel(ColorType::Rgb8, &[51, 102, 153]), [a, b, c, 1.0]);
    assert_eq!(texel(ColorType::Rgba8, &[51, 102, 153, 204]), [a, b, c, d]);
    let wide = [1_u16, 500, 40_000, 65_535];
    let bytes: Vec<u8> = wide.iter().flat_map(|v| v.to_ne_bytes()).collect();
    assert_eq!(texel(ColorType::Rgba16, &bytes), wide.map(|v| f32::from(v) / 65_535.0));
}

#[test]
fn alpha_is_linear_in_every_encoding() {
    let picture = read(&png(1, 1, ColorType::Rgba8, &[128; 4])).unwrap();
    let [r, _, _, a] = picture.rgba(0, 0, Encoding::Srgb);
    assert!(r < 0.22 && a == 128.0 / 255.0);
}

/// A PNG with a palette of red and half transparent blue, in one bit a pixel.
const PALETTE: [u8; 99] = [
    137, 80, 78, 71, 13, 10, 26, 10, 0, 0, 0, 13, 73, 72, 68, 82, 0, 0, 0, 2, 0, 0, 0, 1, 1, 3, 0, 0, 0, 206, 236, 237,
    201, 0, 0, 0, 6, 80, 76, 84, 69, 255, 0, 0, 0, 0, 255, 108, 161, 253, 142, 0, 0, 0, 2, 116, 82, 78, 83, 255, 128,
    8, 15, 179, 106, 0, 0, 0, 10, 73, 68, 65, 84, 120, 156, 99, 112, 0, 0, 0, 66, 0, 65, 41, 55, 244, 239, 0, 0, 0, 0,
    73, 69, 78, 68, 174, 66, 96, 130,
];

#[test]
fn palettes_are_looked_up() {
    let picture = read(&PALETTE).unwrap();
    assert_eq!((picture.width(), picture.height()), (2, 1));
    assert_eq!(picture.rgba(0, 0, Encoding::Linear), [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(picture.rgba(1, 0, Encoding::Linear), [0.0, 0.0, 1.0, 128.0 / 255.0]);
}

#[test]
fn jpeg_is_read_in_grey_and_in_colour() {
    let grey = super::encoded(ImageFormat::Jpeg, 8, 8, ColorType::L8, &[100; 64]);
    let picture = read(&grey).unwrap();
    assert!((picture.rgba(3, 3, Encoding::Linear)[0] * 255.0 - 100.0).abs() <= 1.0);
    let red: Vec<u8> = [200, 30, 30].repeat(64);
    let picture = read(&super::encoded(ImageFormat::Jpeg, 8, 8, ColorType::Rgb8, &red)).unwrap();
    let [r, g, ..] = picture.rgba(5, 1, Encoding::Linear).map(|v| v * 255.0);
    assert!((r - 200.0).abs() <= 4.0 && (g - 30.0).abs() <= 4.0, "{r} {g}");
}

#[test]
fn hdr_is_radiance_with_its_exposure_taken_back() {
    let file = hdr(2, &[[1.0, 0.5, 0.25], [1024.0, 0.0, 512.0]]);
    let picture = read(&file).unwrap();
    assert_eq!(picture.rgb(0, 0).to_array(), [1.0, 0.5, 0.25]);
    assert_eq!(picture.rgb(1, 0).to_array(), [1024.0, 0.0, 512.0]);
    let text = String::from_utf8_lossy(&file).into_owned();
    let end = text.find("\n\n").unwrap();
    let mut exposed = file[..end].to_vec();
    exposed.extend(b"\nEXPOSURE=2");
    exposed.extend(&file[end..]);
    assert_eq!(read(&exposed).unwrap().rgb(0, 0).to_array(), [0.5, 0.25, 0.125]);
}

#[test]
fn exr_is_read_as_colour_or_grey_and_linear() {
    let colour = exr(
        2,
        &[
            ("R", &[1.0, 2.0]),
            ("G", &[3.0, 4.0]),
            ("B", &[5.0, -6.0]),
            ("Z", &[9.0, 9.0]),
        ],
    );
    let picture = read(&colour).unwrap();
    assert_eq!(picture.encoding(), Encoding::Linear);
    assert_eq!(picture.rgb(1, 0).to_array(), [2.0, 4.0, 0.0], "negative is none");
    let grey = read(&exr(1, &[("Y", &[0.5, 0.75]), ("A", &[0.25, 1.0])])).unwrap();
    assert_eq!(grey.rgba(0, 0, Encoding::Linear), [0.5, 0.5, 0.5, 0.25]);
    assert_eq!(grey.rgba(0, 1, Encoding::Linear), [0.75, 0.75, 0.75, 1.0]);
}

#[test]
fn what_is_no_picture_is_refused_with_a_remedy() {
    let message = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
    assert!(message(b"").contains("convert it"));
    assert!(message(b"GIF89a").contains("convert it"));
    assert!(message(&exr(1, &[("X", &[0.5])])).contains("channels X;"));
    let infinite = exr(2, &[("Y", &[0.5, 0.5, 0.5, f32::INFINITY])]);
    assert!(matches!(read(&infinite), Err(TextureError::NotFinite { x: 1, y: 1 })));
}
