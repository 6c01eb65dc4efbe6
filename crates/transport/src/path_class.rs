use crate::photon::MapKind;
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

    /// True when nothing but S has happened: the eye still looks straight ahead, or into mirrors and through glass.
    #[must_use]
    pub const fn is_specular_only(self) -> bool {
        self.0 & (FIRST_DIFFUSE | FIRST_VOLUME | AFTER_DIFFUSE | DEEP) == 0
    }

    /// True when the last event was S.
    #[must_use]
    pub const fn ends_as_specular(self) -> bool {
        self.0 & LAST_SPECULAR != 0
    }

    /// True after two events or more that were D or V: a light met now is indirect light of the first of them.
    #[must_use]
    pub const fn is_deep(self) -> bool {
        self.0 & DEEP != 0
    }

    /// True when a light met now would be seen as E S* D L: what a direct photon map holds.
    #[must_use]
    pub const fn ends_as_direct(self) -> bool {
        self.0 & (AFTER_DIFFUSE | DEEP | LAST_SPECULAR) == AFTER_DIFFUSE
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
    /// The direct photon map is read at the first D vertex.
    PhotonMap,
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

/// How indirect light is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IndirectMethod {
    /// Paths go on from D to D.
    PathTrace,
    /// The indirect photon map is read at the first D vertex.
    PhotonMap,
    /// Rays over the hemisphere of the first D vertex, and what the next D vertex reflects at their ends.
    FinalGather,
    /// The solution of radiosity is read at the first D vertex.
    Radiosity,
    /// Irradiance over the hemisphere of the first D vertex, interpolated between records.
    IrradianceCache,
    /// The layer is black.
    Off,
}

impl IndirectMethod {
    /// True when paths end at their first D vertex, because another estimator knows all light that comes over a second.
    #[must_use]
    pub const fn replaces_paths(self) -> bool {
        matches!(
            self,
            Self::PhotonMap | Self::FinalGather | Self::Radiosity | Self::IrradianceCache
        )
    }
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
    /// Indirect light.
    pub indirect: IndirectMethod,
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
        indirect: IndirectMethod::PathTrace,
        specular_alpha: 0.05,
        max_depth: u32::MAX,
    };

    /// The same terms without bias: each that is not switched off is traced.
    #[must_use]
    pub fn traced(self) -> Self {
        Self {
            direct: match self.direct {
                DirectMethod::Off => DirectMethod::Off,
                _ => DirectMethod::SampleLights,
            },
            caustic: match self.caustic {
                CausticMethod::Off => CausticMethod::Off,
                _ => CausticMethod::Trace,
            },
            indirect: match self.indirect {
                IndirectMethod::Off => IndirectMethod::Off,
                _ => IndirectMethod::PathTrace,
            },
            ..self
        }
    }

    /// True when this layer is not switched off.
    #[must_use]
    pub fn shows(&self, layer: Layer) -> bool {
        match layer {
            Layer::Direct => self.direct != DirectMethod::Off,
            Layer::Specular => self.specular,
            Layer::Caustic => self.caustic != CausticMethod::Off,
            Layer::Indirect => self.indirect != IndirectMethod::Off,
            Layer::Emission | Layer::Volume => true,
        }
    }

    /// True when a traced path of this class that meets a light counts, by a hit or by light sampling.
    ///
    /// `Off` blackens its layer alone: deeper caustics are still traced then. A caustic photon map takes over every
    /// D S⁺ L, wherever in the path it is; the other methods rule at the first D vertex, be it seen in a mirror.
    #[must_use]
    pub fn counts_traced_light(&self, class: PathClass) -> bool {
        let is_read_from_a_map = class.ends_as_caustic() && self.caustic == CausticMethod::PhotonMap
            || class.ends_as_direct() && self.direct == DirectMethod::PhotonMap
            || class.is_deep() && self.indirect.replaces_paths();
        self.shows(class.layer()) && !is_read_from_a_map
    }

    /// The layer that a photon map adds to when it is read at a D vertex that a path of class `class` reached; `None`
    /// where it is not to be read.
    #[must_use]
    pub fn map_layer(&self, kind: MapKind, class: PathClass) -> Option<Layer> {
        let at_first = class.is_specular_only();
        let here = class.after(Event::Diffuse);
        let (is_here, layer) = match kind {
            MapKind::Direct => (at_first, here.layer()),
            MapKind::Caustic => (
                at_first || !self.indirect.replaces_paths(),
                here.after(Event::Specular).layer(),
            ),
            MapKind::Indirect => (at_first, here.after(Event::Diffuse).layer()),
        };
        (is_here && self.reads_map(kind) && self.shows(layer)).then_some(layer)
    }

    /// True when [`Methods::map_layer`] gives a map a layer anywhere.
    #[must_use]
    pub fn reads_map(&self, kind: MapKind) -> bool {
        match kind {
            MapKind::Direct => self.direct == DirectMethod::PhotonMap,
            MapKind::Caustic => self.caustic == CausticMethod::PhotonMap,
            MapKind::Indirect => self.indirect == IndirectMethod::PhotonMap,
        }
    }

    /// The layer that light from the hemisphere of a D vertex adds to which a path of class `class` reached, by gather rays
    /// or from the irradiance cache; `None` where it is not asked for.
    #[must_use]
    pub fn gather_layer(&self, class: PathClass) -> Option<Layer> {
        let gathers = matches!(
            self.indirect,
            IndirectMethod::FinalGather | IndirectMethod::IrradianceCache
        );
        self.indirect_layer(class).filter(|_| gathers)
    }

    /// The layer that the solution of radiosity adds to when it is read at a D vertex that a path of class `class` reached;
    /// `None` where it is not to be read.
    #[must_use]
    pub fn radiosity_layer(&self, class: PathClass) -> Option<Layer> {
        let reads = self.indirect == IndirectMethod::Radiosity;
        self.indirect_layer(class).filter(|_| reads)
    }

    /// The layer that all indirect light of a D vertex belongs to, where it is the first of the path and the layer is shown.
    fn indirect_layer(&self, class: PathClass) -> Option<Layer> {
        let layer = class.after(Event::Diffuse).after(Event::Diffuse).layer();
        (class.is_specular_only() && self.shows(layer)).then_some(layer)
    }

    /// True when a path of this class can still contribute to anything by meeting light, however it goes on.
    #[must_use]
    pub fn may_contribute(&self, class: PathClass) -> bool {
        if class.is_deep() {
            return self.shows(class.layer()) && !self.indirect.replaces_paths();
        }
        match class.layer() {
            Layer::Emission | Layer::Volume => true,
            Layer::Specular => {
                self.specular
                    && (class.is_specular_only()
                        || self.direct != DirectMethod::PhotonMap
                        || self.caustic != CausticMethod::PhotonMap
                        || !self.indirect.replaces_paths())
            }
            Layer::Direct | Layer::Caustic | Layer::Indirect => {
                class.ends_as_direct() && self.direct == DirectMethod::SampleLights
                    || self.caustic == CausticMethod::Trace
                    || self.indirect == IndirectMethod::PathTrace
            }
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

    /// Every combination of methods that shows everything.
    fn all_methods() -> Vec<Methods> {
        let mut all = Vec::new();
        for direct in [DirectMethod::SampleLights, DirectMethod::PhotonMap] {
            for caustic in [CausticMethod::PhotonMap, CausticMethod::Trace] {
                for indirect in [
                    IndirectMethod::PathTrace,
                    IndirectMethod::PhotonMap,
                    IndirectMethod::FinalGather,
                    IndirectMethod::Radiosity,
                    IndirectMethod::IrradianceCache,
                ] {
                    all.push(Methods {
                        direct,
                        caustic,
                        indirect,
                        ..Methods::TRACED
                    });
                }
            }
        }
        all
    }

    /// Where a photon map is read for the path that ends in these events: the D vertex whose rest, seen from the light,
    /// is of the map's kind.
    fn layers_from_maps(methods: &Methods, events: &str) -> Vec<Layer> {
        let mut found = Vec::new();
        for (at, _) in events.match_indices('D') {
            let kind = events[at + 1..].bytes().fold(MapKind::Direct, |kind, e| {
                kind.after(if e == b'S' { Event::Specular } else { Event::Diffuse })
            });
            found.extend(methods.map_layer(kind, class_of(&events[..at])));
            let rest = events[at + 1..].trim_start_matches('S');
            if !rest.is_empty() {
                found.extend(methods.gather_layer(class_of(&events[..at])));
                found.extend(methods.radiosity_layer(class_of(&events[..at])));
            }
        }
        found
    }

    #[test]
    fn each_path_is_counted_once_whatever_the_methods() {
        for methods in all_methods() {
            for events in all_strings(5).iter().filter(|events| !events.contains('V')) {
                let mut counted = layers_from_maps(&methods, events);
                if methods.counts_traced_light(class_of(events)) {
                    counted.push(class_of(events).layer());
                }
                assert_eq!(counted, [class_of(events).layer()], "E{events}L under {methods:?}");
            }
        }
    }

    #[test]
    fn no_path_is_given_up_that_could_still_count() {
        let mut all = all_methods();
        for methods in all_methods() {
            all.push(Methods {
                direct: DirectMethod::Off,
                ..methods
            });
            all.push(Methods {
                caustic: CausticMethod::Off,
                ..methods
            });
            all.push(Methods {
                indirect: IndirectMethod::Off,
                ..methods
            });
            all.push(Methods {
                specular: false,
                ..methods
            });
        }
        let endings = all_strings(3);
        for methods in all {
            for events in all_strings(4).iter().filter(|events| !events.contains('V')) {
                let counts = |more: &String| {
                    !more.contains('V') && methods.counts_traced_light(class_of(&format!("{events}{more}")))
                };
                let could = endings.iter().any(counts);
                assert!(
                    methods.may_contribute(class_of(events)) || !could,
                    "E{events} under {methods:?}"
                );
            }
        }
    }

    #[test]
    fn traced_methods_show_the_same_layers() {
        for direct in [DirectMethod::SampleLights, DirectMethod::PhotonMap, DirectMethod::Off] {
            for caustic in [CausticMethod::PhotonMap, CausticMethod::Trace, CausticMethod::Off] {
                for indirect in [
                    IndirectMethod::FinalGather,
                    IndirectMethod::Radiosity,
                    IndirectMethod::Off,
                ] {
                    let methods = Methods {
                        direct,
                        caustic,
                        indirect,
                        ..Methods::TRACED
                    };
                    let traced = methods.traced();
                    for layer in Layer::ALL {
                        assert_eq!(traced.shows(layer), methods.shows(layer), "{layer:?} under {methods:?}");
                    }
                    assert!(MapKind::ALL.iter().all(|kind| !traced.reads_map(*kind)));
                    assert!(!traced.indirect.replaces_paths());
                }
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
                    methods.indirect = IndirectMethod::Off;
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
