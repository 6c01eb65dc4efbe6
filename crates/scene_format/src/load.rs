//! From a file to a scene: reading, composing, checking, in this order.

use std::cell::RefCell;
use std::path::Path;

use crate::asset::{Folders, read_text};
use crate::compose::{compose, refuse_arcs};
use crate::diagnostic::{Diagnostic, Diagnostics, Report};
use crate::hash::hash_scene;
use crate::namespace::Namespace;
use crate::options::Options;
use crate::read::read_layer;
use crate::scene::Scene;
use crate::schema::Schema;
use crate::session::{SetOpinion, read_set, refuse_variant};
use crate::source::{Place, SourceId, Sources};
use crate::validate::{check_fields, check_targets, resolve_assets};

/// Loads the scene in a file.
///
/// # Errors
///
/// Everything that is wrong with it, up to 20 messages; after a mistake of syntax that one.
pub fn load(path: &Path, schema: &Schema<'_>, options: &Options) -> Result<Scene, Diagnostics> {
    let name = path.display().to_string();
    let mut sources = Sources::default();
    let folder = folder_of(path);
    match read_text(path, &options.limits) {
        Ok(text) => load_text(&name, folder, text, schema, options),
        Err((error, text)) => {
            let end = text.len() as u32;
            let source = sources.add_file(&name, folder, text);
            let mut report = Report::default();
            report.push(if error.code == "not-utf-8" {
                error.at(Place {
                    source,
                    start: end,
                    end,
                })
            } else {
                error
            });
            Err(report.into_diagnostics(sources))
        }
    }
}

/// Loads the scene in `text`, as if it were in the file `name`.
///
/// # Errors
///
/// As [`load`].
pub fn load_str(name: &str, text: &str, schema: &Schema<'_>, options: &Options) -> Result<Scene, Diagnostics> {
    let folder = folder_of(Path::new(name));
    load_text(name, folder, text.to_owned(), schema, options)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn load_text(
    name: &str,
    folder: &Path,
    text: String,
    schema: &Schema<'_>,
    options: &Options,
) -> Result<Scene, Diagnostics> {
    let folders = Folders::of(folder, options.root.as_deref());
    let mut sources = Sources::default();
    let report = RefCell::new(Report::default());
    if text.len() > options.limits.file_bytes.min(u32::MAX as usize) {
        let message = format!("{name} has more than {} bytes", options.limits.file_bytes);
        report.borrow_mut().push(Diagnostic::error("too-large", message));
        return Err(report.into_inner().into_diagnostics(sources));
    }
    let source = sources.add_file(name, &folders.scene, text);
    match compose_file(source, &mut sources, &folders, schema, options, &report) {
        Some(mut scene) if !report.borrow().is_refused() => {
            scene.warnings = report.into_inner().warnings;
            scene.sources = sources;
            Ok(scene)
        }
        _ => Err(report.into_inner().into_diagnostics(sources)),
    }
}

/// Does everything; the scene counts only if nothing was reported.
fn compose_file(
    source: SourceId,
    sources: &mut Sources,
    folders: &Folders,
    schema: &Schema<'_>,
    options: &Options,
    report: &RefCell<Report>,
) -> Option<Scene> {
    let limits = &options.limits;
    let mut layer = read_layer(sources, source, schema, limits, report)?;
    let tree = Namespace::of(&mut layer, limits, &mut report.borrow_mut());
    refuse_arcs(&layer, &tree, &mut report.borrow_mut());
    for variant in &options.variants {
        refuse_variant(variant, sources, &tree, &mut report.borrow_mut());
    }
    let sets = read_sets(sources, &tree, schema, options, report);
    let report = &mut *report.borrow_mut();
    let mut composed = compose(tree, sets, schema, limits, report);
    check_fields(&composed.prims, schema, report);
    check_targets(&composed, report);
    let assets = if options.check_assets {
        resolve_assets(&mut composed.prims, sources, folders, report)
    } else {
        Vec::new()
    };
    let default_prim = layer.default_prim.map(|name| {
        if !composed.index.contains_key(&name.value) {
            let message = format!("`default_prim` names `{}`, which is not here", name.value);
            report.push(Diagnostic::error("missing-prim", message).at(name.place));
        }
        name.value
    });
    let time = layer.time.unwrap_or_default();
    let frame = options.frame.unwrap_or(time.start);
    if !frame.is_finite() {
        report.push(Diagnostic::error("not-finite", "the frame must be finite"));
    }
    let mut hash = hash_scene(&composed.prims, time, &folders.root);
    crate::mix_hash(&mut hash, "frame", &frame.to_le_bytes());
    Some(Scene {
        hash,
        prims: composed.prims,
        index: composed.index,
        default_prim,
        time,
        frame,
        warnings: Vec::new(),
        assets,
        sources: Sources::default(),
        folders: folders.clone(),
    })
}

fn read_sets(
    sources: &mut Sources,
    tree: &Namespace,
    schema: &Schema<'_>,
    options: &Options,
    report: &RefCell<Report>,
) -> Vec<SetOpinion> {
    let mut sets = Vec::new();
    for text in &options.sets {
        let source = sources.add_argument("--set", text);
        sets.extend(read_set(sources, source, tree, schema, &options.limits, report));
    }
    sets
}
