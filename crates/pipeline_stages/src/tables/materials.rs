use super::surface::{
    conductor_material, dielectric_material, diffuse_material, plastic_material, principled_material,
};
use bevy_ecs::prelude::*;
use pipeline_core::{Counters, record_items};
use pipeline_data::vocabulary::{
    Conductor, Dielectric, Diffuse, Emission, Findings, GeometryComponents, GeometryComponentsItem, GeometrySource,
    LightTransport, MaterialBinding, Plastic, Principled, SceneReport, component_place, field_place,
};
use pipeline_data::{InstancePrims, MeshStore, PrimIndex, RenderSettings};
use radiometry::Rgb;
use scene_format::{Diagnostic, Scene};
use std::collections::BTreeMap;
use transport::Material;

/// Names of the material components, for messages.
const MATERIALS: &str = "Diffuse, Conductor, Dielectric, Plastic, Principled";

/// Materials by row, and the row of each instance. On its way to `join_tables`.
#[derive(Resource, Default)]
pub(super) struct MaterialTable {
    pub(super) materials: Vec<Material>,
    pub(super) of_instance: Vec<u32>,
    /// Radiance that the material of each instance emits by itself, and the prim with the material.
    pub(super) glow_of_instance: Vec<Option<(Rgb, u32)>>,
}

type MaterialPrim<'a> = (
    &'a PrimIndex,
    Option<&'a Diffuse>,
    Option<&'a Conductor>,
    Option<&'a Dielectric>,
    Option<&'a Plastic>,
    Option<&'a Principled>,
);
type HasMaterial = Or<(
    With<Diffuse>,
    With<Conductor>,
    With<Dielectric>,
    With<Plastic>,
    With<Principled>,
)>;

/// A material component as a row.
#[derive(Clone, Copy)]
struct Row {
    row: u32,
    prim: u32,
    component: &'static str,
    needs_inside: bool,
    glow: Rgb,
}

/// Rows by prim, and who uses which.
struct Rows<'a> {
    scene: &'a Scene,
    table: MaterialTable,
    of_prim: BTreeMap<u32, Row>,
    /// Prim with the material that a prim is bound to; `None` after an error.
    bindings: BTreeMap<u32, Option<u32>>,
    black: Option<u32>,
    default: Option<u32>,
}

/// Turns material components into rows and finds the row of every instance.
#[expect(clippy::too_many_arguments, reason = "a system lists all that it touches")]
pub(super) fn build_material_table(
    mut check: SceneReport,
    settings: Option<Res<RenderSettings>>,
    store: Res<MeshStore>,
    instances: Res<InstancePrims>,
    mut counters: ResMut<Counters>,
    mut table: ResMut<MaterialTable>,
    materials: Query<MaterialPrim<'_>, HasMaterial>,
    bindings: Query<(&PrimIndex, &MaterialBinding)>,
    geometry: Query<(&PrimIndex, GeometryComponents, Has<Emission>)>,
) {
    let mut findings = Findings::default();
    let specular_alpha = settings.map_or(LightTransport::default().specular_alpha, |s| s.methods.specular_alpha);
    let mut rows = Rows {
        scene: check.scene(),
        table: MaterialTable::default(),
        of_prim: BTreeMap::new(),
        bindings: BTreeMap::new(),
        black: None,
        default: None,
    };
    rows.add_materials(&materials, specular_alpha, &mut findings);
    rows.add_bindings(&bindings, &mut findings);
    let geometry: BTreeMap<u32, _> = geometry
        .iter()
        .map(|(index, parts, emits)| (index.0, (parts, emits)))
        .collect();
    for prim in &instances.0 {
        let Some((parts, emits)) = geometry.get(prim) else {
            continue;
        };
        let row = rows.row_for(*prim, *emits);
        rows.table.of_instance.push(row);
        let glow = rows
            .component_for(*prim)
            .filter(|found| !emits && !found.glow.is_black());
        rows.table
            .glow_of_instance
            .push(glow.map(|found| (found.glow, found.prim)));
        rows.check_inside(*prim, parts, &store, &mut findings);
    }
    record_items(rows.table.of_instance.len());
    counters
        .counter("tables/materials")
        .add(rows.table.materials.len() as u64);
    *table = rows.table;
    check.file(findings);
}

impl Rows<'_> {
    fn add(&mut self, material: Material) -> u32 {
        self.table.materials.push(material);
        self.table.materials.len() as u32 - 1
    }

    fn path(&self, prim: u32) -> &str {
        &self.scene.prims[prim as usize].path
    }

    fn add_materials(
        &mut self,
        materials: &Query<MaterialPrim<'_>, HasMaterial>,
        specular_alpha: f32,
        findings: &mut Findings,
    ) {
        let mut all: Vec<_> = materials.iter().collect();
        all.sort_by_key(|(index, ..)| **index);
        for (index, diffuse, conductor, dielectric, plastic, principled) in all {
            let prim = index.0;
            let names = [
                diffuse.map(|_| "Diffuse"),
                conductor.map(|_| "Conductor"),
                dielectric.map(|_| "Dielectric"),
                plastic.map(|_| "Plastic"),
                principled.map(|_| "Principled"),
            ];
            let names: Vec<&str> = names.into_iter().flatten().collect();
            if let [first, second, ..] = names[..] {
                let message = format!("`{}` has two materials, `{first}` and `{second}`", self.path(prim));
                let mut finding = Diagnostic::error("two-materials", message)
                    .note("a prim has one")
                    .note(format!(
                        "`without: [\"{first}\"]` removes one that a weaker opinion brings"
                    ));
                if let Some(place) = component_place(self.scene, prim, first) {
                    finding = finding.also(place, format!("`{first}` is written"));
                }
                findings.push_at(component_place(self.scene, prim, second), finding);
            }
            let material = if let Some(diffuse) = diffuse {
                diffuse_material(diffuse)
            } else if let Some(conductor) = conductor {
                conductor_material(conductor, specular_alpha, self.scene, prim, findings)
            } else if let Some(dielectric) = dielectric {
                dielectric_material(dielectric, specular_alpha, self.scene, prim, findings)
            } else if let Some(plastic) = plastic {
                plastic_material(plastic, specular_alpha)
            } else if let Some(principled) = principled {
                principled_material(principled, specular_alpha, self.scene, prim, findings)
            } else {
                continue;
            };
            let needs_inside = material.has_inside();
            let row = self.add(material);
            self.of_prim.insert(
                prim,
                Row {
                    row,
                    prim,
                    component: names.first().copied().unwrap_or_default(),
                    needs_inside,
                    glow: principled.map_or(Rgb::BLACK, |principled| principled.emission.into()),
                },
            );
        }
    }

    fn add_bindings(&mut self, bindings: &Query<(&PrimIndex, &MaterialBinding)>, findings: &mut Findings) {
        let mut all: Vec<_> = bindings.iter().collect();
        all.sort_by_key(|(index, _)| **index);
        for (index, binding) in all {
            let path = &binding.target.0;
            let target = self.scene.index_of(path).map(|target| target as u32);
            let bound = target.filter(|target| self.of_prim.contains_key(target));
            if bound.is_none() {
                let rendered = target.is_some_and(|target| self.scene.prims[target as usize].rendered);
                let finding = if rendered {
                    Diagnostic::error("no-material", format!("`{path}` has no material component"))
                        .note(format!("materials: {MATERIALS}"))
                } else {
                    Diagnostic::error(
                        "no-material",
                        format!("`{path}` is not rendered, so it has no material"),
                    )
                    .note("it and every prim above it must be an active `Def`")
                };
                findings.push_at(
                    field_place(self.scene, index.0, "MaterialBinding", &["target"]),
                    finding,
                );
            }
            self.bindings.insert(index.0, bound);
        }
    }

    /// The material component that a geometry prim uses.
    fn component_for(&self, prim: u32) -> Option<Row> {
        if let Some(own) = self.of_prim.get(&prim) {
            return Some(*own);
        }
        let mut at = Some(prim as usize);
        while let Some(prim) = at {
            if let Some(bound) = self.bindings.get(&(prim as u32)) {
                return bound.and_then(|target| self.of_prim.get(&target).copied());
            }
            at = self.scene.prims[prim].parent;
        }
        None
    }

    fn row_for(&mut self, prim: u32, emits: bool) -> u32 {
        if let Some(found) = self.component_for(prim) {
            return found.row;
        }
        let known = if emits { self.black } else { self.default };
        if let Some(row) = known {
            return row;
        }
        if emits {
            let row = self.add(Material::default());
            self.black = Some(row);
            row
        } else {
            let row = self.add(diffuse_material(&Diffuse::default()));
            self.default = Some(row);
            row
        }
    }

    /// Glass has an inside, so its surface must be closed.
    fn check_inside(
        &self,
        prim: u32,
        parts: &GeometryComponentsItem<'_, '_>,
        store: &MeshStore,
        findings: &mut Findings,
    ) {
        let Some(material) = self.component_for(prim).filter(|found| found.needs_inside) else {
            return;
        };
        let Some((name, source)) = parts.sources().next() else {
            return;
        };
        let closed = match source {
            GeometrySource::Shape(shape) => shape.is_closed(),
            GeometrySource::Mesh(mesh) => store.get(mesh).is_none_or(|mesh| mesh.is_closed()),
        };
        if closed {
            return;
        }
        let message = format!("`{}` is of glass, but its geometry is not closed", self.path(prim));
        let mut finding = Diagnostic::error("open-geometry", message)
            .note("without an inside and an outside, light does not know which way to bend")
            .note(match material.component {
                "Principled" => "close it, or write `Principled: (thickness: 0)` for a pane",
                _ => "close it, or write `Dielectric: (thin: true)` for a pane",
            });
        if let Some(place) = component_place(self.scene, material.prim, material.component) {
            finding = finding.also(place, "the material".to_owned());
        }
        findings.push_at(component_place(self.scene, prim, name), finding);
    }
}
