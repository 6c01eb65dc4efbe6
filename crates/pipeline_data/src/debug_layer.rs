use crate::{FilmBatch, FilmSums, RenderSettings};
use bevy_ecs::component::{Component, Mutable};
use bevy_ecs::resource::Resource;
use bevy_ecs::world::EntityMut;

/// One number for what each camera ray meets first, which a stage shows of its workings: a channel of the film beside the
/// light, the mean over the samples of a pixel.
///
/// The component holds the numbers of a batch by slot. Written while `Bounce` runs for bounce 0; what is not there counts 0.
pub trait DebugLayer: Component<Mutability = Mutable> + Default + AsRef<[f32]> {
    /// Name of the channel.
    const NAME: &'static str;

    /// True when the film has the layer; else nobody asks for the numbers.
    fn is_shown(settings: &RenderSettings) -> bool;
}

/// Gives the numbers of a batch for a debug layer, by slot.
pub type NumbersOf = for<'e> fn(&'e EntityMut<'_>) -> &'e [f32];

#[derive(Clone, Copy, Debug)]
struct Registered {
    name: &'static str,
    is_shown: fn(&RenderSettings) -> bool,
    numbers_of: NumbersOf,
}

/// The debug layers that there are. Written by stages when they are built, read by `tables` and when the film adds up.
#[derive(Resource, Clone, Debug, Default)]
pub struct DebugLayers(Vec<Registered>);

impl DebugLayers {
    /// Adds a layer. The batch gets the component by itself.
    pub fn register<L: DebugLayer>(app: &mut bevy_app::App) {
        app.init_resource::<Self>()
            .register_required_components::<FilmBatch, L>();
        let mut layers = app.world_mut().resource_mut::<Self>();
        layers.0.push(Registered {
            name: L::NAME,
            is_shown: L::is_shown,
            numbers_of: |batch| batch.get::<L>().map_or(&[], AsRef::as_ref),
        });
        layers.0.sort_by_key(|layer| layer.name);
    }

    /// Names of those that a render shows, in order.
    #[must_use]
    pub fn shown(&self, settings: &RenderSettings) -> Vec<&'static str> {
        let shown = self.0.iter().filter(|layer| (layer.is_shown)(settings));
        shown.map(|layer| layer.name).collect()
    }

    /// Where the numbers of the debug layers that a film has come from, in its order.
    #[must_use]
    pub fn of_film(&self, film: &FilmSums) -> Vec<NumbersOf> {
        let registered = |name: &str| self.0.iter().find(|layer| layer.name == name);
        let layers = film.debug_layers().map(registered);
        layers
            .map(|layer| layer.map_or((|_| &[]) as NumbersOf, |layer| layer.numbers_of))
            .collect()
    }
}
