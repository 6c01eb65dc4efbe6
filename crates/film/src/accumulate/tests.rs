use proptest::prelude::*;
use rayon::prelude::*;

use super::*;
use crate::guard::Rejected;
use crate::layout::AuxGroup;

/// A small counter-based generator, so that a sample depends on its index alone.
fn hash(index: u64) -> u64 {
    let mut z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

fn value(index: u64) -> f32 {
    (hash(index) >> 40) as f32 / 1_000_000.0
}

fn window() -> FilmWindow {
    FilmWindow {
        resolution: UVec2::new(20, 12),
        crop_min: UVec2::new(3, 2),
        crop_max: UVec2::new(16, 11),
    }
}

/// Adds samples `range` to every pixel; their values depend on pixel and sample number.
fn render(film: &mut Film, range: Range<u64>, span_len: usize) {
    let end = film.pixel_count();
    film.spans_mut(0..end, span_len).par_iter_mut().for_each(|span| {
        for local in 0..span.len() {
            let pixel = span.pixel_of(local);
            for sample in range.clone() {
                let key = (u64::from(pixel.x) << 40) | (u64::from(pixel.y) << 20) | sample;
                let radiance: [[f32; 3]; 6] =
                    std::array::from_fn(|l| std::array::from_fn(|c| value(key * 100 + (l * 3 + c) as u64)));
                let aux: [f32; 7] = std::array::from_fn(|i| value(key * 100 + 50 + i as u64) - 8.0);
                span.add_sample(local, sample as u32, &radiance, 0.5, &aux).unwrap();
            }
        }
    });
}

fn film(tile_size: u32) -> Film {
    Film::new(window(), ChannelLayout::standard(), tile_size).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn image_does_not_depend_on_tiles_spans_or_splits(
        tile in 1_u32..20, span in 1_usize..200, cut in 0_u64..8,
    ) {
        let mut whole = film(16);
        render(&mut whole, 0..8, 1000);
        let mut late = film(tile);
        render(&mut late, cut..8, span);
        let mut merged = film(5);
        render(&mut merged, 0..cut, span);
        merged.merge(&late).unwrap();
        prop_assert_eq!(whole.resolve(), merged.resolve());
    }
}

#[test]
fn layers_add_up_to_beauty_exactly() {
    let mut film = film(4);
    render(&mut film, 0..5, 7);
    let image = film.resolve();
    for (index, component) in ["R", "G", "B"].iter().enumerate() {
        let beauty = image.channel(component).unwrap();
        for (pixel, beauty) in beauty.iter().enumerate() {
            let mut sum = 0.0_f32;
            for layer in &film.layout().layers {
                sum += image.channel(&format!("{layer}.{component}")).unwrap()[pixel];
            }
            assert_eq!(beauty.to_bits(), sum.to_bits(), "component {index}");
        }
    }
    assert!(image.channel("A").unwrap().iter().all(|&a| a == 0.5));
    assert!(image.channel("depth.Z").unwrap().iter().any(|&d| d < 0.0));
}

#[test]
fn pixels_land_where_they_belong() {
    let layout = ChannelLayout {
        layers: vec!["only".into()],
        ..ChannelLayout::default()
    };
    let mut film = Film::new(window(), layout, 4).unwrap();
    for mut span in film.spans_mut(0..13 * 9, 10) {
        for local in 0..span.len() {
            let pixel = span.pixel_of(local);
            let radiance = [[pixel.x as f32, pixel.y as f32, 1.0]];
            span.add_sample(local, 0, &radiance, 1.0, &[]).unwrap();
        }
    }
    let image = film.resolve();
    let (x, y) = (image.channel("R").unwrap(), image.channel("G").unwrap());
    assert_eq!((x[0], y[0]), (3.0, 2.0));
    assert_eq!((x[12], y[12]), (15.0, 2.0));
    assert_eq!((x[13], y[13]), (3.0, 3.0));
    assert_eq!((x[116], y[116]), (15.0, 10.0));
    assert_eq!(film.pixel_of(16), UVec2::new(7, 2));
}

#[test]
fn bad_samples_count_but_add_nothing() {
    let layout = ChannelLayout {
        layers: vec!["a".into(), "b".into()],
        aux: vec![AuxGroup::depth("depth")],
        ..ChannelLayout::default()
    };
    let mut film = Film::new(FilmWindow::full(UVec2::ONE), layout, 1).unwrap();
    let mut spans = film.spans_mut(0..1, 1);
    let span = &mut spans[0];
    let black = [0.0; 3];
    let bad = |value| [[1.0, 1.0, value], [0.0; 3]];
    assert_eq!(span.add_sample(0, 0, &[[4.0; 3], black], 1.0, &[2.0]), Ok(()));
    assert_eq!(span.add_sample(0, 0, &bad(f32::NAN), 1.0, &[2.0]), Err(Rejected::Nan));
    assert_eq!(span.add_sample(0, 0, &bad(-1.0), 1.0, &[2.0]), Err(Rejected::Negative));
    let far = span.add_sample(0, 0, &[black, black], 1.0, &[f32::INFINITY]);
    assert_eq!(far, Err(Rejected::Infinite));
    assert_eq!(
        film.rejected(),
        RejectedCounts {
            nan: 1,
            negative: 1,
            infinite: 1
        }
    );
    assert_eq!(film.sample_count(0), 4);
    let image = film.resolve();
    assert_eq!(image.channel("R").unwrap(), [1.0]);
    assert_eq!(image.channel("A").unwrap(), [0.25]);
    assert_eq!(image.channel("depth.Z").unwrap(), [0.5]);
}

#[test]
fn variance_is_that_of_the_mean() {
    let layout = ChannelLayout {
        layers: vec!["a".into(), "b".into()],
        variance: true,
        ..ChannelLayout::default()
    };
    let mut film = Film::new(FilmWindow::full(UVec2::new(2, 1)), layout, 8).unwrap();
    for (local, values) in [(0, [1.0, 2.0, 3.0, 6.0].as_slice()), (1, &[5.0])] {
        let mut spans = film.spans_mut(0..2, 2);
        for (batch, &value) in (0..).zip(values) {
            // Each value is a batch.
            for number in 0..4 {
                spans[0]
                    .add_sample(local, 4 * batch + number, &[[value, 1.0, 0.0], [1.0; 3]], 1.0, &[])
                    .unwrap();
            }
        }
    }
    let image = film.resolve();
    // Of 2, 3, 4, 7 the mean is 4 and the squared deviations add up to 14.
    assert_eq!(image.channel("variance.R").unwrap(), [14.0 / 12.0, 0.0]);
    assert_eq!(image.channel("variance.G").unwrap(), [0.0, 0.0]);
    assert_eq!(image.channel("R").unwrap(), [4.0, 6.0]);
}

#[test]
fn an_empty_film_is_black() {
    let image = film(16).resolve();
    assert!(image.channels.iter().all(|c| c.samples.iter().all(|&s| s == 0.0)));
    let expected = 13 * 9 * (26 * 16 + 192 + 4 + 32 * 4);
    assert_eq!(memory_bytes(&window(), &ChannelLayout::standard()), expected);
}

#[test]
fn films_that_cannot_be_are_refused() {
    let layout = ChannelLayout::standard;
    assert!(matches!(Film::new(window(), layout(), 0), Err(FilmError::TileSize)));
    let huge = FilmWindow::full(UVec2::splat(MAX_SIDE));
    // Two terabytes: known beforehand, without asking the system for them.
    assert!(memory_bytes(&huge, &layout()) > 1 << 40);
    let mut film = film(4);
    let other = Film::new(FilmWindow::full(UVec2::ONE), layout(), 4).unwrap();
    assert!(matches!(
        film.merge(&other),
        Err(FilmError::Mismatch { what: "window" })
    ));
    let plain = Film::new(window(), ChannelLayout::default(), 4).unwrap();
    assert!(matches!(
        film.merge(&plain),
        Err(FilmError::Mismatch { what: "channels" })
    ));
}
