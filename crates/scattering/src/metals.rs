use radiometry::Rgb;

/// The complex index of refraction of a metal, integrated to linear RGB with Rec.709 primaries.
///
/// Measured spectra were integrated against the colour matching functions, which keeps the colour of a metal better than
/// three wavelengths would. Source: the table of complex indices of the Tungsten renderer (B. Bitterli), which integrates
/// the measured spectra that are passed on with PBRT and Mitsuba; rounded to four decimals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal {
    /// Name in scene files, lower case.
    pub name: &'static str,
    /// Real part of the index.
    pub eta: Rgb,
    /// Imaginary part of the index.
    pub k: Rgb,
}

impl Metal {
    /// Every metal that has a name, in alphabetical order.
    pub const ALL: [Self; 10] = [
        Self::new("aluminium", [1.6575, 0.8804, 0.5212], [9.2239, 6.2695, 4.8370]),
        Self::new("beryllium", [4.1851, 3.1851, 2.7841], [3.8354, 3.0101, 2.8690]),
        Self::new("chrome", [4.3697, 2.9167, 1.6547], [5.2064, 4.2314, 3.7549]),
        Self::new("copper", [0.2004, 0.9240, 1.1022], [3.9129, 2.4528, 2.1422]),
        Self::new("gold", [0.1431, 0.3750, 1.4425], [3.9832, 2.3857, 1.6032]),
        Self::new("iridium", [3.0864, 2.0822, 1.6179], [5.5922, 4.0672, 3.2673]),
        Self::new("mercury", [2.3989, 1.4400, 0.9096], [6.3276, 4.3719, 3.4218]),
        Self::new("silver", [0.1553, 0.1167, 0.1384], [4.8283, 3.1222, 2.1471]),
        Self::new("tungsten", [4.3707, 3.3003, 2.9983], [3.5007, 2.6049, 2.2732]),
        Self::new("vanadium", [4.2775, 3.5132, 2.7611], [3.4912, 2.8894, 3.1117]),
    ];

    const fn new(name: &'static str, eta: [f32; 3], k: [f32; 3]) -> Self {
        Self {
            name,
            eta: Rgb::new(eta[0], eta[1], eta[2]),
            k: Rgb::new(k[0], k[1], k[2]),
        }
    }

    /// Finds a metal by its name, regardless of case; also by the spellings "aluminum" and "chromium".
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let name = match name.to_ascii_lowercase().as_str() {
            "aluminum" => "aluminium".to_owned(),
            "chromium" => "chrome".to_owned(),
            other => other.to_owned(),
        };
        Self::ALL.into_iter().find(|metal| metal.name == name)
    }

    /// The names that [`Metal::from_name`] lists, for error messages.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Self::ALL.into_iter().map(|metal| metal.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fresnel::fresnel_conductor;

    fn normal_reflectance(name: &str) -> Rgb {
        let metal = Metal::from_name(name).expect("named metal");
        fresnel_conductor(1.0, metal.eta, metal.k)
    }

    #[test]
    fn metals_have_their_colours() {
        let gold = normal_reflectance("gold");
        assert!(gold.r > 0.9 && gold.r > gold.g && gold.g > 1.5 * gold.b, "{gold:?}");
        let copper = normal_reflectance("Copper");
        assert!(copper.r > 0.9 && copper.r > 1.3 * copper.g, "{copper:?}");
        let silver = normal_reflectance("silver");
        assert!(silver.r > 0.9 && silver.b > 0.85, "{silver:?}");
        for grey in ["aluminum", "chromium"] {
            let f = normal_reflectance(grey);
            assert!((f.r - f.b).abs() < 0.1 && f.g > 0.5, "{grey}: {f:?}");
        }
    }

    #[test]
    fn names_are_sorted_and_found() {
        let names: Vec<_> = Metal::names().collect();
        assert!(names.is_sorted());
        assert!(names.iter().all(|name| Metal::from_name(name).is_some()));
        assert_eq!(Metal::from_name("unobtainium"), None);
    }
}
