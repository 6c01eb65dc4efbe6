//! Components for the tests: a small copy of a renderer's vocabulary.

use bevy_reflect::{Reflect, TypeRegistry, std_traits::ReflectDefault};
use glam::{DVec3, Quat, UVec2, Vec2, Vec3};
use scene_format::{
    AssetPath, Diagnostics, Exclusive, Options, Range, Required, Scene, Schema, Target, Targets, Unit, load_str,
};

/// Where a prim is.
#[derive(Reflect, Clone, Debug)]
#[reflect(Default)]
pub(crate) struct Transform {
    /// Position.
    #[reflect(@Unit("m"))]
    pub(crate) translate: DVec3,
    pub(crate) scale: Vec3,
    pub(crate) quaternion: Option<Quat>,
}

impl Default for Transform {
    fn default() -> Self {
        Self {
            translate: DVec3::ZERO,
            scale: Vec3::ONE,
            quaternion: None,
        }
    }
}

/// Turns a prim towards a point.
#[derive(Reflect, Clone, Debug, Default)]
#[reflect(Default)]
pub(crate) struct LookAt {
    #[reflect(@Required)]
    pub(crate) target: DVec3,
    pub(crate) up: Vec3,
}

/// A pinhole camera.
#[derive(Reflect, Clone, Debug)]
#[reflect(Default)]
pub(crate) struct Camera {
    /// Vertical angle of view.
    #[reflect(@Range::open(0.0, 180.0), @Unit("degrees"))]
    pub(crate) fov: f32,
    pub(crate) fstop: Option<f32>,
}

impl Default for Camera {
    fn default() -> Self {
        Self { fov: 40.0, fstop: None }
    }
}

#[derive(Reflect, Clone, Debug, Default)]
#[reflect(Default)]
pub(crate) struct Mesh {
    #[reflect(@Required)]
    pub(crate) file: AssetPath,
    pub(crate) smooth: bool,
}

#[derive(Reflect, Clone, Debug, Default)]
#[reflect(Default)]
pub(crate) struct Diffuse {
    #[reflect(@Range::closed(0.0, 1.0))]
    pub(crate) albedo: Vec3,
    pub(crate) texture: Option<AssetPath>,
}

#[derive(Reflect, Clone, Debug, Default)]
#[reflect(Default)]
pub(crate) struct Emission {
    #[reflect(@Range::at_least(0.0), @Unit("W·m⁻²·sr⁻¹"), @Exclusive::group("strength"))]
    pub(crate) radiance: Vec3,
    #[reflect(@Range::at_least(0.0), @Unit("W"), @Exclusive::group("strength"))]
    pub(crate) power: Option<Vec3>,
}

#[derive(Reflect, Clone, Debug, Default)]
#[reflect(Default)]
pub(crate) struct Conductor {
    #[reflect(@Exclusive::group("spectrum"))]
    pub(crate) metal: Option<String>,
    #[reflect(@Exclusive::side("spectrum", "eta_k"))]
    pub(crate) eta: Option<Vec3>,
    #[reflect(@Exclusive::side("spectrum", "eta_k"))]
    pub(crate) k: Option<Vec3>,
    pub(crate) roughness: f32,
}

#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Filter {
    Box,
    Triangle,
    #[default]
    BlackmanHarris,
}

#[derive(Reflect, Clone, Debug)]
#[reflect(Default)]
pub(crate) struct Film {
    #[reflect(@Range::closed(1.0, 65536.0))]
    pub(crate) resolution: UVec2,
    pub(crate) filter: Filter,
    #[reflect(@Range::above(0.0))]
    pub(crate) filter_radius: f32,
    pub(crate) crop: Option<(Vec2, Vec2)>,
    pub(crate) edges: Vec<f32>,
}

impl Default for Film {
    fn default() -> Self {
        Self {
            resolution: UVec2::splat(512),
            filter: Filter::default(),
            filter_radius: 1.5,
            crop: None,
            edges: vec![1.0, 2.0, 3.0],
        }
    }
}

#[derive(Reflect, Clone, Copy, Debug, Default)]
pub(crate) enum Method {
    #[default]
    SampleLights,
    Trace,
    PathTrace,
}

#[derive(Reflect, Clone, Debug, Default)]
#[reflect(Default)]
pub(crate) struct LightTransport {
    pub(crate) direct: Method,
    pub(crate) specular: Method,
    pub(crate) caustic: Method,
    pub(crate) indirect: Method,
}

#[derive(Reflect, Clone, Debug, Default)]
#[reflect(Default)]
pub(crate) struct Render {
    #[reflect(@Required)]
    pub(crate) camera: Target,
    pub(crate) max_depth: Option<u32>,
    pub(crate) seed: u64,
}

#[derive(Reflect, Clone, Debug, Default)]
#[reflect(Default)]
pub(crate) struct LightLinks {
    pub(crate) include: Option<Targets>,
    pub(crate) exclude: Targets,
}

#[derive(Reflect, Clone, Debug, Default)]
#[reflect(Default)]
pub(crate) struct EnvironmentLight {
    pub(crate) radiance: Vec3,
    pub(crate) file: Option<AssetPath>,
}

/// Marks a prim.
#[derive(Reflect, Clone, Debug, Default)]
#[reflect(Default)]
pub(crate) struct Marker;

pub(crate) fn registry() -> TypeRegistry {
    let mut registry = TypeRegistry::new();
    registry.register::<Transform>();
    registry.register::<LookAt>();
    registry.register::<Camera>();
    registry.register::<Mesh>();
    registry.register::<Diffuse>();
    registry.register::<Emission>();
    registry.register::<Conductor>();
    registry.register::<Film>();
    registry.register::<LightTransport>();
    registry.register::<Render>();
    registry.register::<LightLinks>();
    registry.register::<EnvironmentLight>();
    registry.register::<Marker>();
    registry
}

/// Which of the registered types are components; programs ask for `ReflectComponent`.
pub(crate) fn schema(registry: &TypeRegistry) -> Schema<'_> {
    let own = concat!(module_path!(), "::");
    Schema::new(registry, |found| {
        found.type_info().type_path().starts_with(own) && found.contains::<ReflectDefault>()
    })
    .expect("the vocabulary is sound")
}

pub(crate) fn options() -> Options {
    Options {
        check_assets: false,
        ..Options::default()
    }
}

pub(crate) fn load_with(text: &str, options: &Options) -> Result<Scene, Diagnostics> {
    let registry = registry();
    load_str("scene.ron", text, &schema(&registry), options)
}

/// Loads a scene that is right.
pub(crate) fn scene(text: &str) -> Scene {
    load_with(text, &options()).unwrap_or_else(|errors| panic!("{errors}"))
}

/// Gives the messages about a scene that is wrong.
pub(crate) fn errors(text: &str) -> String {
    load_with(text, &options())
        .map(|_| "no error".to_owned())
        .unwrap_or_else(|errors| errors.to_string())
}

/// Gives the messages about arguments that are wrong.
pub(crate) fn set_errors(text: &str, sets: &[&str]) -> String {
    let options = Options {
        sets: sets.iter().map(|&set| set.to_owned()).collect(),
        ..options()
    };
    load_with(text, &options)
        .map(|_| "no error".to_owned())
        .unwrap_or_else(|errors| errors.to_string())
}
