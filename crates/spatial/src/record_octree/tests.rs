use super::{FREE_PLACES, PLACES_PER_RECORD, RecordOctree, RecordOctreeError};
use crate::Bounds;
use glam::Vec3;
use radiometry::{SampleStream, StageKey};

const ROOM: Bounds = Bounds {
    min: Vec3::new(-1.0, 0.0, -3.0),
    max: Vec3::new(2.0, 2.5, 1.0),
};

/// A place in the room and a number in [0, 1), by row.
fn draw(seed: u64, row: u32) -> (Vec3, f32) {
    let stream = SampleStream::new(seed, StageKey::new("octree"), 0, row);
    let (xy, zw) = (stream.draw_2d(0, 0), stream.draw_2d(0, 1));
    let size = ROOM.max - ROOM.min;
    (ROOM.min + size * Vec3::new(xy.x, xy.y, zw.x), zw.y)
}

/// Spheres whose radii spread over three orders of magnitude, half of them on the floor.
fn spheres(count: u32) -> Vec<(Vec3, f32)> {
    let sphere = |row: u32| {
        let (mut position, u) = draw(1, row);
        if row.is_multiple_of(2) {
            position.y = 0.0;
        }
        (position, 0.001 + u * u * u)
    };
    (0..count).map(sphere).collect()
}

fn octree_of(spheres: &[(Vec3, f32)], cell_records: usize) -> RecordOctree {
    let mut octree = RecordOctree::new(&ROOM, cell_records);
    for (row, (position, radius)) in spheres.iter().enumerate() {
        assert_eq!(octree.insert(*position, *radius), Ok(row as u32));
    }
    octree
}

/// What [`RecordOctree::containing`] must find.
fn by_force(spheres: &[(Vec3, f32)], p: Vec3) -> Vec<u32> {
    let holds = |(position, radius): &(Vec3, f32)| position.distance_squared(p) < radius * radius;
    let rows = (0_u32..).zip(spheres).filter(|(_, sphere)| holds(sphere));
    rows.map(|(row, _)| row).collect()
}

#[test]
fn a_point_finds_just_the_spheres_that_contain_it() {
    let spheres = spheres(1500);
    for cell_records in [1, 2, 8, 40] {
        let octree = octree_of(&spheres, cell_records);
        assert_eq!(octree.validate(), Ok(()));
        let mut found_any = 0;
        for row in 0..2000 {
            let p = match row % 3 {
                0 => draw(2, row).0,
                1 => spheres[row as usize % spheres.len()].0,
                _ => draw(2, row).0 * Vec3::new(1.0, 0.0, 1.0),
            };
            let expected = by_force(&spheres, p);
            found_any += usize::from(!expected.is_empty());
            let mut found: Vec<u32> = octree.containing(p).collect();
            found.sort_unstable();
            assert_eq!(found, expected, "{p}");
        }
        assert!(found_any > 1000, "{found_any}");
    }
}

#[test]
fn leaves_are_cut_where_that_separates() {
    let octree = octree_of(&spheres(4000), 8);
    let mean = |octree: &RecordOctree| {
        let sum: usize = (0..1000).map(|row| octree.candidates(draw(3, row).0).count()).sum();
        sum as f64 / 1000.0
    };
    let small: Vec<_> = spheres(4000).iter().map(|(p, r)| (*p, 0.05 * r)).collect();
    let (large, small) = (mean(&octree), mean(&octree_of(&small, 8)));
    assert!(small < 8.0 && large > small, "{small} {large}");
}

#[test]
fn the_same_insertions_give_the_same_tree() {
    let spheres = spheres(700);
    let (one, other) = (octree_of(&spheres, 4), octree_of(&spheres, 4));
    for row in 0..500 {
        let p = draw(4, row).0;
        assert!(one.candidates(p).eq(other.candidates(p)));
    }
    assert_eq!((one.nodes.len(), one.places), (other.nodes.len(), other.places));
}

#[test]
fn spheres_that_hold_nothing_are_refused() {
    let mut octree = RecordOctree::new(&ROOM, 8);
    for radius in [0.0, -1.0, f32::INFINITY, f32::NAN] {
        assert_eq!(octree.insert(Vec3::ONE, radius), Err(RecordOctreeError::BadRadius));
    }
    for bad in [f32::NAN, f32::INFINITY] {
        let position = Vec3::new(0.0, bad, 0.0);
        assert_eq!(octree.insert(position, 1.0), Err(RecordOctreeError::PositionNotFinite));
        assert!(octree.candidates(position).next().is_none());
    }
    for far in [100.0, 1e30] {
        assert_eq!(octree.insert(Vec3::splat(far), 1.0), Err(RecordOctreeError::Outside));
    }
    assert!(octree.is_empty() && octree.candidates(Vec3::splat(100.0)).next().is_none());
    assert_eq!(octree.validate(), Ok(()));
}

#[test]
fn memory_is_bounded_whatever_the_spheres() {
    let n = 3000;
    let (origin, far) = (Vec3::new(0.3, 1.0, -1.0), 1e4);
    type SphereOf = fn(u32) -> (Vec3, f32);
    let hostile: [(&str, SphereOf); 4] = [
        ("one place", |_| (Vec3::new(0.3, 1.0, -1.0), 1e-3)),
        ("one place, tiny", |_| (Vec3::new(0.3, 1.0, -1.0), 1e-30)),
        ("all over everything", |row| (draw(5, row).0, 100.0)),
        ("tiny among large", |row| {
            (draw(6, row).0, if row.is_multiple_of(2) { 1e-6 } else { 3.0 })
        }),
    ];
    for (label, sphere) in hostile {
        let octree = octree_of(&(0..n).map(sphere).collect::<Vec<_>>(), 2);
        assert_eq!(octree.validate(), Ok(()), "{label}");
        let most = FREE_PLACES + (PLACES_PER_RECORD + 8) * n as usize;
        assert!(octree.places <= most, "{label}: {}", octree.places);
        // Nodes without records are at most seven for each with some.
        assert!(octree.nodes.len() <= 8 * (octree.places + 1), "{label}");
        assert!(octree.candidates(origin).count() <= n as usize);
    }
    let at_the_limit = Bounds {
        min: Vec3::splat(far),
        max: Vec3::splat(far),
    };
    let mut octree = RecordOctree::new(&at_the_limit, 1);
    for _ in 0..100 {
        assert!(octree.insert(Vec3::splat(far), 1e-9).is_ok());
    }
    assert_eq!(octree.containing(Vec3::splat(far)).count(), 100);
    assert_eq!(octree.validate(), Ok(()));
    assert!(RecordOctree::new(&Bounds::EMPTY, 0).insert(Vec3::ZERO, 1.0).is_ok());
}
