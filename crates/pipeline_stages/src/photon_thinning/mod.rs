//! Photon thinning: fewer photons where they are denser than the picture has use for, with all their flux.
//!
//! Scene: `"/Render": Def(PhotonThinning: (density: 4))`, beside whatever makes photon maps.
//! Sets: `PrepareStages` (`plan_thinning`), `RevisePhotons` (`thin_photons`).
//! Reads the camera and stored photons. Removes some of these entities and writes the flux of the others.
//! Counters: `photon_thinning/photons removed`.
//!
//! Caustics gather most photons in a few bright places. There only as many stay as are asked for, each with the flux of those
//! that went around it, so that maps and files of photons grow no further once every lit place has its share. What is stored
//! is what the maps, `pipeline photons` and files of photons have; photons taken from a file are not thinned again.
//!
//! Estimates keep their number of photons, hence are wider where it was thinned: it is `nearest` raised where photons are
//! dense, for nothing. That is what it is good for: less noise in bright places. It does not sharpen anything.
//! `scenes/ring.ron` at 256×256, a million caustic photons, trimmed relMSE of the caustic against 48 million in progressive
//! maps, time of lookups on one thread:
//!
//! | `nearest` | `density` | photons in the map | lookup | relMSE |
//! |---|---|---|---|---|
//! | 50 | – | 1,000,000 | 1.55 µs | 0.015 |
//! | 50 | 16 | 413,000 | 1.45 µs | 0.060 |
//! | 50 | 4 | 162,000 | 1.31 µs | 0.375 |
//! | 200 | – | 1,000,000 | 3.51 µs | 0.111 |
//! | 500 | – | 1,000,000 | 7.10 µs | 0.349 |
//! | 50 | – | 202,000 | 1.44 µs | 0.149 |
//!
//! So it does not pay there: blur at the edge of the light is most of the error, and as many photons traced as a thinned map
//! keeps do as well. In `tests/references/ring` light lies outside of the ring as well, and there it does: of a million photons a
//! density of 1 leaves 64,000, with a trimmed relMSE against the reference of 0.0082 and 0.38 µs a lookup; 52,000 photons
//! without thinning have 0.0142 and 0.84 µs, the whole million 0.0071 and 0.97 µs.
//!
//! Thinning takes about as long as tracing. All photons are stored before, so the peak of memory is higher by an eighth, not
//! lower; what gets smaller is the map and the file.
//!
//! Limits: pixels are those of the camera, also for what mirrors or gather rays see; a photon that takes over flux keeps its
//! own direction; an estimate misses some of the flux of the photon on its rim, which stands for others now: on an even field
//! 0.7 % where `nearest` is 50, 2 % where it is 12.
//! Source: Suykens and Willems, "Density Control for Photon Maps", Rendering Workshop 2000.

mod plan;
#[cfg(test)]
mod tests;
mod thin;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use pipeline_core::{PhotonPass, PhotonSystems, Prepare, PrepareSystems};
use pipeline_data::{CausticPhoton, DirectPhoton, IndirectPhoton};
use plan::ThinningPlan;
use scene_format::Range;

/// Thins photons where they are dense. On the prim that carries `Render`.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct PhotonThinning {
    /// Photons of a map that are enough within the square that a pixel of the film covers on a surface which faces the camera.
    /// Where there are more, some give their flux to others and go. Higher: sharper light, more memory and time; lower:
    /// smoother light. Estimates of `nearest` photons are not narrower than √(`nearest` / (π `density`)) pixels then.
    #[reflect(@Range::above(0.0))]
    pub density: f32,
}

impl Default for PhotonThinning {
    fn default() -> Self {
        Self { density: 4.0 }
    }
}

/// Where this stage works.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct PhotonThinningSystems;

/// Adds the thinning of photons.
pub struct PhotonThinningPlugin;

impl Plugin for PhotonThinningPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<PhotonThinning>()
            .add_systems(
                Prepare,
                plan::plan_thinning
                    .in_set(PrepareSystems::PrepareStages)
                    .in_set(PhotonThinningSystems),
            )
            .add_systems(
                PhotonPass,
                (
                    thin::thin_photons::<DirectPhoton>,
                    thin::thin_photons::<CausticPhoton>,
                    thin::thin_photons::<IndirectPhoton>,
                )
                    .chain()
                    .in_set(PhotonSystems::RevisePhotons)
                    .in_set(PhotonThinningSystems)
                    .run_if(resource_exists::<ThinningPlan>),
            );
    }
}
