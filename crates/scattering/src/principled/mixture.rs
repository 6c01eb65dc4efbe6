use super::PrincipledBsdf;
use super::layer::{Layer, Schlick};
use crate::coated_metal::coated_loss;
use crate::energy::reflection_loss;
use crate::ggx::Ggx;
use crate::loss_table::SideLoss;
use crate::reflectance::SchlickShares;
use crate::sheen::Sheen;
use crate::{DielectricBsdf, LobeValues, Transport};
use glam::Vec3;
use radiometry::Rgb;
use std::f32::consts::{FRAC_1_PI, TAU};

/// What a draw can choose among; the number is that of the layer.
#[derive(Clone, Copy)]
pub(super) enum Lobe {
    Reflected(usize),
    Passed(usize),
    Multiple(usize),
    Base(usize),
    Solid(usize),
    /// Light between coat and metal.
    Between,
    Sheen,
}

impl Lobe {
    /// Every lobe, in the order in which `u_lobe` passes them.
    pub(super) const ALL: [Self; 12] = [
        Self::Reflected(0),
        Self::Passed(0),
        Self::Multiple(0),
        Self::Base(0),
        Self::Solid(0),
        Self::Reflected(1),
        Self::Passed(1),
        Self::Multiple(1),
        Self::Base(1),
        Self::Solid(1),
        Self::Between,
        Self::Sheen,
    ];

    /// Place in [`Self::ALL`].
    const fn index(self) -> usize {
        match self {
            Self::Reflected(k) => 5 * k,
            Self::Passed(k) => 5 * k + 1,
            Self::Multiple(k) => 5 * k + 2,
            Self::Base(k) => 5 * k + 3,
            Self::Solid(k) => 5 * k + 4,
            Self::Between => 10,
            Self::Sheen => 11,
        }
    }
}

/// The lobes as seen from `wo`: what each scatters, which is also how often it is drawn.
pub(super) struct Mixture<'a> {
    bsdf: &'a PrincipledBsdf,
    pub(super) layers: [Option<Layer>; 2],
    /// Reflectance of each layer from `wo`.
    shares_o: [SchlickShares; 2],
    pub(super) solids: [Option<DielectricBsdf>; 2],
    /// The loss under the coat, the share of it that is kept, and 1 − R of the coat from `wo`.
    pub(super) coated: Option<(SideLoss<2>, Rgb, f32)>,
    sheen: Option<Sheen>,
    /// What the sheen lets through, from `wo`.
    below_sheen_o: f32,
    pub(super) albedos: [Rgb; Lobe::ALL.len()],
    pub(super) total: f32,
}

impl<'a> Mixture<'a> {
    pub(super) fn new(bsdf: &'a PrincipledBsdf, wo: Vec3) -> Self {
        let cos_o = wo.z.abs();
        let layers = [
            (bsdf.coated < 1.0 || bsdf.metal > 0.0).then(|| bsdf.bare_layer()),
            (bsdf.coated > 0.0).then(|| bsdf.coat_layer()),
        ];
        let shares_o = layers.each_ref().map(|layer| match layer {
            Some(layer) => layer.reflectance.at(cos_o),
            None => SchlickShares { f0: 0.0, f90: 0.0 },
        });
        let solids = layers.each_ref().map(|layer| {
            let layer = layer.as_ref().filter(|layer| layer.solid > 0.0)?;
            Some(bsdf.solid_of(layer))
        });
        let sheen = (!bsdf.sheen.is_black()).then(|| Sheen::new(bsdf.sheen_roughness));
        let mut mixture = Self {
            bsdf,
            layers,
            shares_o,
            solids,
            coated: None,
            below_sheen_o: below_sheen(bsdf, sheen.as_ref(), cos_o),
            sheen,
            albedos: [Rgb::BLACK; Lobe::ALL.len()],
            total: 0.0,
        };
        mixture.look_under_coat();
        for (albedo, lobe) in mixture.albedos_seen(wo).into_iter().zip(&mut mixture.albedos) {
            *lobe = albedo;
            mixture.total += albedo.mean();
        }
        mixture
    }

    fn look_under_coat(&mut self) {
        let ([Some(_), Some(coat)], true) = (&self.layers, self.bsdf.coated_metal() > 0.0) else {
            return;
        };
        let passed = 1.0 - coat.cover.albedo(self.shares_o[1]).r;
        // A mirror under a coat misses nothing: the row is not read then.
        let loss = coated_loss(self.bsdf.surface.alpha().max(crate::SMOOTH_ALPHA), coat.surface.alpha());
        let kept = self.bsdf.kept_under_coat(loss.average());
        self.coated = Some((loss, kept, passed));
    }

    fn albedos_seen(&self, wo: Vec3) -> [Rgb; Lobe::ALL.len()] {
        let cos_o = wo.z.abs();
        let below = self.below_sheen_o;
        Lobe::ALL.map(|lobe| match lobe {
            Lobe::Reflected(k) => self.layers[k].map_or(Rgb::BLACK, |layer| {
                let under_coat = if k == 0 {
                    self.metal_under_coat().albedo(self.shares_o[0])
                } else {
                    Rgb::BLACK
                };
                (layer.reflected.albedo(self.shares_o[k]) + under_coat) * below
            }),
            Lobe::Passed(k) => self.layers[k].map_or(Rgb::BLACK, |layer| layer.passed.albedo(self.shares_o[k]) * below),
            Lobe::Multiple(k) => self.layers[k].map_or(Rgb::BLACK, |layer| {
                if layer.surface.is_smooth() {
                    return Rgb::BLACK;
                }
                (layer.multiple[0] + layer.multiple[1]) * (self.shares_o[k].loss() * below)
            }),
            Lobe::Base(k) => self.layers[k].map_or(Rgb::BLACK, |layer| {
                layer.matt * (Rgb::WHITE - layer.cover.albedo(self.shares_o[k])) * below
            }),
            Lobe::Solid(k) => match (&self.layers[k], &self.solids[k]) {
                (Some(layer), Some(solid)) => solid.albedo(wo) * (layer.solid * below),
                _ => Rgb::BLACK,
            },
            Lobe::Between => match &self.coated {
                Some((loss, kept, _)) if !self.bsdf.surface.is_smooth() => *kept * (loss.at(cos_o) * below),
                _ => Rgb::BLACK,
            },
            Lobe::Sheen => self
                .sheen
                .map_or(Rgb::BLACK, |sheen| self.bsdf.sheen * sheen.albedo(cos_o)),
        })
    }

    /// The metal under the coat, less what the coat takes of light from `wo`.
    fn metal_under_coat(&self) -> Schlick {
        match &self.coated {
            Some((_, _, passed)) => Schlick {
                f0: self.bsdf.base_color * (self.bsdf.coated_metal() * passed),
                f90: Rgb::splat(self.bsdf.coated_metal() * passed),
            },
            None => Schlick::default(),
        }
    }

    pub(super) fn probability(&self, lobe: Lobe) -> f32 {
        self.albedos[lobe.index()].mean() / self.total
    }

    /// Values and density of two directions, `wo.z` and `wi.z` not zero.
    pub(super) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (LobeValues, f32) {
        let (mut values, mut pdf) = (LobeValues::default(), 0.0);
        let reflects = wo.z * wi.z > 0.0;
        for k in 0..2 {
            let Some(layer) = &self.layers[k] else { continue };
            if let Some(solid) = &self.solids[k] {
                let (value, density) = solid.eval_and_pdf(wo, wi, transport);
                values = values + LobeValues::of_class(solid.surface().class(), value * layer.solid);
                pdf += self.probability(Lobe::Solid(k)) * density;
            }
            if reflects || self.bsdf.clear > 0.0 {
                self.add_layer(k, layer, wo, wi, &mut values, &mut pdf);
            }
        }
        if reflects {
            self.add_between(wo, wi, &mut values, &mut pdf);
        }
        let cos_i = wi.z.abs();
        let mut values = values * self.below_sheen(cos_i);
        if let (Some(sheen), true) = (&self.sheen, reflects) {
            values.diffuse += self.bsdf.sheen * (sheen.eval(wo, wi) * cos_i);
            pdf += self.probability(Lobe::Sheen) / TAU;
        }
        (values, pdf)
    }

    /// What the sheen lets through of light that goes from `wo` to an angle.
    pub(super) fn below_sheen(&self, cos_i: f32) -> f32 {
        self.below_sheen_o
            .min(below_sheen(self.bsdf, self.sheen.as_ref(), cos_i))
    }

    /// Adds the lobes of one layer but its clear solid.
    fn add_layer(&self, k: usize, layer: &Layer, wo: Vec3, wi: Vec3, values: &mut LobeValues, pdf: &mut f32) {
        let (cos_o, cos_i) = (wo.z.abs(), wi.z.abs());
        let reflects = wo.z * wi.z > 0.0;
        let shares_i = layer.reflectance.at(cos_i);
        if reflects && !layer.base.is_black() {
            let covered = |shares| Rgb::WHITE - layer.cover.albedo(shares);
            let base = layer.base * covered(self.shares_o[k]) * covered(shares_i);
            values.diffuse += base * (cos_i * FRAC_1_PI);
            *pdf += self.probability(Lobe::Base(k)) * cos_i * FRAC_1_PI;
        }
        if layer.surface.is_smooth() {
            return;
        }
        let mirrored = if reflects { wi } else { Vec3::new(wi.x, wi.y, -wi.z) };
        let ggx = Ggx::new(layer.surface.alpha());
        let h = (wo + mirrored).normalize();
        let density = ggx.density(h);
        let scattered = density * ggx.visibility(cos_o, cos_i) * cos_i;
        let density = 0.25 * density * ggx.masking_over_cos(cos_o);
        let lost = self.shares_o[k].loss();
        let loss = reflection_loss(layer.surface.alpha());
        let again = lost * shares_i.loss() * cos_i * FRAC_1_PI / layer.average_loss.max(f32::MIN_POSITIVE);
        let dot = wo.dot(h);
        let (single, lobe, side) = if reflects {
            let mut term = layer.reflected.at(dot);
            if k == 0 {
                term += self.metal_under_coat().at(dot) * self.passed_ratio(cos_i);
            }
            (term, Lobe::Reflected(k), 0)
        } else {
            (layer.passed.at(dot), Lobe::Passed(k), 1)
        };
        let value = single * scattered + layer.multiple[side] * again;
        *values = *values + LobeValues::of_class(layer.surface.class(), value);
        *pdf += self.probability(lobe) * density;
        let multiple = self.probability(Lobe::Multiple(k));
        if multiple > 0.0 {
            *pdf += multiple * side_share(layer, side) * loss.pdf(cos_i);
        }
    }

    /// `min(T(ω_o), T(ω_i))/T(ω_o)` of the coat.
    fn passed_ratio(&self, cos_i: f32) -> f32 {
        match (&self.coated, &self.layers[1]) {
            (Some((_, _, passed_o)), Some(coat)) if *passed_o > 0.0 => {
                let passed_i = 1.0 - coat.cover.albedo(coat.reflectance.at(cos_i)).r;
                (passed_i / passed_o).clamp(0.0, 1.0)
            }
            _ => 0.0,
        }
    }

    fn add_between(&self, wo: Vec3, wi: Vec3, values: &mut LobeValues, pdf: &mut f32) {
        let surface = self.bsdf.surface;
        let Some((loss, kept, _)) = self.coated.as_ref().filter(|_| !surface.is_smooth()) else {
            return;
        };
        let (cos_o, cos_i) = (wo.z.abs(), wi.z.abs());
        let (loss_i, pdf_i) = loss.at_and_pdf(cos_i);
        let shape = loss.at(cos_o) * loss_i * cos_i * FRAC_1_PI / loss.average().max(f32::MIN_POSITIVE);
        *values = *values + LobeValues::of_class(surface.class(), *kept * shape);
        *pdf += self.probability(Lobe::Between) * pdf_i;
    }
}

/// Share of multiply scattered light that goes to a side: 0 back, 1 through.
pub(super) fn side_share(layer: &Layer, side: usize) -> f32 {
    let sum = layer.multiple[0].mean() + layer.multiple[1].mean();
    if sum > 0.0 {
        layer.multiple[side].mean() / sum
    } else {
        0.0
    }
}

/// What the sheen lets through to all below it, at an angle.
fn below_sheen(bsdf: &PrincipledBsdf, sheen: Option<&Sheen>, cos: f32) -> f32 {
    sheen.map_or(1.0, |sheen| 1.0 - bsdf.sheen.max_element() * sheen.albedo(cos))
}
