use super::gradient::{rotational, translational};
use super::hessian::curvature;
use super::strata::Strata;
use super::{
    CacheSettings, ErrorMetric, Hemisphere, HemisphereSample, IrradianceCache, IrradianceRecord, RgbGradient, Site,
    Spacing, summarize,
};
use crate::medium::PathMedium;
use glam::{Vec2, Vec3};
use radiometry::{Rgb, SampleStream, StageKey};
use spatial::Bounds;

const ROOM: Bounds = Bounds {
    min: Vec3::splat(-2.0),
    max: Vec3::splat(2.0),
};

/// A room without a floor that shines: a plate in front of walls of different radiance. What is seen along a ray.
fn seen(origin: Vec3, direction: Vec3) -> (f32, f32) {
    let plate = (1.0 - origin.z) / direction.z;
    let on_plate = origin + direction * plate;
    if direction.z > 0.0 && on_plate.x > 0.3 && on_plate.x < 1.5 && on_plate.y.abs() < 0.8 {
        return (2.0, plate);
    }
    let wall = |axis: usize| {
        let side = if direction[axis] > 0.0 { 2.0 } else { -2.0 };
        (side - origin[axis]) / direction[axis]
    };
    let distance = wall(0).min(wall(1)).min(wall(2));
    let hit = origin + direction * distance;
    (1.0 + 0.3 * hit.x + 0.1 * hit.y, distance)
}

/// What rays through the middles of all cells see.
fn look(hemisphere: &Hemisphere, origin: Vec3, normal: Vec3) -> Vec<HemisphereSample> {
    let frame = radiometry::Frame::from_normal(normal);
    let sample = |ray: u32| {
        let (ring, cell) = (ray / hemisphere.cells(), ray % hemisphere.cells());
        let direction = frame.world_from_local(hemisphere.direction(ring, cell, Vec2::splat(0.5)));
        let (radiance, distance) = seen(origin, direction);
        HemisphereSample {
            radiance: Rgb::splat(radiance),
            inverse_distance: 1.0 / distance,
        }
    };
    (0..hemisphere.rays()).map(sample).collect()
}

/// E of the first channel by very many rays.
fn irradiance(origin: Vec3, normal: Vec3) -> f32 {
    let hemisphere = Hemisphere::of_rays(400_000);
    let samples = look(&hemisphere, origin, normal);
    let sum: f64 = samples.iter().map(|sample| f64::from(sample.radiance.r)).sum();
    (sum * f64::from(hemisphere.weight())) as f32
}

#[test]
fn a_hemisphere_has_square_cells_and_the_cosine_of_a_lambertian_surface() {
    let hemisphere = Hemisphere::of_rays(1000);
    assert_eq!(
        (hemisphere.rings(), hemisphere.cells(), hemisphere.rays()),
        (18, 56, 1008)
    );
    let stream = |ray| SampleStream::new(3, StageKey::new("hemisphere"), 0, ray).draw_2d(0, 0);
    let mean: f32 = (0..hemisphere.rays())
        .map(|ray| hemisphere.direction(ray / 56, ray % 56, stream(ray)))
        .inspect(|direction| assert!((direction.length() - 1.0).abs() < 1e-5 && direction.z >= 0.0))
        .map(|direction| direction.z * hemisphere.weight())
        .sum();
    // ∫ cos²θ dω = 2π/3.
    assert!((mean - std::f32::consts::TAU / 3.0).abs() < 2e-3, "{mean}");
    assert_eq!(Hemisphere::of_rays(0).rays(), 6);
}

#[test]
fn gradients_are_the_differences_of_irradiance() {
    let (origin, normal) = (Vec3::new(0.1, 0.2, 0.0), Vec3::Z);
    let hemisphere = Hemisphere::of_rays(40_000);
    let samples = look(&hemisphere, origin, normal);
    let (turn, step) = (
        rotational(&hemisphere, &samples),
        translational(&hemisphere, &Strata::new(&hemisphere, &samples)),
    );
    let frame = radiometry::Frame::from_normal(normal);
    for axis in [Vec3::X, Vec3::Y] {
        let small = 0.02;
        let turned = |sign: f32| (normal + axis.cross(normal) * (sign * small)).normalize();
        let expected = (irradiance(origin, turned(1.0)) - irradiance(origin, turned(-1.0))) / (2.0 * small);
        let found = frame.world_from_local(turn.0[0]).dot(axis);
        assert!(
            (found - expected).abs() < 0.03,
            "turning about {axis}: {found}, not {expected}"
        );
        let moved = |sign: f32| origin + axis * (sign * 0.05);
        let expected = (irradiance(moved(1.0), normal) - irradiance(moved(-1.0), normal)) / 0.1;
        let found = frame.world_from_local(step.0[0]).dot(axis);
        // The nearer of two cells stands for their border, which is off where a wall is seen at a slant.
        assert!(
            (found - expected).abs() < 0.1,
            "moving along {axis}: {found}, not {expected}"
        );
    }
}

#[test]
fn curvature_is_the_second_difference_of_irradiance() {
    for origin in [
        Vec3::new(0.1, 0.2, 0.0),
        Vec3::new(1.5, 0.2, 0.0),
        Vec3::new(-1.0, -1.0, 0.5),
        Vec3::new(0.3, 0.7, 0.5),
    ] {
        let step = 0.1;
        let at = |x: f32, y: f32| f64::from(irradiance(origin + Vec3::new(x, y, 0.0) * step, Vec3::Z));
        let twice = |ahead: f64, behind: f64| (ahead + behind - 2.0 * at(0.0, 0.0)) / f64::from(step * step);
        let (xx, yy) = (twice(at(1.0, 0.0), at(-1.0, 0.0)), twice(at(0.0, 1.0), at(0.0, -1.0)));
        let crossed = at(1.0, 1.0) + at(-1.0, -1.0) - at(1.0, -1.0) - at(-1.0, 1.0);
        let xy = crossed / (4.0 * f64::from(step * step));
        let expected = (0.5 * (xx * xx + 2.0 * xy * xy + yy * yy)).sqrt();
        for rays in [1000, 40_000] {
            let hemisphere = Hemisphere::of_rays(rays);
            let found = f64::from(curvature(&Strata::new(
                &hemisphere,
                &look(&hemisphere, origin, Vec3::Z),
            )));
            // It is the root of a root that counts: 60 % off are 13 % of a radius.
            let off = found / expected;
            assert!(
                (0.6..1.6).contains(&off),
                "{origin}, {rays} rays: {found}, not {expected}"
            );
        }
    }
}

#[test]
fn a_room_of_even_light_has_no_curvature() {
    let hemisphere = Hemisphere::of_rays(1000);
    let mut samples = look(&hemisphere, Vec3::new(0.4, -1.0, 0.3), Vec3::Z);
    samples.iter_mut().for_each(|sample| sample.radiance = Rgb::splat(2.0));
    let found = curvature(&Strata::new(&hemisphere, &samples));
    assert!(found < 1e-3, "{found}");
}

#[test]
fn noise_alone_makes_no_gradient() {
    let hemisphere = Hemisphere::of_rays(1000);
    let draw = |ray: u32| SampleStream::new(11, StageKey::new("noise"), 0, ray).draw_1d(0, 0);
    // One ray of twenty sees twenty times as much.
    let sample = |ray: u32| HemisphereSample {
        radiance: Rgb::splat(if draw(ray) < 0.05 { 20.0 } else { 0.0 }),
        inverse_distance: 1.0,
    };
    let samples: Vec<HemisphereSample> = (0..hemisphere.rays()).map(sample).collect();
    let found = translational(&hemisphere, &Strata::new(&hemisphere, &samples))
        .mean()
        .length();
    // E is about π.
    assert!(found < 1.0, "{found}");
}

const SETTINGS: CacheSettings = CacheSettings {
    min_weight: 10.0,
    cell_records: 8,
    gradients: true,
    metric: ErrorMetric::HarmonicMean,
    validity: true,
};

fn record(position: Vec3, range: f32, irradiance: f32) -> IrradianceRecord {
    IrradianceRecord {
        position,
        normal: Vec3::Z,
        irradiance: Rgb::splat(irradiance),
        range,
        nearest: f32::INFINITY,
        ..IrradianceRecord::default()
    }
}

fn cache_of(records: &[IrradianceRecord], gradients: bool) -> IrradianceCache {
    let mut cache = IrradianceCache::new(CacheSettings { gradients, ..SETTINGS }, &ROOM);
    assert_eq!(cache.insert(records), Ok(()));
    cache
}

fn read(cache: &IrradianceCache, position: Vec3, normal: Vec3) -> Option<f32> {
    let told = cache.interpolate(position, normal, |_| true);
    told.map(|told| told.irradiance.r)
}

#[test]
fn a_record_holds_within_a_of_its_range_and_nowhere_else() {
    for gradients in [true, false] {
        let cache = cache_of(&[record(Vec3::ZERO, 1.0, 3.0)], gradients);
        // Where no other is made, and how far it is read.
        let (covered, reach) = (0.1, if gradients { 0.18 } else { 0.1 });
        assert_eq!(read(&cache, Vec3::ZERO, Vec3::Z), Some(3.0));
        assert!(read(&cache, Vec3::X * (reach - 0.001), Vec3::Z).is_some());
        assert_eq!(read(&cache, Vec3::X * (reach + 0.001), Vec3::Z), None);
        assert!(cache.covers(Vec3::X * (covered - 0.001), Vec3::Z, |_| true));
        assert!(!cache.covers(Vec3::X * (covered + 0.001), Vec3::Z, |_| true));
        // √(1 − cos) is sin(θ/2) √2.
        let turned = |error: f32| {
            let angle = 2.0 * radiometry::math::asin(error * std::f32::consts::FRAC_1_SQRT_2);
            let (sin, cos) = radiometry::math::sin_cos(angle);
            Vec3::new(sin, 0.0, cos)
        };
        assert!(read(&cache, Vec3::ZERO, turned(reach - 0.002)).is_some());
        assert_eq!(read(&cache, Vec3::ZERO, turned(reach + 0.002)), None);
        assert_eq!(read(&cache, Vec3::Z * 0.02, Vec3::Z), None, "above its plane");
        assert_eq!(read(&cache, Vec3::Z * -0.02, Vec3::Z), None, "below its plane");
        assert_eq!(read(&cache, Vec3::ZERO, -Vec3::Z), None, "on the other side");
        assert_eq!(read(&cache, Vec3::splat(f32::NAN), Vec3::Z), None);
    }
}

#[test]
fn interpolation_is_continuous_and_between_its_records() {
    let records = [
        record(Vec3::ZERO, 1.0, 3.0),
        record(Vec3::X * 0.08, 1.0, 5.0),
        record(Vec3::X * 0.15, 1.0, 4.0),
    ];
    for gradients in [true, false] {
        let cache = cache_of(&records, gradients);
        let values: Vec<f32> = (0..=1500)
            .map(|i| read(&cache, Vec3::X * (i as f32 * 1e-4), Vec3::Z).expect("covered"))
            .collect();
        assert!(values.iter().all(|v| (3.0..=5.0).contains(v)));
        let jump = values.windows(2).map(|v| (v[1] - v[0]).abs()).fold(0.0, f32::max);
        assert!(jump < 0.1, "{jump}");
    }
}

#[test]
fn records_are_extrapolated_by_their_gradients_and_never_below_zero() {
    let mut steep = record(Vec3::ZERO, 1.0, 1.0);
    steep.translation = RgbGradient([Vec3::X * 5.0; 3]);
    steep.rotation = RgbGradient([Vec3::Y * 2.0; 3]);
    let cache = cache_of(&[steep], true);
    let near = |found: Option<f32>, expected: f32| found.is_some_and(|found| (found - expected).abs() < 1e-4);
    assert!(near(read(&cache, Vec3::X * 0.05, Vec3::Z), 1.25));
    let turned = Vec3::new(0.05, 0.0, 1.0).normalize();
    // n_j × n is y sin 2.9°.
    assert!(near(read(&cache, Vec3::ZERO, turned), 1.0 + 2.0 * turned.x));
    steep.translation = RgbGradient([Vec3::X * 50.0; 3]);
    assert!(near(read(&cache_of(&[steep], true), Vec3::X * -0.05, Vec3::Z), 0.0));
}

#[test]
fn what_a_wall_hides_is_asked_of_records_with_something_near() {
    let mut corner = record(Vec3::ZERO, 0.01, 1.0);
    let blind = |cache: &IrradianceCache| cache.interpolate(Vec3::X * 0.0005, Vec3::Z, |_| false);
    assert!(blind(&cache_of(&[corner], true)).is_some());
    corner.nearest = 0.0004;
    assert!(blind(&cache_of(&[corner], true)).is_none());
}

#[test]
fn widened_records_are_read_no_wider_and_count_for_less() {
    let widened = IrradianceRecord {
        least_range: 0.2,
        translation: RgbGradient([Vec3::X * 10.0; 3]),
        ..record(Vec3::ZERO, 0.05, 1.0)
    };
    let ask = |cache: &IrradianceCache, x: f32| {
        let found = cache.interpolate(Vec3::X * x, Vec3::Z, |_| true);
        found.map(|found| found.irradiance.r)
    };
    let alone = cache_of(&[widened], true);
    // A quarter of the range was found, so the change is a quarter, and at 1/a = 10 the least range reaches 20 mm.
    let value = ask(&alone, 0.01).expect("near");
    assert!((value - 1.025).abs() < 1e-6, "{value}");
    assert!(ask(&alone, 0.0199).is_some() && ask(&alone, 0.0201).is_none());
    assert!(alone.covers(Vec3::X * 0.0199, Vec3::Z, |_| true));
    // One that was not widened is read further than no other is made.
    let other = record(Vec3::X * 0.01, 0.2, 3.0);
    let found = cache_of(&[other], true);
    assert!(ask(&found, 0.045).is_some() && !found.covers(Vec3::X * 0.045, Vec3::Z, |_| true));
    // Weights at the place of the first: the root of a quarter, and that of the other by its distance. Its neighbour has lowered
    // its range.
    let other = record(Vec3::X * 0.004, 0.2, 3.0);
    let reach = (0.05 + 0.004) / SETTINGS.read_weight();
    let rest = 1.0 - (0.004 / reach) * (0.004 / reach);
    let weight = rest * rest;
    let value = ask(&cache_of(&[widened, other], true), 0.0).expect("near");
    let expected = (0.5 + 3.0 * weight) / (0.5 + weight);
    assert!((value - expected).abs() < 1e-5, "{value} {expected}");
}

#[test]
fn ranges_end_where_neighbours_say() {
    let draw = |row: u32| SampleStream::new(8, StageKey::new("ranges"), 0, row).draw_2d(0, 0);
    for metric in [ErrorMetric::HarmonicMean, ErrorMetric::OcclusionHessian] {
        let slope = metric.ranges_per_distance();
        let records: Vec<IrradianceRecord> = (0..300)
            .map(|row| {
                let (place, size) = (draw(row), draw(row + 1000).x);
                record(Vec3::new(place.x, place.y, 0.0), slope * (0.02 + size * size), 1.0)
            })
            .collect();
        let filled = |parts: &[&[IrradianceRecord]]| {
            let mut cache = IrradianceCache::new(CacheSettings { metric, ..SETTINGS }, &ROOM);
            for part in parts {
                assert_eq!(cache.insert(part), Ok(()));
            }
            cache
        };
        for cache in [filled(&[&records]), filled(&[&records[..100], &records[100..]])] {
            let mut lowered = 0;
            for (row, one) in cache.records().iter().enumerate() {
                lowered += usize::from(one.range < records[row].range);
                for (other_row, other) in cache.records().iter().enumerate() {
                    let distance = one.position.distance(other.position);
                    let is_in_range = slope * distance < records[other_row].range;
                    assert!(one.range <= other.range + slope * distance || !is_in_range || row < other_row);
                }
            }
            assert!(lowered > 100, "{lowered}");
        }
    }
}

#[test]
fn a_summary_keeps_its_range_in_bounds() {
    let hemisphere = Hemisphere::of_rays(100);
    let site = Site {
        position: Vec3::ONE,
        normal: Vec3::Y,
        geometric: Vec3::Y,
        error: 0.0,
        pixel: 0.01,
        medium: PathMedium::VACUUM,
    };
    let spacing = Spacing {
        min_pixels: 1.5,
        max_pixels: 40.0,
        most: 7.0,
    };
    let of_metric = |metric: ErrorMetric, inverse_distance: f32, radiance: f32| {
        let sample = HemisphereSample {
            radiance: Rgb::splat(radiance),
            inverse_distance,
        };
        summarize(
            &hemisphere,
            &vec![sample; hemisphere.rays() as usize],
            &site,
            &CacheSettings { metric, ..SETTINGS },
            &spacing,
        )
    };
    let of = |inverse_distance, radiance| of_metric(ErrorMetric::HarmonicMean, inverse_distance, radiance);
    // By the Hessian, even light is the same everywhere, and no light as well.
    for radiance in [1.0, 0.0] {
        let by_hessian = |inverse_distance| of_metric(ErrorMetric::OcclusionHessian, inverse_distance, radiance);
        let room = by_hessian(2.0).expect("sound");
        assert!((room.range - 2.5).abs() < 1e-3, "{radiance}: {}", room.range);
        let outside = by_hessian(0.0).expect("sound");
        assert!((outside.range - 4.0).abs() < 1e-3, "{radiance}: {}", outside.range);
    }
    assert!(of_metric(ErrorMetric::OcclusionHessian, f32::NAN, 1.0).is_none());
    let huge = of_metric(ErrorMetric::OcclusionHessian, 1e-20, 1e30).expect("sound");
    assert!(huge.range.is_finite() && huge.range > 0.0);
    let room = of(0.5, 1.0).expect("sound");
    assert!((room.irradiance.r - std::f32::consts::PI).abs() < 1e-4 && (room.range - 2.0).abs() < 1e-3);
    assert!(room.translation.mean().length() < 1e-3 && room.rotation.mean().length() < 1e-3);
    let outside = of(0.0, 1.0).expect("sound");
    assert!((outside.range - 4.0).abs() < 1e-4, "{}", outside.range);
    let corner = of(1e9, 0.0).expect("sound");
    assert!((corner.effective_range() - 0.15).abs() < 1e-6 && corner.range > 0.0);
    assert!(of(1.0, f32::NAN).is_none() && of(f32::NAN, 1.0).is_none());
    let mut cache = IrradianceCache::new(SETTINGS, &ROOM);
    for hostile in [
        record(Vec3::splat(f32::NAN), 1.0, 1.0),
        record(Vec3::ONE, f32::INFINITY, 1.0),
        record(Vec3::splat(1e9), 1.0, 1.0),
    ] {
        assert!(cache.insert(&[hostile]).is_err() && cache.records().is_empty());
    }
}

#[test]
fn a_restored_cache_tells_what_the_old_one_told() {
    let place = |i: u32| {
        let u = SampleStream::new(5, StageKey::new("places"), 0, i).draw_2d(0, 0);
        Vec3::new(3.0 * u.x - 1.5, 3.0 * u.y - 1.5, 0.0)
    };
    let mut old = cache_of(&[], true);
    // In rounds, so that ranges are lowered again and again.
    for round in 0..20 {
        let of_round = |i: u32| record(place(i), 0.1 + 3.0 * (i % 7) as f32, i as f32);
        let new: Vec<IrradianceRecord> = (round * 10..round * 10 + 10).map(of_round).collect();
        old.insert(&new).unwrap();
    }
    old.rebuild(&ROOM).unwrap();
    let restored = IrradianceCache::restore(old.settings, &ROOM, old.records().to_vec()).unwrap();
    assert_eq!(restored.records(), old.records());
    let at = |cache: &IrradianceCache, i: u32| read(cache, place(i), Vec3::Z);
    assert!((1000..2000).all(|i| at(&restored, i) == at(&old, i)));
    let outside = [record(Vec3::splat(1e6), 1.0, 1.0)];
    assert!(IrradianceCache::restore(old.settings, &ROOM, outside.to_vec()).is_err());
}

#[test]
fn the_density_of_records_adds_up_to_their_number() {
    const STEPS: u32 = 400;
    let records = [(0.0, 0.0, 3.0), (0.2, 0.1, 2.0), (-0.5, 0.4, 4.0)];
    let records = records.map(|(x, y, range)| record(Vec3::new(x, y, 0.0), range, 1.0));
    let cache = cache_of(&records, true);
    let side = 4.0 / STEPS as f32;
    let place =
        |i: u32| Vec3::new((i % STEPS) as f32 + 0.5, (i / STEPS) as f32 + 0.5, 0.0) * side - Vec3::new(2.0, 2.0, 0.0);
    let density = |i: u32| {
        cache
            .interpolate(place(i), Vec3::Z, |_| true)
            .map_or(0.0, |told| told.record_density)
    };
    let count: f32 = (0..STEPS * STEPS).map(|i| density(i) * side * side).sum();
    assert!((count - 3.0).abs() < 0.01, "{count}");
}
