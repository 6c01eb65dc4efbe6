use super::inputs::{Fields, highest_uv_set};
use super::surface::{conductor_material, dielectric_material, plastic_material, principled_interior};
use bevy_ecs::prelude::*;
use pipeline_core::{Counters, record_items};
use pipeline_data::vocabulary::{
    Conductor, Dielectric, Diffuse, Emission, Findings, GeometryComponents, GeometryComponentsItem, GeometrySource,
    LightTransport, MaterialBinding, Plastic, Principled, SceneReport, component_place, field_place,
};
use pipeline_data::{InstancePrims, MeshStore, PrimIndex, RenderSettings, TextureStore};
use radiometry::Rgb;
use scene_format::{Diagnostic, Scene};
use std::collections::BTreeMap;
use std::sync::Arc;
use texture::Texture;
use transport::{Input, Material, SurfaceInputs, TexturedBsdf};

/// Names of the material components, for messages.
const MATERIALS: &str = "Diffuse, Conductor, Dielectric, Plastic, Principled";

/// Materials by row, and the row of each instance. On its way to `join_tables`.
#[derive(Resource, Default)]
pub(super) struct MaterialTable {
    pub(super) materials: Vec<Material>,
    pub(super) of_instance: Vec<u32>,
    /// What the material of each instance emits by itself.
    pub(super) glow_of_instance: Vec<Option<Glow>>,
}

/// Light of a material.
#[derive(Clone)]
pub(super) struct Glow {
    /// W·m⁻²·sr⁻¹; of a texture the mean.
    pub(super) radiance: Rgb,
    /// Shared by all instances.
    pub(super) texture: Option<Arc<Texture>>,
    /// The prim with the material.
    pub(super) material: u32,
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
struct Row {
    row: u32,
    prim: u32,
    component: &'static str,
    needs_inside: bool,
    glow: Option<Glow>,
    /// What the colours of vertices can multiply.
    inputs: Option<SurfaceInputs>,
    /// The row with such colours, once there is one.
    coloured: Option<u32>,
    /// The texture that needs the most sets of texture coordinates, and their number before its own.
    uv_set: Option<(&'static str, u32)>,
}

/// Rows by prim, and who uses which.
struct Rows<'a> {
    scene: &'a Scene,
    textures: &'a TextureStore,
    table: MaterialTable,
    of_prim: BTreeMap<u32, Row>,
    /// Prim with the material that a prim is bound to; `None` after an error.
    bindings: BTreeMap<u32, Option<u32>>,
    black: Option<u32>,
    default: Option<u32>,
    default_coloured: Option<u32>,
}

/// Turns material components into rows and finds the row of every instance.
#[expect(clippy::too_many_arguments, reason = "a system lists all that it touches")]
pub(super) fn build_material_table(
    mut check: SceneReport,
    settings: Option<Res<RenderSettings>>,
    store: Res<MeshStore>,
    textures: Res<TextureStore>,
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
        textures: &textures,
        table: MaterialTable::default(),
        of_prim: BTreeMap::new(),
        bindings: BTreeMap::new(),
        black: None,
        default: None,
        default_coloured: None,
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
        let row = rows.row_for(*prim, *emits, has_colours(parts, &store));
        rows.table.of_instance.push(row);
        let glow = rows.component_for(*prim).filter(|_| !emits);
        let glow = glow.and_then(|found| found.glow.clone());
        rows.table.glow_of_instance.push(glow);
        rows.check_inside(*prim, parts, &store, &mut findings);
        rows.check_coordinates(*prim, parts, &store, &mut findings);
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
            let fields = Fields {
                scene: self.scene,
                store: self.textures,
                prim,
                component: names.first().copied().unwrap_or_default(),
            };
            let mut row = Row::new(&fields);
            let material = if let Some(diffuse) = diffuse {
                row.uv_set = highest_uv_set(&mut diffuse.textures());
                let inputs = row.inputs.insert(fields.diffuse(diffuse, findings));
                Material::from_inputs(inputs.clone())
            } else if let Some(conductor) = conductor {
                conductor_material(conductor, specular_alpha, self.scene, prim, findings)
            } else if let Some(dielectric) = dielectric {
                dielectric_material(dielectric, specular_alpha, self.scene, prim, findings)
            } else if let Some(plastic) = plastic {
                plastic_material(plastic, specular_alpha)
            } else if let Some(principled) = principled {
                row.uv_set = highest_uv_set(&mut principled.textures());
                row.glow = Glow::of(fields.emission(principled, findings), prim);
                let inputs = row
                    .inputs
                    .insert(fields.principled(principled, specular_alpha, findings));
                principled_interior(principled, Material::from_inputs(inputs.clone()))
            } else {
                continue;
            };
            row.needs_inside = material.has_inside();
            if row.needs_inside && material.has_alpha() {
                let message = format!("the glass of `{}` has holes: `alpha` is below 1", self.path(prim));
                let place = field_place(self.scene, prim, fields.component, &["alpha", "alpha_texture"]);
                let finding = Diagnostic::warning("alpha-in-glass", message)
                    .note("what is behind a hole is still its inside, and absorbs; `transmission` makes it clear");
                findings.push_at(place, finding);
            }
            row.row = self.add(material);
            self.of_prim.insert(prim, row);
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
    fn component_for(&self, prim: u32) -> Option<&Row> {
        self.of_prim.get(&self.material_of(prim)?)
    }

    /// The prim whose material a geometry prim uses.
    fn material_of(&self, prim: u32) -> Option<u32> {
        if self.of_prim.contains_key(&prim) {
            return Some(prim);
        }
        let mut at = Some(prim as usize);
        while let Some(prim) = at {
            if let Some(bound) = self.bindings.get(&(prim as u32)) {
                return *bound;
            }
            at = self.scene.prims[prim].parent;
        }
        None
    }

    /// - `coloured`: whether the geometry has colours of its own.
    fn row_for(&mut self, prim: u32, emits: bool, coloured: bool) -> u32 {
        if let Some(material) = self.material_of(prim) {
            return self.row_of(material, coloured);
        }
        let known = match (emits, coloured) {
            (true, _) => self.black,
            (false, true) => self.default_coloured,
            (false, false) => self.default,
        };
        if let Some(row) = known {
            return row;
        }
        let material = if emits {
            Material::default()
        } else {
            Material::from_inputs(SurfaceInputs {
                bsdf: TexturedBsdf::Diffuse(Input::Constant(Diffuse::default().albedo.into())),
                normal: None,
                coverage: None,
                vertex_colours: coloured,
            })
        };
        let row = self.add(material);
        match (emits, coloured) {
            (true, _) => self.black = Some(row),
            (false, true) => self.default_coloured = Some(row),
            (false, false) => self.default = Some(row),
        }
        row
    }

    /// The row of the material of a prim, with or without the colours of vertices.
    fn row_of(&mut self, material: u32, coloured: bool) -> u32 {
        let found = &self.of_prim[&material];
        let (plain, known) = (found.row, found.coloured);
        let Some(inputs) = found.inputs.as_ref().filter(|_| coloured) else {
            return plain;
        };
        if let Some(known) = known {
            return known;
        }
        let inputs = SurfaceInputs {
            vertex_colours: true,
            ..inputs.clone()
        };
        let before = &self.table.materials[plain as usize];
        let material_row = Material {
            absorption: before.absorption,
            priority: before.priority,
            ..Material::from_inputs(inputs)
        };
        let row = self.add(material_row);
        if let Some(found) = self.of_prim.get_mut(&material) {
            found.coloured = Some(row);
        }
        row
    }

    /// A texture on a mesh needs the texture coordinates that it names.
    fn check_coordinates(
        &self,
        prim: u32,
        parts: &GeometryComponentsItem<'_, '_>,
        store: &MeshStore,
        findings: &mut Findings,
    ) {
        let Some((material, (field, set))) = self.component_for(prim).and_then(|found| Some((found, found.uv_set?)))
        else {
            return;
        };
        let has_set = match parts.sources().next() {
            Some((_, GeometrySource::Mesh(mesh))) => store.get(mesh).is_none_or(|m| m.mesh.uv_set(set).is_some()),
            Some((_, GeometrySource::Shape(_))) => set == 0,
            None => true,
        };
        if has_set {
            return;
        }
        let which = match set {
            0 => "texture coordinates".to_owned(),
            set => format!("set {set} of texture coordinates"),
        };
        let message = format!(
            "`{}` has no {which}, which `{field}` of its material needs",
            self.path(prim)
        );
        let place = field_place(self.scene, material.prim, material.component, &[field]);
        let finding = Diagnostic::warning("no-coordinates", message).note(match set {
            0 => "the picture is repeated on every triangle instead",
            _ => "the first set is used instead",
        });
        findings.push_at(place, finding);
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

/// Whether the vertices of a mesh have colours that are wanted.
fn has_colours(parts: &GeometryComponentsItem<'_, '_>, store: &MeshStore) -> bool {
    match parts.sources().next() {
        Some((_, GeometrySource::Mesh(mesh))) => {
            mesh.colors && store.get(mesh).is_some_and(|found| found.mesh.colours.is_some())
        }
        _ => false,
    }
}

impl Glow {
    /// None for a material that is dark everywhere. Cost: a look at every texel.
    fn of(radiance: Input<Rgb>, material: u32) -> Option<Self> {
        if radiance.max().is_black() {
            return None;
        }
        Some(Self {
            radiance: radiance.mean(),
            texture: match radiance {
                Input::Texture(texture) => Some(Arc::from(texture)),
                Input::Constant(_) => None,
            },
            material,
        })
    }
}

impl Row {
    /// A row to be filled in.
    fn new(fields: &Fields<'_>) -> Self {
        Self {
            row: 0,
            prim: fields.prim,
            component: fields.component,
            needs_inside: false,
            glow: None,
            inputs: None,
            coloured: None,
            uv_set: None,
        }
    }
}
