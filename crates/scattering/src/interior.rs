/// A medium that a path is inside of: a row of a table, and how it ranks where media overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interior {
    /// Row of the material, as the caller counts.
    pub medium: u32,
    /// Higher wins where two overlap. Equal ones nest: the one entered last wins.
    pub priority: i8,
}

/// What a surface between media is to a path that passes through it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crossing {
    /// The path is in a medium of higher priority: there is no interface here. It goes straight on, and the list is told.
    Hidden,
    /// An interface between two media; `None` is the vacuum.
    Interface {
        /// On the side that the path comes from.
        from: Option<u32>,
        /// On the side behind the surface.
        to: Option<u32>,
    },
}

/// The media around a path, of which the one that ranks highest is the one it travels in. 28 bytes, no allocation.
///
/// Media may nest (a bubble in ice in water) and may overlap: a drink is modelled a little larger than the inside of its
/// glass, and the glass, of higher priority, cuts it off, so that no thin gap of air and no doubled surface is left
/// between them. The index of refraction and the absorption along a ray are those of [`InteriorList::current`]; at a
/// surface [`InteriorList::crossing`] says between which two media it lies, or that it is hidden. A path that reflects
/// leaves the list as it is; one that passes calls [`InteriorList::pass`].
///
/// Source: Schmidt and Budge, "Simple Nested Dielectrics in Ray Traced Images", Journal of Graphics Tools 7(2), 2002.
/// Differs: equal priorities nest, so that scenes which give none work where closed surfaces lie within each other.
///
/// More than [`InteriorList::CAPACITY`] at once: of all, the one that would rank last is forgotten, since it takes the
/// longest to matter, and [`InteriorList::has_overflowed`] stays true, for a warning. Leaving a medium that the list does
/// not hold, because it was forgotten or because the path began inside of it, does nothing. The same medium may be in the
/// list more than once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InteriorList {
    /// By rank, the lowest first: the last of `len` is the one that counts.
    media: [u32; Self::CAPACITY],
    priorities: [i8; Self::CAPACITY],
    len: u8,
    overflowed: bool,
}

const _: () = assert!(size_of::<InteriorList>() <= 28);

impl InteriorList {
    /// Most media that a path can be in at once.
    pub const CAPACITY: usize = 5;

    /// A path in the vacuum.
    pub const VACUUM: Self = Self {
        media: [0; Self::CAPACITY],
        priorities: [0; Self::CAPACITY],
        len: 0,
        overflowed: false,
    };

    /// The medium that the path travels in; `None` in the vacuum.
    #[inline]
    #[must_use]
    pub fn current(&self) -> Option<u32> {
        self.ranked(0).map(|(medium, _)| medium)
    }

    /// True when a medium had to be forgotten.
    #[must_use]
    pub fn has_overflowed(&self) -> bool {
        self.overflowed
    }

    /// The medium on a rank, 0 for the highest.
    #[inline]
    fn ranked(&self, rank: usize) -> Option<(u32, i8)> {
        let index = usize::from(self.len).checked_sub(rank + 1)?;
        Some((self.media[index], self.priorities[index]))
    }

    /// What the surface of `interior` is to a path that arrives there.
    ///
    /// - `entering`: true from outside of it.
    #[must_use]
    pub fn crossing(&self, interior: Interior, entering: bool) -> Crossing {
        let top = self.ranked(0);
        if entering {
            return match top {
                Some((_, priority)) if priority > interior.priority => Crossing::Hidden,
                _ => Crossing::Interface {
                    from: top.map(|(medium, _)| medium),
                    to: Some(interior.medium),
                },
            };
        }
        let own = Some(interior.medium);
        match (top, self.position(interior)) {
            // The surface of the medium it travels in: what ranks next lies behind.
            (Some(_), Some(position)) if position + 1 == usize::from(self.len) => Crossing::Interface {
                from: own,
                to: self.ranked(1).map(|(medium, _)| medium),
            },
            (Some(_), Some(_)) => Crossing::Hidden,
            // The path began inside, or the medium was forgotten: as if it had been there all the time.
            (Some((_, priority)), None) if priority > interior.priority => Crossing::Hidden,
            (_, None) => Crossing::Interface {
                from: own,
                to: top.map(|(medium, _)| medium),
            },
            (None, Some(_)) => Crossing::Hidden,
        }
    }

    /// Where the medium is in the list, the one entered last if it is there more than once.
    fn position(&self, interior: Interior) -> Option<usize> {
        let known = usize::from(self.len);
        (0..known)
            .rev()
            .find(|i| self.media[*i] == interior.medium && self.priorities[*i] == interior.priority)
    }

    /// Tells the list that the path went through the surface of `interior`.
    pub fn pass(&mut self, interior: Interior, entering: bool) {
        if entering {
            self.enter(interior);
        } else if let Some(position) = self.position(interior) {
            self.remove(position);
        }
    }

    fn enter(&mut self, interior: Interior) {
        let mut at = (0..usize::from(self.len))
            .rev()
            .find(|i| self.priorities[*i] <= interior.priority)
            .map_or(0, |i| i + 1);
        if usize::from(self.len) == Self::CAPACITY {
            self.overflowed = true;
            if at == 0 {
                return;
            }
            self.remove(0);
            at -= 1;
        }
        let end = usize::from(self.len);
        self.media.copy_within(at..end, at + 1);
        self.priorities.copy_within(at..end, at + 1);
        self.media[at] = interior.medium;
        self.priorities[at] = interior.priority;
        self.len += 1;
    }

    fn remove(&mut self, position: usize) {
        let end = usize::from(self.len);
        self.media.copy_within(position + 1..end, position);
        self.priorities.copy_within(position + 1..end, position);
        self.len -= 1;
        // Lists that hold the same are equal.
        self.media[end - 1] = 0;
        self.priorities[end - 1] = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interior::Crossing::{Hidden, Interface};
    use proptest::prelude::*;

    const fn medium(medium: u32, priority: i8) -> Interior {
        Interior { medium, priority }
    }

    /// Follows a straight path; what each surface was, and what the path travelled in behind it.
    fn follow(events: &[(Interior, bool)]) -> Vec<(Crossing, Option<u32>)> {
        let mut list = InteriorList::VACUUM;
        let mut seen = Vec::new();
        for (interior, entering) in events {
            let crossing = list.crossing(*interior, *entering);
            list.pass(*interior, *entering);
            seen.push((crossing, list.current()));
        }
        assert_eq!(list, InteriorList::VACUUM, "all that was entered was left");
        seen
    }

    #[test]
    fn a_drink_overlaps_its_glass_and_ice_swims_in_it() {
        const GLASS: Interior = medium(1, 30);
        const WATER: Interior = medium(2, 10);
        const ICE: Interior = medium(3, 20);
        // Into the wall of the glass; the water begins within it; out of the wall into water; ice that pokes into the
        // far wall; and out of all.
        let seen = follow(&[
            (GLASS, true),
            (WATER, true),
            (GLASS, false),
            (ICE, true),
            (GLASS, true),
            (ICE, false),
            (WATER, false),
            (GLASS, false),
        ]);
        let interface = |from, to| Interface { from, to };
        assert_eq!(
            seen,
            [
                (interface(None, Some(1)), Some(1)),
                (Hidden, Some(1)),
                (interface(Some(1), Some(2)), Some(2)),
                (interface(Some(2), Some(3)), Some(3)),
                (interface(Some(3), Some(1)), Some(1)),
                (Hidden, Some(1)),
                (Hidden, Some(1)),
                (interface(Some(1), None), None),
            ]
        );
    }

    #[test]
    fn without_priorities_the_innermost_counts() {
        const GLASS: Interior = medium(7, 0);
        const BUBBLE: Interior = medium(8, 0);
        let seen = follow(&[(GLASS, true), (BUBBLE, true), (BUBBLE, false), (GLASS, false)]);
        let between = |from, to| Interface { from, to };
        assert_eq!(
            seen.iter().map(|(crossing, _)| *crossing).collect::<Vec<_>>(),
            [
                between(None, Some(7)),
                between(Some(7), Some(8)),
                between(Some(8), Some(7)),
                between(Some(7), None)
            ]
        );
    }

    #[test]
    fn equal_ones_that_overlap_leave_in_any_order() {
        const A: Interior = medium(1, 0);
        const B: Interior = medium(2, 0);
        let seen = follow(&[(A, true), (B, true), (A, false), (B, false)]);
        assert_eq!(seen[2], (Hidden, Some(2)));
        assert_eq!(
            seen[3],
            (
                Interface {
                    from: Some(2),
                    to: None
                },
                None
            )
        );
    }

    #[test]
    fn a_path_that_began_inside_leaves_as_if_it_had_entered() {
        let mut list = InteriorList::VACUUM;
        let water = medium(4, 0);
        let out = Interface {
            from: Some(4),
            to: None,
        };
        assert_eq!(list.crossing(water, false), out);
        list.pass(water, false);
        assert_eq!(list, InteriorList::VACUUM);
    }

    #[test]
    fn the_lowest_is_forgotten_when_there_are_too_many() {
        let mut list = InteriorList::VACUUM;
        for i in 0..InteriorList::CAPACITY as u32 {
            list.pass(medium(i, i as i8), true);
        }
        assert!(!list.has_overflowed() && list.current() == Some(4));
        // Lower than all of them: it is this one that is forgotten, and leaving it is hidden.
        list.pass(medium(9, -1), true);
        assert!(list.has_overflowed() && list.current() == Some(4));
        assert_eq!(list.crossing(medium(9, -1), false), Hidden);
        // Higher than all: medium 0 goes.
        list.pass(medium(10, 50), true);
        assert_eq!(list.current(), Some(10));
        list.pass(medium(10, 50), false);
        for i in (1..InteriorList::CAPACITY as u32).rev() {
            assert_eq!(list.current(), Some(i));
            list.pass(medium(i, i as i8), false);
        }
        assert_eq!(list.current(), None);
        list.pass(medium(0, 0), false);
        assert_eq!(list.current(), None);
    }

    proptest! {
        #[test]
        fn any_order_keeps_ranks_sorted_and_ends_in_the_vacuum(
            priorities in proptest::collection::vec(-3_i8..4, 1..=InteriorList::CAPACITY),
            order in proptest::collection::vec(any::<u32>(), InteriorList::CAPACITY),
        ) {
            let media: Vec<Interior> = (0..).zip(&priorities).map(|(i, p)| medium(i, *p)).collect();
            let mut list = InteriorList::VACUUM;
            for interior in &media {
                let crossing = list.crossing(*interior, true);
                list.pass(*interior, true);
                prop_assert_eq!(crossing == Hidden, list.current() != Some(interior.medium));
                prop_assert!(list.priorities[..usize::from(list.len)].is_sorted());
            }
            let mut leaving = media.clone();
            leaving.sort_by_key(|interior| order[interior.medium as usize]);
            for interior in leaving {
                let (before, crossing) = (list.current(), list.crossing(interior, false));
                list.pass(interior, false);
                match crossing {
                    Hidden => prop_assert_eq!(list.current(), before),
                    Interface { from, to } => prop_assert!(from == before && to == list.current()),
                }
            }
            prop_assert_eq!(list, InteriorList::VACUUM);
        }
    }
}
