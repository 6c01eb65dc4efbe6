//! Components and resources that cross a stage boundary. No systems.
//!
//! One file per flow: what is written in a scene ([`vocabulary`]), what the scene became (`scene`), what is asked of
//! the render (`request`, `settings`), and the streams of paths, photons and pixels that systems hand to each other. A
//! stage may keep whatever else it likes to itself; what two stages share stands here, with its byte budget.
//!
//! It deliberately holds no formula: those are one layer down, in crates that know no ECS.

mod checked_file;
mod debug_layer;
mod irradiance;
mod mesh_store;
mod patch;
mod photon;
mod photon_file;
mod pixel_choice;
mod record_file;
mod request;
mod scene;
mod settings;
mod stream;
mod texture_store;
pub mod vocabulary;

pub use checked_file::CheckedFileError;
pub use debug_layer::{DebugLayer, DebugLayers, NumbersOf};
pub use irradiance::{BuiltIrradianceCache, IrradianceRecord, RECORD_DEPTHS};
pub use mesh_store::{ImportedMesh, MeshKey, MeshStore};
pub use patch::{PatchDemand, RadiosityPatch, SolvedPatches};
pub use photon::{
    BuiltPhotonMaps, CausticPhoton, DirectPhoton, IndirectPhoton, Photon, PhotonDemand, PhotonMarker, ProgressivePasses,
};
pub use photon_file::{PhotonFileError, PhotonsOfKind, read_photons, write_photons};
pub use pixel_choice::{ChosenBlocks, PixelChoice};
pub use record_file::{
    BorrowedRecords, RecordFileError, RecordKeys, RecordsByDepth, StoredRecords, read_records, write_records,
};
pub use request::RenderRequest;
pub use scene::{
    Acceleration, CameraFrame, ComposedScene, EnvironmentMaps, InstancePrims, PrimIndex, SceneOrigin, ShutterInterval,
    TransportScene, WorldMotion, WorldTransform,
};
pub use settings::RenderSettings;
pub use stream::{
    Contribution, ContributionLog, Contributions, FilmBatch, FilmSums, FirstHit, FirstHits, GuideStream, HitStream,
    PathStream, RayStream,
};
pub use texture_store::{PictureKey, TextureRole, TextureStore};
