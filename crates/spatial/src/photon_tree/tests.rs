//! Queries against brute force, on the point sets that break trees.

use glam::Vec3;
use proptest::prelude::*;

use super::{NearestScratch, Neighbour, PhotonTree, PhotonTreeError};

/// A few coordinates that repeat, next to arbitrary ones: ties and degenerate boxes.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        3 => -1.0_f32..1.0,
        1 => prop::sample::select(vec![-1.0_f32, -0.5, -0.0, 0.0, 0.25, 1.0]),
    ]
}

fn point() -> impl Strategy<Value = Vec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(Vec3::from)
}

/// Random, clustered, duplicated, collinear, planar and lattice points.
fn points() -> impl Strategy<Value = Vec<Vec3>> {
    let many = || prop::collection::vec(point(), 0..700);
    prop_oneof![
        many(),
        (many(), point()).prop_map(|(v, c)| v.into_iter().map(|p| c + p * 1e-4).collect()),
        (point(), 0_usize..700).prop_map(|(p, n)| vec![p; n]),
        (many(), point()).prop_map(|(v, axis)| v.into_iter().map(|p| axis * p.x).collect()),
        (many(), coordinate()).prop_map(|(v, y)| v.into_iter().map(|p| p.with_y(y)).collect()),
        many().prop_map(|v| v.into_iter().map(|p| (p * 3.0).round()).collect()),
        many().prop_map(|v| v.into_iter().map(|p| p * 1e-22).collect()),
        many().prop_map(|v| v.into_iter().map(|p| p * 3e38).collect()),
    ]
}

fn dist_sq(p: Vec3, photon: Vec3) -> f32 {
    let d = photon - p;
    d.x * d.x + d.y * d.y + d.z * d.z
}

/// Returns `(squared distance, row)` of all photons within a radius that are accepted, nearest first.
fn brute_force(photons: &[Vec3], p: Vec3, radius: f32, accept: impl Fn(Vec3) -> bool) -> Vec<(f32, u32)> {
    let mut found: Vec<(f32, u32)> = photons
        .iter()
        .zip(0..)
        .map(|(&photon, row)| (dist_sq(p, photon), row))
        .filter(|&(d, row)| d <= radius * radius && accept(photons[row as usize] - p))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    found
}

fn by_row(tree: &PhotonTree, photon: Neighbour) -> (f32, u32) {
    (photon.dist_sq, tree.rows()[photon.slot as usize])
}

fn sorted(mut found: Vec<(f32, u32)>) -> Vec<(f32, u32)> {
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    found
}

/// A field of photons without a pattern, without a generator's crate.
fn scattered(count: u32) -> Vec<Vec3> {
    let unit = |n: u32| (n.wrapping_mul(0x9e37_79b9) >> 8) as f32 / (1 << 24) as f32;
    (0..count)
        .map(|i| Vec3::new(unit(3 * i), unit(5 * i + 1).powi(2), unit(i ^ (i << 7)).round()))
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn finds_what_brute_force_finds(
        photons in points(),
        from in any::<prop::sample::Index>(),
        p in point(),
        at_photon in any::<bool>(),
        k in prop_oneof![0_usize..4, 1_usize..120, 500_usize..900],
        radius in prop_oneof![Just(f32::INFINITY), Just(0.0_f32), 0.0_f32..2.0, Just(1e-4_f32)],
        modulus in 1_u32..4,
    ) {
        let tree = PhotonTree::build(&photons).expect("finite");
        prop_assert_eq!(tree.validate(), Ok(()));
        let p = match at_photon && !photons.is_empty() {
            true => photons[from.index(photons.len())],
            false => p,
        };
        let mut scratch = NearestScratch::new();
        // The second time round, the scratch memory has seen use.
        for _ in 0..2 {
            let all = brute_force(&photons, p, radius, |_| true);
            let nearest = tree.nearest(p, k, radius, &mut scratch);
            let found: Vec<_> = nearest.iter().map(|photon| by_row(&tree, photon)).collect();
            let expected = &all[..k.min(all.len())];
            prop_assert_eq!(sorted(found), expected);
            let kth = nearest.kth().map(|photon| by_row(&tree, photon));
            prop_assert_eq!(kth, (k > 0).then(|| all.get(k - 1).copied()).flatten());
            let inside: Vec<_> = nearest.inside().map(|photon| by_row(&tree, photon)).collect();
            prop_assert_eq!(sorted(inside), &expected[..expected.len() - usize::from(kth.is_some())]);

            let accept = |offset: Vec3| offset.x.to_bits().is_multiple_of(modulus);
            let some = brute_force(&photons, p, radius, accept);
            let mut told = true;
            let nearest = tree.nearest_where(p, k, radius, |slot, offset, d| {
                told &= offset == tree.position(slot) - p && d == dist_sq(p, tree.position(slot));
                accept(offset)
            }, &mut scratch);
            let found: Vec<_> = nearest.iter().map(|photon| by_row(&tree, photon)).collect();
            prop_assert_eq!(sorted(found), &some[..k.min(some.len())]);
            prop_assert!(told, "the predicate was given a wrong offset or distance");
        }
        let mut found = Vec::new();
        tree.within(p, radius, |slot, _, d| found.push((d, tree.rows()[slot as usize])));
        prop_assert_eq!(sorted(found), brute_force(&photons, p, radius, |_| true));
    }

    #[test]
    fn keeps_positions_bit_for_bit(photons in points()) {
        let tree = PhotonTree::build(&photons).expect("finite");
        let mut in_query_order = Vec::new();
        tree.in_query_order(&photons, &mut in_query_order);
        prop_assert_eq!(in_query_order.len(), tree.len());
        for (slot, photon) in (0..).zip(in_query_order) {
            prop_assert_eq!(tree.position(slot).to_array().map(f32::to_bits), photon.to_array().map(f32::to_bits));
        }
    }
}

#[test]
fn is_the_same_tree_at_any_number_of_threads() {
    let photons = scattered(70_001);
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads can be started")
            .install(|| PhotonTree::build(&photons).expect("finite"))
    };
    let one = build(1);
    one.validate().expect("valid");
    let p = Vec3::new(0.4, 0.1, 1.0);
    let mut scratch = NearestScratch::new();
    let order: Vec<Neighbour> = one.nearest(p, 321, 1.0, &mut scratch).iter().collect();
    assert_eq!(order.len(), 321);
    for threads in [2, 3] {
        let other = build(threads);
        assert_eq!(one.rows, other.rows);
        // Debug formatting tells apart all floats but NaN payloads.
        assert_eq!(format!("{:?}", one.nodes), format!("{:?}", other.nodes));
        assert_eq!(format!("{:?}", one.buckets), format!("{:?}", other.buckets));
        let same: Vec<Neighbour> = other.nearest(p, 321, 1.0, &mut scratch).iter().collect();
        assert_eq!(order, same);
    }
}

#[test]
fn one_point_many_times_is_not_searched_whole() {
    let photons = vec![Vec3::ONE; 100_000];
    let tree = PhotonTree::build(&photons).expect("finite");
    tree.validate().expect("valid");
    let mut seen = 0;
    let mut scratch = NearestScratch::new();
    let accept = |_: u32, _: Vec3, _: f32| {
        seen += 1;
        true
    };
    let nearest = tree.nearest_where(Vec3::ZERO, 50, 10.0, accept, &mut scratch);
    let mut rows: Vec<u32> = nearest.iter().map(|photon| by_row(&tree, photon).1).collect();
    rows.sort_unstable();
    assert_eq!(rows, (0..50).collect::<Vec<_>>());
    assert!(seen < 500, "{seen} photons were looked at");
}

#[test]
fn refuses_positions_that_are_not_finite() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut photons = scattered(40_000);
        photons[39_000].z = bad;
        photons[20_007].y = bad;
        let error = PhotonTree::build(&photons).expect_err("a coordinate is not finite");
        assert_eq!(error, PhotonTreeError::NotFinite { row: 20_007 });
    }
}

#[test]
fn refuses_more_photons_than_rows() {
    let len = u32::MAX as usize;
    let error = PhotonTree::from_fn(len, |_| Vec3::ZERO).expect_err("too many");
    assert_eq!(error, PhotonTreeError::TooMany { len });
}

#[test]
fn senseless_queries_find_nothing() {
    let tree = PhotonTree::build(&scattered(1000)).expect("finite");
    let mut scratch = NearestScratch::new();
    let mut found = |p, k, radius| {
        let mut within = 0;
        tree.within(p, radius, |_, _, _| within += 1);
        let nearest = tree.nearest(p, k, radius, &mut scratch);
        assert!(nearest.is_empty() && nearest.kth().is_none());
        within
    };
    assert_eq!(found(Vec3::ZERO, 5, -1.0), 0);
    assert_eq!(found(Vec3::ZERO, 5, f32::NAN), 0);
    assert_eq!(found(Vec3::NAN, 5, f32::INFINITY), 0);
    assert_eq!(found(Vec3::ZERO, 0, 100.0), 1000);
}

#[test]
fn validation_notices_damage() {
    let sound = PhotonTree::build(&scattered(5000)).expect("finite");
    let damaged: [fn(&mut PhotonTree); 6] = [
        |tree| tree.rows.swap(0, 1),
        |tree| tree.rows[7] = tree.rows[6],
        |tree| tree.buckets[3].axes[1][5] += 2.0,
        |tree| tree.buckets[3].axes[1][5] = f32::NAN,
        |tree| tree.nodes[2].first_row[1] += 1,
        |tree| tree.levels[1] += 1,
    ];
    for damage in damaged {
        let mut tree = sound.clone();
        damage(&mut tree);
        assert!(tree.validate().is_err());
    }
}

/// Positions and rows are 16 bytes; the nodes may take a twelfth of that.
const BYTES_A_PHOTON: f64 = 17.4;

#[test]
fn stays_within_its_memory() {
    for count in [50_000, 65_536, 65_537] {
        let tree = PhotonTree::build(&scattered(count)).expect("finite");
        let bytes = tree.memory_bytes() as f64 / f64::from(count);
        assert!(bytes < BYTES_A_PHOTON, "{bytes} bytes a photon");
    }
}
