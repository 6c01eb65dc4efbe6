//! What colour a photon is shown in.

use crate::args::PhotonColour;
use crate::point_colour::{shown, white};
use crate::point_picture::Point;
use glam::Vec3;
use pipeline_data::{Photon, PhotonsOfKind};
use transport::MapKind;

/// Of the photons of a map by flux, the one at this place is shown at full brightness.
const WHITE_SHARE: f64 = 0.99;

/// Display colours of photons.
pub(crate) struct Colours {
    by: PhotonColour,
    /// Of each map, the flux of the largest channel, in W, that is shown at full brightness.
    white: [f32; MapKind::COUNT],
}

impl Colours {
    pub(crate) fn new(by: PhotonColour, maps: &[PhotonsOfKind]) -> Self {
        let mut white_of = [1.0; MapKind::COUNT];
        for (kind, photons) in maps {
            let fluxes = photons.iter().map(|photon| photon.flux.max_element());
            white_of[*kind as usize] = white(fluxes.collect(), WHITE_SHARE);
        }
        Self { by, white: white_of }
    }

    /// The colour of a photon, sRGB in [0, 1].
    fn of(&self, kind: MapKind, photon: &Photon) -> [f32; 3] {
        match self.by {
            PhotonColour::Flux => shown(photon.flux.to_array(), self.white[kind as usize]),
            PhotonColour::Map => match kind {
                MapKind::Direct => [1.0, 0.85, 0.35],
                MapKind::Caustic => [0.3, 0.75, 1.0],
                MapKind::Indirect => [1.0, 0.35, 0.5],
            },
            PhotonColour::Bounce => {
                const BY_BOUNCE: [[f32; 3]; 6] = [
                    [1.0, 1.0, 1.0],
                    [1.0, 0.8, 0.2],
                    [0.4, 0.9, 0.4],
                    [0.3, 0.7, 1.0],
                    [0.7, 0.45, 1.0],
                    [1.0, 0.35, 0.35],
                ];
                BY_BOUNCE[(photon.bounce as usize).min(BY_BOUNCE.len() - 1)]
            }
        }
    }

    /// The photon as a point to draw.
    pub(crate) fn point(&self, kind: MapKind, photon: &Photon) -> Point {
        Point {
            place: Vec3::from_array(photon.position),
            colour: self.of(kind, photon),
        }
    }
}
