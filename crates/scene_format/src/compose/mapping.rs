//! How an arc carries paths and times from the place that it targets to the place that wrote it.

use super::paths::{PathId, PathTable};
use crate::options::DEEPEST;

/// A change of time: outer = inner × scale + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TimeMap {
    pub(crate) offset: f64,
    pub(crate) scale: f64,
}

impl TimeMap {
    pub(crate) const IDENTITY: Self = Self {
        offset: 0.0,
        scale: 1.0,
    };

    pub(crate) fn apply(self, inner: f64) -> f64 {
        inner * self.scale + self.offset
    }

    /// Applies `inner` first.
    pub(crate) fn after(self, inner: Self) -> Self {
        Self {
            offset: self.apply(inner.offset),
            scale: self.scale * inner.scale,
        }
    }

    pub(crate) fn is_sound(self) -> bool {
        self.offset.is_finite() && self.scale.is_finite() && self.scale > 0.0
    }
}

/// The beginning of a path and what takes its place. What has no partner has no image.
type Pair = (Option<PathId>, Option<PathId>);

/// Carries paths from a source namespace to a target namespace, by the beginnings of paths.
///
/// Of the pairs whose source begins a path, the longest counts. A path whose image lies below the
/// target of a longer pair has no image, since that part of the target belongs to another source:
/// the map can be undone wherever it is defined. The rules are those of `OpenUSD`'s map functions.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PathMap {
    pairs: Vec<Pair>,
    /// Whether paths that no pair covers stay as they are; else they have no image.
    keeps_others: bool,
    pub(crate) time: TimeMap,
}

impl PathMap {
    pub(crate) fn identity() -> Self {
        Self {
            pairs: Vec::new(),
            keeps_others: true,
            time: TimeMap::IDENTITY,
        }
    }

    /// Maps one subtree to another.
    pub(crate) fn subtree(from: PathId, to: PathId, keeps_others: bool, time: TimeMap) -> Self {
        let mut map = Self {
            pairs: vec![(Some(from), Some(to))],
            keeps_others,
            time,
        };
        map.tidy();
        map
    }

    pub(crate) fn keeping_others(&self) -> Self {
        let mut map = Self {
            keeps_others: true,
            ..self.clone()
        };
        map.tidy();
        map
    }

    /// The map without what stays as it is, unless nothing else is left.
    pub(crate) fn dropping_others(&self) -> Self {
        Self {
            keeps_others: self.pairs.is_empty() && self.keeps_others,
            ..self.clone()
        }
    }

    fn is_identity(&self) -> bool {
        self.pairs.is_empty() && self.keeps_others
    }

    /// Carries a path from source to target.
    pub(crate) fn to_target(&self, path: PathId, paths: &mut PathTable) -> Option<PathId> {
        self.carry(path, paths, |pair| pair)
    }

    /// Carries a path from target to source.
    pub(crate) fn to_source(&self, path: PathId, paths: &mut PathTable) -> Option<PathId> {
        self.carry(path, paths, |(from, to)| (to, from))
    }

    fn carry(&self, path: PathId, paths: &mut PathTable, turn: impl Fn(Pair) -> Pair) -> Option<PathId> {
        let mut best: Option<(usize, PathId)> = None;
        for (number, &pair) in self.pairs.iter().enumerate() {
            let Some(from) = turn(pair).0 else {
                continue;
            };
            let longer = best.is_none_or(|(_, other)| paths.steps(from) >= paths.steps(other));
            if longer && paths.has_prefix(path, from) {
                best = Some((number, from));
            }
        }
        let (image, covered) = match best {
            Some((number, from)) => {
                let to = turn(self.pairs[number]).1?;
                (paths.replace_prefix(path, from, to), paths.steps(to))
            }
            None if self.keeps_others => (path, 0),
            None => return None,
        };
        let taken = self.pairs.iter().enumerate().any(|(number, &pair)| {
            let longer = |to: PathId| paths.steps(to) > covered && paths.has_prefix(image, to);
            best.is_none_or(|(other, _)| other != number) && turn(pair).1.is_some_and(longer)
        });
        (!taken).then_some(image)
    }

    /// Applies `inner` first: from the source of `inner` to the target of this map.
    pub(crate) fn after(&self, inner: &Self, paths: &mut PathTable) -> Self {
        let time = self.time.after(inner.time);
        if self.is_identity() {
            return Self { time, ..inner.clone() };
        }
        if inner.is_identity() {
            return Self { time, ..self.clone() };
        }
        let mut pairs: Vec<Pair> = Vec::new();
        // Longer paths name nothing: arcs are written, and lead, where prims can be.
        let can_be = |path: PathId, paths: &PathTable| usize::from(paths.steps(path)) <= 4 * DEEPEST;
        for &(from, to) in &inner.pairs {
            if from.is_some_and(|from| !can_be(from, paths)) {
                continue;
            }
            // What has no image must not be taken for something that stays as it is.
            pairs.push((from, to.and_then(|to| self.to_target(to, paths))));
        }
        for &(from, to) in &self.pairs {
            if let Some(from) = from.and_then(|from| inner.to_source(from, paths))
                && can_be(from, paths)
                && !pairs.iter().any(|&(other, _)| other == Some(from))
            {
                pairs.push((Some(from), to));
            }
        }
        let mut map = Self {
            pairs,
            keeps_others: self.keeps_others && inner.keeps_others,
            time,
        };
        map.drop_idle(paths);
        map.tidy();
        map
    }

    /// The map from target to source.
    pub(crate) fn inverse(&self) -> Self {
        let scale = 1.0 / self.time.scale;
        let mut map = Self {
            pairs: self.pairs.iter().map(|&(from, to)| (to, from)).collect(),
            keeps_others: self.keeps_others,
            time: TimeMap {
                offset: -self.time.offset * scale,
                scale,
            },
        };
        map.tidy();
        map
    }

    /// Drops sources without a target that would have no image anyway.
    fn drop_idle(&mut self, paths: &mut PathTable) {
        let mut number = 0;
        while let Some(&pair) = self.pairs.get(number) {
            let idle = match pair {
                (None, None) => true,
                (Some(from), None) => {
                    self.pairs.remove(number);
                    let image = self.to_target(from, paths);
                    self.pairs.insert(number, pair);
                    image.is_none()
                }
                _ => false,
            };
            if idle {
                self.pairs.remove(number);
            } else {
                number += 1;
            }
        }
    }

    /// Puts the pairs in one order, so that equal maps compare equal.
    fn tidy(&mut self) {
        self.pairs.sort_unstable();
        self.pairs.dedup();
        if self.keeps_others && self.pairs.iter().all(|(from, to)| from == to) {
            self.pairs.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reference_maps_its_subtree_only() {
        let mut paths = PathTable::default();
        let [a, k, w, other] = ["/A", "/A/K", "/W", "/B"].map(|text| paths.intern(text));
        let map = PathMap::subtree(a, w, false, TimeMap::IDENTITY);
        let image = map.to_target(k, &mut paths).unwrap();
        assert_eq!(paths.text(image), "/W/K");
        assert_eq!(map.to_target(other, &mut paths), None);
        assert_eq!(map.to_source(w, &mut paths), Some(a));
        assert_eq!(map.inverse().to_target(w, &mut paths), Some(a));
    }

    #[test]
    fn a_class_leaves_the_rest_but_not_its_instance() {
        let mut paths = PathTable::default();
        let [class, instance, other] = ["/C", "/W", "/B"].map(|text| paths.intern(text));
        let map = PathMap::subtree(class, instance, true, TimeMap::IDENTITY);
        assert_eq!(map.to_target(class, &mut paths), Some(instance));
        assert_eq!(map.to_target(other, &mut paths), Some(other));
        assert_eq!(
            map.to_target(instance, &mut paths),
            None,
            "it would be taken for the class"
        );
    }

    #[test]
    fn maps_and_times_compose() {
        let mut paths = PathTable::default();
        let [a, b, c, k] = ["/A", "/B", "/C", "/A/K"].map(|text| paths.intern(text));
        let time = |offset, scale| TimeMap { offset, scale };
        let inner = PathMap::subtree(a, b, false, time(10.0, 2.0));
        let outer = PathMap::subtree(b, c, false, time(1.0, 3.0));
        let both = outer.after(&inner, &mut paths);
        let image = both.to_target(k, &mut paths).unwrap();
        assert_eq!(paths.text(image), "/C/K");
        assert_eq!(both.time.apply(5.0), outer.time.apply(inner.time.apply(5.0)));
        let back = both.inverse();
        assert_eq!(back.to_target(c, &mut paths), Some(a));
        assert!((back.time.apply(both.time.apply(7.0)) - 7.0).abs() < 1e-12);
        assert_eq!(both.after(&PathMap::identity(), &mut paths), both);
    }
}
