//! What a component says about its fields, beside their types and doc comments.
//!
//! They are `bevy_reflect` custom attributes: `#[reflect(@Range::at_least(0.0), @Unit("m"))]`.

use std::fmt;

use bevy_reflect::Reflect;

/// The values that a number may have.
///
/// It holds for a number, and for each component of a vector, tuple, list or optional of numbers.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// `min` itself is not allowed.
    pub min_open: bool,
    /// `max` itself is not allowed.
    pub max_open: bool,
}

impl Range {
    /// `min ≤ x ≤ max`.
    pub const fn closed(min: f64, max: f64) -> Self {
        Self {
            min,
            max,
            min_open: false,
            max_open: false,
        }
    }

    /// `min < x < max`.
    pub const fn open(min: f64, max: f64) -> Self {
        Self {
            min,
            max,
            min_open: true,
            max_open: true,
        }
    }

    /// `min ≤ x < max`.
    pub const fn half_open(min: f64, max: f64) -> Self {
        Self {
            max_open: true,
            ..Self::closed(min, max)
        }
    }

    /// `x ≥ min`.
    pub const fn at_least(min: f64) -> Self {
        Self::closed(min, f64::INFINITY)
    }

    /// `x > min`.
    pub const fn above(min: f64) -> Self {
        Self {
            min_open: true,
            ..Self::at_least(min)
        }
    }

    /// `x ≤ max`.
    pub const fn at_most(max: f64) -> Self {
        Self::closed(f64::NEG_INFINITY, max)
    }

    /// `x < max`.
    pub const fn below(max: f64) -> Self {
        Self {
            max_open: true,
            ..Self::at_most(max)
        }
    }

    /// The same between bounds that a number of single precision can be: 0.01 as such a number is less than 0.01.
    pub(crate) fn in_single_precision(self) -> Self {
        Self {
            min: f64::from(self.min as f32),
            max: f64::from(self.max as f32),
            ..self
        }
    }

    /// Whether `x` is allowed; NaN never is.
    pub fn contains(&self, x: f64) -> bool {
        let above = if self.min_open { x > self.min } else { x >= self.min };
        let below = if self.max_open { x < self.max } else { x <= self.max };
        above && below
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let low = if self.min_open { "above" } else { "at least" };
        let high = if self.max_open { "below" } else { "at most" };
        match (self.min.is_finite(), self.max.is_finite()) {
            (true, true) if !self.min_open && !self.max_open => {
                write!(f, "{} to {}", self.min, self.max)
            }
            (true, true) => write!(f, "{low} {} and {high} {}", self.min, self.max),
            (true, false) => write!(f, "{low} {}", self.min),
            (false, true) => write!(f, "{high} {}", self.max),
            (false, false) => write!(f, "any"),
        }
    }
}

/// The unit of a number: `m`, `degrees`, `W`.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit(pub &'static str);

/// A field that a scene must write; its default is never used.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Required;

/// A struct that may be written as the value of this field alone: `"wood.png"` for `(file: "wood.png")`.
///
/// It is an attribute of the type, whose own `Deserialize` reads both.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shorthand(pub &'static str);

/// A field that excludes others of its component.
///
/// In one `group` only one side may be written. A field without a side is one by itself; fields of
/// the same side belong together, and each of them needs the others.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exclusive {
    /// What is chosen.
    pub group: &'static str,
    /// Which choice; empty for the field itself.
    pub side: &'static str,
}

impl Exclusive {
    /// A field that is a choice by itself.
    pub const fn group(group: &'static str) -> Self {
        Self { group, side: "" }
    }

    /// A field that makes up a choice together with the other fields of that side.
    pub const fn side(group: &'static str, side: &'static str) -> Self {
        Self { group, side }
    }
}
