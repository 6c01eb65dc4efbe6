use super::PrincipledBsdf;
use super::mixture::{Lobe, Mixture, side_share};
use crate::energy::reflection_loss;
use crate::ggx::Ggx;
use crate::{BsdfSample, LobeClass, LobeValues, Transport};
use glam::{Vec2, Vec3};
use radiometry::{Rgb, warp};

/// The largest number below 1.
const LAST: f32 = 1.0 - f32::EPSILON / 2.0;

/// A lobe that was drawn.
struct Choice {
    lobe: Lobe,
    /// Its albedo over its probability: the weight of a delta lobe.
    weight: Rgb,
    /// `u_lobe` stretched back over [0, 1).
    rest: f32,
}

/// What a lobe answers.
enum Drawn {
    Delta(BsdfSample),
    /// A direction on the side of +z, and whether it is meant for the side away from `wo`.
    Direction(Vec3, bool),
}

impl PrincipledBsdf {
    pub(crate) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (LobeValues, f32) {
        if wo.z == 0.0 || wi.z == 0.0 || (wo.z * wi.z < 0.0 && !self.transmits()) {
            return (LobeValues::default(), 0.0);
        }
        let mixture = Mixture::new(self, wo);
        if mixture.total <= 0.0 {
            return (LobeValues::default(), 0.0);
        }
        mixture.eval_and_pdf(wo, wi, transport)
    }

    pub(crate) fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let mixture = Mixture::new(self, wo);
        let choice = mixture.choose(u_lobe)?;
        let (wi, transmitted) = match mixture.draw(&choice, wo, u, transport)? {
            Drawn::Delta(sample) => return Some(sample),
            Drawn::Direction(wi, transmitted) => (wi, transmitted),
        };
        if wi.z <= 0.0 {
            return None;
        }
        let wi = Vec3::new(wi.x, wi.y, wi.z.copysign(if transmitted { -wo.z } else { wo.z }));
        let (values, pdf) = mixture.eval_and_pdf(wo, wi, transport);
        let mut sample = BsdfSample::from_lobes(wi, values, pdf, BsdfSample::class_number(u_lobe))?;
        if transmitted {
            sample.transmitted = true;
            sample.eta_sq_scale = self.refraction_scale(wo, transport);
        }
        Some(sample)
    }

    /// The η² of radiance on crossing to the other side of `wo`: 1 for a wall without thickness.
    fn refraction_scale(&self, wo: Vec3, transport: Transport) -> f32 {
        let eta = if wo.z > 0.0 { self.ior } else { 1.0 / self.ior };
        if self.solid {
            transport.refraction_scale(eta)
        } else {
            1.0
        }
    }

    pub(crate) fn albedo(&self, wo: Vec3) -> Rgb {
        Mixture::new(self, wo).albedos.into_iter().sum()
    }
}

impl Mixture<'_> {
    fn choose(&self, u_lobe: f32) -> Option<Choice> {
        let mut rest = u_lobe * self.total;
        let mut choice = None;
        for (lobe, albedo) in Lobe::ALL.into_iter().zip(self.albedos) {
            let width = albedo.mean();
            if width <= 0.0 {
                continue;
            }
            // Rounding may leave a rest at the end: the last lobe that scatters takes it.
            choice = Some(Choice {
                lobe,
                weight: albedo * (self.total / width),
                rest: (rest / width).min(LAST),
            });
            if rest < width {
                break;
            }
            rest -= width;
        }
        choice
    }

    /// Draws from a lobe; `None` where it fails to find a direction.
    fn draw(&self, choice: &Choice, wo: Vec3, u: Vec2, transport: Transport) -> Option<Drawn> {
        let up = Vec3::new(wo.x, wo.y, wo.z.abs());
        Some(match choice.lobe {
            Lobe::Base(_) => Drawn::Direction(warp::sample_cosine_hemisphere(u), false),
            Lobe::Sheen => Drawn::Direction(warp::sample_uniform_cone(u, 1.0), false),
            Lobe::Between => Drawn::Direction(self.coated.as_ref()?.0.sample(u), false),
            Lobe::Multiple(k) => {
                let layer = self.layers[k].as_ref()?;
                let transmitted = choice.rest >= side_share(layer, 0);
                Drawn::Direction(reflection_loss(layer.surface.alpha()).sample(u), transmitted)
            }
            Lobe::Reflected(k) | Lobe::Passed(k) => {
                let transmitted = matches!(choice.lobe, Lobe::Passed(_));
                let surface = self.layers[k].as_ref()?.surface;
                if surface.is_smooth() {
                    Drawn::Delta(delta(wo, choice.weight, transmitted))
                } else {
                    let h = Ggx::new(surface.alpha()).sample_visible_normal(up, u);
                    Drawn::Direction((2.0 * up.dot(h) * h - up).normalize(), transmitted)
                }
            }
            Lobe::Solid(k) => {
                let sample = self.solids[k].as_ref()?.sample(wo, choice.rest, u, transport)?;
                if sample.is_delta() {
                    let share = self.layers[k].as_ref()?.solid / self.probability(choice.lobe);
                    let weight = sample.weight * (share * self.below_sheen(sample.wi.z.abs()));
                    Drawn::Delta(BsdfSample { weight, ..sample })
                } else {
                    let wi = sample.wi;
                    Drawn::Direction(Vec3::new(wi.x, wi.y, wi.z.abs()), sample.transmitted)
                }
            }
        })
    }
}

/// The mirror direction of `wo`, or the one straight on.
fn delta(wo: Vec3, weight: Rgb, transmitted: bool) -> BsdfSample {
    let reflected = BsdfSample::delta_reflection(wo, weight);
    if transmitted {
        BsdfSample {
            wi: -wo,
            transmitted,
            class: LobeClass::Specular,
            ..reflected
        }
    } else {
        reflected
    }
}
