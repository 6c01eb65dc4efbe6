use radiometry::Rgb;

/// Computes the unpolarised Fresnel reflectance of a smooth dielectric interface, and the cosine of refraction.
///
/// `F = ½ (r_∥² + r_⊥²)`, `r_∥ = (η cosθ_i − cosθ_t)/(η cosθ_i + cosθ_t)`,
/// `r_⊥ = (cosθ_i − η cosθ_t)/(cosθ_i + η cosθ_t)`
///
/// Source: Born and Wolf, "Principles of Optics", 1.5.2.
///
/// - `cos_i`: cosine of incidence, in [0, 1]; a sign is ignored.
/// - `eta`: `n_transmitted / n_incident`, > 0, as seen from the incident side.
/// - returns `(F, cosθ_t)`, both in [0, 1]; (1, 0) exactly under total internal reflection, `(0, cosθ_i)` for `eta` 1.
#[inline]
#[must_use]
pub fn fresnel_dielectric(cos_i: f32, eta: f32) -> (f32, f32) {
    let cos_i = cos_i.abs().min(1.0);
    if eta == 1.0 {
        return (0.0, cos_i);
    }
    let sin_t_sq = (1.0 - cos_i) * (1.0 + cos_i) / (eta * eta);
    if sin_t_sq >= 1.0 {
        return (1.0, 0.0);
    }
    let cos_t = (1.0 - sin_t_sq).sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let f = 0.5 * (parallel * parallel + perpendicular * perpendicular);
    (f.min(1.0), cos_t)
}

/// Computes the unpolarised Fresnel reflectance of a conductor, channel by channel.
///
/// Source: Born and Wolf, "Principles of Optics", 14.2, in the arrangement of S. Lagarde, "Memo on Fresnel Equations",
/// 2013.
///
/// - `cos_i`: cosine of incidence, in [0, 1]; a sign is ignored.
/// - `eta`, `k`: real and imaginary part of the index of refraction relative to the outside, both ≥ 0.
/// - returns the reflectance, in [0, 1]; with k = 0 it is that of a dielectric of index `eta`.
#[inline]
#[must_use]
pub fn fresnel_conductor(cos_i: f32, eta: Rgb, k: Rgb) -> Rgb {
    let c = cos_i.abs().min(1.0);
    Rgb::new(
        conductor_channel(c, eta.r, k.r),
        conductor_channel(c, eta.g, k.g),
        conductor_channel(c, eta.b, k.b),
    )
}

#[inline]
fn conductor_channel(c: f32, eta: f32, k: f32) -> f32 {
    let cos_sq = c * c;
    let sin_sq = 1.0 - cos_sq;
    let eta_sq = eta * eta;
    let k_sq = k * k;
    let t0 = eta_sq - k_sq - sin_sq;
    let a2_plus_b2 = (t0 * t0 + 4.0 * eta_sq * k_sq).sqrt();
    let a = (0.5 * (a2_plus_b2 + t0)).max(0.0).sqrt();
    let t1 = a2_plus_b2 + cos_sq;
    let t2 = 2.0 * a * c;
    let t3 = cos_sq * a2_plus_b2 + sin_sq * sin_sq;
    let t4 = t2 * sin_sq;
    let perpendicular = if t1 + t2 > 0.0 { (t1 - t2) / (t1 + t2) } else { 1.0 };
    let ratio = if t3 + t4 > 0.0 { (t3 - t4) / (t3 + t4) } else { 1.0 };
    (0.5 * perpendicular * (1.0 + ratio)).clamp(0.0, 1.0)
}

/// Computes Schlick's approximation of a Fresnel reflectance: F₀ + (1 − F₀)(1 − cosθ)⁵.
///
/// Source: Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", EUROGRAPHICS 1994.
///
/// - `cos_i`: cosine of incidence, in [0, 1]; a sign is ignored.
/// - `f0`: reflectance at normal incidence, in [0, 1].
#[inline]
#[must_use]
pub fn schlick(cos_i: f32, f0: Rgb) -> Rgb {
    let m = 1.0 - cos_i.abs().min(1.0);
    let m2 = m * m;
    let m5 = m2 * m2 * m;
    f0 + (Rgb::WHITE - f0) * m5
}

/// Averages the Fresnel reflectance of a dielectric interface over diffuse light: F̄ = 2 ∫₀¹ F(μ) μ dμ.
///
/// The quadrature runs on the optically thin side; the dense side follows from it exactly, since what diffuse light
/// sends through an interface is the same in both directions per mode: 1 − F̄(1/η) = (1 − F̄(η)) / η² for η > 1.
/// Differs from the closed form of Duntley 1942, which cancels badly as η → 1, by less than 10⁻⁴.
///
/// - `eta`: `n_transmitted / n_incident`, > 0, as seen from the incident side. For a Lambertian base under a coat of
///   index n, F̄(n) is the external and F̄(1/n) the internal diffuse reflectance.
#[must_use]
pub fn average_fresnel_dielectric(eta: f32) -> f32 {
    let dense = eta.max(1.0 / eta);
    let outside = average_over_hemisphere(|mu| fresnel_dielectric(mu, dense).0);
    if eta >= 1.0 {
        outside
    } else {
        1.0 - (1.0 - outside) / (dense * dense)
    }
}

/// Averages the Fresnel reflectance of a conductor over diffuse light: F̄ = 2 ∫₀¹ F(μ) μ dμ, to about 10⁻⁵.
#[must_use]
pub fn average_fresnel_conductor(eta: Rgb, k: Rgb) -> Rgb {
    let channel = |i: usize| average_over_hemisphere(|mu| conductor_channel(mu, eta[i], k[i]));
    Rgb::new(channel(0), channel(1), channel(2))
}

/// 2 ∫₀¹ f(μ) μ dμ by Gauss–Legendre quadrature in t = √μ, which resolves the steep end at grazing incidence.
fn average_over_hemisphere(f: impl Fn(f32) -> f32) -> f32 {
    GAUSS_LEGENDRE
        .iter()
        .flat_map(|(x, w)| [(0.5 - 0.5 * x, *w), (0.5 + 0.5 * x, *w)])
        .map(|(t, w)| 2.0 * w * t * t * t * f(t * t))
        .sum()
}

/// Positive nodes of the eight-point Gauss–Legendre rule on [−1, 1], with their weights.
const GAUSS_LEGENDRE: [(f32, f32); 4] = [
    (0.183_434_64, 0.362_683_78),
    (0.525_532_4, 0.313_706_65),
    (0.796_666_5, 0.222_381_03),
    (0.960_289_86, 0.101_228_54),
];

#[cfg(test)]
mod tests {
    use super::*;
    use radiometry::math;

    #[test]
    fn closed_forms_of_glass() {
        assert!((fresnel_dielectric(1.0, 1.5).0 - 0.04).abs() < 1e-6);
        assert!((fresnel_dielectric(1.0, 1.0 / 1.5).0 - 0.04).abs() < 1e-6);
        assert_eq!(fresnel_dielectric(0.0, 1.5).0, 1.0);
        // At Brewster's angle, tanθ = η, the parallel part vanishes: F = ½ ((η² − 1)/(η² + 1))².
        let brewster = 1.0 / (1.0_f32 + 1.5 * 1.5).sqrt();
        let expected = 0.5 * (1.25_f32 / 3.25) * (1.25 / 3.25);
        assert!((fresnel_dielectric(brewster, 1.5).0 - expected).abs() < 1e-6);
    }

    #[test]
    fn total_internal_reflection_begins_at_the_critical_angle() {
        let critical = math::asin(1.0 / 1.5);
        assert_eq!(fresnel_dielectric(math::cos(critical + 1e-3), 1.0 / 1.5), (1.0, 0.0));
        let (f, cos_t) = fresnel_dielectric(math::cos(critical - 1e-3), 1.0 / 1.5);
        assert!(f < 1.0 && cos_t > 0.0);
    }

    #[test]
    fn both_sides_reflect_alike() {
        // At grazing incidence the way back amplifies the rounding of cosθ_t, so the test starts a little above it.
        for i in 1..=100 {
            let c = i as f32 / 100.0;
            let (f, cos_t) = fresnel_dielectric(c, 1.5);
            let (back, cos_back) = fresnel_dielectric(cos_t, 1.0 / 1.5);
            assert!(
                (f - back).abs() < 1e-4 && (c - cos_back).abs() < 1e-4,
                "{c}: {f} {back}"
            );
        }
    }

    #[test]
    fn a_conductor_without_absorption_is_a_dielectric() {
        for i in 1..=100 {
            let c = i as f32 / 100.0;
            let f = fresnel_conductor(c, Rgb::new(1.5, 1.33, 2.4), Rgb::BLACK);
            for (channel, eta) in [(0, 1.5), (1, 1.33), (2, 2.4)] {
                assert!((f[channel] - fresnel_dielectric(c, eta).0).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn conductor_at_normal_incidence_has_its_closed_form() {
        let (eta, k) = (0.2_f32, 3.9_f32);
        let expected = ((eta - 1.0) * (eta - 1.0) + k * k) / ((eta + 1.0) * (eta + 1.0) + k * k);
        let f = fresnel_conductor(1.0, Rgb::splat(eta), Rgb::splat(k));
        assert!((f.r - expected).abs() < 1e-6);
        assert!((fresnel_conductor(0.0, Rgb::splat(eta), Rgb::splat(k)).r - 1.0).abs() < 1e-6);
    }

    #[test]
    fn diffuse_average_meets_duntley() {
        for n in [1.1_f64, 1.33, 1.5, 2.0, 3.0] {
            let (n2, n4) = (n * n, n * n * n * n);
            let duntley = 0.5
                + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0) * (n + 1.0))
                + n2 * (n2 - 1.0) * (n2 - 1.0) / (n2 + 1.0).powi(3)
                    * f64::from(math::ln(((n - 1.0) / (n + 1.0)) as f32))
                - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
                + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0) * (n4 - 1.0)) * f64::from(math::ln(n as f32));
            let average = f64::from(average_fresnel_dielectric(n as f32));
            assert!((average - duntley).abs() < 1e-4, "{n}: {average} against {duntley}");
            let inside = average_fresnel_dielectric((1.0 / n) as f32);
            let mids = (0..20_000).map(|i| (f64::from(i) + 0.5) / 20_000.0);
            let direct: f64 = mids
                .map(|mu| 1e-4 * mu * f64::from(fresnel_dielectric(mu as f32, (1.0 / n) as f32).0))
                .sum();
            assert!(
                (f64::from(inside) - direct).abs() < 3e-4,
                "{n}: {inside} against {direct}"
            );
        }
    }
}
