use scattering::LobeClass;

/// What happened at a vertex of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// S: a delta lobe, or one at least as smooth as `specular_alpha`.
    Specular,
    /// D: any other lobe of a surface.
    Diffuse,
    /// V: scattering in a medium.
    Volume,
}

impl From<LobeClass> for Event {
    fn from(class: LobeClass) -> Self {
        match class {
            LobeClass::Specular => Self::Specular,
            LobeClass::Diffuse => Self::Diffuse,
        }
    }
}

/// A layer of the film. Every light path is in exactly one; their sum, in this order, is the beauty image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Layer {
    /// E D L.
    Direct,
    /// E S (S|D|V)* L.
    Specular,
    /// E D S⁺ L.
    Caustic,
    /// E D S* (D|V)(S|D|V)* L.
    Indirect,
    /// E L.
    Emission,
    /// E V (S|D|V)* L.
    Volume,
}

impl Layer {
    /// All layers, in the order in which they add up.
    pub const ALL: [Self; 6] = [
        Self::Direct,
        Self::Specular,
        Self::Caustic,
        Self::Indirect,
        Self::Emission,
        Self::Volume,
    ];

    /// Number of layers.
    pub const COUNT: usize = Self::ALL.len();

    /// Lower-case name, as in the channels of the image file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Specular => "specular",
            Self::Caustic => "caustic",
            Self::Indirect => "indirect",
            Self::Emission => "emission",
            Self::Volume => "volume",
        }
    }
}

/// The class of an eye path so far: what decides its layer and which estimators may speak. One byte.
///
/// A finite state machine over the events since the eye. It remembers the first event, whether there was a D, whether
/// there were two of D or V, and whether the last event was S.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PathClass(u8);

const FIRST_SPECULAR: u8 = 1;
const FIRST_DIFFUSE: u8 = 2;
const FIRST_VOLUME: u8 = 4;
const FIRST_ANY: u8 = FIRST_SPECULAR | FIRST_DIFFUSE | FIRST_VOLUME;
/// The last event that was not S was D.
const AFTER_DIFFUSE: u8 = 8;
/// Two events or more were D or V.
const DEEP: u8 = 16;
/// The last event was S.
const LAST_SPECULAR: u8 = 32;

impl PathClass {
    /// The class of a camera ray: no event yet.
    pub const EYE: Self = Self(0);

    /// The class after one more event.
    #[must_use]
    pub const fn after(self, event: Event) -> Self {
        let first = match (self.0 & FIRST_ANY, event) {
            (0, Event::Specular) => FIRST_SPECULAR,
            (0, Event::Diffuse) => FIRST_DIFFUSE,
            (0, Event::Volume) => FIRST_VOLUME,
            (first, _) => first,
        };
        let kept = self.0 & (DEEP | AFTER_DIFFUSE);
        let scattered_before = self.0 & (FIRST_DIFFUSE | FIRST_VOLUME | AFTER_DIFFUSE) != 0;
        Self(match event {
            Event::Specular => first | kept | LAST_SPECULAR,
            Event::Diffuse => first | (kept & DEEP) | AFTER_DIFFUSE | if scattered_before { DEEP } else { 0 },
            Event::Volume => first | (kept & DEEP) | if scattered_before { DEEP } else { 0 },
        })
    }

    /// The layer of a path of this class that now meets a light.
    #[must_use]
    pub const fn layer(self) -> Layer {
        if self.0 & FIRST_SPECULAR != 0 {
            Layer::Specular
        } else if self.0 & FIRST_VOLUME != 0 {
            Layer::Volume
        } else if self.0 & FIRST_DIFFUSE == 0 {
            Layer::Emission
        } else if self.0 & DEEP != 0 {
            Layer::Indirect
        } else if self.0 & LAST_SPECULAR != 0 {
            Layer::Caustic
        } else {
            Layer::Direct
        }
    }

    /// True when a light met now would be seen as D S⁺ L: what a caustic photon map holds.
    #[must_use]
    pub const fn ends_as_caustic(self) -> bool {
        self.0 & AFTER_DIFFUSE != 0 && self.0 & LAST_SPECULAR != 0
    }
}

/// How direct light is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirectMethod {
    /// Light sampling, and D-lobe hits with multiple importance sampling.
    SampleLights,
    /// The layer is black.
    Off,
}

/// How caustics are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CausticMethod {
    /// The caustic photon map is read at every D vertex.
    PhotonMap,
    /// By chance: D lobes that meet a light over specular surfaces.
    Trace,
    /// The layer is black.
    Off,
}

/// Which estimator serves which term of the split reflection equation, and what counts as specular.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Methods {
    /// Direct light.
    pub direct: DirectMethod,
    /// Whether specular paths are traced; black otherwise.
    pub specular: bool,
    /// Caustics.
    pub caustic: CausticMethod,
    /// Whether indirect light is traced; black otherwise.
    pub indirect: bool,
    /// GGX lobes up to this α are S.
    pub specular_alpha: f32,
    /// Most events on a path; paths that would have more end there.
    pub max_depth: u32,
}

impl Methods {
    /// Everything traced: unbiased path tracing, the reference for all else.
    pub const TRACED: Self = Self {
        direct: DirectMethod::SampleLights,
        specular: true,
        caustic: CausticMethod::Trace,
        indirect: true,
        specular_alpha: 0.05,
        max_depth: u32::MAX,
    };

    /// True when this layer is not switched off.
    #[must_use]
    pub fn shows(&self, layer: Layer) -> bool {
        match layer {
            Layer::Direct => self.direct != DirectMethod::Off,
            Layer::Specular => self.specular,
            Layer::Caustic => self.caustic != CausticMethod::Off,
            Layer::Indirect => self.indirect,
            Layer::Emission | Layer::Volume => true,
        }
    }

    /// True when a traced path of this class that meets a light counts, by a hit or by light sampling.
    ///
    /// `Off` blackens its layer alone: deeper caustics are still traced then. A caustic photon map takes over every
    /// D S⁺ L, wherever in the path it is.
    #[must_use]
    pub fn counts_traced_light(&self, class: PathClass) -> bool {
        self.shows(class.layer()) && !(self.caustic == CausticMethod::PhotonMap && class.ends_as_caustic())
    }

    /// The layer that a caustic photon map adds to when it is read at a D vertex that a path of class `class` reached;
    /// `None` where it is not to be read.
    #[must_use]
    pub fn caustic_map_layer(&self, class: PathClass) -> Option<Layer> {
        let layer = class.after(Event::Diffuse).after(Event::Specular).layer();
        (self.caustic == CausticMethod::PhotonMap && self.shows(layer)).then_some(layer)
    }

    /// True when a path of this class can still contribute to anything, however it goes on.
    #[must_use]
    pub fn may_contribute(&self, class: PathClass) -> bool {
        match class.layer() {
            Layer::Specular => self.specular,
            Layer::Indirect => self.indirect,
            Layer::Direct => self.direct != DirectMethod::Off || self.caustic == CausticMethod::Trace || self.indirect,
            Layer::Caustic => self.caustic == CausticMethod::Trace || self.indirect,
            Layer::Emission | Layer::Volume => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of path classes, read as regular expressions over the events from the eye to the light.
    fn layer_by_table(events: &str) -> Layer {
        let bytes = events.as_bytes();
        match bytes.first() {
            None => Layer::Emission,
            Some(b'S') => Layer::Specular,
            Some(b'V') => Layer::Volume,
            Some(_) => {
                let rest = &bytes[1..];
                if rest.is_empty() {
                    Layer::Direct
                } else if rest.iter().all(|e| *e == b'S') {
                    Layer::Caustic
                } else {
                    Layer::Indirect
                }
            }
        }
    }

    fn all_strings(length: usize) -> Vec<String> {
        let mut all = vec![String::new()];
        let mut previous = all.clone();
        for _ in 0..length {
            previous = previous
                .iter()
                .flat_map(|s| ["S", "D", "V"].map(|e| format!("{s}{e}")))
                .collect();
            all.extend(previous.iter().cloned());
        }
        all
    }

    fn class_of(events: &str) -> PathClass {
        events.bytes().fold(PathClass::EYE, |class, e| {
            class.after(match e {
                b'S' => Event::Specular,
                b'D' => Event::Diffuse,
                _ => Event::Volume,
            })
        })
    }

    #[test]
    fn every_path_is_in_the_layer_of_the_table() {
        for events in all_strings(6) {
            assert_eq!(class_of(&events).layer(), layer_by_table(&events), "E{events}L");
            let trimmed = events.trim_end_matches('S');
            assert_eq!(
                class_of(&events).ends_as_caustic(),
                trimmed.len() < events.len() && trimmed.ends_with('D'),
                "E{events}L"
            );
        }
    }

    #[test]
    fn each_caustic_is_counted_once_whatever_the_method() {
        for caustic in [CausticMethod::PhotonMap, CausticMethod::Trace] {
            let methods = Methods {
                caustic,
                ..Methods::TRACED
            };
            for events in all_strings(5).iter().filter(|e| class_of(e).ends_as_caustic()) {
                let traced = methods.counts_traced_light(class_of(events));
                let at_diffuse = &events[..events.trim_end_matches('S').len() - 1];
                let mapped = methods.caustic_map_layer(class_of(at_diffuse));
                assert!(traced != mapped.is_some(), "E{events}L");
                assert!(
                    mapped.is_none_or(|layer| layer == class_of(events).layer()),
                    "E{events}L"
                );
            }
        }
    }

    #[test]
    fn off_blackens_its_own_layer_alone() {
        for off in 0..4 {
            let mut methods = Methods::TRACED;
            let layer = match off {
                0 => {
                    methods.direct = DirectMethod::Off;
                    Layer::Direct
                }
                1 => {
                    methods.specular = false;
                    Layer::Specular
                }
                2 => {
                    methods.caustic = CausticMethod::Off;
                    Layer::Caustic
                }
                _ => {
                    methods.indirect = false;
                    Layer::Indirect
                }
            };
            for events in all_strings(5) {
                let class = class_of(&events);
                assert_eq!(methods.counts_traced_light(class), class.layer() != layer, "E{events}L");
                // A path is only given up when nothing that it could become counts.
                let could = all_strings(3)
                    .iter()
                    .any(|more| methods.counts_traced_light(class_of(&format!("{events}{more}"))));
                assert!(methods.may_contribute(class) || !could, "E{events}");
            }
        }
    }
}
