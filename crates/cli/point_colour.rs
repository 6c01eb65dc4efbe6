//! From quantities to the colours of points.

/// The value that stands at a share of all of them in order; none of none.
pub(crate) fn at_share(mut values: Vec<f32>, share: f64) -> Option<f32> {
    let place = (values.len() as f64 * share) as usize;
    (place < values.len()).then(|| *values.select_nth_unstable_by(place, f32::total_cmp).1)
}

/// The value that is shown at full brightness, above 0: the one at a share of all of them. Larger ones are as bright.
pub(crate) fn white(values: Vec<f32>, share: f64) -> f32 {
    at_share(values, share).map_or(1.0, |value| value.max(f32::MIN_POSITIVE))
}

/// A linear quantity as a display colour, sRGB in [0, 1].
pub(crate) fn shown(linear: [f32; 3], white: f32) -> [f32; 3] {
    linear.map(|value| (value / white).clamp(0.0, 1.0).sqrt())
}

/// Yellow at 0, red between, blue at 1.
pub(crate) fn ramp(share: f32) -> [f32; 3] {
    const STOPS: [[f32; 3]; 3] = [[1.0, 0.9, 0.3], [1.0, 0.35, 0.4], [0.35, 0.6, 1.0]];
    let place = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let first = (place as usize).min(STOPS.len() - 2);
    let (from, to, rest) = (STOPS[first], STOPS[first + 1], place - first as f32);
    std::array::from_fn(|i| from[i] + (to[i] - from[i]) * rest)
}

/// A display colour in 8 bits.
pub(crate) fn to_bytes(colour: [f32; 3]) -> [u8; 3] {
    colour.map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_bright_values_do_not_darken_the_rest() {
        let mut values = vec![2.0; 1000];
        values[17] = 1e9;
        assert_eq!(white(values, 0.99), 2.0);
        assert_eq!(white(Vec::new(), 0.99), 1.0);
        assert_eq!(shown([0.5, 2.0, 1e9], 2.0), [0.5, 1.0, 1.0]);
    }

    #[test]
    fn the_ramp_goes_from_end_to_end() {
        assert_eq!(to_bytes(ramp(0.0)), [255, 230, 77]);
        assert_eq!(to_bytes(ramp(1.0)), to_bytes(ramp(7.0)));
        assert_ne!(to_bytes(ramp(0.5)), to_bytes(ramp(0.6)));
    }
}
