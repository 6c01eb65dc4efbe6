//! The tree of prims that one layer mentions.

use std::collections::BTreeMap;

use crate::diagnostic::{Diagnostic, Report, nearest};
use crate::layer::{Body, Layer, PrimSpec, Spanned, Specifier};
use crate::options::Limits;
use crate::source::Place;

/// A prim that a layer mentions, or that a path below it implies.
#[derive(Debug)]
pub(crate) struct Entry {
    pub(crate) path: String,
    pub(crate) name: String,
    pub(crate) children: Vec<usize>,
    pub(crate) specifier: Specifier,
    /// None for one that is only implied.
    pub(crate) place: Option<Place>,
    pub(crate) body: Body,
}

/// The tree of prims that one layer mentions.
#[derive(Debug, Default)]
pub(crate) struct Namespace {
    pub(crate) entries: Vec<Entry>,
    pub(crate) roots: Vec<usize>,
    pub(crate) index: BTreeMap<String, usize>,
}

impl Namespace {
    /// Builds the tree; missing parents become `Over`, and children take the order of the layer.
    pub(crate) fn of(layer: &mut Layer, limits: &Limits, report: &mut Report) -> Self {
        let mut tree = Self::default();
        for spec in std::mem::take(&mut layer.prims) {
            let parent = tree.ensure_parents(&spec.key.value);
            tree.add(parent, spec, report);
            if tree.entries.len() > limits.prims {
                let message = format!("a scene has at most {} prims", limits.prims);
                report.push(Diagnostic::error("too-many-prims", message));
                break;
            }
        }
        let order = std::mem::take(&mut layer.order);
        let mut roots = std::mem::take(&mut tree.roots);
        tree.reorder(&mut roots, &order, report);
        tree.roots = roots;
        tree
    }

    /// Finds a prim by path.
    pub(crate) fn find(&self, path: &str) -> Option<usize> {
        self.index.get(path).copied()
    }

    /// Finds the path that was probably meant.
    pub(crate) fn nearest_path(&self, path: &str) -> Option<&str> {
        nearest(path, self.index.keys().map(String::as_str))
    }

    fn ensure_parents(&mut self, path: &str) -> Option<usize> {
        let mut parent = None;
        for (at, _) in path.match_indices('/').skip(1) {
            let above = &path[..at];
            parent = Some(match self.find(above) {
                Some(found) => found,
                None => self.insert(parent, above),
            });
        }
        parent
    }

    fn insert(&mut self, parent: Option<usize>, path: &str) -> usize {
        let number = self.entries.len();
        let name = path.rsplit('/').next().unwrap_or(path);
        self.entries.push(Entry {
            path: path.to_owned(),
            name: name.to_owned(),
            children: Vec::new(),
            specifier: Specifier::Over,
            place: None,
            body: Body::default(),
        });
        match parent {
            Some(parent) => self.entries[parent].children.push(number),
            None => self.roots.push(number),
        }
        self.index.insert(path.to_owned(), number);
        number
    }

    /// Adds what a layer says about one prim and about everything below it. At most as deep as
    /// the reader lets prims be.
    fn add(&mut self, parent: Option<usize>, spec: PrimSpec, report: &mut Report) {
        let path = match parent {
            Some(parent) if !spec.key.value.starts_with('/') => {
                format!("{}/{}", self.entries[parent].path, spec.key.value)
            }
            _ => spec.key.value.clone(),
        };
        let number = match self.find(&path) {
            None => self.insert(parent, &path),
            Some(number) => {
                if let Some(first) = self.entries[number].place {
                    report.push(
                        Diagnostic::error("duplicate-prim", format!("`{path}` is written twice in this file"))
                            .at(spec.key.place)
                            .also(first, "first written")
                            .note("put everything that a file says about a prim in one place"),
                    );
                    return;
                }
                number
            }
        };
        let mut body = spec.body;
        let children = std::mem::take(&mut body.children);
        let order = std::mem::take(&mut body.order);
        let entry = &mut self.entries[number];
        entry.place = Some(spec.key.place);
        entry.specifier = spec.specifier;
        entry.body = body;
        for child in children {
            self.add(Some(number), child, report);
        }
        let mut list = std::mem::take(&mut self.entries[number].children);
        self.reorder(&mut list, &order, report);
        self.entries[number].children = list;
    }

    /// Moves the named prims, each with the unnamed ones that follow it, into the order given;
    /// unnamed ones at the front stay there.
    fn reorder(&self, list: &mut Vec<usize>, order: &[Spanned<String>], report: &mut Report) {
        if order.is_empty() {
            return;
        }
        let mut rank = BTreeMap::new();
        for (position, name) in order.iter().enumerate() {
            rank.entry(name.value.as_str()).or_insert(position);
        }
        let mut blocks: Vec<(Option<usize>, Vec<usize>)> = vec![(None, Vec::new())];
        for &number in list.iter() {
            match rank.get(self.entries[number].name.as_str()) {
                Some(&position) => blocks.push((Some(position), vec![number])),
                None => blocks.last_mut().expect("never empty").1.push(number),
            }
        }
        blocks.sort_by_key(|(position, _)| *position);
        for (position, name) in order.iter().enumerate() {
            if !blocks.iter().any(|(found, _)| *found == Some(position)) {
                let message = format!("`order` names `{}`, which is not here", name.value);
                report.push(Diagnostic::warning("order-without-effect", message).at(name.place));
            }
        }
        *list = blocks.into_iter().flat_map(|(_, block)| block).collect();
    }
}
