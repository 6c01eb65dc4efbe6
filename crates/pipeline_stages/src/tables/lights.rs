use super::frame::{moving_frame, rotation_of};
use super::materials::{Glow, MaterialTable};
use bevy_ecs::prelude::*;
use glam::{DAffine3, Vec3};
use pipeline_core::Counters;
use pipeline_data::vocabulary::{
    DistantLight, Emission, EnvironmentLight, Findings, PointLight, SceneReport, SpotLight, component_place,
    field_place,
};
use pipeline_data::{
    Acceleration, EnvironmentMaps, InstancePrims, PrimIndex, RenderRequest, SceneOrigin, WorldMotion, WorldTransform,
};
use radiometry::Rgb;
use scene_format::{Diagnostic, Place, Scene};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use transport::{Environment, LightSource, MovingFrame, SpotCone};

/// All lights that shine, in the order of the scene. On its way to `join_tables`.
#[derive(Resource, Default)]
pub(super) struct LightList {
    pub(super) lights: Vec<LightSource>,
    /// Where a light is written that no ray can meet by chance, if there is one.
    pub(super) delta_light: Option<Place>,
}

type LightPrim<'a> = (
    &'a PrimIndex,
    Option<&'a WorldTransform>,
    Option<&'a Emission>,
    Option<&'a WorldMotion>,
    Option<&'a PointLight>,
    Option<&'a SpotLight>,
    Option<&'a DistantLight>,
    Option<&'a EnvironmentLight>,
);
type IsLight = Or<(
    With<Emission>,
    With<PointLight>,
    With<SpotLight>,
    With<DistantLight>,
    With<EnvironmentLight>,
)>;

struct Collector<'a> {
    scene: &'a Scene,
    acceleration: &'a Acceleration,
    instance_of_prim: BTreeMap<u32, u32>,
    origin: &'a SceneOrigin,
    maps: &'a EnvironmentMaps,
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
    maps: Res<EnvironmentMaps>,
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
        maps: &maps,
        findings: Findings::default(),
        list: LightList::default(),
        dark: None,
        environment: None,
    };
    let mut rows: Vec<_> = lights.iter().collect();
    rows.sort_by_key(|(index, ..)| **index);
    for (index, world, emission, motion, point, spot, distant, environment) in rows {
        let prim = index.0;
        if let Some(emission) = emission {
            collector.add_area(prim, emission);
        }
        // What could not be placed was reported where that was found.
        let Some(world) = world else { continue };
        if let Some(point) = point {
            collector.add_point(prim, point, world, motion);
        }
        if let Some(spot) = spot {
            collector.add_spot(prim, spot, world, motion);
        }
        if let Some(distant) = distant {
            collector.add_distant(prim, distant, world, motion);
        }
        if let Some(environment) = environment {
            collector.add_environment(prim, environment, world, motion);
        }
    }
    for (instance, glow) in (0..).zip(&materials.glow_of_instance) {
        if let Some(glow) = glow {
            collector.add_glow(instance, glow);
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
            texture: None,
            two_sided: emission.two_sided,
        };
        self.add(prim, "Emission", radiance, source);
    }

    /// A surface that shines because its material does.
    fn add_glow(&mut self, instance: u32, glow: &Glow) {
        let Some(rays) = &self.acceleration.0 else { return };
        let area = rays.instance_area(instance);
        if area.is_nan() || area <= 0.0 {
            self.dark.get_or_insert((glow.material, "Principled"));
            return;
        }
        let radiance = glow.radiance;
        let source = LightSource::Area {
            instance,
            radiance,
            texture: glow.texture.clone(),
            two_sided: false,
        };
        self.add(glow.material, "Principled", radiance, source);
    }

    /// The frame of a light; one that is too far off is reported.
    fn frame(&mut self, prim: u32, world: &WorldTransform, motion: Option<&WorldMotion>) -> Option<MovingFrame> {
        let frame = moving_frame(world, motion, self.origin.0);
        if frame.is_none() {
            let path = self.path(prim);
            let message = format!("`{path}` is too far from the scene's geometry for single precision");
            let place = component_place(self.scene, prim, "Transform");
            self.findings.push_at(place, Diagnostic::error("too-far", message));
        }
        frame
    }

    /// Remembers where the first light is written that no ray can meet.
    fn note_delta(&mut self, prim: u32, component: &'static str, strength: Rgb) {
        if !strength.is_black() && self.list.delta_light.is_none() {
            self.list.delta_light = component_place(self.scene, prim, component);
        }
    }

    fn add_point(&mut self, prim: u32, light: &PointLight, world: &WorldTransform, motion: Option<&WorldMotion>) {
        let intensity: Rgb = match light.intensity {
            Some(intensity) => intensity.into(),
            None => Rgb::from(light.power) * (0.25 / PI) as f32,
        };
        let Some(frame) = self.frame(prim, world, motion) else {
            return;
        };
        self.note_delta(prim, "PointLight", intensity);
        self.add(prim, "PointLight", intensity, LightSource::Point { frame, intensity });
    }

    fn add_spot(&mut self, prim: u32, light: &SpotLight, world: &WorldTransform, motion: Option<&WorldMotion>) {
        if light.inner_angle > light.outer_angle {
            let message = format!(
                "`SpotLight.inner_angle` of {} is wider than `outer_angle`, {}",
                light.inner_angle, light.outer_angle
            );
            let place = field_place(self.scene, prim, "SpotLight", &["inner_angle", "outer_angle"]);
            self.findings.push_at(place, Diagnostic::error("out-of-range", message));
            return;
        }
        let cone = SpotCone::from_half_angles(light.inner_angle.to_radians(), light.outer_angle.to_radians());
        let intensity: Rgb = match light.intensity {
            Some(intensity) => intensity.into(),
            None => Rgb::from(light.power) * (1.0 / cone.solid_angle()),
        };
        let Some(frame) = self.frame(prim, world, motion) else {
            return;
        };
        self.note_delta(prim, "SpotLight", intensity);
        self.add(
            prim,
            "SpotLight",
            intensity,
            LightSource::Spot { frame, intensity, cone },
        );
    }

    fn add_distant(&mut self, prim: u32, light: &DistantLight, world: &WorldTransform, motion: Option<&WorldMotion>) {
        let irradiance = Rgb::from(light.irradiance);
        // Only its direction counts.
        let at_origin = |m: &DAffine3| DAffine3::from_mat3_translation(m.matrix3, self.origin.0);
        let motion = motion.map(|motion| WorldMotion(motion.0.iter().map(at_origin).collect()));
        let world = WorldTransform(at_origin(&world.0));
        let Some(frame) = self.frame(prim, &world, motion.as_ref()) else {
            return;
        };
        if light.angle == 0.0 {
            self.note_delta(prim, "DistantLight", irradiance);
        }
        let source = LightSource::Distant {
            frame,
            irradiance,
            half_angle: 0.5 * light.angle.to_radians(),
        };
        self.add(prim, "DistantLight", irradiance, source);
    }

    fn add_environment(
        &mut self,
        prim: u32,
        light: &EnvironmentLight,
        world: &WorldTransform,
        motion: Option<&WorldMotion>,
    ) {
        let place = component_place(self.scene, prim, "EnvironmentLight");
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
        let map = self.maps.0.get(&PrimIndex(prim)).cloned();
        if light.file.is_some() && map.is_none() {
            // It could not be read, which was reported.
            return;
        }
        let turns = |keys: &WorldMotion| keys.0.windows(2).any(|pair| pair[0].matrix3 != pair[1].matrix3);
        if map.is_some() && motion.is_some_and(turns) {
            let message = format!(
                "the environment of `{}` is not blurred by its rotation",
                self.path(prim)
            );
            let finding = Diagnostic::warning("without-effect", message).note("it stands as at the frame");
            self.findings.push_at(place, finding);
        }
        let radiance = match &map {
            Some(_) => Rgb::splat(light.scale),
            None => Rgb::from(light.radiance) * light.scale,
        };
        let environment = Environment {
            radiance,
            map_from_world: rotation_of(world).transpose(),
            map,
        };
        let strength = environment.fluence();
        self.add(
            prim,
            "EnvironmentLight",
            strength,
            LightSource::Environment(environment),
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
                "lights: PointLight, SpotLight, DistantLight, EnvironmentLight, and any geometry with Emission or a Principled that emits",
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
