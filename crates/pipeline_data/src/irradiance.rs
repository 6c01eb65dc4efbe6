use bevy_ecs::component::Component;
use bevy_ecs::resource::Resource;
use transport::IrradianceCache;

/// A record of irradiance. Written by `irradiance_cache`; one entity each, by the thousand; 128 bytes.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct IrradianceRecord {
    /// Its number among those of its depth, in the order in which they were made.
    pub number: u32,
    /// 0 for what the eye reads; rays of records of depth d read those of depth d + 1 where they end.
    pub depth: u32,
    /// World space from [`SceneOrigin`](crate::SceneOrigin), metres.
    pub record: transport::IrradianceRecord,
}

const _: () = assert!(size_of::<IrradianceRecord>() <= 128);

/// Depths of records.
pub const RECORD_DEPTHS: usize = 3;

/// By depth: the records in the order of their numbers, and the octree over them, ready to be read. Written by `irradiance_cache`.
#[derive(Resource, Clone, Debug)]
pub struct BuiltIrradianceCache(pub [IrradianceCache; RECORD_DEPTHS]);

impl BuiltIrradianceCache {
    /// What the eye reads.
    #[must_use]
    pub fn seen(&self) -> &IrradianceCache {
        &self.0[0]
    }
}
