use super::{PhotonRows, thin_photons};
use crate::density::{DensityFilter, DensityScratch, DensitySettings, PhotonColumns, PhotonMap, PhotonSurface};
use crate::scene::Scene;
use glam::Vec3;
use radiometry::{Rgb, SampleStream, StageKey};
use spatial::{PhotonTree, RayScene};

/// Photons on a floor of 1 m²: the half at x < 0.5 has a tenth of them.
const PHOTONS: u32 = 40_000;
const SPARSE: f32 = 0.1 * 2.0 * PHOTONS as f32;
const DENSE: f32 = 0.9 * 2.0 * PHOTONS as f32;

#[derive(Clone, Default)]
struct Photons {
    position: Vec<Vec3>,
    normal: Vec<Vec3>,
    flux: Vec<Rgb>,
}

impl Photons {
    fn push(&mut self, position: Vec3, normal: Vec3, flux: Rgb) {
        self.position.push(position);
        self.normal.push(normal);
        self.flux.push(flux);
    }

    fn rows(&self) -> PhotonRows<'_> {
        PhotonRows {
            position: &self.position,
            normal: &self.normal,
            flux: &self.flux,
        }
    }

    fn thinned(&self, density: f32) -> Vec<Option<Rgb>> {
        thin_photons(self.rows(), |_| density).expect("finite photons")
    }

    /// Those that are kept.
    fn after(&self, thinned: &[Option<Rgb>]) -> Self {
        let mut kept = Self::default();
        for (row, flux) in thinned.iter().enumerate() {
            if let Some(flux) = flux {
                kept.push(self.position[row], self.normal[row], *flux);
            }
        }
        kept
    }

    /// Sum of the fluxes where the predicate holds.
    fn flux_where(&self, holds: impl Fn(Vec3, Vec3) -> bool) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for ((position, normal), flux) in self.position.iter().zip(&self.normal).zip(&self.flux) {
            if holds(*position, *normal) {
                sum[0] += f64::from(flux.r);
                sum[1] += f64::from(flux.g);
                sum[2] += f64::from(flux.b);
            }
        }
        sum
    }

    fn map(&self, nearest: usize) -> PhotonMap {
        let tree = PhotonTree::build(&self.position).expect("finite photons");
        let mut columns = PhotonColumns::default();
        tree.in_query_order(&self.flux, &mut columns.flux);
        let surfaces: Vec<_> = self.normal.iter().map(|normal| PhotonSurface::open(*normal)).collect();
        tree.in_query_order(&surfaces, &mut columns.surface);
        let density = DensitySettings {
            nearest,
            max_radius: 0.1,
            filter: DensityFilter::Disc,
            shrink: 1.0,
        };
        PhotonMap { tree, columns, density }
    }
}

fn numbers(i: u32) -> [f32; 4] {
    let stream = SampleStream::new(3, StageKey::new("thinning"), 0, i);
    let (a, b) = (stream.draw_2d(0, 0), stream.draw_2d(1, 0));
    [a.x, a.y, b.x, b.y]
}

fn floor() -> Photons {
    let mut photons = Photons::default();
    for i in 0..PHOTONS {
        let [x, z, half, power] = numbers(i);
        let x = 0.5 * x + if half < 0.1 { 0.0 } else { 0.5 };
        photons.push(
            Vec3::new(x, 0.0, z),
            Vec3::Y,
            Rgb::new(0.5 + power, 1.0, 1.5 - power) * 1e-4,
        );
    }
    photons
}

/// What sums of fluxes may differ by, relative: each is rounded to `f32` once.
const ROUNDING: f64 = 1e-7;

fn assert_same(a: [f64; 3], b: [f64; 3]) {
    for (a, b) in a.into_iter().zip(b) {
        assert!((a - b).abs() <= ROUNDING * b, "{a} instead of {b}");
    }
}

#[test]
fn flux_is_kept_and_crowds_are_thinned_to_what_was_asked_for() {
    let photons = floor();
    for density in [2.0 * SPARSE, 0.5 * DENSE, 0.05 * DENSE] {
        let thinned = photons.thinned(density);
        let after = photons.after(&thinned);
        assert_same(after.flux_where(|_, _| true), photons.flux_where(|_, _| true));
        // Half of the floor, without its edges, where discs hang over and light seems thinner.
        let inside = |p: &&Vec3| p.x > 0.55 && p.x < 0.95 && p.z > 0.05 && p.z < 0.95;
        let count = after.position.iter().filter(inside).count() as f32;
        let expected = density * 0.4 * 0.9;
        assert!((count / expected - 1.0).abs() < 0.03, "{count} of {expected}");
    }
}

#[test]
fn where_photons_are_sparse_nothing_changes() {
    let photons = floor();
    let thinned = photons.thinned(2.0 * SPARSE);
    for (row, flux) in thinned.iter().enumerate() {
        let position = photons.position[row];
        assert!(position.x > 0.45 || *flux == Some(photons.flux[row]), "{position}");
    }
    assert!(thinned.iter().any(Option::is_none));
    for enough in [f32::INFINITY, f32::NAN, 1.1 * PHOTONS as f32 * 2.0] {
        let all: Vec<_> = photons.flux.iter().copied().map(Some).collect();
        assert_eq!(photons.thinned(enough), all, "{enough} a square metre");
    }
}

#[test]
fn irradiance_is_that_of_all_photons() {
    /// One photon of so many is left.
    const OF: usize = 8;
    /// Photons of the discs that are compared.
    const NEAREST: usize = 50;
    /// Spread of the difference: what crosses the rim of discs. Photons thinned by chance would be spread by 1/√50 = 0.14.
    const SPREAD: f64 = 0.08;
    let photons = floor();
    let after = photons.after(&photons.thinned(DENSE / OF as f32));
    let (map, thinned) = (photons.map(NEAREST * OF), after.map(NEAREST));
    // No walls anywhere.
    let rays = RayScene::build(vec![], vec![]).expect("an empty scene");
    let scene = Scene::new(rays, vec![], vec![], vec![]);
    let mut scratch = [DensityScratch::default(), DensityScratch::default()];
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    for i in 0..1000 {
        let [x, z, ..] = numbers(PHOTONS + i);
        let site = Vec3::new(0.62 + 0.26 * x, 0.0, 0.12 + 0.76 * z);
        let [before, after] = [(&map, 0), (&thinned, 1)].map(|(map, i)| {
            map.estimate_irradiance(&scene, site, Vec3::Y, 1e-7, &mut scratch[i])
                .value
                .g
        });
        let off = f64::from(after / before) - 1.0;
        sum += off;
        squares += off * off;
        count += 1.0;
    }
    let (mean, spread) = (sum / count, (squares / count).sqrt());
    assert!(
        mean.abs() < 0.02 && spread < SPREAD,
        "{mean} off on average, spread by {spread}"
    );
}

#[test]
fn flux_stays_on_its_side_of_its_surface() {
    // Both sides of a sheet, and a wall that stands on it.
    let mut photons = Photons::default();
    let sides = [Vec3::Y, -Vec3::Y, Vec3::X];
    for i in 0..30_000 {
        let [u, v, side, _] = numbers(i);
        let side = sides[(side * 3.0) as usize];
        let position = if side == Vec3::X {
            Vec3::new(0.0, u, v)
        } else {
            Vec3::new(u, 0.0, v)
        };
        photons.push(position, side, Rgb::splat(1.0));
    }
    let after = photons.after(&photons.thinned(500.0));
    assert!(after.flux.len() < 3000, "{}", after.flux.len());
    for side in sides {
        assert_same(
            after.flux_where(|_, normal| normal == side),
            photons.flux_where(|_, normal| normal == side),
        );
    }
}

#[test]
fn photons_in_one_point_leave_some_to_take_their_flux() {
    let mut photons = Photons::default();
    for _ in 0..10_000 {
        photons.push(Vec3::ONE, Vec3::Y, Rgb::splat(0.25));
    }
    let after = photons.after(&photons.thinned(100.0));
    assert!((1..=20).contains(&after.flux.len()), "{}", after.flux.len());
    assert_eq!(after.flux_where(|_, _| true), [2500.0; 3]);
    let mut lost = photons;
    lost.position[7].x = f32::NAN;
    assert!(thin_photons(lost.rows(), |_| 100.0).is_err());
    assert_eq!(Photons::default().thinned(1.0), []);
}

#[test]
fn threads_change_no_bit() {
    let photons = floor();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads start").install(|| photons.thinned(0.2 * DENSE))
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(3));
}
