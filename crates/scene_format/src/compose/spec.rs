//! What one layer says, place by place: the tree of a file laid out by path.

use std::collections::HashMap;

use super::mapping::TimeMap;
use super::paths::{PathId, PathTable, Step, Word};
use crate::diagnostic::{Diagnostic, Report};
use crate::layer::{
    AssetArc, Body, ComponentSpec, FieldOpinion, Layer, ListEdit, PrimSpec, Spanned, Specifier, TimeSettings,
};
use crate::options::Limits;
use crate::path::{absolute_path_problem, resolve_target};
use crate::schema::Schema;
use crate::source::{Place, SourceId};

/// A file, a prim in it, or both, as an arc names them.
#[derive(Clone, Debug)]
pub(crate) struct AssetRef {
    /// Relative to the file that writes it; none for the layer stack that the arc is in.
    pub(crate) file: Option<Box<str>>,
    /// None for the default prim.
    pub(crate) prim: Option<PathId>,
    pub(crate) time: TimeMap,
    pub(crate) place: Place,
}

/// The arcs, sets and selections at one path; boxed, since most prims have none.
#[derive(Debug, Default)]
pub(crate) struct Arcs {
    pub(crate) references: Option<ListEdit<AssetRef>>,
    pub(crate) payloads: Option<ListEdit<AssetRef>>,
    pub(crate) inherits: Option<ListEdit<Spanned<PathId>>>,
    pub(crate) specializes: Option<ListEdit<Spanned<PathId>>>,
    pub(crate) select: Vec<Selection>,
    pub(crate) sets: Vec<SetSpec>,
}

/// A set of variants, with those that have a body here.
#[derive(Debug)]
pub(crate) struct SetSpec {
    pub(crate) name: Word,
    pub(crate) variants: Vec<Word>,
}

/// A choice in a set of variants.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Selection {
    pub(crate) set: Word,
    /// None for `""`, which chooses nothing.
    pub(crate) variant: Option<Word>,
    pub(crate) place: Place,
}

/// What one layer says at one path, be it a prim or a variant of one.
#[derive(Debug)]
pub(crate) struct Spec {
    pub(crate) path: PathId,
    /// None for a prim that only a path below it implies.
    pub(crate) place: Option<Place>,
    /// None for the body of a variant.
    pub(crate) specifier: Option<Specifier>,
    pub(crate) active: Option<bool>,
    pub(crate) type_label: Option<Box<str>>,
    pub(crate) doc: Option<Box<str>>,
    /// Positions in the schema, with places.
    pub(crate) without: Vec<(usize, Place)>,
    pub(crate) components: Vec<ComponentSpec>,
    pub(crate) children: Vec<Word>,
    pub(crate) order: Vec<(Word, Place)>,
    pub(crate) arcs: Option<Box<Arcs>>,
}

impl Spec {
    pub(crate) fn new(path: PathId, specifier: Option<Specifier>) -> Self {
        Self {
            path,
            place: None,
            specifier,
            active: None,
            type_label: None,
            doc: None,
            without: Vec::new(),
            components: Vec::new(),
            children: Vec::new(),
            order: Vec::new(),
            arcs: None,
        }
    }
}

/// One file, laid out by path. The first spec is that of `/`.
#[derive(Debug)]
pub(crate) struct FlatLayer {
    pub(crate) source: SourceId,
    pub(crate) default_prim: Option<Spanned<PathId>>,
    pub(crate) time: Option<TimeSettings>,
    pub(crate) sublayers: Vec<AssetRef>,
    pub(crate) specs: Vec<Spec>,
    /// Whether it is the command line's.
    pub(crate) is_session: bool,
}

/// Lays out layers; what is wrong with paths and names of files goes to the report.
pub(crate) struct Flattener<'a, 'r> {
    pub(crate) paths: &'a mut PathTable,
    pub(crate) schema: &'a Schema<'r>,
    pub(crate) limits: &'a Limits,
    pub(crate) report: &'a mut Report,
}

/// One layer while it is laid out.
struct Specs {
    list: Vec<Spec>,
    at: HashMap<PathId, usize>,
}

impl Specs {
    fn find_or_add(&mut self, path: PathId, specifier: Option<Specifier>) -> usize {
        *self.at.entry(path).or_insert_with(|| {
            self.list.push(Spec::new(path, specifier));
            self.list.len() - 1
        })
    }
}

impl Flattener<'_, '_> {
    /// Lays out a file.
    pub(crate) fn flatten(&mut self, layer: Layer, source: SourceId) -> FlatLayer {
        let mut specs = Specs {
            list: Vec::new(),
            at: HashMap::new(),
        };
        specs.find_or_add(PathId::ROOT, None);
        for prim in layer.prims {
            let parent = self.ensure_parents(&prim.key.value, &mut specs);
            self.add_prim(parent, prim, &mut specs);
        }
        specs.list[0].order = self.order(&layer.order);
        let sublayers = layer.sublayers.map(|list| list.value).unwrap_or_default();
        FlatLayer {
            source,
            default_prim: layer.default_prim.map(|name| Spanned {
                value: self.paths.intern(&name.value),
                place: name.place,
            }),
            time: layer.time,
            sublayers: sublayers.iter().filter_map(|arc| self.sublayer(arc)).collect(),
            specs: specs.list,
            is_session: false,
        }
    }

    /// Adds an `Over` for every ancestor of a path that is not there, and gives the parent's spec.
    fn ensure_parents(&mut self, path: &str, specs: &mut Specs) -> usize {
        let mut above = 0;
        let mut at = PathId::ROOT;
        let parents = path.rfind('/').map_or("", |end| &path[..end]);
        for name in parents.split('/').filter(|name| !name.is_empty()) {
            let word = self.paths.word(name);
            at = self.paths.child(at, word);
            above = add_child(above, word, at, specs);
        }
        above
    }

    /// Adds a prim and everything below it; at most as deep as the reader lets prims be.
    fn add_prim(&mut self, parent: usize, prim: PrimSpec, specs: &mut Specs) {
        let name = prim.key.value.rsplit('/').next().unwrap_or_default();
        let word = self.paths.word(name);
        let path = self.paths.child(specs.list[parent].path, word);
        let number = add_child(parent, word, path, specs);
        let spec = &mut specs.list[number];
        if let Some(first) = spec.place {
            let message = format!("`{}` is written twice in this file", self.paths.text(path));
            return self.report.push(
                Diagnostic::error("duplicate-prim", message)
                    .at(prim.key.place)
                    .also(first, "first written")
                    .note("put everything that a file says about a prim in one place"),
            );
        }
        spec.place = Some(prim.key.place);
        spec.specifier = Some(prim.specifier);
        self.fill(number, prim.body, specs);
    }

    /// Takes over what a prim or a variant says, with children and variants.
    fn fill(&mut self, number: usize, body: Body, specs: &mut Specs) {
        let path = specs.list[number].path;
        let owner = self.paths.without_variants(path);
        let mut arcs = self.arcs(&body, owner);
        let spec = &mut specs.list[number];
        spec.active = body.active;
        spec.type_label = body.type_label.map(String::into_boxed_str);
        spec.doc = body.doc.map(String::into_boxed_str);
        spec.without = body
            .without
            .iter()
            .filter_map(|name| Some((self.schema.index_of(&name.value)?, name.place)))
            .collect();
        spec.components = body.components;
        self.make_targets_absolute(&mut specs.list[number].components, owner);
        for child in body.children {
            self.add_prim(number, child, specs);
        }
        specs.list[number].order = self.order(&body.order);
        let sets = body.variants.map(|sets| sets.value).unwrap_or_default();
        if sets.len() > self.limits.variants {
            let message = format!("a prim has at most {} sets of variants", self.limits.variants);
            let error = Diagnostic::error("too-long", message);
            self.report.push(error.at(sets[self.limits.variants].name.place));
        }
        for set in sets {
            let set_word = self.paths.word(&set.name.value);
            let variants = set
                .variants
                .iter()
                .map(|(name, _)| self.paths.word(&name.value))
                .collect();
            arcs.get_or_insert_default().sets.push(SetSpec {
                name: set_word,
                variants,
            });
            for (name, body) in set.variants {
                let variant = self.paths.word(&name.value);
                let step = Step::Variant { set: set_word, variant };
                let path = self.paths.join(path, step);
                let number = specs.find_or_add(path, None);
                specs.list[number].place = Some(name.place);
                self.fill(number, body, specs);
            }
        }
        specs.list[number].arcs = arcs.map(Box::new);
    }

    fn arcs(&mut self, body: &Body, owner: PathId) -> Option<Arcs> {
        let nothing = body.references.is_none()
            && body.payloads.is_none()
            && body.inherits.is_none()
            && body.specializes.is_none()
            && body.select.is_none();
        if nothing {
            return None;
        }
        let owner = self.paths.text(owner);
        let select = body.select.as_ref().map_or(&[][..], |select| &select.value);
        Some(Arcs {
            references: body.references.as_ref().map(|edit| self.assets(&edit.value)),
            payloads: body.payloads.as_ref().map(|edit| self.assets(&edit.value)),
            inherits: body.inherits.as_ref().map(|edit| self.classes(&edit.value, &owner)),
            specializes: body.specializes.as_ref().map(|edit| self.classes(&edit.value, &owner)),
            select: select
                .iter()
                .map(|(set, variant)| Selection {
                    set: self.paths.word(&set.value),
                    variant: (!variant.value.is_empty()).then(|| self.paths.word(&variant.value)),
                    place: variant.place,
                })
                .collect(),
            sets: Vec::new(),
        })
    }

    fn assets(&mut self, edit: &ListEdit<AssetArc>) -> ListEdit<AssetRef> {
        edit.filter_map(|arc| self.asset(arc))
    }

    fn classes(&mut self, edit: &ListEdit<Spanned<String>>, owner: &str) -> ListEdit<Spanned<PathId>> {
        edit.filter_map(
            |item| match resolve_target(&item.value, owner, self.limits.name_bytes) {
                Ok(path) => Some(Spanned {
                    value: self.paths.intern(&path),
                    place: item.place,
                }),
                Err(problem) => self.fail("bad-path", problem, item.place),
            },
        )
    }

    fn fail<T>(&mut self, code: &'static str, problem: String, place: Place) -> Option<T> {
        self.report.push(Diagnostic::error(code, problem).at(place));
        None
    }

    /// Takes `file#/Prim`, `file` or `#/Prim` apart.
    fn asset(&mut self, arc: &AssetArc) -> Option<AssetRef> {
        let text = &arc.to.value;
        let (file, prim) = match text.split_once('#') {
            Some((file, prim)) => (file, Some(prim)),
            None => (text.as_str(), None),
        };
        if file.is_empty() && prim.is_none() {
            let problem = "this names neither a file nor a prim".to_owned();
            return self.fail("path-escape", problem, arc.to.place);
        }
        let prim = match prim {
            Some(path) => match absolute_path_problem(path, self.limits.name_bytes) {
                Some(problem) => return self.fail("bad-path", problem, arc.to.place),
                None => Some(self.paths.intern(path)),
            },
            None => None,
        };
        Some(AssetRef {
            file: (!file.is_empty()).then(|| file.into()),
            prim,
            time: TimeMap {
                offset: arc.offset,
                scale: arc.scale,
            },
            place: arc.to.place,
        })
    }

    fn sublayer(&mut self, arc: &AssetArc) -> Option<AssetRef> {
        if arc.to.value.contains('#') {
            let problem = "a sublayer is a whole file; to bring one prim of it, use `references`".to_owned();
            return self.fail("bad-path", problem, arc.to.place);
        }
        self.asset(arc)
    }

    fn order(&mut self, names: &[Spanned<String>]) -> Vec<(Word, Place)> {
        names
            .iter()
            .map(|name| (self.paths.word(&name.value), name.place))
            .collect()
    }

    fn make_targets_absolute(&mut self, components: &mut [ComponentSpec], owner: PathId) {
        let mut owner_text = None;
        for field in components.iter_mut().flat_map(|component| &mut component.fields) {
            if let FieldOpinion::Targets(edit) = &mut field.opinion {
                let owner = owner_text.get_or_insert_with(|| self.paths.text(owner));
                *edit = edit.filter_map(
                    |item| match resolve_target(&item.value, owner, self.limits.name_bytes) {
                        Ok(value) => Some(Spanned {
                            value,
                            place: item.place,
                        }),
                        Err(problem) => self.fail("bad-path", problem, item.place),
                    },
                );
            }
        }
    }
}

/// Finds or adds the spec of a child, and lists it with its parent.
fn add_child(parent: usize, name: Word, path: PathId, specs: &mut Specs) -> usize {
    let before = specs.list.len();
    let number = specs.find_or_add(path, Some(Specifier::Over));
    if specs.list.len() > before {
        specs.list[parent].children.push(name);
    }
    number
}
