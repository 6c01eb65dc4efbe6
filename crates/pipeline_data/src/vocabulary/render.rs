use bevy_ecs::component::Component;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use scene_format::{Range, Required, Target};

/// What to render: exactly one prim carries it, with `Film`, `LightTransport` and the settings of the methods.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Render {
    /// The prim that carries `Camera`.
    #[reflect(@Required)]
    pub camera: Target,
    /// Paths from the camera through each pixel. Four times as many halve the noise and take four times as long.
    #[reflect(@Range::closed(1.0, 16_777_216.0))]
    pub samples: u32,
    /// Most events on a path; none: paths end by chance alone, without bias. Low values lose light.
    #[reflect(@Range::at_least(1.0))]
    pub max_depth: Option<u32>,
    /// Chooses the random numbers: another seed, another noise, the same picture.
    pub seed: u64,
    /// Passes of progressive photon maps, each with photons of its own and its share of the samples; none: as many as
    /// `samples`, one sample a pass. A pass takes 1,024 samples at most.
    #[reflect(@Range::at_least(1.0))]
    pub passes: Option<u32>,
}

impl Default for Render {
    fn default() -> Self {
        Self {
            camera: Target::default(),
            samples: 64,
            max_depth: None,
            seed: 0,
            passes: None,
        }
    }
}

/// Which method finds which part of the light. On the prim that carries `Render`.
///
/// `direct: SampleLights, specular: Trace, caustic: Trace, indirect: PathTrace` is unbiased path tracing: the reference.
/// `Off` blackens its part and changes nothing else.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct LightTransport {
    /// Light that comes straight from a lamp to a matt surface.
    pub direct: DirectMethod,
    /// What is seen in mirrors and through glass.
    pub specular: SpecularMethod,
    /// Light that mirrors and glass focus on matt surfaces. `PhotonMap` finds what `Trace` finds rarely or never.
    pub caustic: CausticMethod,
    /// Light that comes over other matt surfaces.
    pub indirect: IndirectMethod,
    /// Surfaces with a GGX width (roughness²) up to this count as mirrors; higher gives more to `specular` and `caustic`.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub specular_alpha: f32,
}

impl Default for LightTransport {
    fn default() -> Self {
        Self {
            direct: DirectMethod::default(),
            specular: SpecularMethod::default(),
            caustic: CausticMethod::default(),
            indirect: IndirectMethod::default(),
            specular_alpha: 0.05,
        }
    }
}

/// How direct light is found.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DirectMethod {
    /// Shadow rays to sampled lights.
    #[default]
    SampleLights,
    /// Photons straight from the lights: blurs the edges of shadows. To look at a photon map, or for a first guess.
    PhotonMap,
    /// Not at all.
    Off,
}

impl From<DirectMethod> for transport::DirectMethod {
    fn from(method: DirectMethod) -> Self {
        match method {
            DirectMethod::SampleLights => Self::SampleLights,
            DirectMethod::PhotonMap => Self::PhotonMap,
            DirectMethod::Off => Self::Off,
        }
    }
}

/// How reflections and refractions are found.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpecularMethod {
    /// Paths that follow mirrors and glass.
    #[default]
    Trace,
    /// Not at all.
    Off,
}

/// How caustics are found.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CausticMethod {
    /// Photons from the lights, stored behind mirrors and glass.
    #[default]
    PhotonMap,
    /// Paths that meet a lamp by chance.
    Trace,
    /// Not at all.
    Off,
}

impl From<CausticMethod> for transport::CausticMethod {
    fn from(method: CausticMethod) -> Self {
        match method {
            CausticMethod::PhotonMap => Self::PhotonMap,
            CausticMethod::Trace => Self::Trace,
            CausticMethod::Off => Self::Off,
        }
    }
}

/// How indirect light is found.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum IndirectMethod {
    /// Paths that go on from surface to surface.
    PathTrace,
    /// Photons that came over matt surfaces, seen directly: fast, and blotchy with few photons.
    PhotonMap,
    /// Rays over the hemisphere that read all photon maps where they end: smooth, and sharp in corners.
    FinalGather,
    /// Light exchanged between patches of all matt surfaces, solved once: smooth, and without small shadows.
    Radiosity,
    /// Irradiance computed well at few places and interpolated between them: smooth, and fast where light changes slowly.
    #[default]
    IrradianceCache,
    /// Not at all.
    Off,
}

impl From<IndirectMethod> for transport::IndirectMethod {
    fn from(method: IndirectMethod) -> Self {
        match method {
            IndirectMethod::PathTrace => Self::PathTrace,
            IndirectMethod::PhotonMap => Self::PhotonMap,
            IndirectMethod::FinalGather => Self::FinalGather,
            IndirectMethod::Radiosity => Self::Radiosity,
            IndirectMethod::IrradianceCache => Self::IrradianceCache,
            IndirectMethod::Off => Self::Off,
        }
    }
}
