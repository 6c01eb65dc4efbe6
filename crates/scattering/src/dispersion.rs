use radiometry::Rgb;
use std::sync::LazyLock;

/// How the index of refraction of a glass falls with the wavelength: n(λ) = A + B/λ².
///
/// Source: Cauchy's formula, fitted to the index at the d line (587.56 nm) and the Abbe number
/// `V = (n_d − 1)/(n_F − n_C)`, F at 486.13 nm and C at 656.27 nm. Good to about 10⁻³ in the visible range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dispersion {
    a: f32,
    /// In nm².
    b: f32,
}

const D_LINE: f32 = 587.56;
const F_LINE: f32 = 486.13;
const C_LINE: f32 = 656.27;

impl Dispersion {
    /// Fits the two coefficients.
    ///
    /// - `ior`: index at the d line, > 0.
    /// - `abbe`: Abbe number, at least 5: crown glass 59, flint 36, diamond 55, water 56. Low spreads colours more.
    #[must_use]
    pub fn from_abbe(ior: f32, abbe: f32) -> Self {
        let b = (ior - 1.0) / (abbe * (1.0 / (F_LINE * F_LINE) - 1.0 / (C_LINE * C_LINE)));
        Self {
            a: ior - b / (D_LINE * D_LINE),
            b,
        }
    }

    /// Index of refraction at a wavelength in nm.
    #[inline]
    #[must_use]
    pub fn ior_at(&self, wavelength: f32) -> f32 {
        self.a + self.b / (wavelength * wavelength)
    }
}

/// A wavelength drawn for a path of RGB light, and what it does to the path.
///
/// Spectral care in RGB: light stays RGB until it meets a dispersive interface. There one wavelength is drawn, the path
/// follows the index of that wavelength from then on, and its throughput is multiplied once by the weight, the colour of
/// the wavelength. The mean of the weights over all wavelengths is exactly white, so where the index does not matter
/// nothing changes but noise; where it does, each wavelength shows its colour.
///
/// The colours are those of monochromatic light in Rec.709, from the colour matching functions of Wyman, Sloan and
/// Shirley, "Simple Analytic Approximations to the CIE XYZ Color Matching Functions", JCGT 2(2), 2013. Differs: negative
/// parts are cut off, since radiance may not be negative, so the purest colours of a rainbow are a little pale; and each
/// channel is scaled to the mean of one, which is an illuminant of equal RGB. What RGB light says of a spectrum is only
/// its three bands: a saturated light does not know its wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledWavelength {
    /// In nm, in [390, 720].
    pub wavelength: f32,
    /// Factor for each channel; its mean over draws is one. At most 3.
    pub weight: Rgb,
}

/// Shortest and longest wavelength, nm: beyond them the eye sees less than a thousandth.
const SHORTEST: f32 = 390.0;
const LONGEST: f32 = 720.0;
const BANDS: usize = 110;
const BAND_WIDTH: f32 = (LONGEST - SHORTEST) / BANDS as f32;

impl SampledWavelength {
    /// Draws a wavelength in proportion to the sum of the channels of its colour.
    ///
    /// Piecewise constant over bands of 3 nm, so the mean weight is exact. Deterministic.
    ///
    /// - `u`: in [0, 1).
    #[must_use]
    pub fn new(u: f32) -> Self {
        let table = &*BAND_TABLE;
        let band = table.cumulative.partition_point(|c| *c <= u).min(BANDS - 1);
        let low = if band == 0 { 0.0 } else { table.cumulative[band - 1] };
        let width = table.cumulative[band] - low;
        let inside = if width > 0.0 {
            ((u - low) / width).clamp(0.0, 1.0)
        } else {
            0.5
        };
        let colour = table.colours[band];
        Self {
            wavelength: SHORTEST + (band as f32 + inside) * BAND_WIDTH,
            weight: colour / colour.mean(),
        }
    }
}

struct BandTable {
    /// Each channel has the sum one over all bands.
    colours: Vec<Rgb>,
    cumulative: Vec<f32>,
}

static BAND_TABLE: LazyLock<BandTable> = LazyLock::new(|| {
    let middle = |band: usize| SHORTEST + (band as f32 + 0.5) * BAND_WIDTH;
    let raw: Vec<Rgb> = (0..BANDS).map(|band| rgb_of_wavelength(middle(band))).collect();
    let sum: Rgb = raw.iter().copied().sum();
    let colours: Vec<Rgb> = raw.into_iter().map(|colour| colour / sum).collect();
    let mut total = 0.0;
    let mut cumulative: Vec<f32> = colours
        .iter()
        .map(|colour| {
            total += f64::from(colour.mean());
            total as f32
        })
        .collect();
    // The last band with a colour closes the range.
    let last = colours
        .iter()
        .rposition(|colour| !colour.is_black())
        .unwrap_or(BANDS - 1);
    cumulative[last..].fill(1.0);
    BandTable { colours, cumulative }
});

/// Colour of monochromatic light in linear Rec.709, with negative channels cut off.
fn rgb_of_wavelength(wavelength: f32) -> Rgb {
    let lobe = |peak: f32, below: f32, above: f32| {
        let t = (wavelength - peak) * if wavelength < peak { below } else { above };
        radiometry::math::exp(-0.5 * t * t)
    };
    let x =
        0.362 * lobe(442.0, 0.0624, 0.0374) + 1.056 * lobe(599.8, 0.0264, 0.0323) - 0.065 * lobe(501.1, 0.0490, 0.0382);
    let y = 0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322);
    let z = 1.217 * lobe(437.0, 0.0845, 0.0278) + 0.681 * lobe(459.0, 0.0385, 0.0725);
    Rgb::new(
        3.2406 * x - 1.5372 * y - 0.4986 * z,
        -0.9689 * x + 1.8758 * y + 0.0415 * z,
        0.0557 * x - 0.2040 * y + 1.0570 * z,
    )
    .map(|c| c.max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_has_the_abbe_number_that_it_was_given() {
        for (ior, abbe) in [(1.5168, 64.17), (1.62, 36.4), (2.417, 55.3), (0.75, 40.0)] {
            let glass = Dispersion::from_abbe(ior, abbe);
            assert!((glass.ior_at(D_LINE) - ior).abs() < 1e-6);
            let found = (ior - 1.0) / (glass.ior_at(F_LINE) - glass.ior_at(C_LINE));
            assert!((found - abbe).abs() < 2e-3 * abbe, "{ior}: {found} against {abbe}");
        }
        // Schott N-BK7 at the g and the s line, against its data sheet.
        let crown = Dispersion::from_abbe(1.5168, 64.17);
        assert!((crown.ior_at(435.84) - 1.52668).abs() < 1.5e-3 && (crown.ior_at(706.52) - 1.51289).abs() < 1.5e-3);
    }

    /// Mean of a function of the wavelength, weighted as a path would be.
    fn mean(n: u32, f: impl Fn(f32) -> f32) -> Rgb {
        let draws = (0..n).map(|i| SampledWavelength::new((i as f32 + 0.5) / n as f32));
        draws.map(|s| s.weight * f(s.wavelength)).sum::<Rgb>() / n as f32
    }

    #[test]
    fn all_wavelengths_together_are_white() {
        let white = mean(1 << 14, |_| 1.0);
        assert!((white - Rgb::WHITE).map(f32::abs).max_element() < 1e-3, "{white:?}");
    }

    #[test]
    fn glass_that_hardly_spreads_transmits_as_one_that_does_not() {
        let exact = 1.0 - crate::fresnel_dielectric(0.6, 1.5).0;
        let glass = Dispersion::from_abbe(1.5, 60.0);
        let spread = mean(1 << 12, |wavelength| {
            1.0 - crate::fresnel_dielectric(0.6, glass.ior_at(wavelength)).0
        });
        assert!((spread.luminance() - exact).abs() < 1e-3, "{spread:?} against {exact}");
        for channel in 0..3 {
            assert!((spread[channel] - exact).abs() < 2e-3, "{spread:?} against {exact}");
        }
    }

    #[test]
    fn wavelengths_have_their_colours_and_bounded_weights() {
        for i in 0..1000 {
            let s = SampledWavelength::new(i as f32 / 1000.0);
            assert!((SHORTEST..=LONGEST).contains(&s.wavelength));
            assert!(s.weight.is_finite() && s.weight.max_element() <= 3.001, "{s:?}");
            match s.wavelength {
                610.0.. => assert!(s.weight.r > s.weight.g && s.weight.r > s.weight.b, "{s:?}"),
                510.0..560.0 => assert!(s.weight.g > s.weight.r && s.weight.g > s.weight.b, "{s:?}"),
                400.0..470.0 => assert!(s.weight.b > s.weight.r && s.weight.b > s.weight.g, "{s:?}"),
                _ => {}
            }
        }
        assert!(SampledWavelength::new(0.0).wavelength < SampledWavelength::new(0.999).wavelength);
    }
}
