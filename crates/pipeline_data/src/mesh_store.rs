use bevy_ecs::resource::Resource;
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// A mesh file in memory.
#[derive(Clone, Debug)]
pub struct ImportedMesh {
    /// The file, absolute and canonical.
    pub path: PathBuf,
    /// Where the middle of the mesh lies in the coordinates of the file, metres; positions are relative to it.
    pub origin: DVec3,
    /// Its triangles, with the normals of the file if it has any and a prim uses them.
    pub mesh: Arc<spatial::TriangleMesh>,
    /// Box around the positions: its least and greatest corner.
    pub bounds: (Vec3, Vec3),
    closed: OnceLock<bool>,
}

impl ImportedMesh {
    /// Describes a mesh that has at least one triangle.
    #[must_use]
    pub fn new(path: PathBuf, origin: DVec3, mesh: spatial::TriangleMesh) -> Self {
        let extend = |(low, high): (Vec3, Vec3), p: &Vec3| (low.min(*p), high.max(*p));
        Self {
            path,
            origin,
            bounds: mesh.positions.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), extend),
            mesh: Arc::new(mesh),
            closed: OnceLock::new(),
        }
    }

    /// True when the mesh separates an inside from an outside. Found out on the first call, which sorts all edges.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        *self.closed.get_or_init(|| self.mesh.is_closed())
    }
}

/// Every mesh file that the scene names, each once. Written by `load`, read by `geometry` and `tables`.
#[derive(Resource, Clone, Debug, Default)]
pub struct MeshStore {
    meshes: Vec<ImportedMesh>,
    by_path: BTreeMap<PathBuf, usize>,
}

impl MeshStore {
    /// Adds a mesh, or replaces the one of the same file; returns its row.
    pub fn insert(&mut self, mesh: ImportedMesh) -> usize {
        let next = self.meshes.len();
        let row = *self.by_path.entry(mesh.path.clone()).or_insert(next);
        if row < next {
            self.meshes[row] = mesh;
        } else {
            self.meshes.push(mesh);
        }
        row
    }

    /// The row of a file.
    #[must_use]
    pub fn row_of(&self, path: &Path) -> Option<usize> {
        self.by_path.get(path).copied()
    }

    /// The mesh of a file.
    #[must_use]
    pub fn get(&self, path: &Path) -> Option<&ImportedMesh> {
        self.row_of(path).map(|row| &self.meshes[row])
    }

    /// All meshes, by row.
    #[must_use]
    pub fn meshes(&self) -> &[ImportedMesh] {
        &self.meshes
    }
}
