use bevy_ecs::prelude::*;
use pipeline_core::{Counters, Report, record_items};
use pipeline_data::vocabulary::{Findings, Mesh, field_place};
use pipeline_data::{ComposedScene, ImportedMesh, MeshKey, MeshStore, PrimIndex, RenderRequest};
use rayon::prelude::*;
use scene_format::{
    Diagnostic, MeshData, MeshError, MeshLimits, MeshWarning, Model, ModelError, ModelFile, Oddity, Place, Scene,
    is_model,
};
use spatial::TriangleMesh;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// A file to read.
struct Wanted {
    path: PathBuf,
    /// The first field that names it.
    place: Option<Place>,
    parts: Vec<WantedPart>,
}

/// Triangles that prims want of a file.
struct WantedPart {
    key: MeshKey,
    /// The first field that names them.
    place: Option<Place>,
    /// Whether a prim shades them by their normals.
    normals: bool,
    /// Whether a prim multiplies its material by their colours.
    colours: bool,
}

/// A file that was read.
struct Imported {
    /// The file and others that it names.
    files: Vec<Vec<u8>>,
    /// In the order of the parts.
    meshes: Vec<Result<ImportedMesh, ModelError>>,
    warnings: Oddities,
}

/// What is odd about the meshes of a file: of each kind the first, and in how many meshes more.
#[derive(Default)]
struct Oddities(Vec<(MeshWarning, usize)>);

/// Loads what each `Mesh` names, every file once, and mixes its bytes into the scene's hash.
///
/// Files are parsed in parallel; store and hash are filled in the order in which the prims name them.
pub(super) fn import_meshes(
    mut commands: Commands,
    request: Res<RenderRequest>,
    mut composed: ResMut<ComposedScene>,
    mut report: ResMut<Report>,
    mut counters: ResMut<Counters>,
    meshes: Query<(&PrimIndex, &Mesh)>,
) {
    let mut findings = Findings::default();
    let wanted = list_files(&composed.0, meshes, &mut findings);
    let limits = MeshLimits::default();
    let root = composed.0.root();
    let imported: Vec<_> = wanted
        .par_iter()
        .map(|file| import(file, &shown_path(&file.path, &request.scene), root, &limits))
        .collect();
    let mut store = MeshStore::default();
    for (file, imported) in wanted.iter().zip(imported) {
        match imported {
            Ok(imported) => {
                imported.warnings.report(file, &request, &mut findings);
                for bytes in &imported.files {
                    composed.0.mix_file("mesh", bytes);
                }
                for (part, mesh) in file.parts.iter().zip(imported.meshes) {
                    match mesh {
                        Ok(mesh) => {
                            store.insert(mesh);
                        }
                        Err(error) => findings.push_at(part.place, describe(&error)),
                    }
                }
            }
            Err(error) => findings.push_at(file.place, describe(&error)),
        }
    }
    let triangles: usize = store.meshes().iter().map(|mesh| mesh.mesh.triangles.len()).sum();
    record_items(triangles);
    counters.counter("load/triangles").add(triangles as u64);
    findings.file(&composed.0, &request, &mut report);
    commands.insert_resource(store);
}

/// Lists the files that prims name with what they want of them, each once, in the order of the prims.
fn list_files(scene: &Scene, meshes: Query<(&PrimIndex, &Mesh)>, findings: &mut Findings) -> Vec<Wanted> {
    let mut rows: Vec<(PrimIndex, &Mesh)> = meshes.iter().map(|(index, mesh)| (*index, mesh)).collect();
    rows.sort_by_key(|(index, _)| *index);
    let mut wanted: Vec<Wanted> = Vec::new();
    let mut row_of_file = BTreeMap::new();
    let mut row_of_part = BTreeMap::new();
    for (index, mesh) in rows {
        let place = field_place(scene, index.0, "Mesh", &["file"]);
        let key = MeshKey::from(mesh);
        if !is_model(&key.path) {
            let message = "only `.obj`, `.gltf` and `.glb` files can be read as a mesh";
            findings.push_at(place, Diagnostic::error("not-supported-yet", message));
            continue;
        }
        let file = *row_of_file.entry(key.path.clone()).or_insert_with(|| {
            wanted.push(Wanted {
                path: key.path.clone(),
                place,
                parts: Vec::new(),
            });
            wanted.len() - 1
        });
        let parts = &mut wanted[file].parts;
        let part = *row_of_part.entry(key.clone()).or_insert_with(|| {
            let place = field_place(scene, index.0, "Mesh", &["primitive", "mesh", "file"]);
            parts.push(WantedPart {
                key,
                place,
                normals: false,
                colours: false,
            });
            parts.len() - 1
        });
        parts[part].normals |= mesh.smooth;
        parts[part].colours |= mesh.colors;
    }
    wanted
}

fn import(file: &Wanted, shown: &str, root: &Path, limits: &MeshLimits) -> Result<Imported, ModelError> {
    let bytes = read(&file.path, limits.bytes).map_err(|source| MeshError::Unreadable {
        file: shown.to_owned(),
        source,
    })?;
    let opened = ModelFile {
        name: shown,
        path: &file.path,
        root,
        bytes: &bytes,
    };
    let mut model = Model::open(opened, limits)?;
    let mut warnings = Oddities::default();
    let mut meshes = Vec::with_capacity(file.parts.len());
    for part in &file.parts {
        meshes.push(model.mesh(&part.key.part).map(|data| {
            warnings.add(&data.warnings);
            place(part, data)
        }));
    }
    let others: Vec<Vec<u8>> = model.other_files().iter().map(|(_, bytes)| bytes.clone()).collect();
    drop(model);
    Ok(Imported {
        files: std::iter::once(bytes).chain(others).collect(),
        meshes,
        warnings,
    })
}

fn place(part: &WantedPart, data: MeshData) -> ImportedMesh {
    let mesh = TriangleMesh {
        positions: data.positions,
        normals: data.normals.filter(|_| part.normals),
        uvs: data.uvs,
        more_uvs: data.more_uvs,
        colours: data.colours.filter(|_| part.colours),
        triangles: data.triangles,
    };
    ImportedMesh::new(part.key.clone(), data.origin, mesh)
}

/// A mesh that cannot be seen is no reason to refuse the scene.
fn describe(error: &ModelError) -> Diagnostic {
    match error {
        ModelError::Flat { .. } => Diagnostic::warning(error.code(), error.to_string()),
        _ => Diagnostic::error(error.code(), error.to_string()),
    }
}

impl Oddities {
    fn add(&mut self, warnings: &[MeshWarning]) {
        let mut seen: Vec<Oddity> = Vec::new();
        for warning in warnings {
            if seen.contains(&warning.oddity) {
                continue;
            }
            seen.push(warning.oddity);
            match self.0.iter_mut().find(|(first, _)| first.oddity == warning.oddity) {
                Some((_, more)) => *more += 1,
                None => self.0.push((*warning, 0)),
            }
        }
    }

    fn report(&self, file: &Wanted, request: &RenderRequest, findings: &mut Findings) {
        let shown = shown_path(&file.path, &request.scene);
        for (warning, more) in &self.0 {
            let rest = match more {
                0 => String::new(),
                1 => "; so it is in 1 more mesh of the file".to_owned(),
                more => format!("; so it is in {more} more meshes of the file"),
            };
            let message = format!("{shown}: {warning}{rest}");
            findings.push_at(file.place, Diagnostic::warning("odd-mesh", message));
        }
    }
}

/// Reads a file up to one byte more than `limit`, so that a longer one can be told.
pub(super) fn read(path: &Path, limit: u64) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?
        .take(limit.saturating_add(1))
        .read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Names a file the way the scene was named: below its folder if it lies there.
pub(super) fn shown_path(path: &Path, scene: &Path) -> String {
    let folder = scene.parent().unwrap_or(Path::new(""));
    let canonical = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    }
    .canonicalize();
    match canonical
        .ok()
        .and_then(|canonical| path.strip_prefix(canonical).ok().map(Path::to_path_buf))
    {
        Some(rest) => folder.join(rest).display().to_string(),
        None => path.display().to_string(),
    }
}
