use super::materials::MaterialTable;
use bevy_ecs::prelude::*;
use glam::Vec3;
use pipeline_core::Counters;
use pipeline_data::vocabulary::{
    Emission, EnvironmentLight, Findings, PointLight, SceneReport, component_place, field_place,
};
use pipeline_data::{Acceleration, InstancePrims, PrimIndex, RenderRequest, SceneOrigin, WorldTransform};
use radiometry::Rgb;
use scene_format::{Diagnostic, Place, Scene};
use spatial::MOST_DISTANT;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use transport::LightSource;

/// All lights that shine, in the order of the scene. On its way to `join_tables`.
#[derive(Resource, Default)]
pub(super) struct LightList {
    pub(super) lights: Vec<LightSource>,
    /// Where a point light is written, if there is one.
    pub(super) point_light: Option<Place>,
}

type LightPrim<'a> = (
    &'a PrimIndex,
    Option<&'a WorldTransform>,
    Option<&'a Emission>,
    Option<&'a PointLight>,
    Option<&'a EnvironmentLight>,
);
type IsLight = Or<(With<Emission>, With<PointLight>, With<EnvironmentLight>)>;

struct Collector<'a> {
    scene: &'a Scene,
    acceleration: &'a Acceleration,
    instance_of_prim: BTreeMap<u32, u32>,
    origin: &'a SceneOrigin,
    findings: Findings,
    list: LightList,
    /// First light that does not shine.
    dark: Option<(u32, &'static str)>,
    environment: Option<u32>,
}

/// Turns light components into sources in world space, and checks that there is light at all.
#[expect(clippy::too_many_arguments, reason = "a system lists all that it touches")]
pub(super) fn list_lights(
    mut check: SceneReport,
    acceleration: Res<Acceleration>,
    instances: Res<InstancePrims>,
    materials: Res<MaterialTable>,
    origin: Res<SceneOrigin>,
    mut counters: ResMut<Counters>,
    mut list: ResMut<LightList>,
    lights: Query<LightPrim<'_>, IsLight>,
) {
    let mut collector = Collector {
        scene: check.scene(),
        acceleration: &acceleration,
        instance_of_prim: (0..)
            .zip(&instances.0)
            .map(|(instance, prim)| (*prim, instance))
            .collect(),
        origin: &origin,
        findings: Findings::default(),
        list: LightList::default(),
        dark: None,
        environment: None,
    };
    let mut rows: Vec<_> = lights.iter().collect();
    rows.sort_by_key(|(index, ..)| **index);
    for (index, world, emission, point, environment) in rows {
        if let Some(emission) = emission {
            collector.add_area(index.0, emission);
        }
        if let (Some(point), Some(world)) = (point, world) {
            collector.add_point(index.0, point, world);
        }
        if let Some(environment) = environment {
            collector.add_environment(index.0, environment);
        }
    }
    for (instance, glow) in (0..).zip(&materials.glow_of_instance) {
        if let Some((radiance, material)) = glow {
            collector.add_glow(instance, *radiance, *material);
        }
    }
    // After an error, what seems to be missing may be what was wrong.
    if !check.failed() && !collector.findings.has_error() {
        collector.check_presence(check.request());
    }
    counters
        .counter("tables/lights")
        .add(collector.list.lights.len() as u64);
    let findings = collector.findings;
    *list = collector.list;
    check.file(findings);
}

impl Collector<'_> {
    fn path(&self, prim: u32) -> &str {
        &self.scene.prims[prim as usize].path
    }

    /// Keeps a light that shines; refuses one that overflows.
    fn add(&mut self, prim: u32, component: &'static str, strength: Rgb, source: LightSource) {
        if strength.is_black() {
            self.dark.get_or_insert((prim, component));
        } else if strength.is_finite() {
            self.list.lights.push(source);
        } else {
            let message = format!("the light of `{}` is too strong to be computed with", self.path(prim));
            let place = component_place(self.scene, prim, component);
            self.findings.push_at(place, Diagnostic::error("too-bright", message));
        }
    }

    fn add_area(&mut self, prim: u32, emission: &Emission) {
        // Without a ray scene there was an error, which says more.
        let Some(rays) = &self.acceleration.0 else { return };
        let place = component_place(self.scene, prim, "Emission");
        let Some(instance) = self.instance_of_prim.get(&prim).copied() else {
            let message = format!(
                "`Emission` of `{}` has no effect: the prim has no geometry",
                self.path(prim)
            );
            let note = "a light without a surface is a `PointLight`";
            self.findings
                .push_at(place, Diagnostic::warning("without-effect", message).note(note));
            return;
        };
        let area = rays.instance_area(instance);
        if area.is_nan() || area <= 0.0 {
            let message = format!("`{}` cannot shine: its surface has no area", self.path(prim));
            self.findings.push_at(place, Diagnostic::warning("no-area", message));
            self.dark.get_or_insert((prim, "Emission"));
            return;
        }
        let radiance = match emission.power {
            Some(power) => radiance_of_power(power, area, emission.two_sided),
            None => emission.radiance.into(),
        };
        let source = LightSource::Area {
            instance,
            radiance,
            two_sided: emission.two_sided,
        };
        self.add(prim, "Emission", radiance, source);
    }

    /// A surface that shines because its material does.
    ///
    /// - `material`: the prim with the material.
    fn add_glow(&mut self, instance: u32, radiance: Rgb, material: u32) {
        let Some(rays) = &self.acceleration.0 else { return };
        let area = rays.instance_area(instance);
        if area.is_nan() || area <= 0.0 {
            self.dark.get_or_insert((material, "Principled"));
            return;
        }
        let source = LightSource::Area {
            instance,
            radiance,
            two_sided: false,
        };
        self.add(material, "Principled", radiance, source);
    }

    fn add_point(&mut self, prim: u32, light: &PointLight, world: &WorldTransform) {
        let intensity: Rgb = match light.intensity {
            Some(intensity) => intensity.into(),
            None => Rgb::from(light.power) * (0.25 / PI) as f32,
        };
        let position = (world.0.translation - self.origin.0).as_vec3();
        if !position.is_finite() || position.abs().max_element() > MOST_DISTANT {
            let message = format!(
                "`{}` is too far from the scene's geometry for single precision",
                self.path(prim)
            );
            let place = component_place(self.scene, prim, "Transform");
            self.findings.push_at(place, Diagnostic::error("too-far", message));
            return;
        }
        if !intensity.is_black() && self.list.point_light.is_none() {
            self.list.point_light = component_place(self.scene, prim, "PointLight");
        }
        self.add(
            prim,
            "PointLight",
            intensity,
            LightSource::Point { position, intensity },
        );
    }

    fn add_environment(&mut self, prim: u32, light: &EnvironmentLight) {
        let place = component_place(self.scene, prim, "EnvironmentLight");
        if light.file.is_some() {
            let finding = Diagnostic::error("not-supported-yet", "`EnvironmentLight.file` is not supported yet")
                .note("a uniform environment is `EnvironmentLight: (radiance: (1, 1, 1))`");
            self.findings
                .push_at(field_place(self.scene, prim, "EnvironmentLight", &["file"]), finding);
            return;
        }
        if let Some(first) = self.environment {
            let message = format!(
                "both `{}` and `{}` carry `EnvironmentLight`",
                self.path(first),
                self.path(prim)
            );
            let mut finding = Diagnostic::error("two-environments", message)
                .note("a scene has one; `active: false` switches the other off");
            if let Some(place) = component_place(self.scene, first, "EnvironmentLight") {
                finding = finding.also(place, format!("`EnvironmentLight` of `{}`", self.path(first)));
            }
            self.findings.push_at(place, finding);
            return;
        }
        self.environment = Some(prim);
        let radiance = Rgb::from(light.radiance) * light.scale;
        self.add(
            prim,
            "EnvironmentLight",
            radiance,
            LightSource::Environment { radiance },
        );
    }

    /// Refuses a scene without light; one without geometry too, unless its environment can be seen.
    fn check_presence(&mut self, request: &RenderRequest) {
        let scene = request.scene.display();
        if self.list.lights.is_empty() {
            let finding = match self.dark {
                Some((prim, component)) => {
                    let message = format!("no light of {scene} shines, so the picture would be black");
                    let finding = Diagnostic::error("no-light", message).label("this one is black");
                    match component_place(self.scene, prim, component) {
                        Some(place) => finding.at(place),
                        None => finding,
                    }
                }
                None => {
                    let message = format!("{scene} has no light, so the picture would be black");
                    Diagnostic::error("no-light", message).note("write, for example:").note(
                        "    \"/Lamp\": Def(Transform: (translate: (0, 2, 0)), PointLight: (power: (100, 100, 100))),",
                    )
                }
            };
            self.findings.push(finding.note(
                "lights: PointLight, EnvironmentLight, and any geometry with Emission or a Principled that emits",
            ));
        } else if self.instance_of_prim.is_empty() {
            let message = format!("{scene} has no geometry");
            let note = "geometry: Sphere, Quad, Disc, Cuboid, Cylinder, Torus, Band, Mesh";
            self.findings.push(if self.environment.is_some() {
                Diagnostic::warning("no-geometry", message + "; only its environment is seen").note(note)
            } else {
                Diagnostic::error("no-geometry", message + ", so there is nothing to see").note(note)
            });
        }
    }
}

/// Radiance of a Lambertian emitter: L = Φ / (π A), A of all sides that shine.
///
/// - `power`: W, of the whole surface.
/// - `area`: m², of one side, > 0.
/// - returns W·m⁻²·sr⁻¹.
fn radiance_of_power(power: Vec3, area: f64, two_sided: bool) -> Rgb {
    let sides = if two_sided { 2.0 } else { 1.0 };
    (power.as_dvec3() / (PI * area * sides)).as_vec3().into()
}
