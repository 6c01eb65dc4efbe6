//! The photons in the making: what is planned for the render, and what is under way in a pass.

use bevy_ecs::resource::Resource;
use pipeline_data::{Photon, PhotonsOfKind};
use radiometry::{SampleStream, StageKey};
use rayon::prelude::*;
use std::collections::VecDeque;
use transport::{
    DensitySettings, EmissionSampler, EmittedPhoton, LightTable, MapKind, MapKinds, Scene, TargetSphere,
    progressive_shrink, trace_photon,
};

/// Photon paths emitted by one run of `PhotonPass`.
pub(super) const BATCH_PATHS: u32 = 1 << 14;

/// Photon paths that one task follows.
const TASK_PATHS: usize = 128;

/// Photons of one task that landed, by [`MapKind`], each in (path, bounce) order.
pub(super) type Landed = [Vec<Photon>; MapKind::COUNT];

/// At most this many times the wanted photons are emitted.
const MAX_EMITTED_RATIO: u64 = 100;

/// Most photon paths of one run; their numbers are `u32`.
const MOST_PATHS: u64 = (u32::MAX - BATCH_PATHS) as u64;

/// What is planned for the render. Written by `plan_photons`; present where photons are needed.
#[derive(Resource, Clone, Debug)]
pub(super) struct PhotonPlan {
    /// One for each aim of emission.
    pub(super) emissions: Vec<EmissionPlan>,
    pub(super) seed: u64,
    /// Most events between the light and where a photon is stored.
    pub(super) max_depth: u32,
    /// Photons that were read from a file, to be stored instead of tracing any.
    pub(super) reloaded: Option<Vec<PhotonsOfKind>>,
}

/// Photons that are emitted together, from the same random numbers, and the maps that they fill.
#[derive(Clone, Debug)]
pub(super) struct EmissionPlan {
    pub(super) aim: Aim,
    /// Whether every pass has photons of its own; else one emission serves all passes.
    pub(super) is_progressive: bool,
    pub(super) maps: Vec<MapPlan>,
}

/// One map of the plan.
#[derive(Clone, Copy, Debug)]
pub(super) struct MapPlan {
    pub(super) kind: MapKind,
    /// Photons to store.
    pub(super) wanted: u64,
    /// How the map of pass 0 is read.
    pub(super) density: DensitySettings,
    /// Batches to emit, where that is fixed beforehand, as for progressive maps; else it follows from what lands.
    pub(super) batches: Option<u32>,
}

/// What photons are aimed at when they leave their lights.
#[derive(Clone, Debug)]
pub(super) struct Aim {
    /// Key of the random numbers.
    pub(super) stage: StageKey,
    /// Spheres; none: nothing, photons leave as the lights shine.
    pub(super) targets: Vec<TargetSphere>,
    /// Share of the photons that leaves as the lights shine: the defence against bad aim.
    pub(super) uniform_share: f32,
}

impl Aim {
    /// The sampler of photons with this aim.
    pub(super) fn sampler<'a>(&'a self, lights: &'a LightTable) -> EmissionSampler<'a> {
        EmissionSampler::aimed(lights, &self.targets, self.uniform_share)
    }

    /// Emits a batch, from path number `first` on.
    pub(super) fn emit_batch(
        &self,
        lights: &LightTable,
        seed: u64,
        pass: u32,
        first: u32,
    ) -> Vec<Option<EmittedPhoton>> {
        let sampler = self.sampler(lights);
        (first..first + BATCH_PATHS)
            .into_par_iter()
            .map(|path| sampler.emit(&self.stream(seed, pass, path)))
            .collect()
    }

    /// Follows a batch to where its photons land: those of kinds that are `wanted`, task by task in the order of their paths.
    /// Their flux is not divided by the number emitted.
    pub(super) fn trace_batch(
        &self,
        scene: &Scene,
        batch: &[Option<EmittedPhoton>],
        wanted: MapKinds,
        plan: &PhotonPlan,
        pass: u32,
        first: u32,
    ) -> Vec<Landed> {
        let follow = |(task, photons): (usize, &[Option<EmittedPhoton>])| {
            let mut landed = Landed::default();
            for (i, photon) in photons.iter().enumerate() {
                let Some(photon) = photon else { continue };
                let path = first + (task * TASK_PATHS + i) as u32;
                let stream = self.stream(plan.seed, pass, path);
                trace_photon(scene, photon, wanted, plan.max_depth, path, &stream, |deposit| {
                    landed[deposit.kind as usize].push(Photon::from(deposit));
                });
            }
            landed
        };
        batch.par_chunks(TASK_PATHS).enumerate().map(follow).collect()
    }

    fn stream(&self, seed: u64, pass: u32, path: u32) -> SampleStream {
        SampleStream::new(seed, self.stage, u64::from(pass), path)
    }
}

/// What is under way in one pass. Written by `begin_photons`, taken by `finish_photons`.
#[derive(Resource, Clone, Debug)]
pub(super) struct PhotonRun {
    /// Emissions that are not over; the first one is under way.
    pub(super) emissions: VecDeque<EmissionRun>,
    /// Maps whose photons have all landed.
    pub(super) landed: Vec<MapRun>,
}

/// One emission under way.
#[derive(Clone, Debug)]
pub(super) struct EmissionRun {
    pub(super) aim: Aim,
    /// The pass that it is for: chooses the random numbers, and how far the radius has shrunk. 0 where it serves all.
    pub(super) pass: u32,
    /// Paths emitted so far.
    pub(super) emitted: u32,
    /// The batch between emission and tracing.
    pub(super) batch: Vec<Option<EmittedPhoton>>,
    pub(super) maps: Vec<MapRun>,
}

/// One map under way.
#[derive(Clone, Debug)]
pub(super) struct MapRun {
    pub(super) plan: MapPlan,
    /// The pass that it is for.
    pub(super) pass: u32,
    /// Photons that landed, in (path, bounce) order; flux not yet divided by the number emitted.
    pub(super) photons: Vec<Photon>,
    /// Paths that were emitted for them, once all have landed.
    pub(super) emitted: Option<u32>,
}

impl PhotonRun {
    /// The run of a pass.
    ///
    /// - `all`: also the maps that serve every pass.
    pub(super) fn new(plan: &PhotonPlan, pass: u32, all: bool) -> Self {
        let needed = plan.emissions.iter().filter(|emission| all || emission.is_progressive);
        let emission = |emission: &EmissionPlan| {
            let pass = if emission.is_progressive { pass } else { 0 };
            EmissionRun {
                aim: emission.aim.clone(),
                pass,
                emitted: 0,
                batch: Vec::new(),
                maps: emission.maps.iter().map(|map| MapRun::new(*map, pass)).collect(),
            }
        };
        Self {
            emissions: needed.map(emission).collect(),
            landed: Vec::new(),
        }
    }

    /// The run of photons that were traced before, their flux already divided by the number emitted.
    pub(super) fn reloaded(plan: &PhotonPlan, maps: &[PhotonsOfKind]) -> Self {
        let planned = plan.emissions.iter().flat_map(|emission| &emission.maps);
        let landed = planned.filter_map(|map| {
            let (_, photons) = maps.iter().find(|(kind, _)| *kind == map.kind)?;
            let mut run = MapRun::new(*map, 0);
            run.photons.clone_from(photons);
            run.emitted = Some(1);
            Some(run)
        });
        Self {
            emissions: VecDeque::new(),
            landed: landed.collect(),
        }
    }

    /// True when every photon has landed.
    pub(super) fn is_over(&self) -> bool {
        self.emissions.is_empty()
    }

    /// Photons that have landed so far.
    pub(super) fn landed_count(&self) -> u64 {
        let under_way = self.emissions.iter().flat_map(|emission| &emission.maps);
        let counts = self.landed.iter().chain(under_way).map(|map| map.photons.len() as u64);
        counts.sum()
    }
}

impl EmissionRun {
    /// Kinds of photons that are still to be stored.
    pub(super) fn wanted(&self) -> MapKinds {
        let open = self.maps.iter().filter(|map| map.emitted.is_none());
        open.fold(MapKinds::default(), |kinds, map| kinds.with(map.plan.kind))
    }

    /// Takes in what has landed of a batch, and closes the maps that have enough.
    pub(super) fn take_in(&mut self, landed: &[Landed]) {
        self.emitted += BATCH_PATHS;
        for map in &mut self.maps {
            for task in landed {
                map.photons.extend_from_slice(&task[map.plan.kind as usize]);
            }
        }
        for map in self.maps.iter_mut().filter(|map| map.emitted.is_none()) {
            if map.has_enough(self.emitted) {
                map.emitted = Some(self.emitted);
            }
        }
    }
}

impl MapRun {
    pub(super) fn new(plan: MapPlan, pass: u32) -> Self {
        Self {
            plan,
            pass,
            photons: Vec::new(),
            emitted: None,
        }
    }

    /// True when enough photons have landed, or too many were emitted for more to be worth waiting for.
    fn has_enough(&self, emitted: u32) -> bool {
        match self.plan.batches {
            Some(batches) => emitted / BATCH_PATHS >= batches,
            None => self.photons.len() as u64 >= self.plan.wanted || u64::from(emitted) >= self.plan.most_emitted(),
        }
    }

    /// How the map is read.
    pub(super) fn density(&self) -> DensitySettings {
        DensitySettings {
            shrink: progressive_shrink(self.pass),
            ..self.plan.density
        }
    }
}

impl MapPlan {
    /// Most paths that are emitted for the map.
    fn most_emitted(&self) -> u64 {
        self.wanted.saturating_mul(MAX_EMITTED_RATIO).min(MOST_PATHS)
    }

    /// Batches that a pass emits when `landed` photons of the first batch came to this map.
    pub(super) fn batches_for(&self, landed: usize) -> u32 {
        let most = (self.most_emitted() / u64::from(BATCH_PATHS)).max(1);
        let enough = match landed {
            0 => most,
            landed => self.wanted.div_ceil(landed as u64).min(most),
        };
        enough as u32
    }
}
