use bevy_ecs::prelude::*;
use glam::{DAffine3, DVec3};
use pipeline_core::{Counters, record_items};
use pipeline_data::vocabulary::{Findings, GeometryComponents, GeometrySource, Mesh, SceneReport, component_place};
use pipeline_data::{Acceleration, InstancePrims, MeshStore, PrimIndex, SceneOrigin, WorldMotion, WorldTransform};
use scene_format::{Diagnostic, Scene};
use spatial::{Geometry, Instance, Placement, RayScene, SpatialError, TriangleMesh};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Geometries and instances as `spatial` wants them, with what the instances came from.
struct Parts<'a> {
    store: &'a MeshStore,
    geometries: Vec<Geometry>,
    instances: Vec<Instance>,
    prims: Vec<u32>,
    /// Name of the component of each instance.
    components: Vec<&'static str>,
    /// Row of the geometry of a mesh, by row in the store and whether it is shaded by its normals.
    row_of_mesh: BTreeMap<(usize, bool), u32>,
}

/// Rounding of coordinates by more than this share of the size of a thing is worth a warning.
const MOST_ROUNDING: f32 = 0.01;

/// Collects all geometry, moved to the scene's origin, and builds the ray scene.
pub(super) fn build_acceleration(
    mut check: SceneReport,
    store: Res<MeshStore>,
    origin: Res<SceneOrigin>,
    mut counters: ResMut<Counters>,
    mut acceleration: ResMut<Acceleration>,
    mut instance_prims: ResMut<InstancePrims>,
    prims: Query<(&PrimIndex, &WorldTransform, Option<&WorldMotion>, GeometryComponents)>,
) {
    let scene = check.scene();
    let mut findings = Findings::default();
    let mut parts = Parts {
        store: &store,
        geometries: Vec::new(),
        instances: Vec::new(),
        prims: Vec::new(),
        components: Vec::new(),
        row_of_mesh: BTreeMap::new(),
    };
    let mut rows: Vec<_> = prims.iter().collect();
    rows.sort_by_key(|(index, ..)| **index);
    for (index, world, motion, geometry) in rows {
        let mut sources = geometry.sources();
        let Some((name, source)) = sources.next() else { continue };
        if let Some((second, _)) = sources.next() {
            let finding = two_geometries(scene, index.0, name, second);
            findings.push_at(component_place(scene, index.0, second), finding);
        } else {
            let motion = motion.map(|motion| &*motion.0);
            parts.add(index.0, name, source, (&world.0, motion), origin.0);
        }
    }
    acceleration.0 = None;
    record_items(parts.instances.len());
    counters.counter("geometry/instances").add(parts.instances.len() as u64);
    if !findings.has_error() && !check.failed() {
        match RayScene::build(parts.geometries.clone(), parts.instances.clone()) {
            Ok(rays) => {
                parts.warn_of_rounding(&rays, scene, &mut findings);
                acceleration.0 = Some(rays);
            }
            Err(error) => parts.find_errors(&error, scene, &mut findings),
        }
    }
    instance_prims.0 = parts.prims;
    check.file(findings);
}

impl Parts<'_> {
    fn add(
        &mut self,
        prim: u32,
        component: &'static str,
        source: GeometrySource<'_>,
        (world, motion): (&DAffine3, Option<&[DAffine3]>),
        scene_origin: DVec3,
    ) {
        let (geometry, own_origin) = match source {
            GeometrySource::Shape(shape) => (self.add_geometry(Geometry::Shape(shape)), DVec3::ZERO),
            // A file that could not be read was reported when it was.
            GeometrySource::Mesh(mesh) => match self.add_mesh(mesh) {
                Some(added) => added,
                None => return,
            },
        };
        // First to the place in the world, then to the scene's origin, so that large numbers cancel in `f64`.
        let rebased = |world: &DAffine3| DAffine3 {
            matrix3: world.matrix3,
            translation: world.transform_point3(own_origin) - scene_origin,
        };
        let placement = match motion {
            None => Placement::Fixed(rebased(world)),
            Some(keys) => Placement::Moving(keys.iter().map(rebased).collect()),
        };
        self.instances.push(Instance { geometry, placement });
        self.prims.push(prim);
        self.components.push(component);
    }

    fn add_geometry(&mut self, geometry: Geometry) -> u32 {
        self.geometries.push(geometry);
        self.geometries.len() as u32 - 1
    }

    /// Row of the geometry of a mesh, and where its middle lies in the coordinates of the file.
    fn add_mesh(&mut self, mesh: &Mesh) -> Option<(u32, DVec3)> {
        let row = self.store.row_of(mesh)?;
        let imported = &self.store.meshes()[row];
        let smooth = mesh.smooth || imported.mesh.normals.is_none();
        let geometry = match self.row_of_mesh.get(&(row, smooth)) {
            Some(geometry) => *geometry,
            None => {
                let triangles = if smooth {
                    Arc::clone(&imported.mesh)
                } else {
                    without_normals(&imported.mesh)
                };
                let geometry = self.add_geometry(Geometry::Mesh(triangles));
                self.row_of_mesh.insert((row, smooth), geometry);
                geometry
            }
        };
        Some((geometry, imported.origin))
    }

    /// Says which prims are so small and so far from the middle of the scene that single precision distorts them.
    fn warn_of_rounding(&self, rays: &RayScene, scene: &Scene, findings: &mut Findings) {
        let reach = |row: &usize| {
            let bounds = rays.instance_bounds(*row as u32);
            let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
            (!bounds.is_empty() && reach * f32::EPSILON > MOST_ROUNDING * bounds.diagonal()).then_some(reach)
        };
        let mut lost = (0..self.instances.len()).filter_map(|row| Some((row, reach(&row)?)));
        let Some((row, distance)) = lost.next() else { return };
        let path = &scene.prims[self.prims[row] as usize].path;
        let others = match lost.count() {
            0 => String::new(),
            1 => " and 1 other".into(),
            n => format!(" and {n} others"),
        };
        let message = format!("`{path}`{others}: too small for so large a scene, rounding distorts it");
        let finding = Diagnostic::warning("lost-in-rounding", message)
            .note(format!(
                "it lies {distance:.1e} m from the middle of the scene, where single precision resolves {:.1e} m",
                distance * f32::EPSILON
            ))
            .note("bring what is far off nearer, or leave it out");
        findings.push_at(component_place(scene, self.prims[row], self.components[row]), finding);
    }

    /// Says what is wrong with which prim, after the whole could not be built because of `first`.
    fn find_errors(&self, first: &SpatialError, scene: &Scene, findings: &mut Findings) {
        for (row, instance) in self.instances.iter().enumerate() {
            let alone = vec![Instance {
                geometry: 0,
                placement: instance.placement.clone(),
            }];
            let geometry = self.geometries[instance.geometry as usize].clone();
            if let Err(error) = RayScene::build(vec![geometry], alone) {
                let (component, finding) = describe(&error, scene, self.prims[row], self.components[row]);
                findings.push_at(component_place(scene, self.prims[row], component), finding);
            }
        }
        if !findings.has_error() {
            findings.push(Diagnostic::error("bad-geometry", first.to_string()));
        }
    }
}

fn without_normals(mesh: &TriangleMesh) -> Arc<TriangleMesh> {
    Arc::new(TriangleMesh {
        normals: None,
        ..mesh.clone()
    })
}

/// Puts an error about one prim in words, and names the component that has to change.
fn describe<'c>(error: &SpatialError, scene: &Scene, prim: u32, component: &'c str) -> (&'c str, Diagnostic) {
    let path = &scene.prims[prim as usize].path;
    let (code, component, what) = match error {
        SpatialError::SingularTransform { .. } | SpatialError::NonFiniteTransform { .. } => {
            ("singular-transform", "Transform", error.to_string())
        }
        SpatialError::Overflow { .. } => ("too-far", component, error.to_string()),
        SpatialError::InvalidShape { reason, .. } => ("bad-shape", component, (*reason).to_owned()),
        _ => ("bad-geometry", component, error.to_string()),
    };
    // The row in the message is that of a scene of one, which says nothing to anybody.
    let what = what
        .trim_start_matches("instance 0: ")
        .trim_start_matches("geometry 0: ");
    (
        component,
        Diagnostic::error(code, format!("`{path}` cannot be traced: {what}")),
    )
}

fn two_geometries(scene: &Scene, prim: u32, first: &str, second: &str) -> Diagnostic {
    let path = &scene.prims[prim as usize].path;
    let message = format!("`{path}` has two geometries, `{first}` and `{second}`");
    let finding = Diagnostic::error("two-geometries", message)
        .note("a prim has one; put the other on a child")
        .note(format!(
            "`without: [\"{first}\"]` removes one that a weaker opinion brings"
        ));
    match component_place(scene, prim, first) {
        Some(place) => finding.also(place, format!("`{first}` is written")),
        None => finding,
    }
}
