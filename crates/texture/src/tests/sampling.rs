use crate::{Channel, Encoding, Filter, Picture, Texture, Wrap};
use glam::Vec2;
use radiometry::Rgb;
use std::sync::Arc;

/// A picture of one row whose texel x is x in every channel.
fn ramp(width: u32) -> Texture {
    let values = (0..width).flat_map(|x| [x as f32; 3]).collect();
    Texture::new(Arc::new(Picture::from_rgb(width, 1, values).unwrap()))
}

fn value(texture: &Texture, u: f32) -> f32 {
    texture.value(Vec2::new(u, 0.5))
}

#[test]
fn texel_centres_give_texels_and_half_ways_give_means() {
    let texture = ramp(8);
    for x in 0..8 {
        assert_eq!(value(&texture, (x as f32 + 0.5) / 8.0), x as f32);
    }
    for x in 1..8 {
        assert_eq!(value(&texture, x as f32 / 8.0), x as f32 - 0.5);
        assert_eq!(value(&texture, (x as f32 + 0.25) / 8.0), x as f32 - 0.25);
    }
}

#[test]
fn nearest_changes_at_the_edges_of_texels() {
    let mut texture = ramp(8);
    texture.filter = Filter::Nearest;
    for x in 0..8 {
        assert_eq!(value(&texture, x as f32 / 8.0), x as f32);
        assert_eq!(value(&texture, ((x as f32 + 1.0) / 8.0).next_down()), x as f32);
    }
}

#[test]
fn wraps_are_exact_at_seams() {
    let shown = |wrap, texel: i32| match wrap {
        Wrap::Repeat => texel.rem_euclid(8) as f32,
        // 0 1 .. 6 7 7 6 .. 1 0 0 1 ..
        Wrap::Mirror => 7.5 - (texel.rem_euclid(16) as f32 - 7.5).abs(),
        Wrap::Clamp => texel.clamp(0, 7) as f32,
    };
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        let mut texture = ramp(8);
        texture.wrap[0] = wrap;
        // Quarters of a texel, so that every number is exact.
        for quarter in -32 * 4..=40 * 4_i32 {
            let u = quarter as f32 / 32.0;
            let centre = (quarter - 2).div_euclid(4);
            let share = (quarter - 2).rem_euclid(4) as f32 / 4.0;
            let (left, right) = (shown(wrap, centre), shown(wrap, centre + 1));
            assert_eq!(value(&texture, u), left + (right - left) * share, "{wrap:?} {u}");
        }
    }
}

#[test]
fn a_repeated_picture_has_no_seam_far_away() {
    let texture = ramp(4);
    for turn in [-1000.0, -1.0, 1.0, 7.0, 4096.0] {
        assert_eq!(value(&texture, turn + 0.125), 0.0);
        assert_eq!(value(&texture, turn), 1.5);
    }
}

#[test]
fn coordinates_that_are_no_numbers_give_some_texel() {
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        for filter in [Filter::Linear, Filter::Nearest] {
            let mut texture = ramp(4);
            (texture.wrap, texture.filter) = ([wrap; 2], filter);
            for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN] {
                let found = texture.value(Vec2::new(odd, odd));
                assert!((0.0..4.0).contains(&found), "{odd}: {found}");
            }
        }
    }
}

#[test]
fn rows_run_from_the_top() {
    let picture = Picture::from_rgb(1, 2, vec![1.0, 1.0, 1.0, 0.0, 0.0, 0.0]).unwrap();
    let texture = Texture::new(Arc::new(picture));
    assert_eq!(texture.value(Vec2::new(0.5, 0.75)), 1.0);
    assert_eq!(texture.value(Vec2::new(0.5, 0.25)), 0.0);
}

#[test]
fn filtering_is_in_linear_light() {
    let file = super::png(2, 1, image::ColorType::L8, &[0, 255]);
    let texture = Texture::new(Arc::new(super::read(&file).unwrap()));
    assert_eq!(texture.encoding, Encoding::Srgb);
    assert_eq!(value(&texture, 0.5), 0.5);
}

#[test]
fn channel_factor_and_bounds() {
    let picture = Picture::from_rgb(2, 1, vec![0.1, 0.2, 0.3, 0.5, 0.0, 0.3]).unwrap();
    let mut texture = Texture::new(Arc::new(picture));
    texture.factor = Rgb::new(2.0, 3.0, 4.0);
    texture.channel = Channel::G;
    assert_eq!(texture.value(Vec2::new(0.25, 0.5)), 0.4);
    assert_eq!(texture.rgb(Vec2::new(0.75, 0.5)).to_array(), [1.0, 0.0, 1.2]);
    assert_eq!(texture.range(), (0.0, 0.4));
    assert_eq!(texture.max_rgb().to_array(), [1.0, 0.6, 1.2]);
    let mean = texture.mean_rgb();
    assert!((mean.r - 0.6).abs() < 1e-6 && (mean.g - 0.3).abs() < 1e-6);
    texture.channel = Channel::A;
    assert_eq!(texture.value(Vec2::new(0.25, 0.5)), 2.0);
}
