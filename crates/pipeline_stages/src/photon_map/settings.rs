use bevy_ecs::prelude::*;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use scene_format::{Range, Unit};
use transport::DensityFilter;

/// Settings of the caustic photon map, on the prim that carries `Render`; used when `LightTransport.caustic` is `PhotonMap`.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct CausticPhotonMap {
    /// Photons to store. More: sharper and less noisy caustics, more memory (about 150 bytes each) and time.
    /// Emission goes on in whole batches until they are stored, at most 100 times as many.
    #[reflect(@Range::at_least(1.0))]
    pub photons: u32,
    /// Photons that set the radius of an estimate. Fewer: sharper and noisier; more: smoother and blurred.
    #[reflect(@Range::closed(2.0, 100_000.0))]
    pub nearest: u32,
    /// Largest radius of an estimate. By default the radius that holds `nearest` photons when all of them are spread
    /// evenly over every diffuse surface.
    #[reflect(@Range::above(0.0), @Unit("m"))]
    pub max_radius: Option<f32>,
    /// Weight of photons over the disc that they are gathered in.
    pub filter: PhotonFilter,
}

impl Default for CausticPhotonMap {
    fn default() -> Self {
        Self {
            photons: 100_000,
            nearest: 50,
            max_radius: None,
            filter: PhotonFilter::Cone,
        }
    }
}

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
