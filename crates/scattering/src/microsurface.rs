use crate::LobeClass;

/// Below this α a microsurface is treated as smooth (a delta lobe).
///
/// A direction in single precision is known to about 10⁻⁷, and the density of GGX changes over α: at 10⁻³ densities are
/// still good to 10⁻³. In `roughness` the limit is 0.032, normals spread over 0.06°.
pub const SMOOTH_ALPHA: f32 = 1e-3;

/// Decides whether a lobe counts as S or D in the path classes; the one place that does.
///
/// - `alpha`: GGX width; smooth (delta) lobes have 0.
/// - `specular_alpha`: the scene's threshold, `LightTransport.specular_alpha`, 0.05 by default. 0 leaves only delta
///   lobes specular.
#[inline]
#[must_use]
pub fn lobe_class(alpha: f32, specular_alpha: f32) -> LobeClass {
    if alpha < SMOOTH_ALPHA || alpha <= specular_alpha {
        LobeClass::Specular
    } else {
        LobeClass::Diffuse
    }
}

/// How rough a specular surface is, and how its lobe is classified. 8 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microsurface {
    alpha: f32,
    class: LobeClass,
    energy_compensation: bool,
}

impl Microsurface {
    /// A perfectly smooth surface: delta lobes.
    pub const SMOOTH: Self = Self {
        alpha: 0.0,
        class: LobeClass::Specular,
        energy_compensation: false,
    };

    /// Builds a GGX surface of width α = roughness², with energy compensation.
    ///
    /// - `roughness`: perceptual, clamped to [0, 1]; α below [`SMOOTH_ALPHA`] becomes [`Microsurface::SMOOTH`].
    /// - `specular_alpha`: the threshold of [`lobe_class`].
    #[must_use]
    pub fn from_roughness(roughness: f32, specular_alpha: f32) -> Self {
        let roughness = roughness.clamp(0.0, 1.0);
        let alpha = roughness * roughness;
        if alpha < SMOOTH_ALPHA || alpha.is_nan() {
            return Self::SMOOTH;
        }
        Self {
            alpha,
            class: lobe_class(alpha, specular_alpha),
            energy_compensation: true,
        }
    }

    /// The same surface with or without the light that scatters more than once between microfacets.
    ///
    /// Without it a rough surface is too dark: at α = 1 a white metal loses 59 % of diffuse light.
    #[must_use]
    pub fn with_energy_compensation(self, on: bool) -> Self {
        Self {
            energy_compensation: on && !self.is_smooth(),
            ..self
        }
    }

    /// GGX width, 0 for a smooth surface, else in [[`SMOOTH_ALPHA`], 1].
    #[inline]
    #[must_use]
    pub fn alpha(self) -> f32 {
        self.alpha
    }

    /// True for a delta lobe.
    #[inline]
    #[must_use]
    pub fn is_smooth(self) -> bool {
        self.alpha == 0.0
    }

    /// Class of the lobe, its multiply scattered part included.
    #[inline]
    #[must_use]
    pub fn class(self) -> LobeClass {
        self.class
    }

    /// True when multiple scattering between microfacets is added.
    #[inline]
    #[must_use]
    pub fn has_energy_compensation(self) -> bool {
        self.energy_compensation
    }
}

const _: () = assert!(size_of::<Microsurface>() <= 8);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_follow_the_threshold() {
        assert_eq!(lobe_class(0.0, 0.0), LobeClass::Specular);
        assert_eq!(lobe_class(0.05, 0.05), LobeClass::Specular);
        assert_eq!(lobe_class(0.050_001, 0.05), LobeClass::Diffuse);
        assert_eq!(lobe_class(0.01, 0.0), LobeClass::Diffuse);
    }

    #[test]
    fn nearly_smooth_is_smooth() {
        assert!(Microsurface::from_roughness(0.031, 0.05).is_smooth());
        assert!(Microsurface::from_roughness(-1.0, 0.05).is_smooth());
        assert!(Microsurface::from_roughness(f32::NAN, 0.05).is_smooth());
        let rough = Microsurface::from_roughness(0.5, 0.05);
        assert_eq!((rough.alpha(), rough.class()), (0.25, LobeClass::Diffuse));
        assert!(rough.has_energy_compensation());
        assert!(
            !Microsurface::SMOOTH
                .with_energy_compensation(true)
                .has_energy_compensation()
        );
    }
}
