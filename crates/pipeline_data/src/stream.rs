use crate::RenderSettings;
use bevy_ecs::change_detection::Mut;
use bevy_ecs::component::{Component, Mutable};
use bevy_ecs::resource::Resource;
use bevy_ecs::world::EntityMut;
use film::{AuxGroup, ChannelLayout};
use glam::{Vec2, Vec3};
use radiometry::{Rgb, SampleStream, StageKey};
use spatial::{Ray, SurfacePoint};
use transport::{Guide, Layer, Path};

/// A batch of camera paths: a run of film pixels, in storage order. Written by `camera` for each wave; a few dozen.
///
/// All streams of a batch are components of the same entity. Streams that hold live paths ([`RayStream`],
/// [`PathStream`], [`HitStream`], [`GuideStream`]) run in parallel, row by row; streams by slot ([`FirstHits`], contributions) have one
/// row for each path that the wave began with.
#[derive(Component, Clone, Debug, Default)]
#[require(RayStream, HitStream, GuideStream, PathStream, FirstHits)]
pub struct FilmBatch {
    /// First pixel, in the film's storage order.
    pub first_pixel: usize,
    /// Pixel of each slot, counted from `first_pixel`.
    pub pixel_of_slot: Vec<u32>,
    /// Which sample of its pixel each slot is, from 0.
    pub sample_of_slot: Vec<u32>,
    /// Place of each slot's ray on the film, in pixels from the top left corner.
    pub film_position: Vec<Vec2>,
}

impl FilmBatch {
    /// The random numbers that a stage draws for the sample of a slot. Whatever a camera ray needs draws from here, so that
    /// batches of samples are independent in all of it.
    #[inline]
    #[must_use]
    pub fn sample_stream(
        &self,
        slot: usize,
        stage: StageKey,
        film: &film::Film,
        settings: &RenderSettings,
    ) -> SampleStream {
        let pixel = film.pixel_of(self.first_pixel + self.pixel_of_slot[slot] as usize);
        let domain = u64::from(pixel.y) * u64::from(settings.resolution.x) + u64::from(pixel.x);
        let sequences = film.layout().sequences();
        SampleStream::dealt(settings.seed, stage, domain, self.sample_of_slot[slot], sequences)
    }
}

/// The rays of live paths. Written by `camera` and `path_tracing`; 32 bytes a path.
#[derive(Component, Clone, Debug, Default)]
pub struct RayStream(pub Vec<Ray>);

/// The state of live paths. Written by `camera` and `path_tracing`; 84 bytes a path.
#[derive(Component, Clone, Debug, Default)]
pub struct PathStream(pub Vec<Path>);

/// What each live path's ray met; `None` where it left the scene. Written by `path_tracing`.
#[derive(Component, Clone, Debug, Default)]
pub struct HitStream(pub Vec<Option<SurfacePoint>>);

/// Where light comes from at each hit, for paths to be drawn there; empty where nothing guides them. Written by
/// `path_guiding`; 136 bytes a path.
#[derive(Component, Clone, Debug, Default)]
pub struct GuideStream(pub Vec<Guide>);

/// What the camera ray of each slot met first, for the auxiliary channels. Written by `image`.
#[derive(Component, Clone, Debug, Default)]
pub struct FirstHits(pub Vec<FirstHit>);

/// One row of [`FirstHits`]; all zero where the ray left the scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct FirstHit {
    /// 1 where there is a surface.
    pub alpha: f32,
    /// Directional albedo.
    pub albedo: Rgb,
    /// Unit shading normal, world space.
    pub normal: Vec3,
    /// Distance from the eye in metres.
    pub depth: f32,
}

/// Light that one lighting term found for a batch, in the order it was found. 16 bytes an entry.
#[derive(Clone, Debug, Default)]
pub struct ContributionLog(Vec<(u32, Rgb)>);

/// Bits of an entry's first word that hold the slot; the layer is above them.
const SLOT_BITS: u32 = 28;

impl ContributionLog {
    /// Adds a contribution, in W·m⁻²·sr⁻¹, to a slot of the batch.
    #[inline]
    pub fn add(&mut self, slot: u32, layer: Layer, radiance: Rgb) {
        debug_assert!(slot < 1 << SLOT_BITS, "a batch has few slots");
        self.0.push((slot | ((layer as u32) << SLOT_BITS), radiance));
    }

    /// All entries: slot, index of the layer in [`Layer::ALL`], radiance.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize, Rgb)> {
        const SLOT_MASK: u32 = (1 << SLOT_BITS) - 1;
        self.0
            .iter()
            .map(|(key, radiance)| ((key & SLOT_MASK) as usize, (key >> SLOT_BITS) as usize, *radiance))
    }

    /// Forgets everything; keeps the memory.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

/// The component in which one lighting term keeps its contributions to a batch.
///
/// Each term has a type of its own, so that terms share a set without touching each other.
pub trait Contribution: Component<Mutability = Mutable> + Default + AsMut<ContributionLog> {
    /// Stable name of the term, by which contributions are added up in a fixed order.
    const NAME: &'static str;
}

type LogOf = for<'e, 'w> fn(&'e mut EntityMut<'w>) -> Option<Mut<'e, ContributionLog>>;

/// The lighting terms that there are. Written by stages when they are built, read when the film adds up.
#[derive(Resource, Clone, Debug, Default)]
pub struct Contributions(Vec<(&'static str, LogOf)>);

impl Contributions {
    /// Makes `C` count on the film. The batch gets the component by itself.
    pub fn register<C: Contribution>(app: &mut bevy_app::App) {
        app.init_resource::<Self>()
            .register_required_components::<FilmBatch, C>();
        let mut terms = app.world_mut().resource_mut::<Self>();
        terms.0.push((C::NAME, |batch| {
            Some(batch.get_mut::<C>()?.map_unchanged(AsMut::as_mut))
        }));
        terms.0.sort_by_key(|(name, _)| *name);
    }

    /// Empties the logs of a batch, by name of the term, giving each entry to `receive`: slot, index of the layer in
    /// [`Layer::ALL`], radiance.
    pub fn drain(&self, batch: &mut EntityMut<'_>, mut receive: impl FnMut(usize, usize, Rgb)) {
        for (_, log_of) in &self.0 {
            if let Some(mut log) = log_of(batch) {
                for (slot, layer, radiance) in log.iter() {
                    receive(slot, layer, radiance);
                }
                log.clear();
            }
        }
    }
}

/// The film: exact sums of all samples so far. Made and filled by `image`, read by `camera`.
#[derive(Resource, Debug)]
pub struct FilmSums(pub film::Film);

impl FilmSums {
    /// Layers that the film has: all but `volume`, which nothing renders yet.
    pub const LAYERS: usize = 5;

    /// Groups of channels that every film has beside the light: what is seen first. Those of debug layers come after them.
    const SEEN_FIRST: usize = 3;

    /// Names of the debug layers that the film has.
    pub fn debug_layers(&self) -> impl Iterator<Item = &str> {
        let groups = self.0.layout().aux.iter().skip(Self::SEEN_FIRST);
        groups.map(|group| group.name.as_str())
    }

    /// Channels of a film that keeps the variance of every layer.
    #[must_use]
    pub fn layout_by_layer() -> ChannelLayout {
        ChannelLayout {
            layer_variance: true,
            ..Self::layout(true, &[])
        }
    }

    /// Channels of the film: the light, what is seen first, and debug layers; with or without the variance.
    #[must_use]
    pub fn layout(variance: bool, debug_layers: &[&str]) -> ChannelLayout {
        let seen_first: [AuxGroup; Self::SEEN_FIRST] = [
            AuxGroup::rgb("albedo"),
            AuxGroup::xyz("normal"),
            AuxGroup::depth("depth"),
        ];
        let debug = debug_layers.iter().map(|name| AuxGroup::scalar(name));
        ChannelLayout {
            layers: Layer::ALL[..Self::LAYERS]
                .iter()
                .map(|layer| layer.name().into())
                .collect(),
            aux: seen_first.into_iter().chain(debug).collect(),
            variance,
            layer_variance: false,
        }
    }
}
