use bevy_ecs::prelude::*;
use pipeline_core::{Counters, Report, record_items};
use pipeline_data::vocabulary::{Findings, Mesh, field_place};
use pipeline_data::{ComposedScene, ImportedMesh, MeshStore, PrimIndex, RenderRequest};
use rayon::prelude::*;
use scene_format::{Diagnostic, MeshError, MeshLimits, MeshWarning, Place, Scene, mix_hash, parse_obj};
use spatial::TriangleMesh;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// A file to read, with the place of the first field that names it.
struct Wanted {
    path: PathBuf,
    place: Option<Place>,
    /// Whether a prim shades it by its normals.
    normals: bool,
}

/// A file that was read.
struct Imported {
    bytes: Vec<u8>,
    mesh: ImportedMesh,
    warnings: Vec<MeshWarning>,
}

/// Loads each file that a `Mesh` names, once, and mixes its bytes into the scene's hash.
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
    let imported: Vec<_> = wanted
        .par_iter()
        .map(|file| import(file, &shown_path(&file.path, &request.scene), &limits))
        .collect();
    let mut store = MeshStore::default();
    let mut triangles = 0;
    for (file, imported) in wanted.iter().zip(imported) {
        let imported = match imported {
            Ok(imported) => imported,
            Err(error) => {
                findings.push_at(file.place, Diagnostic::error("bad-mesh", error.to_string()));
                continue;
            }
        };
        for warning in &imported.warnings {
            let message = format!("{}: {warning}", shown_path(&file.path, &request.scene));
            findings.push_at(file.place, Diagnostic::warning("odd-mesh", message));
        }
        mix_hash(&mut composed.0.hash, "mesh", &imported.bytes);
        triangles += imported.mesh.mesh.triangles.len();
        store.insert(imported.mesh);
    }
    record_items(triangles);
    counters.counter("load/triangles").add(triangles as u64);
    findings.file(&composed.0, &request, &mut report);
    commands.insert_resource(store);
}

/// Lists the files that prims name, each once, in the order of the prims.
fn list_files(scene: &Scene, meshes: Query<(&PrimIndex, &Mesh)>, findings: &mut Findings) -> Vec<Wanted> {
    let mut rows: Vec<(PrimIndex, &Mesh)> = meshes.iter().map(|(index, mesh)| (*index, mesh)).collect();
    rows.sort_by_key(|(index, _)| *index);
    let mut wanted: Vec<Wanted> = Vec::new();
    let mut row_of = std::collections::BTreeMap::new();
    for (index, mesh) in rows {
        let place = field_place(scene, index.0, "Mesh", &["file"]);
        let path = Path::new(&mesh.file.0);
        if !path
            .extension()
            .is_some_and(|ending| ending.eq_ignore_ascii_case("obj"))
        {
            let message = "only `.obj` files can be read as a mesh yet";
            findings.push_at(place, Diagnostic::error("not-supported-yet", message));
            continue;
        }
        let row = *row_of.entry(path.to_path_buf()).or_insert_with(|| {
            wanted.push(Wanted {
                path: path.to_path_buf(),
                place,
                normals: false,
            });
            wanted.len() - 1
        });
        wanted[row].normals |= mesh.smooth;
    }
    wanted
}

fn import(file: &Wanted, shown: &str, limits: &MeshLimits) -> Result<Imported, MeshError> {
    let bytes = read(&file.path, limits.bytes).map_err(|source| MeshError::Unreadable {
        file: shown.to_owned(),
        source,
    })?;
    let parsed = parse_obj(shown, &bytes, limits)?;
    let mesh = TriangleMesh {
        positions: parsed.positions,
        normals: parsed.normals.filter(|_| file.normals),
        uvs: parsed.uvs,
        triangles: parsed.triangles,
    };
    Ok(Imported {
        bytes,
        mesh: ImportedMesh::new(file.path.clone(), parsed.origin, mesh),
        warnings: parsed.warnings,
    })
}

/// Reads a file up to one byte more than `limit`, so that a longer one can be told.
fn read(path: &Path, limit: u64) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(limit + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Names a file the way the scene was named: below its folder if it lies there.
fn shown_path(path: &Path, scene: &Path) -> String {
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
