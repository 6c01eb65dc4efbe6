use proptest::prelude::*;

use super::*;

const KEY: [u8; 32] = [7; 32];

fn window() -> FilmWindow {
    FilmWindow {
        resolution: UVec2::new(9, 9),
        crop_min: UVec2::new(1, 2),
        crop_max: UVec2::new(8, 7),
    }
}

fn filled(tile_size: u32) -> Film {
    let mut film = Film::new(window(), ChannelLayout::standard(), tile_size).unwrap();
    let end = film.pixel_count();
    for mut span in film.spans_mut(0..end, 6) {
        for local in 0..span.len() {
            let pixel = span.pixel_of(local).as_vec2();
            let radiance = [[pixel.x * 0.3, pixel.y * 0.7, 1e-9]; 6];
            span.add_sample(local, 0, &radiance, 1.0, &[pixel.x - 4.0; 7]).unwrap();
            let _ = span.add_sample(local, 1, &[[f32::NAN; 3]; 6], 1.0, &[0.0; 7]);
        }
    }
    film
}

fn saved(film: &Film) -> Vec<u8> {
    let mut bytes = Vec::new();
    film.save(&mut bytes, &KEY).unwrap();
    bytes
}

fn load(bytes: &[u8]) -> Result<Film, CheckpointError> {
    Film::load(&mut &bytes[..], &KEY, window(), ChannelLayout::standard(), 3)
}

#[test]
fn comes_back_the_same_with_other_tiles() {
    let film = filled(4);
    let bytes = saved(&film);
    assert_eq!(bytes, saved(&filled(7)), "tile size must not show");
    let restored = load(&bytes).unwrap();
    assert_eq!(restored.resolve(), film.resolve());
    assert_eq!(restored.rejected(), film.rejected());
    assert_eq!(restored.rejected().nan, 35);
    assert_eq!(saved(&restored), bytes);
}

#[test]
fn leaves_what_follows_to_the_caller() {
    let mut bytes = saved(&filled(4));
    bytes.extend_from_slice(b"more");
    let mut rest = bytes.as_slice();
    Film::load(&mut rest, &KEY, window(), ChannelLayout::standard(), 4).unwrap();
    assert_eq!(rest, b"more");
}

#[test]
fn each_disagreement_is_named() {
    let bytes = saved(&filled(4));
    let layout = ChannelLayout::standard;
    let source = || bytes.as_slice();
    let other_key = Film::load(&mut source(), &[8; 32], window(), layout(), 4);
    assert!(matches!(other_key, Err(CheckpointError::Key)));
    let whole = FilmWindow::full(UVec2::splat(9));
    let other_window = Film::load(&mut source(), &KEY, whole, layout(), 4);
    assert!(matches!(other_window, Err(CheckpointError::Window { .. })));
    let fewer = ChannelLayout {
        variance: false,
        ..layout()
    };
    let other_layout = Film::load(&mut source(), &KEY, window(), fewer, 4);
    assert!(matches!(other_layout, Err(CheckpointError::Layout)));
    let mut newer = bytes.clone();
    newer[8] = 3;
    assert!(matches!(load(&newer), Err(CheckpointError::Version { found: 3 })));
    assert!(matches!(load(b"PNG and so on"), Err(CheckpointError::NotACheckpoint)));
    assert!(matches!(load(b""), Err(CheckpointError::Truncated)));
}

proptest! {
    #[test]
    fn cut_off_files_are_refused(end in any::<prop::sample::Index>()) {
        let bytes = saved(&filled(4));
        let cut = &bytes[..end.index(bytes.len())];
        prop_assert!(matches!(load(cut), Err(CheckpointError::Truncated)));
    }

    #[test]
    fn any_flipped_bit_is_noticed(at in any::<prop::sample::Index>(), bit in 0_u8..8) {
        let mut bytes = saved(&filled(4));
        let at = at.index(bytes.len());
        bytes[at] ^= 1 << bit;
        prop_assert!(load(&bytes).is_err());
    }

    #[test]
    fn nonsense_is_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(load(&bytes).is_err());
        let tail = [&saved(&filled(4))[..68], &bytes].concat();
        prop_assert!(load(&tail).is_err());
    }
}
