use crate::beckmann::Beckmann;
use crate::ggx::Ggx;
use glam::{Vec2, Vec3};

/// How the normals of microfacets are distributed; α is the width of either.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalDistribution {
    /// Trowbridge and Reitz's: highlights with a long tail, as of most real surfaces.
    #[default]
    Ggx,
    /// Beckmann's: normally distributed slopes, highlights that end. Its sampling takes several times as long.
    Beckmann,
}

/// A distribution of normals of a width, with its masking.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Normals {
    Ggx(Ggx),
    Beckmann(Beckmann),
}

impl Normals {
    #[inline]
    pub(crate) fn new(distribution: NormalDistribution, alpha: f32) -> Self {
        match distribution {
            NormalDistribution::Ggx => Self::Ggx(Ggx::new(alpha)),
            NormalDistribution::Beckmann => Self::Beckmann(Beckmann::new(alpha)),
        }
    }

    /// `D(h)`, normalised as `∫ D(h) h_z dh = 1`.
    #[inline]
    pub(crate) fn density(self, h: Vec3) -> f32 {
        match self {
            Self::Ggx(d) => d.density(h),
            Self::Beckmann(d) => d.density(h),
        }
    }

    /// `G₁(ω_o)/cosθ_o`.
    #[inline]
    pub(crate) fn masking_over_cos(self, cos_o: f32) -> f32 {
        match self {
            Self::Ggx(d) => d.masking_over_cos(cos_o),
            Self::Beckmann(d) => d.masking_over_cos(cos_o),
        }
    }

    /// `G₂(ω_o, ω_i)/(4 cosθ_o cosθ_i)`, height-correlated.
    #[inline]
    pub(crate) fn visibility(self, cos_o: f32, cos_i: f32) -> f32 {
        match self {
            Self::Ggx(d) => d.visibility(cos_o, cos_i),
            Self::Beckmann(d) => d.visibility(cos_o, cos_i),
        }
    }

    /// A normal among those visible from `wo`; density `G₁(ω_o) (ω_o·h) D(h)/cosθ_o` per solid angle.
    #[inline]
    pub(crate) fn sample_visible_normal(self, wo: Vec3, u: Vec2) -> Vec3 {
        match self {
            Self::Ggx(d) => d.sample_visible_normal(wo, u),
            Self::Beckmann(d) => d.sample_visible_normal(wo, u),
        }
    }
}
