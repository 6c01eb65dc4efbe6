use super::lights::LightList;
use super::materials::MaterialTable;
use bevy_ecs::prelude::*;
use pipeline_data::vocabulary::{Findings, SceneReport, field_place};
use pipeline_data::{Acceleration, RenderSettings, TransportScene};
use scene_format::{Diagnostic, Scene};
use transport::CausticMethod;

/// Joins the ray scene with materials and lights, unless something was wrong.
pub(super) fn join_tables(
    mut commands: Commands,
    mut check: SceneReport,
    settings: Option<Res<RenderSettings>>,
    mut acceleration: ResMut<Acceleration>,
    mut materials: ResMut<MaterialTable>,
    mut lights: ResMut<LightList>,
) {
    commands.remove_resource::<TransportScene>();
    let (table, list) = (std::mem::take(&mut *materials), std::mem::take(&mut *lights));
    let rays = acceleration.0.take();
    if check.failed() {
        return;
    }
    let Some(rays) = rays else { return };
    let mut findings = Findings::default();
    if let Some(settings) = settings {
        warn_of_unreachable_caustics(check.scene(), &settings, &table, &list, &mut findings);
    }
    let scene = transport::Scene::new(rays, table.materials, table.of_instance, list.lights);
    if scene.lights.is_empty() {
        let finding = Diagnostic::error("no-light", "no light is strong enough to be computed with")
            .note("make a light brighter, or its surface larger");
        findings.push(finding);
    }
    commands.insert_resource(TransportScene(scene));
    check.file(findings);
}

/// A light without an extent can't be met by chance, and a mirror can't be connected to it.
fn warn_of_unreachable_caustics(
    scene: &Scene,
    settings: &RenderSettings,
    table: &MaterialTable,
    list: &LightList,
    findings: &mut Findings,
) {
    let Some(light) = list
        .delta_light
        .filter(|_| settings.methods.caustic == CausticMethod::Trace)
    else {
        return;
    };
    let is_delta = |row: &u32| table.materials[*row as usize].has_delta();
    if table.of_instance.iter().any(is_delta) {
        let finding = Diagnostic::warning(
            "unreachable-caustics",
            "`caustic: Trace` cannot find the light of a point behind mirrors, clear glass or smooth coats",
        )
        .also(light, "the light without an extent")
        .note("use `caustic: PhotonMap`, or give it one: a small `Sphere` with `Emission`, an `angle` above 0");
        let place = field_place(scene, settings.render_prim, "LightTransport", &["caustic"]);
        findings.push_at(place, finding);
    }
}
