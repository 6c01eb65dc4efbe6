use super::motion::{Motions, find_motions};
use super::placement::{PlacementError, WorldBox, half_extent, place};
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::AppTypeRegistry;
use glam::{DAffine3, DVec3};
use pipeline_core::record_items;
use pipeline_data::vocabulary::{
    Findings, GeometryComponents, GeometryComponentsItem, GeometrySource, LookAt, SceneReport, Transform, field_place,
    is_scene_component,
};
use pipeline_data::{MeshStore, PrimIndex, SceneOrigin, ShutterInterval, WorldMotion, WorldTransform};
use scene_format::{Diagnostic, FieldState, Place, Scene, Schema};
use std::slice;

type Placeable<'a> = (
    Entity,
    &'a PrimIndex,
    Option<&'a Transform>,
    Option<&'a LookAt>,
    GeometryComponents,
);

/// Gives every prim its world transform, its motion where it moves while the shutter is open, and finds the middle of all
/// geometry.
///
/// What is below a prim that cannot be placed is left without a transform and without a message of its own.
pub(super) fn resolve_transforms(
    mut commands: Commands,
    mut check: SceneReport,
    store: Res<MeshStore>,
    shutter: Option<Res<ShutterInterval>>,
    registry: Res<AppTypeRegistry>,
    prims: Query<Placeable<'_>>,
) {
    let scene = check.scene();
    let mut findings = Findings::default();
    let mut rows: Vec<_> = prims.iter().collect();
    rows.sort_by_key(|(_, index, ..)| **index);
    record_items(rows.len());
    let mut world_of_prim: Vec<Option<DAffine3>> = vec![None; scene.prims.len()];
    for (_, index, transform, look_at, _) in &rows {
        let row = index.0 as usize;
        check_matrix_alone(scene, index.0, &mut findings);
        let parent = scene.prims[row]
            .parent
            .map_or(Some(DAffine3::IDENTITY), |parent| world_of_prim[parent]);
        world_of_prim[row] = parent.and_then(|parent| match place(&parent, *transform, *look_at) {
            Ok(world) => Some(world),
            Err(error) => {
                let (place, finding) = describe(error, scene, index.0);
                findings.push_at(place, finding);
                None
            }
        });
    }
    let motions = match shutter {
        None => Motions::default(),
        Some(shutter) => {
            let registry = registry.read();
            let placed: Vec<u32> = rows.iter().map(|(_, index, ..)| index.0).collect();
            // The scene was read with this schema.
            Schema::new(&registry, is_scene_component).map_or_else(
                |_| Motions::default(),
                |schema| find_motions(scene, &schema, *shutter, &placed, &world_of_prim),
            )
        }
    };
    for (prim, error) in &motions.errors {
        let (place, finding) = describe(*error, scene, *prim);
        findings.push_at(place, finding.note("so it is at some time while the shutter is open"));
    }
    let mut around = WorldBox::EMPTY;
    for (entity, index, _, _, geometry) in rows {
        let mut entity = commands.entity(entity);
        entity.remove::<(WorldTransform, WorldMotion)>();
        let Some(world) = world_of_prim[index.0 as usize] else {
            continue;
        };
        let keys = motions.keys.get(&index.0);
        for key in keys.map_or(slice::from_ref(&world), Vec::as_slice) {
            add_geometry(&mut around, key, &geometry, &store);
        }
        entity.insert(WorldTransform(world));
        if let Some(keys) = keys {
            entity.insert(WorldMotion(keys.as_slice().into()));
        }
    }
    check.file(findings);
    commands.insert_resource(SceneOrigin(around.centre()));
}

fn add_geometry(around: &mut WorldBox, world: &DAffine3, geometry: &GeometryComponentsItem<'_, '_>, store: &MeshStore) {
    match geometry.sources().next() {
        Some((_, GeometrySource::Shape(shape))) => {
            let half = half_extent(&shape);
            around.add(world, -half, half);
        }
        Some((_, GeometrySource::Mesh(mesh))) => {
            if let Some(mesh) = store.get(mesh) {
                let corner = |p: glam::Vec3| -> DVec3 { mesh.origin + p.as_dvec3() };
                around.add(world, corner(mesh.bounds.0), corner(mesh.bounds.1));
            }
        }
        None => {}
    }
}

/// A matrix says all that a transform can say.
fn check_matrix_alone(scene: &Scene, prim: u32, findings: &mut Findings) {
    let Some(transform) = scene.prims[prim as usize].component("Transform") else {
        return;
    };
    let written = |name: &str| {
        transform
            .field(name)
            .filter(|field| !matches!(field.state, FieldState::Blocked))
    };
    let Some(matrix) = written("matrix") else { return };
    let others = ["translate", "rotate", "scale", "quaternion"];
    if let Some(other) = others.into_iter().find_map(written) {
        let message = format!("`Transform` cannot have both `matrix` and `{}`", other.name);
        findings.push(
            Diagnostic::error("exclusive-fields", message)
                .at(matrix.place)
                .also(other.place, format!("`{}` is written", other.name))
                .note(format!(
                    "to use `matrix`, write `Transform: ({}: Block)` where it should win",
                    other.name
                )),
        );
    }
}

fn describe(error: PlacementError, scene: &Scene, prim: u32) -> (Option<Place>, Diagnostic) {
    let path = &scene.prims[prim as usize].path;
    let (component, fields, code, message, note): (_, &[&str], _, _, _) = match error {
        PlacementError::NotFinite => (
            "Transform",
            &[],
            "not-finite",
            format!("the place of `{path}` in the world overflows"),
            "with the transforms above it, some number is too large",
        ),
        PlacementError::Singular => (
            "Transform",
            &["matrix", "scale"],
            "singular-transform",
            format!("the transform of `{path}` is singular: it leaves no volume"),
            "give every axis a scale other than 0; a flat thing is a `Quad` or a `Disc`",
        ),
        PlacementError::NoRotation => (
            "Transform",
            &["quaternion"],
            "bad-rotation",
            format!("the quaternion of `{path}` has no length"),
            "no rotation is (0, 0, 0, 1)",
        ),
        PlacementError::NotAffine => (
            "Transform",
            &["matrix"],
            "bad-matrix",
            format!("the last row of the matrix of `{path}` is not (0, 0, 0, 1)"),
            "the 16 numbers are columns: the fourth, eighth and twelfth are 0, the last is 1",
        ),
        PlacementError::TargetIsOrigin => (
            "LookAt",
            &["target"],
            "bad-look-at",
            format!("`{path}` lies where it looks, so it has no direction"),
            "`target` is a point of the world; move it or the prim",
        ),
        PlacementError::UpAlongView => (
            "LookAt",
            &["up", "target"],
            "bad-look-at",
            format!("`{path}` looks along its `up`, so its roll is not known"),
            "write another `up`, for example `up: (0, 0, 1)` for a view straight down",
        ),
    };
    let place = field_place(scene, prim, component, fields);
    (place, Diagnostic::error(code, message).note(note))
}
