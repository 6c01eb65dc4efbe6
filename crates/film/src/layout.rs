//! Which channels a film accumulates, and what they are called in files.

use crate::batch::{BATCH_RUN, BATCHES};
use crate::error::FilmError;

/// Longest name of a layer or group, so that a channel name stays within the 31 bytes that every
/// EXR reader accepts.
const MAX_NAME_BYTES: usize = 24;

/// A group of auxiliary channels, such as the albedo or the depth of what a pixel shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AuxGroup {
    /// Name of the group; the first half of its channel names.
    pub name: String,
    /// One entry a channel: its half after the dot. An empty one means that the channel has the name
    /// of the group alone.
    pub components: Vec<String>,
}

impl AuxGroup {
    /// A colour: `name.R`, `name.G`, `name.B`.
    #[must_use]
    pub fn rgb(name: &str) -> Self {
        Self::with_components(name, &["R", "G", "B"])
    }

    /// A vector: `name.X`, `name.Y`, `name.Z`.
    #[must_use]
    pub fn xyz(name: &str) -> Self {
        Self::with_components(name, &["X", "Y", "Z"])
    }

    /// A distance: `name.Z`, the convention of renderers that write depth as a layer.
    #[must_use]
    pub fn depth(name: &str) -> Self {
        Self::with_components(name, &["Z"])
    }

    /// A plain number: `name`.
    #[must_use]
    pub fn scalar(name: &str) -> Self {
        Self::with_components(name, &[""])
    }

    fn with_components(name: &str, components: &[&str]) -> Self {
        Self {
            name: name.to_owned(),
            components: components.iter().map(|&c| c.to_owned()).collect(),
        }
    }

    /// Iterates over the full channel names.
    pub fn channel_names(&self) -> impl Iterator<Item = String> + '_ {
        self.components.iter().map(|component| {
            if component.is_empty() {
                self.name.clone()
            } else {
                format!("{}.{component}", self.name)
            }
        })
    }
}

/// The channels of a film.
///
/// Per pixel: three for every radiance layer, one for alpha, and those of the groups, 16 bytes each; for the
/// variance, if it is wanted, the sums of [`BATCHES`](crate::BATCHES) batches, 192 bytes a set.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChannelLayout {
    /// Names of the RGB radiance layers, W·m⁻²·sr⁻¹. Their sum, in this order, is the beauty image.
    pub layers: Vec<String>,
    /// Groups of auxiliary channels; averaged over the samples like everything else.
    pub aux: Vec<AuxGroup>,
    /// Whether sums of batches are kept, for the variance of the mean of each beauty channel.
    pub variance: bool,
    /// Whether such sums are kept of each layer too, which [`Film::estimate`](crate::Film::estimate) then tells apart; no
    /// file has them. Counts with `variance` alone.
    pub layer_variance: bool,
}

impl ChannelLayout {
    /// The layers of the path classes, with albedo, normal, depth and variance.
    #[must_use]
    pub fn standard() -> Self {
        let layers = ["direct", "specular", "caustic", "indirect", "emission", "volume"];
        Self {
            layers: layers.iter().map(|&l| l.to_owned()).collect(),
            aux: vec![
                AuxGroup::rgb("albedo"),
                AuxGroup::xyz("normal"),
                AuxGroup::depth("depth"),
            ],
            variance: true,
            layer_variance: false,
        }
    }

    /// Returns the number of auxiliary values that a sample carries: the sum over the groups.
    #[must_use]
    pub fn aux_count(&self) -> usize {
        self.aux.iter().map(|group| group.components.len()).sum()
    }

    /// Returns the number of channels that a pixel holds sums of; the variance comes from sums of another kind.
    #[must_use]
    pub fn channel_count(&self) -> usize {
        self.alpha_offset() + 1 + self.aux_count()
    }

    /// Returns how many independently scrambled sequences the samples of a pixel have to be dealt to, and how many at a
    /// time go to one.
    #[must_use]
    pub fn sequences(&self) -> (u32, u32) {
        (if self.variance { BATCHES } else { 1 }, BATCH_RUN)
    }

    /// Sets of batches that a pixel holds: of the beauty, then of each layer.
    pub(crate) fn batch_sets(&self) -> usize {
        match (self.variance, self.layer_variance) {
            (false, _) => 0,
            (true, false) => 1,
            (true, true) => 1 + self.layers.len(),
        }
    }

    /// Position of alpha among the sums of a pixel; the layers come before it.
    pub(crate) fn alpha_offset(&self) -> usize {
        3 * self.layers.len()
    }

    /// Returns the channel names of the resolved image, in the order in which it lists them:
    /// `R G B A`, the layers, the groups, the variance.
    #[must_use]
    pub fn image_channel_names(&self) -> Vec<String> {
        let rgb = |name: &str| AuxGroup::rgb(name).channel_names().collect::<Vec<_>>();
        let mut names: Vec<String> = ["R", "G", "B", "A"].iter().map(|&n| n.to_owned()).collect();
        names.extend(self.layers.iter().flat_map(|layer| rgb(layer)));
        names.extend(self.aux.iter().flat_map(AuxGroup::channel_names));
        if self.variance {
            names.extend(rgb("variance"));
        }
        names
    }

    /// Checks that every channel has a name of its own that any EXR reader accepts.
    ///
    /// # Errors
    ///
    /// [`FilmError::ChannelName`] for a name that is empty, longer than 24 bytes, not made of ASCII
    /// letters, digits, `_` and `-`, or that gives two channels the same name.
    pub fn validate(&self) -> Result<(), FilmError> {
        let refuse = |name: &str, reason| {
            let name = name.to_owned();
            Err(FilmError::ChannelName { name, reason })
        };
        let groups = self.aux.iter().map(|group| &group.name);
        for name in self.layers.iter().chain(groups) {
            if name.is_empty() || name.len() > MAX_NAME_BYTES {
                return refuse(name, "it must have 1 to 24 bytes");
            }
            if !is_plain(name) {
                return refuse(name, "only ASCII letters, digits, '_' and '-' are allowed");
            }
        }
        for component in self.aux.iter().flat_map(|group| &group.components) {
            if component.len() > 4 || !is_plain(component) {
                return refuse(component, "a component has at most 4 ASCII letters or digits");
            }
        }
        let mut names = self.image_channel_names();
        names.sort_unstable();
        match names.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => refuse(&pair[0], "two channels would have it"),
            None => Ok(()),
        }
    }
}

/// Tells whether a name has only characters that need no quoting anywhere.
fn is_plain(name: &str) -> bool {
    name.bytes()
        .all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_layout_counts() {
        let layout = ChannelLayout::standard();
        layout.validate().unwrap();
        assert_eq!(layout.aux_count(), 7);
        assert_eq!(layout.channel_count(), 18 + 1 + 7);
        let names = layout.image_channel_names();
        assert_eq!(names.len(), 3 + layout.channel_count() + 3);
        for name in ["R", "A", "direct.R", "volume.B", "normal.X", "depth.Z", "variance.G"] {
            assert!(names.iter().any(|n| n == name), "{name} is missing");
        }
    }

    #[test]
    fn bad_names_are_refused() {
        let with_layers = |layers: &[&str]| ChannelLayout {
            layers: layers.iter().map(|&l| l.to_owned()).collect(),
            ..ChannelLayout::default()
        };
        assert!(with_layers(&["a", "b"]).validate().is_ok());
        assert!(with_layers(&["a", "a"]).validate().is_err());
        assert!(with_layers(&[""]).validate().is_err());
        assert!(with_layers(&["a.b"]).validate().is_err());
        assert!(with_layers(&["a layer with quite a long name"]).validate().is_err());
        let clash = ChannelLayout {
            aux: vec![AuxGroup::scalar("R")],
            ..ChannelLayout::default()
        };
        assert!(clash.validate().is_err());
        let variance = ChannelLayout {
            aux: vec![AuxGroup::rgb("variance")],
            variance: true,
            ..ChannelLayout::default()
        };
        assert!(variance.validate().is_err());
    }
}
