use bevy_ecs::component::Component;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use glam::UVec2;
use scene_format::{Range, Unit};

/// The picture: its size, and how samples become pixels. On the prim that carries `Render`.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Film {
    /// Width and height.
    #[reflect(@Range::closed(1.0, 65536.0), @Unit("pixels"))]
    pub resolution: UVec2,
    /// How samples near a pixel count for it.
    pub filter: FilterKind,
    /// Reach of the filter: wider is smoother, narrower sharper. A `Box` of 0.5 is the pixel itself.
    #[reflect(@Range::closed(0.01, 32.0), @Unit("pixels"))]
    pub filter_radius: f32,
    /// Whether to tell the error of each pixel, as channels `variance.R`, `variance.G`, `variance.B` of EXR files. Samples
    /// then come in eight independent batches; one sequence of all samples, without it, has less noise on smooth parts.
    pub variance: bool,
    /// Brightens (above 0) or darkens the 8-bit picture; each stop doubles. EXR files stay as they are.
    #[reflect(@Range::closed(-40.0, 40.0), @Unit("stops"))]
    pub exposure: f32,
    /// Tone curve of the 8-bit picture. EXR files stay linear.
    pub tone_map: ToneMap,
}

impl Default for Film {
    fn default() -> Self {
        Self {
            resolution: UVec2::splat(512),
            filter: FilterKind::default(),
            filter_radius: 1.5,
            variance: true,
            exposure: 0.0,
            tone_map: ToneMap::default(),
        }
    }
}

/// Shape of a reconstruction filter.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilterKind {
    /// Constant.
    Box,
    /// Falls linearly.
    Triangle,
    /// A bell.
    Gaussian,
    /// Sharp with next to no aliasing.
    #[default]
    BlackmanHarris,
}

impl From<FilterKind> for film::FilterKind {
    fn from(kind: FilterKind) -> Self {
        match kind {
            FilterKind::Box => Self::Box,
            FilterKind::Triangle => Self::Triangle,
            FilterKind::Gaussian => Self::Gaussian,
            FilterKind::BlackmanHarris => Self::BlackmanHarris,
        }
    }
}

/// How radiance is brought into the range of a display.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToneMap {
    /// Clips at 1; exact below.
    Srgb,
    /// Exact in the dark and middle tones, highlights roll off.
    #[default]
    Filmic,
}

impl From<ToneMap> for film::ToneMap {
    fn from(map: ToneMap) -> Self {
        match map {
            ToneMap::Srgb => Self::Srgb,
            ToneMap::Filmic => Self::Filmic,
        }
    }
}
