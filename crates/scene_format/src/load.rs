//! From a file to a scene: reading, composing, checking, in this order.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::asset::Folders;
use crate::compose::{Composed, LayerId, Library, PathTable, compose};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::hash::hash_scene;
use crate::options::Options;
use crate::scene::{LoadCost, Scene};
use crate::schema::Schema;
use crate::session::read_session;
use crate::source::{SourceId, Sources};
use crate::validate::{check_fields, check_targets, resolve_assets};

/// Loads the scene in a file.
///
/// # Errors
///
/// Everything that is wrong with it, up to 20 messages; after a mistake of syntax that one.
pub fn load(path: &Path, schema: &Schema<'_>, options: &Options) -> Result<Scene, Diagnostics> {
    on_large_stack(|| load_file(path, schema, options))
}

fn load_file(path: &Path, schema: &Schema<'_>, options: &Options) -> Result<Scene, Diagnostics> {
    let canonical = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let folders = Folders::of(folder_of(&canonical), options.root.as_deref());
    let mut library = Library::new(schema, &options.limits, folders);
    match library.add_source(&canonical, &path.display().to_string(), None) {
        Ok(source) => load_source(library, source, Some(canonical), options),
        Err(error) => {
            library.report.push(error);
            Err(library.report.into_diagnostics(library.sources))
        }
    }
}

/// Loads the scene in `text`, as if it were in the file `name`.
///
/// # Errors
///
/// As [`load`].
pub fn load_str(name: &str, text: &str, schema: &Schema<'_>, options: &Options) -> Result<Scene, Diagnostics> {
    on_large_stack(|| load_text(name, text, schema, options))
}

/// Composition goes down the namespace within each arc of a chain, thousands of calls in the worst scene that the
/// limits allow.
const STACK_BYTES: usize = 256 << 20;

/// Runs on a thread whose stack is large enough for every scene, wherever a program loads from. Pages that are not
/// touched cost nothing.
fn on_large_stack<T: Send>(run: impl FnOnce() -> T + Send) -> T {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new()
            .stack_size(STACK_BYTES)
            .spawn_scoped(scope, run)
            .expect("a program that cannot start a thread cannot render either");
        match thread.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}

fn load_text(name: &str, text: &str, schema: &Schema<'_>, options: &Options) -> Result<Scene, Diagnostics> {
    let folder = folder_of(Path::new(name));
    let folders = Folders::of(folder, options.root.as_deref());
    let mut library = Library::new(schema, &options.limits, folders);
    if text.len() > options.limits.file_bytes.min(u32::MAX as usize) {
        let message = format!("{name} has more than {} bytes", options.limits.file_bytes);
        library.report.push(Diagnostic::error("too-large", message));
        return Err(library.report.into_diagnostics(library.sources));
    }
    let folder = library.folders.scene.clone();
    let source = library.sources.add_file(name, &folder, text.to_owned(), None);
    load_source(library, source, None, options)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// - `canonical`: the file that the text is from, so that other files may name it.
fn load_source(
    mut library: Library<'_, '_>,
    source: SourceId,
    canonical: Option<PathBuf>,
    options: &Options,
) -> Result<Scene, Diagnostics> {
    let begun = Instant::now();
    let read_before = library.reading;
    let scene = library
        .add_text(source, canonical)
        .and_then(|layer| compose_scene(&mut library, layer, options));
    match scene {
        Some(mut scene) if !library.report.is_refused() => {
            let (layers, opinions) = library.counts();
            scene.cost = LoadCost {
                layers,
                opinions,
                reading: library.reading,
                composing: begun.elapsed().saturating_sub(library.reading - read_before),
            };
            scene.warnings = library.report.into_warnings();
            scene.sources = library.sources;
            scene.paths = library.paths;
            Ok(scene)
        }
        _ => Err(library.report.into_diagnostics(library.sources)),
    }
}

/// Composes a scene and checks it; it counts only if no error was reported.
fn compose_scene(library: &mut Library<'_, '_>, layer: LayerId, options: &Options) -> Option<Scene> {
    let mut composed = compose_with_session(library, layer, options)?;
    let root = library.layer(layer);
    let (time, default_prim) = (root.time.unwrap_or_default(), root.default_prim.clone());
    let default_prim = default_prim.map(|name| {
        let path = library.paths.text(name.value);
        if !composed.index.contains_key(&path) {
            let message = format!("`default_prim` names `{path}`, which is not here");
            let error = Diagnostic::error("missing-prim", message).at(name.place);
            library.report.push(error);
        }
        path
    });
    let report = &mut library.report;
    check_fields(&composed.prims, library.schema, report);
    if options.check_targets {
        check_targets(&composed, report);
    }
    let assets = if options.check_assets {
        resolve_assets(&mut composed.prims, &library.sources, &library.folders, report)
    } else {
        Vec::new()
    };
    let frame = options.frame.unwrap_or(time.start);
    if !frame.is_finite() {
        report.push(Diagnostic::error("not-finite", "the frame must be finite"));
    }
    let mut hash = hash_scene(&composed.prims, time, &library.folders.root);
    crate::mix_hash(&mut hash, "frame", &frame.to_le_bytes());
    Some(Scene {
        hash,
        files: [0; 32],
        prims: composed.prims,
        index: composed.index,
        default_prim,
        time,
        frame,
        warnings: Vec::new(),
        assets,
        cost: LoadCost::default(),
        sources: Sources::default(),
        paths: PathTable::default(),
        folders: library.folders.clone(),
    })
}

/// Composes a file below what the command line says; none if files could not be read, which makes
/// further messages pointless.
fn compose_with_session(library: &mut Library<'_, '_>, layer: LayerId, options: &Options) -> Option<Composed> {
    let session = read_session(library, options);
    let mut found = None;
    if session.has_short_sets() {
        let above = session.layer(library, None);
        let stack = library.build_stack(layer, Some(above));
        let before = library.report.clone();
        let without = compose(library, stack, options.load_payloads);
        if without.is_cut_short || (library.report.is_refused() && !library.is_complete()) {
            return None;
        }
        // What this scene lacks, the arguments may add.
        library.report.forget_since(before);
        found = Some(without);
    }
    let above = (!session.is_empty()).then(|| session.layer(library, found.as_ref()));
    let stack = library.build_stack(layer, above);
    let composed = compose(library, stack, options.load_payloads);
    if composed.is_cut_short || (library.report.is_refused() && !library.is_complete()) {
        return None;
    }
    session.check(&composed, &mut library.report);
    Some(composed)
}
