use crate::vocabulary::Mesh;
use bevy_ecs::resource::Resource;
use glam::{DVec3, Vec3};
use scene_format::MeshPart;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// Which triangles a `Mesh` names.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MeshKey {
    /// The file, absolute and canonical.
    pub path: PathBuf,
    /// What of it.
    pub part: MeshPart,
}

impl From<&Mesh> for MeshKey {
    fn from(mesh: &Mesh) -> Self {
        Self {
            path: PathBuf::from(&mesh.file.0),
            part: MeshPart {
                mesh: mesh.mesh.clone(),
                primitive: mesh.primitive,
            },
        }
    }
}

/// A mesh of a file in memory.
#[derive(Clone, Debug)]
pub struct ImportedMesh {
    /// Where it comes from.
    pub key: MeshKey,
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
    pub fn new(key: MeshKey, origin: DVec3, mesh: spatial::TriangleMesh) -> Self {
        let extend = |(low, high): (Vec3, Vec3), p: &Vec3| (low.min(*p), high.max(*p));
        Self {
            key,
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

/// Every mesh that the scene names, each once. Written by `load`, read by `geometry` and `tables`.
#[derive(Resource, Clone, Debug, Default)]
pub struct MeshStore {
    meshes: Vec<ImportedMesh>,
    by_key: BTreeMap<MeshKey, usize>,
}

impl MeshStore {
    /// Adds a mesh, or replaces the one of the same key; returns its row.
    pub fn insert(&mut self, mesh: ImportedMesh) -> usize {
        let next = self.meshes.len();
        let row = *self.by_key.entry(mesh.key.clone()).or_insert(next);
        if row < next {
            self.meshes[row] = mesh;
        } else {
            self.meshes.push(mesh);
        }
        row
    }

    /// The row of what a prim names; none if it could not be read, or cannot be seen.
    #[must_use]
    pub fn row_of(&self, mesh: &Mesh) -> Option<usize> {
        self.by_key.get(&MeshKey::from(mesh)).copied()
    }

    /// What a prim names; none as for [`row_of`](Self::row_of).
    #[must_use]
    pub fn get(&self, mesh: &Mesh) -> Option<&ImportedMesh> {
        self.row_of(mesh).map(|row| &self.meshes[row])
    }

    /// All meshes, by row.
    #[must_use]
    pub fn meshes(&self) -> &[ImportedMesh] {
        &self.meshes
    }
}
