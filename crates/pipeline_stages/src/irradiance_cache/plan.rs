use super::fill::CacheFill;
use super::{IncomingLight, IrradianceCache};
use bevy_ecs::prelude::*;
use pipeline_core::RenderClock;
use pipeline_data::vocabulary::{Findings, SceneReport, component_place, field_place};
use pipeline_data::{BuiltIrradianceCache, IrradianceRecord, PhotonDemand, PrimIndex, RenderSettings, TransportScene};
use scene_format::Diagnostic;
use transport::{CacheSettings, GatherMethods, Hemisphere, IndirectMethod, MapKind, MapKinds, Spacing};

/// Rays of the records that all others read, in rays of others.
const FIRST_RAYS: u32 = 4;

/// How the cache is filled and read. Written by `plan_cache`; present where it is.
#[derive(Resource, Clone, Copy, Debug)]
pub(super) struct CachePlan {
    pub(super) hemisphere: Hemisphere,
    /// Of the records that all others read.
    pub(super) first_hemisphere: Hemisphere,
    pub(super) settings: CacheSettings,
    pub(super) spacing: Spacing,
    /// Of the rays of records.
    pub(super) methods: GatherMethods,
    pub(super) reads_photons: bool,
}

/// Takes up the settings, asks for photon maps where they are read, and asks for records.
pub(super) fn plan_cache(
    mut commands: Commands,
    settings: Option<Res<RenderSettings>>,
    scene: Option<Res<TransportScene>>,
    prims: Query<(&PrimIndex, &IrradianceCache)>,
    records: Query<Entity, With<IrradianceRecord>>,
    (mut demand, mut clock): (ResMut<PhotonDemand>, ResMut<RenderClock>),
    report: Option<SceneReport<'_>>,
) {
    commands.remove_resource::<CachePlan>();
    commands.remove_resource::<CacheFill>();
    commands.remove_resource::<BuiltIrradianceCache>();
    records.iter().for_each(|record| commands.entity(record).despawn());
    clock.records_pending = 0;
    let (Some(settings), Some(scene), Some(mut report)) = (settings, scene, report) else {
        return;
    };
    let is_chosen = settings.methods.indirect == IndirectMethod::IrradianceCache;
    let mut findings = Findings::default();
    let mut chosen = IrradianceCache::default();
    for (prim, written) in &prims {
        let unused = if prim.0 != settings.render_prim {
            "`IrradianceCache` stands on a prim that carries no `Render`; it has no effect there"
        } else if !is_chosen {
            "`IrradianceCache` has no effect: `LightTransport.indirect` is not `IrradianceCache`"
        } else {
            chosen = written.clone();
            continue;
        };
        let place = component_place(report.scene(), prim.0, "IrradianceCache");
        findings.push_at(place, Diagnostic::warning("unused-settings", unused));
    }
    if chosen.max_spacing < chosen.min_spacing {
        let message = format!(
            "`max_spacing` must be at least `min_spacing`, {}, but is {}",
            chosen.min_spacing, chosen.max_spacing
        );
        let place = field_place(
            report.scene(),
            settings.render_prim,
            "IrradianceCache",
            &["max_spacing"],
        );
        findings.push_at(place, Diagnostic::error("out-of-range", message));
    }
    report.file(findings);
    if !is_chosen {
        return;
    }
    let reads_photons = chosen.incoming == IncomingLight::PhotonGather;
    if reads_photons {
        demand.kinds = MapKind::ALL.into_iter().fold(demand.kinds, MapKinds::with);
        // As many as their settings say.
        demand.photons = None;
    }
    let plan = CachePlan {
        hemisphere: Hemisphere::of_rays(chosen.rays),
        first_hemisphere: Hemisphere::of_rays(chosen.rays.saturating_mul(FIRST_RAYS)),
        settings: CacheSettings {
            min_weight: chosen.min_weight,
            cell_records: chosen.cell_records as usize,
            gradients: chosen.gradients,
            validity: chosen.validity,
        },
        spacing: Spacing {
            min_pixels: chosen.min_spacing,
            max_pixels: chosen.max_spacing,
            min_weight: chosen.min_weight,
            most: scene.0.rays.bounds().diagonal().max(f32::MIN_POSITIVE),
        },
        methods: GatherMethods::new(&settings.methods, reads_photons),
        reads_photons,
    };
    commands.insert_resource(plan);
    begin(&mut commands, &plan, &scene, 0);
    clock.records_pending = 1;
}

/// Asks for records, the cache as empty as at first.
fn begin(commands: &mut Commands<'_, '_>, plan: &CachePlan, scene: &TransportScene, generation: u32) {
    let cache = transport::IrradianceCache::new(plan.settings, &scene.0.rays.bounds());
    commands.insert_resource(BuiltIrradianceCache(cache));
    commands.insert_resource(CacheFill {
        generation,
        ..CacheFill::default()
    });
}

/// True when photons have landed that records read, and there are records that read others.
pub(super) fn has_new_photons(
    plan: Option<Res<CachePlan>>,
    fill: Option<Res<CacheFill>>,
    clock: Res<RenderClock>,
) -> bool {
    plan.is_some_and(|plan| plan.reads_photons) && fill.is_none() && clock.photons_pending == 0
}

/// Drops records that read the photons of an earlier pass, and asks for new ones.
pub(super) fn renew_records(
    mut commands: Commands,
    plan: Res<CachePlan>,
    scene: Res<TransportScene>,
    records: Query<Entity, With<IrradianceRecord>>,
    mut clock: ResMut<RenderClock>,
) {
    records.iter().for_each(|record| commands.entity(record).despawn());
    // The pass is that of the render, so that one that was resumed has the same records.
    let pass = (clock.waves_done / clock.waves_per_pass.max(1)) as u32;
    begin(&mut commands, &plan, &scene, pass);
    clock.records_pending += 1;
}
