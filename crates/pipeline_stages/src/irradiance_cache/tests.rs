use super::fill::CacheFill;
use super::insert::maintain_octree;
use super::sites::{SAME_NORMAL, thin};
use crate::DefaultStages;
use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_ecs::system::RunSystemOnce;
use glam::{UVec2, Vec3};
use pipeline_core::{CachePass, CorePlugin, Load, Prepare, RenderClock, Report};
use pipeline_data::{BuiltIrradianceCache, IrradianceRecord, RECORD_DEPTHS, RenderRequest};
use radiometry::{SampleStream, StageKey};
use spatial::Bounds;
use std::f64::consts::PI;
use std::path::Path;
use transport::{CacheSettings, ErrorMetric, IrradianceCache, PathMedium, Site};

/// A reference scene through `Load` and `Prepare`, small and with these fields.
fn prepare(scene: &str, fields: &[&str]) -> App {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/references");
    let mut app = App::empty();
    app.add_plugins((CorePlugin, DefaultStages));
    let mut request = RenderRequest {
        scene: folder.join(scene).join("scene.ron"),
        resolution: Some(UVec2::splat(32)),
        samples: Some(1),
        ..RenderRequest::default()
    };
    request.options.sets = fields.iter().map(|field| (*field).to_owned()).collect();
    app.insert_resource(request);
    app.world_mut().run_schedule(Load);
    app.world_mut().run_schedule(Prepare);
    app
}

const CACHE: &str = "/Render.LightTransport.indirect=IrradianceCache";
const RAYS: &str = "/Render.IrradianceCache.rays=256";

/// Runs `CachePass` until nothing is missing, and returns the records that the eye reads by number.
fn fill(app: &mut App) -> Vec<IrradianceRecord> {
    let world = app.world_mut();
    assert_eq!(world.resource::<Report>().errors().join("\n"), "");
    while world.resource::<RenderClock>().records_pending > 0 {
        world.run_schedule(CachePass);
    }
    assert!(!world.contains_resource::<CacheFill>());
    let mut query = world.query::<&IrradianceRecord>();
    let seen = query.iter(world).filter(|entity| entity.depth == 0);
    let mut records: Vec<IrradianceRecord> = seen.copied().collect();
    records.sort_unstable_by_key(|record| record.number);
    records
}

#[test]
fn records_of_a_furnace_hold_what_it_reflects() {
    /// What the mean may be off by. Records read others, so they share an error, which shrinks with rays and seeds.
    const MEAN: f64 = 0.005;
    for (name, albedo) in [("furnace", 0.5), ("furnace80", 0.8)] {
        let mut found: Vec<f64> = Vec::new();
        for seed in ["1", "2", "3"] {
            let seed = format!("/Render.Render.seed={seed}");
            let mut app = prepare(name, &[CACHE, "/Render.IrradianceCache.rays=1000", &seed]);
            let records = fill(&mut app);
            assert!(records.len() > 50, "{name}: {}", records.len());
            found.extend(records.iter().map(|entity| f64::from(entity.record.irradiance.g)));
            let built = app.world().resource::<BuiltIrradianceCache>();
            assert_eq!(built.seen().records().len(), records.len());
            for (record, entity) in built.seen().records().iter().zip(&records) {
                assert_eq!(*record, entity.record, "entities are what is read");
            }
        }
        // L_e = 1 − ρ, so that radiance is 1 everywhere, and ρ of it reflected.
        let expected = PI * albedo;
        let mean = found.iter().sum::<f64>() / found.len() as f64;
        assert!((mean / expected - 1.0).abs() < MEAN, "{name}: {mean}, not {expected}");
    }
}

#[test]
fn the_order_of_entities_decides_nothing() {
    let mut app = prepare("cornell", &[CACHE, "/Render.IrradianceCache.rays=16"]);
    let records = fill(&mut app);
    let settings = CacheSettings {
        min_weight: 10.0,
        cell_records: 8,
        gradients: true,
        metric: ErrorMetric::OcclusionHessian,
        validity: true,
    };
    let world = app.world_mut();
    let built_of = |world: &mut World, order: &[IrradianceRecord]| {
        let mut query = world.query_filtered::<Entity, With<IrradianceRecord>>();
        let old: Vec<Entity> = query.iter(world).collect();
        old.into_iter().for_each(|entity| assert!(world.despawn(entity)));
        let bounds = Bounds {
            min: Vec3::splat(-10.0),
            max: Vec3::splat(10.0),
        };
        world.insert_resource(BuiltIrradianceCache(
            [settings; RECORD_DEPTHS].map(|settings| IrradianceCache::new(settings, &bounds)),
        ));
        world.insert_resource(CacheFill::default());
        world.spawn_batch(order.to_vec());
        world.run_system_once(maintain_octree).unwrap();
        world.resource::<BuiltIrradianceCache>().seen().records().to_vec()
    };
    let first = built_of(world, &records);
    assert_eq!(first.len(), records.len());
    let mut turned = records;
    turned.reverse();
    assert_eq!(built_of(world, &turned), first);
    turned.sort_by_key(|record| radiometry::hash_u64(record.number.into()));
    assert_eq!(built_of(world, &turned), first);
}

#[test]
fn places_of_records_are_spread_out_and_leave_no_gap() {
    const SPACING: f32 = 4.0;
    const PIXEL: f32 = 0.01;
    let draw = |i: u32| SampleStream::new(1, StageKey::new("sites"), 0, i).draw_2d(0, 0);
    let site = |i: u32| {
        let place = draw(i);
        Site {
            position: Vec3::new(place.x, 0.0, place.y),
            normal: if i.is_multiple_of(3) { -Vec3::Y } else { Vec3::Y },
            geometric: Vec3::Y,
            error: 0.0,
            pixel: PIXEL,
            medium: PathMedium::VACUUM,
        }
    };
    let sites: Vec<Site> = (0..3000).map(site).collect();
    let bounds = Bounds {
        min: Vec3::splat(-1.0),
        max: Vec3::splat(1.0),
    };
    let chosen = thin(&sites, SPACING, usize::MAX, &bounds);
    let taken: Vec<&Site> = (sites.iter().zip(&chosen))
        .filter(|(_, takes)| **takes)
        .map(|(site, _)| site)
        .collect();
    let are_close =
        |a: &Site, b: &Site| a.normal.dot(b.normal) > SAME_NORMAL && a.position.distance(b.position) < SPACING * PIXEL;
    for (i, one) in taken.iter().enumerate() {
        assert!(!taken[..i].iter().any(|other| are_close(one, other)));
    }
    assert!(taken.len() > 300, "{}", taken.len());
    assert!(
        sites
            .iter()
            .all(|site| taken.iter().any(|other| are_close(site, other)))
    );
    // Both sides are looked at each for itself.
    assert!(taken.iter().any(|site| site.normal.y < 0.0) && taken.iter().any(|site| site.normal.y > 0.0));
    let few = thin(&sites, SPACING, 10, &bounds);
    assert_eq!(few.iter().filter(|takes| **takes).count(), 10);
    // What is not in the scene gets no record, and keeps none from others.
    let lost = Site {
        position: Vec3::splat(f32::NAN),
        ..sites[0]
    };
    assert_eq!(thin(&[lost, sites[0], lost], SPACING, 9, &bounds), [false, true, false]);
}

#[test]
fn settings_that_do_nothing_are_told_and_those_that_contradict_refused() {
    let told = |fields: &[&str]| {
        let app = prepare("furnace", fields);
        let report = app.world().resource::<Report>();
        let has_cache = app.world().contains_resource::<BuiltIrradianceCache>();
        (report.warnings().join("\n"), report.errors().join("\n"), has_cache)
    };
    let (warnings, errors, has_cache) = told(&[CACHE, RAYS]);
    assert!(
        warnings.is_empty() && errors.is_empty() && has_cache,
        "{warnings}{errors}"
    );
    let (warnings, _, has_cache) = told(&[RAYS]);
    assert!(
        warnings.contains("`LightTransport.indirect` is not `IrradianceCache`") && !has_cache,
        "{warnings}"
    );
    let elsewhere = "/Scene/Camera.IrradianceCache.rays=256";
    let (warnings, _, has_cache) = told(&[CACHE, elsewhere]);
    assert!(warnings.contains("carries no `Render`") && has_cache, "{warnings}");
    let crossed = [
        CACHE,
        "/Render.IrradianceCache.min_spacing=9",
        "/Render.IrradianceCache.max_spacing=3",
    ];
    let (_, errors, _) = told(&crossed);
    assert!(
        errors.contains("`max_spacing` must be at least `min_spacing`, 9, but is 3"),
        "{errors}"
    );
}
