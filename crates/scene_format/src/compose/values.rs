//! Copies of opinions for the prims that they reach.

use bevy_reflect::{PartialReflect, ReflectRef};

use super::mapping::TimeMap;

/// Copies a value; none if its type can be copied neither by itself nor part by part.
pub(crate) fn clone_value(value: &dyn PartialReflect) -> Option<Box<dyn PartialReflect>> {
    match value.reflect_clone() {
        Ok(copy) => Some(copy.into_partial_reflect()),
        Err(_) => value.to_dynamic().ok(),
    }
}

/// Counts the items of a list; other values count nothing more than themselves.
pub(crate) fn list_length(value: &dyn PartialReflect) -> usize {
    match value.reflect_ref() {
        ReflectRef::List(items) => items.len(),
        ReflectRef::Map(items) => items.len(),
        ReflectRef::Set(items) => items.len(),
        _ => 0,
    }
}

/// Copies samples, with their times as the scene counts them; none if the times run together or away.
pub(crate) fn clone_samples(
    samples: &[(f64, Box<dyn PartialReflect>)],
    time: TimeMap,
) -> Option<Vec<(f64, Box<dyn PartialReflect>)>> {
    let copy: Vec<_> = samples
        .iter()
        .filter_map(|(at, value)| Some((time.apply(*at), clone_value(&**value)?)))
        .collect();
    let sound = copy.iter().all(|(at, _)| at.is_finite()) && copy.windows(2).all(|pair| pair[0].0 < pair[1].0);
    (sound && copy.len() == samples.len()).then_some(copy)
}
