use bevy_ecs::component::Component;
use bevy_ecs::resource::Resource;
use transport::IrradianceCache;

/// A record of irradiance. Written by `irradiance_cache`; one entity each, by the thousand; 124 bytes.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct IrradianceRecord {
    /// Its number, in the order in which records were made.
    pub number: u32,
    /// World space from [`SceneOrigin`](crate::SceneOrigin), metres.
    pub record: transport::IrradianceRecord,
}

const _: () = assert!(size_of::<IrradianceRecord>() <= 128);

/// The records in the order of their numbers, and the octree over them, ready to be read. Written by `irradiance_cache`.
#[derive(Resource, Clone, Debug)]
pub struct BuiltIrradianceCache(pub IrradianceCache);
