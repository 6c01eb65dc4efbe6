use super::*;

fn image(width: u32, height: u32, pixel: impl FnMut(usize) -> [f32; 3]) -> RgbImage {
    let pixels = (0..width as usize * height as usize).map(pixel).collect();
    RgbImage { width, height, pixels }
}

#[test]
fn agrees_with_an_independent_implementation() {
    let mut state = 1_u64;
    let mut next = || {
        state = (state * 1_103_515_245 + 12_345) % (1 << 31);
        (state >> 8) as f32 / 8_388_608.0
    };
    let mut reference = image(60, 50, |_| [0.0; 3]);
    let mut noisy = reference.clone();
    for (r, i) in reference.pixels.iter_mut().zip(&mut noisy.pixels) {
        *r = std::array::from_fn(|_| next());
        *i = std::array::from_fn(|_| 2.0 * next());
    }
    noisy.pixels[777] = [f32::NAN, f32::INFINITY, 1.0];
    noisy.pixels[1234] = [500.0, 0.0, 0.0];
    let found = compare(&noisy, &reference, 3).unwrap();
    // Computed by the formulas of the doc comment in Python, with the same numbers.
    let close = |a: f64, b: f64| (a - b).abs() < 1e-12 * b;
    assert!(close(found.rel_mse, 357.867_205_140_235_85), "{}", found.rel_mse);
    assert!(
        close(found.rel_mse_trimmed, 35.314_079_875_000_94),
        "{}",
        found.rel_mse_trimmed
    );
    assert!(close(found.mean_reference[1], 0.505_849_148_909_250_9));
    assert_eq!(found.non_finite, [1, 0]);
    assert_eq!(found.worst.len(), 3);
    assert_eq!((found.worst[0].x, found.worst[0].y), (1234 % 60, 1234 / 60));
    assert_eq!(found.worst[0].image, [500.0, 0.0, 0.0]);
    assert!(found.worst[0].error > found.worst[1].error);
}

#[test]
fn known_values() {
    // R = 1 everywhere, so a doubled image has an error of 1 / (1 + 0.01).
    let one = image(4, 4, |_| [1.0; 3]);
    let two = image(4, 4, |_| [2.0; 3]);
    let found = compare(&two, &one, 100).unwrap();
    assert!((found.rel_mse - 1.0 / 1.01).abs() < 1e-12);
    assert_eq!(found.relative_difference, [1.0; 3]);
    assert_eq!(found.worst.len(), 16);
    assert_eq!((found.worst[1].x, found.worst[1].y), (1, 0));
    let same = compare(&one, &one, 1).unwrap();
    assert_eq!((same.rel_mse, same.rel_mse_trimmed), (0.0, 0.0));
    assert_eq!(same.relative_difference, [0.0; 3]);
}

#[test]
fn black_references_are_defined() {
    let black = image(3, 3, |_| [0.0; 3]);
    let dim = image(3, 3, |i| if i == 4 { [0.1, 0.0, 0.0] } else { [0.0; 3] });
    assert_eq!(compare(&black, &black, 0).unwrap().rel_mse, 0.0);
    let found = compare(&dim, &black, 1).unwrap();
    assert_eq!(found.rel_mse, f64::INFINITY);
    assert_eq!(found.relative_difference, [f64::INFINITY, 0.0, 0.0]);
    assert_eq!((found.worst[0].x, found.worst[0].y), (1, 1));
}

#[test]
fn sizes_must_agree() {
    let (a, b) = (image(4, 3, |_| [0.0; 3]), image(3, 4, |_| [0.0; 3]));
    assert!(matches!(compare(&a, &b, 1), Err(MetricsError::Size { .. })));
    assert!(matches!(difference(&a, &b), Err(MetricsError::Size { .. })));
    assert!(matches!(block_differences(&a, &b, 8), Err(MetricsError::Size { .. })));
    let none = image(0, 0, |_| [0.0; 3]);
    assert!(matches!(compare(&none, &none, 1), Err(MetricsError::Empty)));
}

#[test]
fn blocks_cover_the_image() {
    let reference = image(19, 9, |_| [1.0; 3]);
    let shifted = image(19, 9, |i| if i % 19 >= 16 { [1.5, 1.0, 0.0] } else { [1.0; 3] });
    let blocks = block_differences(&shifted, &reference, 8).unwrap();
    let corners: Vec<_> = blocks.iter().map(|b| (b.x, b.y)).collect();
    assert_eq!(corners, [(0, 0), (8, 0), (16, 0), (0, 8), (8, 8), (16, 8)]);
    for block in &blocks {
        let expected = if block.x == 16 { [0.5, 0.0, -1.0] } else { [0.0; 3] };
        assert_eq!(block.difference(), expected);
    }
}

#[test]
fn block_means_are_those_that_are_compared() {
    let sloped = image(19, 9, |i| [i as f32, 0.0, f32::NAN]);
    let means = block_means(&sloped, 8);
    assert_eq!((means.width, means.height), (3, 2));
    let blocks = block_differences(&sloped, &sloped, 8).unwrap();
    for (mean, block) in means.pixels.iter().zip(&blocks) {
        assert_eq!(*mean, block.mean_image.map(|v| v as f32));
    }
    assert_eq!(block_means(&sloped, 1).pixels[7], [7.0, 0.0, 0.0]);
}

#[test]
fn differences_are_signed_and_painted() {
    let reference = image(2, 2, |_| [1.0; 3]);
    let values = [2.0, 0.0, 1.0, f32::NAN];
    let other = image(2, 2, |i| [values[i]; 3]);
    let signed = difference(&other, &reference).unwrap();
    assert_eq!(signed.pixels[..3], [[1.0; 3], [-1.0; 3], [0.0; 3]]);
    let painted = false_colour(&signed, 1.0);
    assert_eq!(painted[0..3], [255, 42, 0]);
    assert_eq!(painted[3..6], [0, 85, 255]);
    assert_eq!(painted[6..9], [0, 0, 0]);
    assert_eq!(painted[9..12], [255, 0, 255]);
}
