use bevy_ecs::component::Component;
use bevy_ecs::resource::Resource;
use bytemuck::{Pod, Zeroable};
use radiometry::{Rgb, pack_direction};
use transport::{MapKind, MapKinds, PhotonMaps};

/// A photon stored where it reached a diffuse surface. Written by `photon_map`; one entity each, by the hundred
/// thousand; 40 bytes. Its marker, a [`PhotonMarker`], says which map it belongs to.
#[derive(Component, Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Photon {
    /// Where it landed: world space from [`SceneOrigin`](crate::SceneOrigin), metres.
    pub position: [f32; 3],
    /// Flux in W, already divided by the number emitted.
    pub flux: Rgb,
    /// Unit direction to where it came from, octahedral.
    pub direction: u32,
    /// Unit geometric normal of the surface, on the side it arrived from, octahedral.
    pub normal: u32,
    /// Number of its path from the light.
    pub path: u32,
    /// Events between the light and here.
    pub bounce: u32,
}

const _: () = assert!(size_of::<Photon>() <= 40);

impl From<transport::Deposit> for Photon {
    fn from(d: transport::Deposit) -> Self {
        Self {
            position: d.position.to_array(),
            flux: d.flux,
            direction: pack_direction(d.direction),
            normal: pack_direction(d.normal),
            path: d.path,
            bounce: d.bounce,
        }
    }
}

/// The component that says which map a photon belongs to: one table of the world, hence one photon map, a marker.
pub trait PhotonMarker: Component + Copy + Default {
    /// The map.
    const KIND: MapKind;
}

/// Marks a photon that came straight from the light.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct DirectPhoton;

/// Marks a photon that met only specular surfaces since the light.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct CausticPhoton;

/// Marks a photon that met a diffuse surface since the light, or scattered in a medium.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct IndirectPhoton;

impl PhotonMarker for DirectPhoton {
    const KIND: MapKind = MapKind::Direct;
}

impl PhotonMarker for CausticPhoton {
    const KIND: MapKind = MapKind::Caustic;
}

impl PhotonMarker for IndirectPhoton {
    const KIND: MapKind = MapKind::Indirect;
}

/// Which photon maps stages read, beside what `LightTransport` says. Written by each of them in `PrepareStages`, read by
/// `photon_map`, which comes after them.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct PhotonDemand {
    /// Kinds of photons.
    pub kinds: MapKinds,
    /// Photons to store for a map that nothing else reads, where its own settings do not say.
    pub photons: Option<u32>,
}

/// The photon maps, ready to be read. Written by `photon_map`; present once they are built.
#[derive(Resource, Clone, Debug, Default)]
pub struct BuiltPhotonMaps(pub PhotonMaps);

/// Present when the picture is the mean of passes that each have photons of their own. Written by `photon_map` before
/// `camera` plans the waves.
#[derive(Resource, Clone, Copy, Debug)]
pub struct ProgressivePasses {
    /// Samples that each pixel takes in a pass.
    pub samples_per_pass: u32,
}
