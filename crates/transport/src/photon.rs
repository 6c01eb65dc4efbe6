use crate::emission::EmittedPhoton;
use crate::medium::{PathMedium, follow};
use crate::path::{ROULETTE_DEPTH, ROULETTE_MAX};
use crate::path_class::Event;
use crate::scene::Scene;
use crate::vertex::Vertex;
use glam::Vec3;
use radiometry::{Rgb, SampleStream, StageKey};
use scattering::Transport;
use spatial::{Ray, spawn_origin};

/// Key of the random numbers of photons.
pub const PHOTON_STAGE: StageKey = StageKey::new("photon_map");

/// The photon map that a photon belongs to, by what happened to it since the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapKind {
    /// Nothing yet.
    Direct,
    /// Only specular events.
    Caustic,
    /// A diffuse or volume event: indirect, for good.
    Indirect,
}

impl MapKind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Direct, Self::Caustic, Self::Indirect];

    /// Number of kinds.
    pub const COUNT: usize = Self::ALL.len();

    /// Lower-case name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Caustic => "caustic",
            Self::Indirect => "indirect",
        }
    }

    /// The kind after one more event.
    #[must_use]
    pub const fn after(self, event: Event) -> Self {
        match (self, event) {
            (Self::Direct | Self::Caustic, Event::Specular) => Self::Caustic,
            _ => Self::Indirect,
        }
    }
}

/// Which photon maps are wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MapKinds {
    /// Photons straight from the light.
    pub direct: bool,
    /// Photons over specular surfaces.
    pub caustic: bool,
    /// All others.
    pub indirect: bool,
}

impl MapKinds {
    /// The caustic map alone.
    pub const CAUSTIC: Self = Self {
        direct: false,
        caustic: true,
        indirect: false,
    };

    /// These and one kind more.
    #[must_use]
    pub const fn with(mut self, kind: MapKind) -> Self {
        match kind {
            MapKind::Direct => self.direct = true,
            MapKind::Caustic => self.caustic = true,
            MapKind::Indirect => self.indirect = true,
        }
        self
    }

    /// All that either has.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self {
            direct: self.direct || other.direct,
            caustic: self.caustic || other.caustic,
            indirect: self.indirect || other.indirect,
        }
    }

    /// True when no photon is wanted.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        !(self.direct || self.caustic || self.indirect)
    }

    /// True when photons of this kind are wanted.
    #[must_use]
    pub const fn wants(self, kind: MapKind) -> bool {
        match kind {
            MapKind::Direct => self.direct,
            MapKind::Caustic => self.caustic,
            MapKind::Indirect => self.indirect,
        }
    }

    /// True when a photon of this kind can still become one that is wanted.
    const fn may_become(self, kind: MapKind) -> bool {
        match kind {
            MapKind::Direct => self.direct || self.caustic || self.indirect,
            MapKind::Caustic => self.caustic || self.indirect,
            MapKind::Indirect => self.indirect,
        }
    }
}

/// A photon that landed on a surface with a diffuse lobe.
#[derive(Clone, Copy, Debug)]
pub struct Deposit {
    /// Where, world space, metres.
    pub position: Vec3,
    /// Unit direction to where it came from.
    pub direction: Vec3,
    /// Unit geometric normal on the side it came from.
    pub normal: Vec3,
    /// Flux in W, not yet divided by the number emitted.
    pub flux: Rgb,
    /// Number of its path.
    pub path: u32,
    /// Events between the light and here.
    pub bounce: u32,
    /// The map that it belongs to.
    pub kind: MapKind,
}

mod dimension {
    pub(super) const LOBE: u32 = 0;
    pub(super) const DIRECTION: u32 = 1;
    pub(super) const ROULETTE: u32 = 2;
    pub(super) const WAVELENGTH: u32 = 3;
    /// And all after it: one for each surface that is not whole, along a ray.
    pub(super) const CUTOUT: u32 = 4;
}

/// Follows a photon until it is absorbed, leaves the scene or is of no use any more; calls `store` for each deposit.
///
/// Flux is not multiplied by a cosine when it is stored, is not scaled by η² at refraction, and carries Veach's factor
/// for shading normals. Russian roulette absorbs in proportion to what the surface absorbs, so that the fluxes stay
/// alike.
///
/// - `wanted`: only such photons are stored, and no photon is followed that cannot become one.
/// - `max_depth`: most events; a photon that is not finite or has no flux left ends as well.
/// - `path`: the number of this photon; `stream` its random numbers, from bounce 1 on.
pub fn trace_photon(
    scene: &Scene,
    emitted: &EmittedPhoton,
    wanted: MapKinds,
    max_depth: u32,
    path: u32,
    stream: &SampleStream,
    mut store: impl FnMut(Deposit),
) {
    let (mut ray, mut flux) = (emitted.ray, emitted.flux);
    let mut kind = MapKind::Direct;
    let mut medium = PathMedium::at(scene, ray.origin, ray.time);
    for bounce in 0.. {
        let (Some(point), left) = follow(scene, &mut medium, &ray, |cutout| {
            stream.draw_1d(bounce + 1, dimension::CUTOUT + cutout)
        }) else {
            return;
        };
        flux *= left;
        let u = || stream.draw_1d(bounce + 1, dimension::WAVELENGTH);
        if let Some(weight) = medium.disperse(scene, &point, u) {
            flux *= weight;
        }
        if flux.is_black() || !flux.is_finite() {
            return;
        }
        let vertex = Vertex::new(scene, &point, -ray.direction, &medium);
        if vertex.bsdf.has_diffuse() && wanted.wants(kind) {
            let normal = vertex.facing_normal();
            store(Deposit {
                position: point.p,
                direction: vertex.wo,
                normal,
                flux,
                path,
                bounce,
                kind,
            });
        }
        if bounce >= max_depth {
            return;
        }
        let u_lobe = stream.draw_1d(bounce + 1, dimension::LOBE);
        let u = stream.draw_2d(bounce + 1, dimension::DIRECTION);
        let Some(sample) = vertex.sample(u_lobe, u, Transport::Flux) else {
            return;
        };
        kind = kind.after(sample.class.into());
        if !wanted.may_become(kind) {
            return;
        }
        let scattered = flux * sample.weight;
        // Without a limit below 1, a photon caught in lossless glass would never end.
        let most = if bounce < ROULETTE_DEPTH { 1.0 } else { ROULETTE_MAX };
        let survival = (scattered.max_element() / flux.max_element()).min(most);
        if survival < 1.0 && stream.draw_1d(bounce + 1, dimension::ROULETTE) >= survival {
            return;
        }
        flux = scattered * (1.0 / survival);
        if sample.transmitted {
            medium.pass(scene, &point, sample.wi);
        }
        ray = Ray {
            time: ray.time,
            ..Ray::new(spawn_origin(point.p, point.error, point.ng, sample.wi), sample.wi)
        };
    }
}
