//! From the names of a model to names of prims: legal, and unlike among siblings.

use std::collections::{BTreeMap, BTreeSet};

use crate::path::name_problem;

/// A name that a model gives, and what to use if it gives none.
pub(super) struct Wanted<'a> {
    pub(super) name: &'a str,
    pub(super) fallback: String,
}

/// Names the children of one prim, in their order. What is legal and unlike stays as it is; only the others change.
///
/// - `taken`: names that something else has.
///
/// Cost: O(n log n), however many share a name.
pub(super) fn sibling_names(wanted: &[Wanted<'_>], taken: &[&str], longest: usize) -> Vec<String> {
    let mut used: BTreeSet<String> = taken.iter().map(|&name| name.to_owned()).collect();
    let mut names: Vec<Option<String>> = wanted
        .iter()
        .map(|wanted| {
            let legal = name_problem(wanted.name, longest).is_none();
            (legal && used.insert(wanted.name.to_owned())).then(|| wanted.name.to_owned())
        })
        .collect();
    let mut next: BTreeMap<String, usize> = BTreeMap::new();
    for (name, wanted) in names.iter_mut().zip(wanted) {
        if name.is_some() {
            continue;
        }
        let base = legal_name(wanted, longest);
        let mut candidate = base.clone();
        let number = next.entry(base.clone()).or_insert(2);
        while !used.insert(candidate.clone()) {
            candidate = format!("{base}_{number}");
            *number += 1;
        }
        *name = Some(candidate);
    }
    names.into_iter().flatten().collect()
}

/// Makes a legal name, with room for a number at its end.
pub(super) fn legal_name(wanted: &Wanted<'_>, longest: usize) -> String {
    let legal = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let mut name: String = wanted.name.chars().take(longest - ROOM).map(legal).collect();
    if name.is_empty() {
        name.clone_from(&wanted.fallback);
    }
    if name.starts_with(|c: char| c.is_ascii_digit()) {
        name.insert(0, '_');
    }
    name
}

/// Bytes for `_` and a number below 2³², and for one that goes before a digit.
const ROOM: usize = 12;
