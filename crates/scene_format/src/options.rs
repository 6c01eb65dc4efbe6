//! How to load a scene.

use std::path::PathBuf;

/// What a scene may need at most. Each limit is an error with a place when it is passed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of one file; 64 MiB.
    pub file_bytes: usize,
    /// Files; 1,000.
    pub layers: usize,
    /// Prims; 1,000,000.
    pub prims: usize,
    /// Length of a prim's path in names; 64, and never more.
    pub prim_depth: usize,
    /// Fields that are written; 10,000,000.
    pub opinions: usize,
    /// Items of one list; 100,000.
    pub list_items: usize,
    /// Time samples of one field; 1,000,000.
    pub samples: usize,
    /// Variants of one set; 1,000.
    pub variants: usize,
    /// Bytes of one name; 128.
    pub name_bytes: usize,
    /// Arcs between a prim and an opinion about it; 64.
    pub arc_depth: usize,
    /// Places that may have opinions about one prim; 100,000.
    pub index_nodes: usize,
    /// Steps of composition, a place, a layer at a place, a name, a target and so on one each; 200,000,000, which
    /// take a minute or so.
    pub work: usize,
    /// Pixels of one picture that a field names; 134,217,728, for example 16,384 by 8,192. Files are not opened here:
    /// it is for who reads the pictures.
    pub texture_pixels: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            file_bytes: 64 << 20,
            layers: 1_000,
            prims: 1_000_000,
            prim_depth: DEEPEST,
            opinions: 10_000_000,
            list_items: 100_000,
            samples: 1_000_000,
            variants: 1_000,
            name_bytes: 128,
            arc_depth: 64,
            index_nodes: 100_000,
            work: 200_000_000,
            texture_pixels: 1 << 27,
        }
    }
}

impl Limits {
    /// Names of the limits, for [`Self::set`].
    pub const NAMES: [&str; 13] = [
        "file_bytes",
        "layers",
        "prims",
        "prim_depth",
        "opinions",
        "list_items",
        "samples",
        "variants",
        "name_bytes",
        "arc_depth",
        "index_nodes",
        "work",
        "texture_pixels",
    ];

    /// Sets the limit of a name; false if there is none of that name.
    pub fn set(&mut self, name: &str, value: usize) -> bool {
        let limit = match name {
            "file_bytes" => &mut self.file_bytes,
            "layers" => &mut self.layers,
            "prims" => &mut self.prims,
            "prim_depth" => &mut self.prim_depth,
            "opinions" => &mut self.opinions,
            "list_items" => &mut self.list_items,
            "samples" => &mut self.samples,
            "variants" => &mut self.variants,
            "name_bytes" => &mut self.name_bytes,
            "arc_depth" => &mut self.arc_depth,
            "index_nodes" => &mut self.index_nodes,
            "work" => &mut self.work,
            "texture_pixels" => &mut self.texture_pixels,
            _ => return false,
        };
        *limit = value;
        true
    }
}

/// Prims are never nested deeper: that many fit on the stack of any thread.
pub(crate) const DEEPEST: usize = 64;

/// How to load a scene.
#[derive(Clone, Debug)]
pub struct Options {
    /// Values for single fields, as `/Prim.Component.field=RON` or `/Prim.field=RON`; they are
    /// stronger than the scene, and a later one is stronger than an earlier.
    pub sets: Vec<String>,
    /// Choices of variants, as `/Prim{set=variant}`.
    pub variants: Vec<String>,
    /// The folder that no file may lie outside of; by default the folder of the scene or the
    /// nearest one above it that has a `pipeline.toml`.
    pub root: Option<PathBuf>,
    /// The frame to show; by default the scene's `time.start`, else 0.
    pub frame: Option<f64>,
    /// Whether payloads are brought in.
    pub load_payloads: bool,
    /// Whether the files that fields name must exist. When off, [`AssetPath`](crate::AssetPath)
    /// keeps the text of the scene.
    pub check_assets: bool,
    /// Whether the prims that fields of rendered prims point to must exist.
    pub check_targets: bool,
    /// What a scene may need at most.
    pub limits: Limits,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            sets: Vec::new(),
            variants: Vec::new(),
            root: None,
            frame: None,
            load_payloads: true,
            check_assets: true,
            check_targets: true,
            limits: Limits::default(),
        }
    }
}
