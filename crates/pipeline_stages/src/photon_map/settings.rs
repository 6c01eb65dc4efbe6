use bevy_ecs::component::Mutable;
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::std_traits::ReflectDefault;
use bevy_reflect::{GetTypeRegistration, Reflect};
use scene_format::{Range, Unit};
use transport::{DensityFilter, MapKind};

/// What the settings of every photon map say.
pub trait PhotonMapSettings: Component<Mutability = Mutable> + Clone + Default + GetTypeRegistration {
    /// Name of the component, as it stands in scene files.
    const NAME: &'static str;
    /// The map.
    const KIND: MapKind;
    /// Photons to store.
    fn photons(&self) -> u32;
    /// Photons that set the radius of an estimate.
    fn nearest(&self) -> u32;
    /// Largest radius of an estimate, metres.
    fn max_radius(&self) -> Option<f32>;
    /// Weight of photons over their disc.
    fn filter(&self) -> PhotonFilter;
    /// Whether every pass has photons of its own.
    fn progressive(&self) -> bool;
}

macro_rules! photon_map_settings {
    ($name:ident, $kind:ident, $doc:literal) => {
        #[doc = $doc]
        #[derive(Component, Reflect, Clone, Debug)]
        #[reflect(Component, Default)]
        pub struct $name {
            /// Photons to store. More: sharper and less noisy light, more memory (about 150 bytes each) and time.
            /// Emission goes on in whole batches until they are stored, at most 100 times as many.
            #[reflect(@Range::at_least(1.0))]
            pub photons: u32,
            /// Photons that set the radius of an estimate. Fewer: sharper and noisier; more: smoother and blurred.
            #[reflect(@Range::closed(2.0, 100_000.0))]
            pub nearest: u32,
            /// Largest radius of an estimate. By default the radius that holds `nearest` photons when all of them are
            /// spread evenly over every diffuse surface.
            #[reflect(@Range::above(0.0), @Unit("m"))]
            pub max_radius: Option<f32>,
            /// Weight of photons over the disc that they are gathered in.
            pub filter: PhotonFilter,
            /// New photons for every pass, and a radius that shrinks from pass to pass: the picture converges to the
            /// true one, however few photons a pass has. Without it one map serves all samples, and what it blurs stays
            /// blurred.
            pub progressive: bool,
        }

        impl Default for $name {
            fn default() -> Self {
                Self {
                    photons: 100_000,
                    nearest: 50,
                    max_radius: None,
                    filter: PhotonFilter::Cone,
                    progressive: false,
                }
            }
        }

        impl PhotonMapSettings for $name {
            const NAME: &'static str = stringify!($name);
            const KIND: MapKind = MapKind::$kind;

            fn photons(&self) -> u32 {
                self.photons
            }

            fn nearest(&self) -> u32 {
                self.nearest
            }

            fn max_radius(&self) -> Option<f32> {
                self.max_radius
            }

            fn filter(&self) -> PhotonFilter {
                self.filter
            }

            fn progressive(&self) -> bool {
                self.progressive
            }
        }
    };
}

photon_map_settings!(
    DirectPhotonMap,
    Direct,
    "Settings of the direct photon map, light straight from the lights; on the prim that carries `Render`. Read when `LightTransport.direct` is `PhotonMap`, and by `FinalGather`."
);
photon_map_settings!(
    CausticPhotonMap,
    Caustic,
    "Settings of the caustic photon map, light over mirrors and glass alone; on the prim that carries `Render`. Read when `LightTransport.caustic` is `PhotonMap`, and by `FinalGather`."
);
photon_map_settings!(
    IndirectPhotonMap,
    Indirect,
    "Settings of the indirect photon map, light over other matt surfaces; on the prim that carries `Render`. Read when `LightTransport.indirect` is `PhotonMap`, and by `FinalGather`."
);

/// Weight of photons over the disc that they are gathered in.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default)]
pub enum PhotonFilter {
    /// All alike: least noise, blurs edges most.
    Disc,
    /// Falls linearly to the rim: keeps edges sharper.
    #[default]
    Cone,
    /// A Gaussian bell, between disc and cone.
    Gaussian,
    /// Falls with the square of the distance.
    Epanechnikov,
}

impl From<PhotonFilter> for DensityFilter {
    fn from(filter: PhotonFilter) -> Self {
        match filter {
            PhotonFilter::Disc => Self::Disc,
            PhotonFilter::Cone => Self::Cone,
            PhotonFilter::Gaussian => Self::Gaussian,
            PhotonFilter::Epanechnikov => Self::Epanechnikov,
        }
    }
}
