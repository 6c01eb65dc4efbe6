use bevy_ecs::component::Component;
use bytemuck::{Pod, Zeroable};
use radiometry::{Rgb, pack_direction};

/// A photon stored where it reached a diffuse surface. Written by `photon_map`; one entity each, by the hundred
/// thousand; 40 bytes. Its marker ([`CausticPhoton`]) says which map it belongs to.
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

/// Marks a photon that met only specular surfaces since the light.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct CausticPhoton;
