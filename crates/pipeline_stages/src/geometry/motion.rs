//! Where prims are while the shutter is open: transforms at as many times as it takes for straight lines between them.

use super::placement::{PlacementError, place};
use bevy_reflect::PartialReflect;
use glam::{DAffine3, DVec3};
use pipeline_data::ShutterInterval;
use pipeline_data::vocabulary::{LookAt, Transform};
use scene_format::{Scene, Schema};
use spatial::straight_between;
use std::collections::BTreeMap;

/// Most intervals between two keys.
const MOST_INTERVALS: usize = 128;
/// Most keys of all prims together; where very many move, each has fewer.
const MOST_KEYS: usize = 1 << 22;
/// Where an interval is looked at beside its middle: a share that no period of a motion has with that.
const SECOND_PROBE: f64 = 0.381_966_011_250_105;
/// How far a place in a prim may be off the way it really takes, as a share of its distance from the prim's origin, and
/// of the way itself.
const TOLERANCE: f64 = 1e-4;

/// The keys of each prim that moves, by row of the scene. A prim that cannot be placed at some time is in `errors`.
#[derive(Default)]
pub(super) struct Motions {
    pub(super) keys: BTreeMap<u32, Vec<DAffine3>>,
    pub(super) errors: Vec<(u32, PlacementError)>,
}

/// World transforms of all moving prims at one time.
type Worlds = BTreeMap<u32, DAffine3>;

struct Clock<'a> {
    scene: &'a Scene,
    schema: &'a Schema<'a>,
    shutter: ShutterInterval,
    /// Parents before children.
    moving: Vec<u32>,
    still: &'a [Option<DAffine3>],
    errors: Vec<(u32, PlacementError)>,
}

/// Finds the keys of every prim whose place, or that of a prim above it, changes over time.
///
/// - `placed`: rows of all prims with entities, parents before children.
/// - `still`: world transform of each row at the frame; `None` where there was an error.
pub(super) fn find_motions(
    scene: &Scene,
    schema: &Schema<'_>,
    shutter: ShutterInterval,
    placed: &[u32],
    still: &[Option<DAffine3>],
) -> Motions {
    let mut moves = vec![false; scene.prims.len()];
    let mut moving = Vec::new();
    for row in placed.iter().copied().filter(|row| still[*row as usize].is_some()) {
        let parent_moves = scene.prims[row as usize].parent.is_some_and(|parent| moves[parent]);
        if parent_moves || changes(scene, row) {
            moves[row as usize] = true;
            moving.push(row);
        }
    }
    if moving.is_empty() || shutter.close <= shutter.open {
        return Motions::default();
    }
    let most = (MOST_KEYS / moving.len()).clamp(1, MOST_INTERVALS);
    let mut clock = Clock {
        scene,
        schema,
        shutter,
        moving,
        still,
        errors: Vec::new(),
    };
    let times = clock.worlds(most);
    clock.collect(&times)
}

/// True when the scene gives samples for where a prim is.
fn changes(scene: &Scene, row: u32) -> bool {
    ["Transform", "LookAt"].iter().any(|component| {
        scene.prims[row as usize]
            .component(component)
            .is_some_and(|found| found.fields.iter().any(|field| field.samples().is_some()))
    })
}

impl Clock<'_> {
    /// The world at evenly spaced times, halved until all ways are straight between them.
    fn worlds(&mut self, most: usize) -> Vec<Worlds> {
        let first = self.first_intervals().min(1 << most.ilog2());
        let mut times: Vec<Worlds> = (0..=first).map(|i| self.at(i as f64 / first as f64)).collect();
        while self.errors.is_empty() {
            let intervals = times.len() - 1;
            let within = |i: usize, share: f64| (i as f64 + share) / intervals as f64;
            let between: Vec<Worlds> = (0..intervals).map(|i| self.at(within(i, 0.5))).collect();
            let straight = (0..intervals).all(|i| is_straight(&times[i], &between[i], &times[i + 1], 0.5))
                && (0..intervals).all(|i| {
                    is_straight(
                        &times[i],
                        &self.at(within(i, SECOND_PROBE)),
                        &times[i + 1],
                        SECOND_PROBE,
                    )
                });
            if straight || 2 * intervals > most {
                break;
            }
            let mut all = Vec::with_capacity(2 * intervals + 1);
            for (before, after) in times.into_iter().zip(between.into_iter().map(Some).chain([None])) {
                all.push(before);
                all.extend(after);
            }
            times = all;
        }
        times
    }

    /// A power of two of intervals, none longer than the time between two samples that the scene gives, or than a
    /// quarter of a turn takes.
    fn first_intervals(&self) -> usize {
        let (open, close) = (self.shutter.open, self.shutter.close);
        let mut least = 1.0_f64;
        for row in &self.moving {
            for component in ["Transform", "LookAt"] {
                let Some(found) = self.scene.prims[*row as usize].component(component) else {
                    continue;
                };
                for field in &found.fields {
                    let Some(samples) = field.samples() else { continue };
                    let mut degrees = 0.0;
                    for pair in samples.windows(2) {
                        let [(start, before), (end, after)] = pair else {
                            continue;
                        };
                        let shared = end.min(close) - start.max(open);
                        if shared <= 0.0 {
                            continue;
                        }
                        least = least.max((close - open) / (end - start));
                        let angles = |value: &dyn PartialReflect| value.try_downcast_ref::<DVec3>().copied();
                        if let ("rotate", Some(before), Some(after)) = (field.name, angles(&**before), angles(&**after))
                        {
                            degrees += (after - before).abs().max_element() * shared / (end - start);
                        }
                    }
                    least = least.max(degrees / 90.0);
                }
            }
        }
        (least.min(MOST_INTERVALS as f64).ceil() as usize).next_power_of_two()
    }

    /// - `share`: of the time that the shutter is open.
    fn at(&mut self, share: f64) -> Worlds {
        let time = self.shutter.open + share * (self.shutter.close - self.shutter.open);
        let mut worlds = Worlds::new();
        for row in &self.moving {
            let parent = match self.scene.prims[*row as usize].parent {
                None => Some(DAffine3::IDENTITY),
                Some(parent) => worlds.get(&(parent as u32)).copied().or(self.still[parent]),
            };
            let Some(parent) = parent else { continue };
            let transform: Option<Transform> = self.component(*row, "Transform", time);
            let look_at: Option<LookAt> = self.component(*row, "LookAt", time);
            match place(&parent, transform.as_ref(), look_at.as_ref()) {
                Ok(world) => {
                    worlds.insert(*row, world);
                }
                Err(error) => self.errors.push((*row, error)),
            }
        }
        worlds
    }

    fn component<T: bevy_reflect::Reflect>(&self, row: u32, name: &str, time: f64) -> Option<T> {
        let found = self.scene.prims[row as usize].component(name)?;
        let built = found.build(self.schema, time).downcast::<T>();
        built.ok().map(|built| *built)
    }

    fn collect(mut self, times: &[Worlds]) -> Motions {
        self.errors.dedup();
        let mut motions = Motions {
            errors: self.errors,
            ..Motions::default()
        };
        for row in self.moving {
            let keys: Option<Vec<DAffine3>> = times.iter().map(|worlds| worlds.get(&row).copied()).collect();
            if let Some(keys) = keys {
                motions.keys.insert(row, without_needless(keys));
            }
        }
        motions
    }
}

/// Two keys where all others lie on the straight way between them.
fn without_needless(keys: Vec<DAffine3>) -> Vec<DAffine3> {
    let (first, last) = (keys[0], keys[keys.len() - 1]);
    let share = |i: usize| i as f64 / (keys.len() - 1) as f64;
    let straight = |i: usize| deviates(&straight_between(&first, &last, share(i)), &keys[i], &first, &last) <= 1e-9;
    if (1..keys.len() - 1).all(straight) {
        vec![first, last]
    } else {
        keys
    }
}

/// - `share`: of the way at which `between` is.
fn is_straight(before: &Worlds, between: &Worlds, after: &Worlds, share: f64) -> bool {
    between
        .iter()
        .all(|(row, exact)| match (before.get(row), after.get(row)) {
            (Some(before), Some(after)) => {
                deviates(&straight_between(before, after, share), exact, before, after) <= TOLERANCE
            }
            _ => true,
        })
}

/// How far two placements are apart, in units of the prim's own size and of the way from `before` to `after`.
fn deviates(found: &DAffine3, exact: &DAffine3, before: &DAffine3, after: &DAffine3) -> f64 {
    let axes = |m: &DAffine3| [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis];
    let turned = axes(found)
        .into_iter()
        .zip(axes(exact))
        .map(|(a, b): (DVec3, DVec3)| (a - b).length() / b.length())
        .fold(0.0, f64::max);
    let size = axes(exact).map(|axis| axis.length()).into_iter().fold(0.0, f64::max);
    let way = before.translation.distance(after.translation);
    turned.max(found.translation.distance(exact.translation) / (size + way))
}
