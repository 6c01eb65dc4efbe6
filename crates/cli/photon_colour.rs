//! What colour a photon is shown in.

use crate::args::PhotonColour;
use pipeline_data::{Photon, PhotonsOfKind};
use transport::MapKind;

/// Of the photons of a map by flux, the one at this place is shown at full brightness; brighter ones are as bright.
const WHITE_SHARE: f64 = 0.99;

/// Display colours of photons.
pub(crate) struct Colours {
    by: PhotonColour,
    /// Of each map, the flux of the largest channel, in W, that is shown at full brightness.
    white: [f32; MapKind::COUNT],
}

impl Colours {
    pub(crate) fn new(by: PhotonColour, maps: &[PhotonsOfKind]) -> Self {
        let mut white = [1.0; MapKind::COUNT];
        for (kind, photons) in maps {
            let mut fluxes: Vec<f32> = photons.iter().map(|photon| photon.flux.max_element()).collect();
            let place = (fluxes.len() as f64 * WHITE_SHARE) as usize;
            if place < fluxes.len() {
                let (_, flux, _) = fluxes.select_nth_unstable_by(place, f32::total_cmp);
                white[*kind as usize] = flux.max(f32::MIN_POSITIVE);
            }
        }
        Self { by, white }
    }

    /// The colour of a photon, sRGB in [0, 1].
    pub(crate) fn of(&self, kind: MapKind, photon: &Photon) -> [f32; 3] {
        match self.by {
            PhotonColour::Flux => {
                let white = self.white[kind as usize];
                photon.flux.to_array().map(|flux| (flux / white).clamp(0.0, 1.0).sqrt())
            }
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

    /// The same in 8 bits.
    pub(crate) fn bytes_of(&self, kind: MapKind, photon: &Photon) -> [u8; 3] {
        self.of(kind, photon).map(|value| (value * 255.0).round() as u8)
    }
}
