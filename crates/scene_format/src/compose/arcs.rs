//! The arcs that specs write: references, payloads, inherits, specializes.

use super::graph::{ArcKind, NewArc, NodeId, Site};
use super::indexer::{ArcOptions, Composer, Indexer, new_arc};
use super::library::{FileId, LayerId, Library, StackId};
use super::list_edits::{Combined, EditTrouble};
use super::mapping::{PathMap, TimeMap};
use super::paths::{PathId, Step, Word};
use super::spec::{Arcs, AssetRef};
use crate::diagnostic::Diagnostic;
use crate::layer::{ListEdit, Spanned};
use crate::source::Place;

/// Which of the two lists of files and prims.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AssetArcKind {
    References,
    Payloads,
}

impl AssetArcKind {
    fn kind(self) -> ArcKind {
        match self {
            Self::References => ArcKind::References,
            Self::Payloads => ArcKind::Payloads,
        }
    }

    fn list(self, arcs: &Arcs) -> Option<&ListEdit<AssetRef>> {
        match self {
            Self::References => arcs.references.as_ref(),
            Self::Payloads => arcs.payloads.as_ref(),
        }
    }
}

/// Which kinds of arcs the specs of a site write.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct WrittenArcs {
    pub(crate) references: bool,
    pub(crate) payloads: bool,
    pub(crate) inherits: bool,
    pub(crate) specializes: bool,
    pub(crate) variants: bool,
}

impl Library<'_, '_> {
    /// Tells which kinds of arcs a site has.
    pub(crate) fn written_arcs(&self, site: Site) -> WrittenArcs {
        let mut found = WrittenArcs::default();
        for (_, _, spec) in self.specs(site.stack, site.path) {
            if let Some(arcs) = &spec.arcs {
                found.references |= arcs.references.is_some();
                found.payloads |= arcs.payloads.is_some();
                found.inherits |= arcs.inherits.is_some();
                found.specializes |= arcs.specializes.is_some();
                found.variants |= !arcs.sets.is_empty();
            }
        }
        found
    }

    /// Lists the sets of variants of a site; those of a stronger layer come first.
    pub(crate) fn variant_sets(&self, site: Site) -> Vec<Word> {
        let mut list: Vec<Word> = Vec::new();
        for (_, _, spec) in self.specs(site.stack, site.path) {
            let sets = spec.arcs.as_ref().map_or(&[][..], |arcs| &arcs.sets);
            for set in sets {
                if !list.contains(&set.name) {
                    list.push(set.name);
                }
            }
        }
        list
    }

    /// Lists the prims at the top level of a stack.
    pub(crate) fn top_level_prims(&self, stack: StackId) -> Vec<String> {
        let specs = self.specs(stack, PathId::ROOT);
        let names = specs.flat_map(|(_, _, spec)| &spec.children);
        let mut list: Vec<String> = Vec::new();
        for name in names.take(8) {
            let text = format!("/{}", self.paths.word_text(*name));
            if !list.contains(&text) {
                list.push(text);
            }
        }
        list
    }

    /// Combines the list edits of a site's layers, weak to strong. The time of a layer is applied to
    /// the files that it names; what stays in the layer stack has the times of its layers already.
    fn asset_list(&mut self, site: Site, which: AssetArcKind) -> Vec<AssetRef> {
        let mut list = Combined::default();
        for (layer, time, spec) in self.weak_to_strong(site) {
            let arcs = self.layer(layer).specs[spec as usize].arcs.as_deref();
            let Some(edit) = arcs.and_then(|arcs| which.list(arcs)).cloned() else {
                continue;
            };
            self.work += edit.len();
            if self.is_exhausted() {
                break;
            }
            let edit = edit.filter_map(|asset| {
                let mut asset = asset.clone();
                if asset.file.is_some() {
                    asset.time = time.after(asset.time);
                }
                Some((self.locate(&asset), asset))
            });
            list.add(&edit, |(file, asset): &(Option<FileId>, AssetRef)| (*file, asset.prim));
        }
        for (place, trouble) in list.troubles(|(_, asset)| asset.place) {
            self.warn_edit(place, trouble);
        }
        list.items.into_iter().map(|(_, asset)| asset).collect()
    }

    fn class_list(&mut self, site: Site, kind: ArcKind) -> Vec<Spanned<PathId>> {
        let mut list = Combined::default();
        for (layer, _, spec) in self.weak_to_strong(site) {
            let arcs = self.layer(layer).specs[spec as usize].arcs.as_deref();
            let edit = arcs.and_then(|arcs| match kind {
                ArcKind::Inherits => arcs.inherits.clone(),
                _ => arcs.specializes.clone(),
            });
            let Some(edit) = edit else { continue };
            self.work += edit.len();
            if self.is_exhausted() {
                break;
            }
            list.add(&edit, |item: &Spanned<PathId>| item.value);
        }
        for (place, trouble) in list.troubles(|item| item.place) {
            self.warn_edit(place, trouble);
        }
        list.items
    }

    fn weak_to_strong(&self, site: Site) -> Vec<(LayerId, TimeMap, u32)> {
        let mut list: Vec<_> = self.spec_numbers(site.stack, site.path).collect();
        list.reverse();
        list
    }

    fn warn_edit(&mut self, place: Place, code: EditTrouble) {
        let name = self.sources.text(place).to_owned();
        let warning = code.warning(&name);
        self.report.push_once(warning.at(place));
    }

    /// The prim that a file means where none is named.
    fn default_prim(&self, layer: LayerId) -> Option<PathId> {
        self.layer(layer).default_prim.as_ref().map(|name| name.value)
    }
}

impl Indexer<'_> {
    /// Follows the references or payloads that a node writes.
    pub(crate) fn add_asset_arcs(&mut self, composer: &mut Composer<'_, '_, '_>, node: NodeId, which: AssetArcKind) {
        let found = self.graph.node(node);
        if !found.contributes() {
            return;
        }
        if which == AssetArcKind::Payloads && !composer.load_payloads && self.has_scene_path(composer, node) {
            return;
        }
        let site = self.graph.node(node).site;
        for (position, asset) in composer.library.asset_list(site, which).into_iter().enumerate() {
            if let Some((target, arc)) = self.asset_arc(composer, node, which, position as u32, &asset) {
                let options = ArcOptions {
                    with_ancestors: !composer.library.paths.is_top_level_prim(target.path),
                    ..ArcOptions::default()
                };
                self.add_arc(composer, target, &arc, options);
            }
        }
    }

    /// Whether the path of a node stands for a prim of the scene. An arc to a prim below the top level
    /// needs the arcs above its target to find it, which stand for none.
    fn has_scene_path(&self, composer: &mut Composer<'_, '_, '_>, node: NodeId) -> bool {
        let paths = &mut composer.library.paths;
        let mut path = paths.without_variants(self.graph.node(node).site.path);
        let mut carry = |kind, map: &PathMap, path| {
            let inside = matches!(kind, ArcKind::References | ArcKind::Payloads);
            let narrow = inside.then(|| map.dropping_others());
            narrow.as_ref().unwrap_or(map).to_target(path, paths)
        };
        let (mut graph, mut node, mut frame) = (&self.graph, node, self.frame);
        loop {
            for above in graph.up(node).filter(|&above| above != NodeId::ROOT) {
                let found = graph.node(above);
                match carry(found.kind, &found.map_to_parent, path) {
                    Some(image) => path = image,
                    None => return false,
                }
            }
            let Some(around) = frame else {
                return true;
            };
            match carry(around.arc.kind, &around.arc.map, path) {
                Some(image) => path = image,
                None => return false,
            }
            (graph, node, frame) = (around.graph, around.parent, around.previous);
        }
    }

    /// Finds what a reference or payload targets; what is wrong is reported.
    fn asset_arc(
        &self,
        composer: &mut Composer<'_, '_, '_>,
        node: NodeId,
        which: AssetArcKind,
        position: u32,
        asset: &AssetRef,
    ) -> Option<(Site, NewArc)> {
        let kind = which.kind();
        let site = self.graph.node(node).site;
        let library = &mut *composer.library;
        let (stack, layer) = if asset.file.is_some() {
            let layer = library.open(asset, kind.word())?;
            (library.stack_of(layer), layer)
        } else {
            // The last layer that is not the command line's is the first of the stack.
            let layers = &library.stack(site.stack).layers;
            let first = layers.iter().find(|(layer, _)| !library.layer(*layer).is_session);
            (site.stack, first?.0)
        };
        let owner = library.paths.without_variants(site.path);
        let depth = library.paths.depth(site.path);
        let target = asset.prim.or_else(|| library.default_prim(layer));
        let inside = asset.file.is_none();
        let map = |path| PathMap::subtree(path, owner, inside, asset.time);
        let Some(path) = target else {
            let name = library.sources.name(library.layer(layer).source).to_owned();
            let message = format!("`{name}` has no `default_prim`, so a prim has to be named");
            let error = Diagnostic::error("missing-prim", message);
            let error = self.suggest_prims(composer, stack, error);
            let arc = new_arc(kind, node, node, map(PathId::ROOT), position, depth, Some(asset.place));
            self.report_at(composer, error, &arc, true);
            return None;
        };
        let arc = new_arc(kind, node, node, map(path), position, depth, Some(asset.place));
        if !asset.time.is_sound() {
            let message = "the offsets up to here add up to a time that is too large";
            self.report_at(composer, Diagnostic::error("bad-layer-offset", message), &arc, true);
            return None;
        }
        Some((Site { stack, path }, arc))
    }

    fn suggest_prims(&self, composer: &Composer<'_, '_, '_>, stack: StackId, error: Diagnostic) -> Diagnostic {
        let names = composer.library.top_level_prims(stack);
        match names.first() {
            Some(first) => error.note(format!(
                "its prims: {}; write `#{first}` behind the file's name",
                names.join(", ")
            )),
            None => error.note("it has no prims"),
        }
    }

    /// Follows the classes or bases that a node writes.
    pub(crate) fn add_written_classes(&mut self, composer: &mut Composer<'_, '_, '_>, node: NodeId, kind: ArcKind) {
        let found = self.graph.node(node);
        if !found.contributes() {
            return;
        }
        let site = found.site;
        let owner = composer.library.paths.without_variants(site.path);
        for (position, class) in composer.library.class_list(site, kind).into_iter().enumerate() {
            let map = PathMap::subtree(class.value, owner, true, TimeMap::IDENTITY);
            let depth = composer.library.paths.depth(site.path);
            let arc = new_arc(kind, node, node, map, position as u32, depth, Some(class.place));
            self.add_class(composer, &arc, None);
        }
    }

    /// Adds a class below a node; gives the node of the class, new or there before.
    ///
    /// - `source`: site of the class that implies this one; where both are the same, the new node is
    ///   a placeholder without opinions.
    pub(crate) fn add_class(
        &mut self,
        composer: &mut Composer<'_, '_, '_>,
        arc: &NewArc,
        source: Option<Site>,
    ) -> Option<NodeId> {
        let instance = self.graph.node(arc.parent).site;
        let implied = arc.origin != arc.parent;
        let path = class_path(composer, instance.path, &arc.map, implied)?;
        let site = Site {
            stack: instance.stack,
            path,
        };
        let children = &self.graph.node(arc.parent).children;
        let known = children
            .iter()
            .copied()
            .find(|&child| self.graph.node(child).site == site);
        if let Some(known) = known {
            // Of two bases that are implied at the prim, the one of the stronger origin counts.
            let yields = arc.kind == ArcKind::Specializes && arc.parent == NodeId::ROOT && implied && {
                let origin = self.graph.node(known).origin;
                self.graph.compare_in_tree(arc.origin, origin).is_lt()
            };
            if !yields {
                return Some(known);
            }
            self.graph.make_subtree_inert(known, &composer.library.paths);
        }
        if arc.kind == ArcKind::Specializes && (arc.parent != NodeId::ROOT || self.frame.is_some()) {
            return self.add_base(composer, site, arc);
        }
        let counts = path != instance.path && source != Some(site);
        let options = ArcOptions {
            inert: !counts,
            skip_duplicates: counts,
            with_ancestors: counts && !composer.library.paths.is_top_level_prim(path),
            ..ArcOptions::default()
        };
        self.add_arc(composer, site, arc, options)
    }
}

/// Finds the path that an instance takes opinions from through a class map.
///
/// - `implied`: of an instance in a variant, a class below the prim of the variant is looked for in the
///   same variant. Where the arc itself is written there, it means the plain path.
fn class_path(composer: &mut Composer<'_, '_, '_>, instance: PathId, map: &PathMap, implied: bool) -> Option<PathId> {
    let paths = &mut composer.library.paths;
    let plain = paths.without_variants(instance);
    let class = map.to_source(plain, paths)?;
    if !implied || plain == instance {
        return Some(class);
    }
    let mut body = instance;
    while !matches!(paths.step(body), Step::Variant { .. }) {
        body = paths.parent(body);
    }
    let prim = paths.without_variants(body);
    Some(paths.replace_prefix(class, prim, body))
}
