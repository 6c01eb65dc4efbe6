//! The files of a scene, each read once, and the stacks of layers that they make.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::mapping::TimeMap;
use super::paths::{PathId, PathTable};
use super::spec::{AssetRef, FlatLayer, Flattener, Selection, Spec};
use crate::asset::{self, Folders};
use crate::diagnostic::{Diagnostic, Report};
use crate::model::{ModelFile, ModelLimits, is_model, translate_model};
use crate::options::Limits;
use crate::read::read_layer;
use crate::schema::Schema;
use crate::source::{Place, Reached, SourceId, Sources};

/// Number of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct LayerId(u32);

/// Number of a layer stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct StackId(u32);

/// Number of a file that an arc names, be it there or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct FileId(u32);

/// A file that an arc names.
#[derive(Debug)]
struct NamedFile {
    /// None for one that is not there or may not be read.
    path: Option<PathBuf>,
    read: Option<Outcome>,
}

/// What came of reading a file; none of it is tried twice.
#[derive(Clone, Copy, Debug)]
enum Outcome {
    Layer(LayerId),
    Failed,
}

/// A layer and its sublayers, strong to weak.
#[derive(Debug)]
pub(crate) struct LayerStack {
    pub(crate) layers: Vec<(LayerId, TimeMap)>,
    /// First link of each path.
    heads: HashMap<PathId, u32>,
    /// Which layer, which of its specs, and the next link, one more than its position; 0 ends.
    links: Vec<(u32, u32, u32)>,
}

/// Fields of `links` that make up one opinion in the count of opinions.
const LINKS_PER_OPINION: usize = 4;

impl LayerStack {
    /// Whether a layer says anything at a path.
    pub(crate) fn has_specs(&self, path: PathId) -> bool {
        self.heads.contains_key(&path)
    }
}

/// Reads files and stacks them; knows every file by its canonical name.
pub(crate) struct Library<'a, 'r> {
    pub(crate) paths: PathTable,
    pub(crate) sources: Sources,
    pub(crate) report: Report,
    pub(crate) schema: &'a Schema<'r>,
    pub(crate) limits: &'a Limits,
    pub(crate) folders: Folders,
    layers: Vec<FlatLayer>,
    files: Vec<NamedFile>,
    by_name: HashMap<PathBuf, FileId>,
    stacks: Vec<LayerStack>,
    stack_of: BTreeMap<LayerId, StackId>,
    /// Which file a text means that is written in another.
    named: HashMap<(SourceId, Box<str>), FileId>,
    opinions: usize,
    /// Steps of composition so far: what bounds the time that hostile files can take.
    pub(crate) work: usize,
    /// Another limit was passed, and reported; there is no sense in going on.
    is_stopped: bool,
    /// Time spent on reading files so far.
    pub(crate) reading: Duration,
    /// Sublayers that close a circle, and whose they are; each is reported once.
    closed_cycles: BTreeSet<(LayerId, LayerId)>,
    /// What the command line selects, by prim.
    pub(crate) session_selections: HashMap<PathId, Vec<Selection>>,
}

impl<'a, 'r> Library<'a, 'r> {
    pub(crate) fn new(schema: &'a Schema<'r>, limits: &'a Limits, folders: Folders) -> Self {
        Self {
            paths: PathTable::default(),
            sources: Sources::default(),
            report: Report::default(),
            schema,
            limits,
            folders,
            layers: Vec::new(),
            files: Vec::new(),
            by_name: HashMap::new(),
            stacks: Vec::new(),
            stack_of: BTreeMap::new(),
            named: HashMap::new(),
            opinions: 0,
            work: 0,
            is_stopped: false,
            reading: Duration::ZERO,
            closed_cycles: BTreeSet::new(),
            session_selections: HashMap::new(),
        }
    }

    pub(crate) fn layer(&self, layer: LayerId) -> &FlatLayer {
        &self.layers[layer.0 as usize]
    }

    pub(crate) fn stack(&self, stack: StackId) -> &LayerStack {
        &self.stacks[stack.0 as usize]
    }

    /// Lists what a stack says at a path, strong to weak, with the time of each layer.
    pub(crate) fn specs(&self, stack: StackId, path: PathId) -> impl Iterator<Item = (LayerId, TimeMap, &Spec)> {
        let numbers = self.spec_numbers(stack, path);
        numbers.map(|(layer, time, spec)| (layer, time, &self.layer(layer).specs[spec as usize]))
    }

    /// Like [`Self::specs`], with positions in [`FlatLayer::specs`].
    pub(crate) fn spec_numbers(&self, stack: StackId, path: PathId) -> impl Iterator<Item = (LayerId, TimeMap, u32)> {
        let stack = self.stack(stack);
        let mut next = stack.heads.get(&path).copied().unwrap_or(0);
        std::iter::from_fn(move || {
            let &(position, spec, following) = stack.links.get((next as usize).checked_sub(1)?)?;
            next = following;
            let (layer, time) = stack.layers[position as usize];
            Some((layer, time, spec))
        })
    }

    /// Takes a text for a file; what is wrong with it is reported.
    pub(crate) fn add_text(&mut self, source: SourceId, canonical: Option<PathBuf>) -> Option<LayerId> {
        let begun = Instant::now();
        let report = RefCell::new(std::mem::take(&mut self.report));
        let layer = read_layer(&self.sources, source, self.schema, self.limits, &report);
        self.report = report.into_inner();
        self.reading += begun.elapsed();
        let id = layer.map(|layer| {
            let mut flattener = Flattener {
                paths: &mut self.paths,
                schema: self.schema,
                limits: self.limits,
                report: &mut self.report,
            };
            let flat = flattener.flatten(layer, source);
            self.add_layer(flat)
        });
        if let Some(canonical) = canonical {
            let file = self.file(canonical);
            self.files[file.0 as usize].read = Some(id.map_or(Outcome::Failed, Outcome::Layer));
        }
        id
    }

    /// Gives the number of a file by its canonical name.
    fn file(&mut self, canonical: PathBuf) -> FileId {
        if let Some(&file) = self.by_name.get(&canonical) {
            return file;
        }
        let file = self.add_file(Some(canonical.clone()));
        self.by_name.insert(canonical, file);
        file
    }

    fn add_file(&mut self, path: Option<PathBuf>) -> FileId {
        self.files.push(NamedFile { path, read: None });
        FileId(self.files.len() as u32 - 1)
    }

    pub(crate) fn add_layer(&mut self, layer: FlatLayer) -> LayerId {
        let fields = layer.specs.iter().flat_map(|spec| &spec.components);
        self.opinions += fields.map(|component| component.fields.len()).sum::<usize>();
        self.layers.push(layer);
        LayerId(self.layers.len() as u32 - 1)
    }

    /// Tells which file an arc means, without reading it; none for an arc within its layer stack.
    pub(crate) fn locate(&mut self, asset: &AssetRef) -> Option<FileId> {
        let text = asset.file.as_ref()?;
        let key = (asset.place.source, text.clone());
        if let Some(&file) = self.named.get(&key) {
            return Some(file);
        }
        let file = match asset::resolve(text, asset.place, &self.sources, &self.folders) {
            Ok(path) => self.file(path),
            Err(_) => self.add_file(None),
        };
        self.named.insert(key, file);
        Some(file)
    }

    /// Reads the file that an arc names, unless it was read before. What is wrong is reported once.
    pub(crate) fn open(&mut self, asset: &AssetRef, word: &'static str) -> Option<LayerId> {
        let text = asset.file.as_ref()?;
        let file = self.locate(asset)?;
        match self.files[file.0 as usize].read {
            Some(Outcome::Layer(layer)) => return Some(layer),
            Some(Outcome::Failed) => return None,
            None => {}
        }
        let Some(path) = self.files[file.0 as usize].path.clone() else {
            self.files[file.0 as usize].read = Some(Outcome::Failed);
            // Asked again for the message.
            if let Err(error) = asset::resolve(text, asset.place, &self.sources, &self.folders) {
                self.report.push_once(error);
            }
            return None;
        };
        if let Some(error) = self.is_full() {
            self.report.push_once(error.at(asset.place));
            return None;
        }
        let reached = Reached {
            place: asset.place,
            word,
        };
        match self.read_file(&path, text, reached) {
            Ok(source) => self.add_text(source, Some(path)),
            Err(error) => {
                self.report.push(error);
                self.files[file.0 as usize].read = Some(Outcome::Failed);
                None
            }
        }
    }

    /// Says why no more files are read.
    fn is_full(&self) -> Option<Diagnostic> {
        let limits = self.limits;
        if self.layers.len() >= limits.layers {
            let message = format!("a scene has at most {} layers", limits.layers);
            return Some(Diagnostic::error("too-many-layers", message));
        }
        (self.opinions > limits.opinions).then(|| {
            let message = format!("a scene has at most {} fields", limits.opinions);
            Diagnostic::error("too-many-opinions", message)
        })
    }

    fn read_file(&mut self, path: &Path, written: &str, reached: Reached) -> Result<SourceId, Diagnostic> {
        let name = self.sources.shown_beside(reached.place.source, written);
        self.add_source(path, &name, Some(reached))
            .map_err(|error| match error.place {
                Some(_) => error,
                None => error.at(reached.place),
            })
    }

    /// Reads a file as text; a model is translated.
    ///
    /// - `path`: canonical.
    /// - `name`: what people know the file by.
    ///
    /// # Errors
    ///
    /// A file that is unreadable, too large, no text, or a broken model.
    pub(crate) fn add_source(
        &mut self,
        path: &Path,
        name: &str,
        reached: Option<Reached>,
    ) -> Result<SourceId, Diagnostic> {
        let folder = path.parent().unwrap_or(Path::new(""));
        if is_model(path) {
            let begun = Instant::now();
            let text = self.translate(path, name, reached)?;
            self.reading += begun.elapsed();
            return Ok(self.sources.add_model(name, folder, text, reached));
        }
        match asset::read_text(path, name, self.limits) {
            Ok(text) => Ok(self.sources.add_file(name, folder, text, reached)),
            Err((error, text)) if error.code == "not-utf-8" => {
                let end = text.len() as u32;
                let source = self.sources.add_file(name, folder, text, reached);
                Err(error.at(Place {
                    source,
                    start: end,
                    end,
                }))
            }
            Err((error, _)) => Err(error),
        }
    }

    fn translate(&mut self, path: &Path, name: &str, reached: Option<Reached>) -> Result<String, Diagnostic> {
        let limits = ModelLimits::of(self.limits);
        let bytes = asset::read_bytes(path, name, limits.bytes)?;
        let file = ModelFile {
            name,
            path,
            root: &self.folders.root,
            bytes: &bytes,
        };
        let model = translate_model(&file, self.schema, &limits)
            .map_err(|error| Diagnostic::error(error.code(), error.to_string()))?;
        for warning in &model.warnings {
            let warning = Diagnostic::warning("odd-model", format!("{name}: {warning}"));
            self.report.push_once(match reached {
                Some(reached) => warning.at(reached.place),
                None => warning,
            });
        }
        Ok(model.text)
    }

    /// Whether composition takes more steps than a scene may need.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.is_stopped || self.work > self.limits.work
    }

    pub(crate) fn report_exhaustion(&mut self) {
        if self.is_stopped {
            return;
        }
        let message = format!("composing takes more than {} steps", self.limits.work);
        let error = Diagnostic::error("too-much-work", message)
            .note("long lists times many references, or arcs that multiply; `--limit work=N` allows more");
        self.report.push_once(error);
    }

    /// How many files and fields there are, the command line's included.
    pub(crate) fn counts(&self) -> (usize, usize) {
        (self.layers.len(), self.opinions)
    }

    /// Whether every file that was asked for could be read.
    pub(crate) fn is_complete(&self) -> bool {
        let failed = |file: &NamedFile| matches!(file.read, Some(Outcome::Failed));
        !self.files.iter().any(failed)
    }

    /// Gives the stack of a file, with all sublayers.
    pub(crate) fn stack_of(&mut self, layer: LayerId) -> StackId {
        if let Some(&stack) = self.stack_of.get(&layer) {
            return stack;
        }
        let stack = self.build_stack(layer, None);
        self.stack_of.insert(layer, stack);
        stack
    }

    /// Makes the stack of a scene: that of its file, with the command line's layer above it.
    pub(crate) fn build_stack(&mut self, layer: LayerId, session: Option<LayerId>) -> StackId {
        let mut layers: Vec<(LayerId, TimeMap)> = session
            .into_iter()
            .map(|session| (session, TimeMap::IDENTITY))
            .collect();
        self.add_sublayers(layer, TimeMap::IDENTITY, &mut Vec::new(), &mut layers);
        let mut heads = HashMap::new();
        let mut links = Vec::new();
        for (position, &(layer, _)) in layers.iter().enumerate().rev() {
            if links.len() / LINKS_PER_OPINION + self.opinions > self.limits.opinions {
                let message = format!(
                    "the files and their sublayers have more than {} opinions",
                    self.limits.opinions
                );
                self.is_stopped = true;
                let note = "a file that many others list as their sublayer counts for each of them";
                self.report
                    .push_once(Diagnostic::error("too-many-opinions", message).note(note));
                break;
            }
            for (number, spec) in self.layer(layer).specs.iter().enumerate() {
                let head = heads.entry(spec.path).or_insert(0);
                links.push((position as u32, number as u32, *head));
                *head = links.len() as u32;
            }
        }
        self.opinions += links.len() / LINKS_PER_OPINION;
        self.stacks.push(LayerStack { layers, heads, links });
        StackId(self.stacks.len() as u32 - 1)
    }

    /// Adds a layer and what lies below it; `above` holds the layers on the way with the places
    /// that led on from them.
    fn add_sublayers(
        &mut self,
        layer: LayerId,
        time: TimeMap,
        above: &mut Vec<(LayerId, Place)>,
        layers: &mut Vec<(LayerId, TimeMap)>,
    ) {
        layers.push((layer, time));
        for asset in self.layer(layer).sublayers.clone() {
            if layers.len() >= self.limits.layers {
                let message = format!(
                    "a file has at most {} sublayers, all levels together",
                    self.limits.layers
                );
                let error = Diagnostic::error("too-many-layers", message);
                return self.report.push_once(error.at(asset.place));
            }
            let Some(below) = self.open(&asset, "sublayers") else {
                continue;
            };
            above.push((layer, asset.place));
            let time = time.after(asset.time);
            if let Some(first) = above.iter().position(|&(other, _)| other == below) {
                if self.closed_cycles.insert((layer, below)) {
                    self.report_cycle(&above[first..]);
                }
            } else if !time.is_sound() {
                let message = "the offsets of the sublayers to here add up to a time that is too large";
                self.report
                    .push_once(Diagnostic::error("bad-layer-offset", message).at(asset.place));
            } else {
                self.add_sublayers(below, time, above, layers);
            }
            above.pop();
        }
    }

    fn report_cycle(&mut self, steps: &[(LayerId, Place)]) {
        let Some(((_, last), before)) = steps.split_last() else {
            return;
        };
        let name = self.sources.name(last.source).to_owned();
        let message = format!("`{name}` is its own sublayer in the end");
        let mut error = Diagnostic::error("sublayer-cycle", message).at(*last);
        for (_, place) in before {
            error = error.also(*place, format!("leads to {}", self.sources.text(*place)));
        }
        self.report
            .push_once(error.note("a layer cannot lie below itself; take one of these out"));
    }
}
