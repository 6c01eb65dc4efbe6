use super::fill::CacheFill;
use super::{ErrorMetric, IncomingLight, IrradianceCache};
use bevy_ecs::prelude::*;
use pipeline_core::RenderClock;
use pipeline_data::vocabulary::{Findings, SceneReport, field_place, stage_settings};
use pipeline_data::{
    BuiltIrradianceCache, IrradianceRecord, PhotonDemand, PrimIndex, RECORD_DEPTHS, RenderSettings, TransportScene,
};
use scene_format::Diagnostic;
use transport::{CacheSettings, GatherMethods, Hemisphere, IndirectMethod, MapKind, MapKinds, Spacing};

/// 1/a of deep records: few that hold far.
const DEEP_MIN_WEIGHT: f32 = 5.0;

/// Least radius within which a deep record holds, in sides of the film: it is of the scene, whatever the pixels.
const DEEP_SPACING: f32 = 0.02;

/// Lights that are sampled where the ray of a record ends.
const LIGHTS: u32 = 4;

/// How the cache is filled and read. Written by `plan_cache`; present where it is.
#[derive(Resource, Clone, Copy, Debug)]
pub(super) struct CachePlan {
    pub(super) hemisphere: Hemisphere,
    /// By depth.
    pub(super) settings: [CacheSettings; RECORD_DEPTHS],
    /// By depth.
    pub(super) spacing: [Spacing; RECORD_DEPTHS],
    /// Of the rays of records, by depth.
    pub(super) methods: [GatherMethods; RECORD_DEPTHS],
    pub(super) reads_photons: bool,
}

impl CachePlan {
    /// Caches without records.
    pub(super) fn empty_cache(&self, scene: &TransportScene) -> BuiltIrradianceCache {
        let bounds = scene.0.rays.bounds();
        BuiltIrradianceCache(
            self.settings
                .map(|settings| transport::IrradianceCache::new(settings, &bounds)),
        )
    }

    /// A filling that begins. Where photons tell what deep records would, there are none.
    pub(super) fn new_fill(&self, is_renewed: bool) -> CacheFill {
        CacheFill::new(!self.reads_photons, is_renewed)
    }
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
    let unused = (!is_chosen).then_some("`LightTransport.indirect` is not `IrradianceCache`");
    let written = ("IrradianceCache", &prims);
    let chosen =
        stage_settings(written, settings.render_prim, unused, report.scene(), &mut findings).unwrap_or_default();
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
    if !is_chosen && (clock.records_only || report.request().records.is_some()) {
        let prim = &report.scene().prims[settings.render_prim as usize].path;
        let finding = Diagnostic::error(
            "no-records",
            "this scene has no records: `LightTransport.indirect` is not `IrradianceCache`",
        )
        .note(format!("add `--set {prim}.LightTransport.indirect=IrradianceCache`"));
        let place = field_place(report.scene(), settings.render_prim, "LightTransport", &["indirect"]);
        findings.push_at(place, finding);
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
    // The Hessian bounds the error of a linear change: without gradients there is none.
    let metric = if chosen.gradients {
        chosen.metric
    } else {
        ErrorMetric::HarmonicMean
    };
    let seen = CacheSettings {
        min_weight: chosen.min_weight,
        cell_records: chosen.cell_records as usize,
        gradients: chosen.gradients,
        metric: metric.into(),
        validity: chosen.validity,
    };
    let seen_spacing = Spacing {
        min_pixels: chosen.min_spacing,
        max_pixels: chosen.max_spacing,
        most: scene.0.rays.bounds().diagonal().max(f32::MIN_POSITIVE),
    };
    // Distances decide how far deep records hold, which have less noise than what they hold.
    let deep = CacheSettings {
        min_weight: DEEP_MIN_WEIGHT,
        metric: transport::ErrorMetric::HarmonicMean,
        ..seen
    };
    let deep_spacing = Spacing {
        min_pixels: DEEP_SPACING * settings.resolution.as_vec2().element_product().sqrt(),
        max_pixels: f32::MAX,
        ..seen_spacing
    };
    let methods = GatherMethods::new(&settings.methods, reads_photons).with_lights(LIGHTS);
    let plan = CachePlan {
        hemisphere: Hemisphere::of_rays(chosen.rays),
        settings: [seen, deep, deep],
        spacing: [seen_spacing, deep_spacing, deep_spacing],
        methods: std::array::from_fn(|depth| methods.after(depth as u32)),
        reads_photons,
    };
    commands.insert_resource(plan);
    begin(&mut commands, &plan, &scene, false);
    clock.records_pending = 1;
}

/// Asks for records, the caches as empty as at first.
fn begin(commands: &mut Commands<'_, '_>, plan: &CachePlan, scene: &TransportScene, is_renewed: bool) {
    commands.insert_resource(plan.empty_cache(scene));
    commands.insert_resource(plan.new_fill(is_renewed));
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
    begin(&mut commands, &plan, &scene, true);
    clock.records_pending += 1;
}
