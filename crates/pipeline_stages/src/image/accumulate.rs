use bevy_ecs::prelude::*;
use bevy_ecs::world::EntityMut;
use pipeline_core::{Counter, Counters, record_items};
use pipeline_data::{Contributions, DebugLayers, FilmBatch, FilmSums, FirstHits, NumbersOf};
use rayon::prelude::*;

/// Layers of the film.
const LAYERS: usize = FilmSums::LAYERS;

/// The counters of this system, asked for once.
pub(super) struct SampleCounters {
    samples: Counter,
    rejected: Counter,
}

impl FromWorld for SampleCounters {
    fn from_world(world: &mut World) -> Self {
        let mut counters = world.resource_mut::<Counters>();
        Self {
            samples: counters.counter("image/samples"),
            rejected: counters.counter("image/rejected samples"),
        }
    }
}

/// Adds the contributions of the wave to the film. The one guard against NaN, negative and infinite values is here, in
/// [`film::FilmSpan::add_sample`].
pub(super) fn accumulate_batches(
    world: &mut World,
    batches: &mut QueryState<EntityMut<'static>, With<FilmBatch>>,
    mut counters: Local<Option<SampleCounters>>,
) {
    let counters = &*counters.get_or_insert_with(|| SampleCounters::from_world(world));
    world.resource_scope(|world, mut film: Mut<FilmSums>| {
        let debug_layers = world.get_resource::<DebugLayers>();
        let numbers: Vec<_> = debug_layers.map_or_else(Vec::new, |layers| layers.of_film(&film));
        world.resource_scope(|world, terms: Mut<Contributions>| {
            let mut batches: Vec<_> = batches.iter_mut(world).collect();
            batches.sort_unstable_by_key(first_pixel);
            let Some(first) = batches.first().map(first_pixel) else {
                return;
            };
            let span_len = match batches.get(1) {
                Some(second) => first_pixel(second) - first,
                None => film.0.pixel_count() - first,
            };
            let end = film.0.pixel_count().min(first + span_len * batches.len());
            let spans = film.0.spans_mut(first..end, span_len);
            let samples = spans
                .into_par_iter()
                .zip(batches)
                .map_init(Vec::new, |layers, (mut span, mut batch)| {
                    add_batch(&mut batch, &mut span, &terms, &numbers, counters, layers)
                })
                .sum();
            counters.samples.add(samples as u64);
            record_items(samples);
        });
    });
}

fn first_pixel(batch: &EntityMut<'_>) -> usize {
    batch.get::<FilmBatch>().map_or(0, |batch| batch.first_pixel)
}

/// Adds one batch to its span of the film; returns the number of samples.
fn add_batch(
    batch: &mut EntityMut<'_>,
    span: &mut film::FilmSpan<'_>,
    terms: &Contributions,
    numbers_of: &[NumbersOf],
    counters: &SampleCounters,
    layers: &mut Vec<[[f32; 3]; LAYERS]>,
) -> usize {
    let slots = batch.get::<FilmBatch>().map_or(0, |batch| batch.pixel_of_slot.len());
    layers.clear();
    layers.resize(slots, [[0.0; 3]; LAYERS]);
    terms.drain(batch, |slot, layer, radiance| {
        let sum = &mut layers[slot][layer];
        for (sum, value) in sum.iter_mut().zip(radiance.to_array()) {
            *sum += value;
        }
    });
    let numbers: Vec<&[f32]> = numbers_of.iter().map(|of| of(batch)).collect();
    let (Some(batch), Some(first_hits)) = (batch.get::<FilmBatch>(), batch.get::<FirstHits>()) else {
        return 0;
    };
    let places = batch.pixel_of_slot.iter().zip(&batch.sample_of_slot);
    let mut aux = Vec::new();
    for (slot, ((radiance, (pixel, number)), hit)) in layers.iter().zip(places).zip(&first_hits.0).enumerate() {
        aux.clear();
        aux.extend(hit.albedo.to_array());
        aux.extend(hit.normal.to_array());
        aux.push(hit.depth);
        aux.extend(numbers.iter().map(|of_slot| of_slot.get(slot).copied().unwrap_or(0.0)));
        let added = span.add_sample(*pixel as usize, *number, radiance, hit.alpha, &aux);
        if added.is_err() {
            counters.rejected.add(1);
        }
    }
    slots
}
