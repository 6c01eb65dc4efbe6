use crate::parse;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
use std::time::Duration;

/// A global-illumination renderer whose data lives in an ECS.
#[derive(Parser, Debug)]
#[command(
    name = "pipeline",
    version,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 done, 1 render or I/O failed, 2 bad command line or bad scene, 130 interrupted \
                  (image written)."
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Subcommand, Debug)]
pub(crate) enum Command {
    /// Render a scene to image files
    Run(RunArgs),
    /// Load and check a scene, render nothing
    Check(CheckArgs),
    /// Write a composed scene as one layer without arcs
    Flatten(FlattenArgs),
    /// Say why a value is what it is: every opinion about it, and why each loser loses
    Explain(ExplainArgs),
    /// List what a scene can say: components, fields, types, units, ranges, defaults
    Schema(SchemaArgs),
    /// List schedules, sets and systems in the order they run
    Stages(StagesArgs),
    /// Render a scene and print what every system cost
    Profile(ProfileArgs),
    /// Draw the photons of a scene as points, or write them to a file
    Photons(PhotonsArgs),
    /// Draw the irradiance records of a scene as points, or write them to a file
    Records(RecordsArgs),
    /// Measure how far an image is from a reference
    Compare(CompareArgs),
    /// Look for bias: trace random parts of a scene, and test its own methods against them
    Audit(AuditArgs),
}

/// A scene and how to compose it.
#[derive(Args, Debug)]
pub(crate) struct SceneArgs {
    /// The scene file
    #[arg(value_name = "SCENE")]
    pub(crate) scene: PathBuf,
    /// Set one field, stronger than the scene; a later one wins
    #[arg(long, value_name = "/PRIM.COMPONENT.FIELD=VALUE")]
    pub(crate) set: Vec<String>,
    /// Choose a variant
    #[arg(long, value_name = "/PRIM{SET=VARIANT}")]
    pub(crate) variant: Vec<String>,
    /// The frame to show [default: the scene's first, else 0]
    #[arg(long, value_name = "T", value_parser = parse::finite, allow_negative_numbers = true)]
    pub(crate) frame: Option<f64>,
    /// The folder that no file of the scene may lie outside of [default: the scene's folder, or the nearest one above
    /// it with a pipeline.toml]
    #[arg(long, value_name = "DIR")]
    pub(crate) root: Option<PathBuf>,
    /// Leave payloads out
    #[arg(long)]
    pub(crate) no_payloads: bool,
    /// Raise or lower a limit that protects against hostile files; a wrong NAME lists them all
    #[arg(long, value_name = "NAME=N", value_parser = parse::limit)]
    pub(crate) limit: Vec<(String, usize)>,
}

/// How to render.
#[derive(Args, Debug)]
pub(crate) struct RenderArgs {
    /// A file to write, .exr (linear, with layers) or .png (tone-mapped); may be given several times
    #[arg(short, long = "output", value_name = "FILE", value_parser = parse::output)]
    pub(crate) output: Vec<PathBuf>,
    /// Samples a pixel, in place of the scene's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16_777_216))]
    pub(crate) samples: Option<u32>,
    /// Stop after the first pass with an estimated relative error of the image below this, 2% or 0.02: the root of the
    /// relMSE that `compare` would find. Samples are unbounded then, but for --samples
    #[arg(long, value_name = "ERROR", value_parser = parse::relative_error)]
    pub(crate) until: Option<f64>,
    /// Stop after the first pass that ends later than this: 90, 30s, 2m, 1h, 500ms
    #[arg(long, value_name = "TIME", value_parser = parse::duration)]
    pub(crate) time_limit: Option<Duration>,
    /// Pixels of the whole film, in place of the scene's
    #[arg(long, value_name = "WxH", value_parser = parse::resolution)]
    pub(crate) resolution: Option<[u32; 2]>,
    /// Render a part only: first pixel, and the pixel after the last
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse::crop)]
    pub(crate) crop: Option<[u32; 4]>,
    /// Threads to use; changes no bit of the image [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=parse::MAX_THREADS))]
    pub(crate) threads: Option<u16>,
    /// Seed of all random numbers, in place of the scene's
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Side of a film tile in pixels; changes no bit of the image
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=parse::MAX_TILE))]
    pub(crate) tile_size: u32,
    /// Treat warnings and dropped samples as errors
    #[arg(long)]
    pub(crate) strict: bool,
    /// Write what every system cost
    #[arg(long, value_name = "FILE.json")]
    pub(crate) profile: Option<PathBuf>,
    /// Write a timeline of all systems, for Perfetto
    #[arg(long, value_name = "FILE.json")]
    pub(crate) trace: Option<PathBuf>,
    /// Take photons from a file that `pipeline photons` wrote, instead of tracing them; changes no bit of the image
    #[arg(long, value_name = "FILE.photons")]
    pub(crate) photons: Option<PathBuf>,
    /// Begin with irradiance records from a file that `pipeline records` wrote; where only the camera or the film differ, those
    /// that are missing are added
    #[arg(long, value_name = "FILE.records")]
    pub(crate) records: Option<PathBuf>,
    /// Go on from where the same command was interrupted
    #[arg(long)]
    pub(crate) resume: bool,
    /// Show nothing but warnings and errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

#[derive(Args, Debug)]
#[command(
    after_help = "Without -o, writes SCENE.exr and SCENE.png, named after the scene, in the working directory.\n\
                        Ctrl-C writes the image as it is; the same command with --resume goes on from there."
)]
pub(crate) struct RunArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) render: RenderArgs,
}

#[derive(Args, Debug)]
#[command(after_help = "Takes the options of `run`, and writes no image without -o.")]
pub(crate) struct ProfileArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) render: RenderArgs,
}

#[derive(Args, Debug)]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// Treat warnings as errors
    #[arg(long)]
    pub(crate) strict: bool,
}

#[derive(Args, Debug)]
#[command(after_help = "Prints RON that composes to the same scene when it lies beside it; \
                        `--json` prints values, relationships, and whose opinions they are, for tools.")]
pub(crate) struct FlattenArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// Print JSON, errors too
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct ExplainArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// The field to explain; without COMPONENT the one component that has it
    #[arg(value_name = "/PRIM.COMPONENT.FIELD")]
    pub(crate) question: String,
}

#[derive(Args, Debug)]
pub(crate) struct SchemaArgs {
    /// The component to describe [default: all]
    #[arg(value_name = "COMPONENT")]
    pub(crate) component: Option<String>,
}

#[derive(Args, Debug)]
pub(crate) struct StagesArgs {
    /// A scene to check first
    #[arg(value_name = "SCENE")]
    pub(crate) scene: Option<PathBuf>,
    /// Print a Graphviz graph
    #[arg(long)]
    pub(crate) dot: bool,
}

#[derive(Args, Debug)]
#[command(
    after_help = ".png draws the photons over the scene; .ply is a point cloud for MeshLab or Blender; \
                  .photons is for `run --photons`."
)]
pub(crate) struct PhotonsArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// A file to write, .png, .ply or .photons; may be given several times
    #[arg(short, long = "output", value_name = "FILE", required = true, value_parser = parse::photon_output)]
    pub(crate) output: Vec<PathBuf>,
    /// A map to show; may be given several times [default: all]
    #[arg(long, value_name = "MAP", value_enum)]
    pub(crate) map: Vec<PhotonMapName>,
    /// What the colour of a photon tells
    #[arg(long, value_name = "BY", value_enum, default_value_t = PhotonColour::Flux)]
    pub(crate) colour: PhotonColour,
    #[command(flatten)]
    pub(crate) draw: DrawArgs,
}

#[derive(Args, Debug)]
#[command(
    after_help = ".png draws the records over the scene; .ply is a point cloud for MeshLab or Blender; \
                  .records is for `run --records`."
)]
pub(crate) struct RecordsArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// A file to write, .png, .ply or .records; may be given several times
    #[arg(short, long = "output", value_name = "FILE", required = true, value_parser = parse::record_output)]
    pub(crate) output: Vec<PathBuf>,
    /// What the colour of a record tells
    #[arg(long, value_name = "BY", value_enum, default_value_t = RecordColour::Irradiance)]
    pub(crate) colour: RecordColour,
    /// Begin with records from a file; where only the camera or the film differ, those that are missing are added
    #[arg(long, value_name = "FILE.records")]
    pub(crate) records: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) draw: DrawArgs,
}

/// How photons or records are made to be drawn.
#[derive(Args, Debug)]
pub(crate) struct DrawArgs {
    /// Pixels of the whole film, in place of the scene's
    #[arg(long, value_name = "WxH", value_parser = parse::resolution)]
    pub(crate) resolution: Option<[u32; 2]>,
    /// Draw a part only: first pixel, and the pixel after the last
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse::crop)]
    pub(crate) crop: Option<[u32; 4]>,
    /// Threads to use; changes no bit of what is made [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=parse::MAX_THREADS))]
    pub(crate) threads: Option<u16>,
    /// Seed of all random numbers, in place of the scene's
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Show nothing but warnings and errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// A photon map, on the command line.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PhotonMapName {
    Direct,
    Caustic,
    Indirect,
}

impl From<PhotonMapName> for transport::MapKind {
    fn from(name: PhotonMapName) -> Self {
        match name {
            PhotonMapName::Direct => Self::Direct,
            PhotonMapName::Caustic => Self::Caustic,
            PhotonMapName::Indirect => Self::Indirect,
        }
    }
}

/// What the colour of a photon tells.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PhotonColour {
    /// Its flux
    Flux,
    /// The map that it is in
    Map,
    /// Events since the light
    Bounce,
}

/// What the colour of a record tells.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RecordColour {
    /// Its irradiance
    Irradiance,
    /// How far it holds: yellow near, blue far
    Range,
    /// When it was made: the first yellow, the last blue
    Number,
}

#[derive(Args, Debug)]
pub(crate) struct CompareArgs {
    /// The image, .exr
    #[arg(value_name = "IMAGE")]
    pub(crate) image: PathBuf,
    /// The reference, .exr, of the same size
    #[arg(value_name = "REFERENCE")]
    pub(crate) reference: PathBuf,
    /// Write IMAGE - REFERENCE: .exr has the signed numbers; .png is red where IMAGE is too bright, blue where too dark
    #[arg(long, value_name = "FILE", value_parser = parse::output)]
    pub(crate) diff: Option<PathBuf>,
    /// Judge by the trimmed error, which leaves out the worst 0.1 % of the pixels
    #[arg(long)]
    pub(crate) trim: bool,
    /// How many of the worst pixels to list
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub(crate) worst: usize,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Fail (exit code 1) if the relative mean squared error is over this
    #[arg(long, value_name = "X", value_parser = parse::not_negative)]
    pub(crate) max_relmse: Option<f64>,
    /// Compare a layer, such as `caustic`, instead of the whole image
    #[arg(long, value_name = "NAME")]
    pub(crate) layer: Option<String>,
}

#[derive(Args, Debug)]
#[command(
    after_help = "Exit codes: 0 no bias found, 1 bias found or the audit failed, 2 bad command line or bad scene, 130 \
                  interrupted.\n\
                  The tracer cannot see everything: what hangs on a few bright samples, or may be light that no ray has met \
                  yet, counts as undecided. Photon maps are the same for all samples, so their noise is in the image for good, and counts as bias."
)]
pub(crate) struct AuditArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// A map of the bias to write, .exr (numbers) or .png (red where too bright, blue where too dark, framed in white
    /// where found); may be given several times
    #[arg(short, long = "output", value_name = "FILE", value_parser = parse::output)]
    pub(crate) output: Vec<PathBuf>,
    /// Processor time to trace for, loading included: 90, 30s, 2m, 1h. One pass is always made
    #[arg(long, value_name = "TIME", default_value = "30s", value_parser = parse::duration)]
    pub(crate) budget: Duration,
    /// Difference that is no defect, relative to the traced value: 1% or 0.01
    #[arg(long, value_name = "SHARE", default_value = "1%", value_parser = parse::share)]
    pub(crate) tolerance: f64,
    /// Chance that an image without bias passes, above 50%
    #[arg(long, value_name = "SHARE", default_value = "99%", value_parser = parse::confidence)]
    pub(crate) confidence: f64,
    /// Blocks of pixels to look at, chosen at random
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1_048_576))]
    pub(crate) blocks: u32,
    /// Side of a block in pixels: small ones find what is sharp, large ones what is faint
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(4..=256))]
    pub(crate) block_size: u32,
    /// Another trial looks at other blocks, and traces them with other random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) trial: u64,
    /// Traced samples a pixel at most, which makes an audit repeatable to the bit
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(i64::from(film::LEAST_AUDIT_SAMPLES)..=16_777_216))]
    pub(crate) traced_samples: Option<u32>,
    /// Samples a pixel of the scene's own methods, in place of the scene's; at least 32 are taken
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16_777_216))]
    pub(crate) samples: Option<u32>,
    /// Pixels of the whole film, in place of the scene's
    #[arg(long, value_name = "WxH", value_parser = parse::resolution)]
    pub(crate) resolution: Option<[u32; 2]>,
    /// Look at a part only: first pixel, and the pixel after the last
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse::crop)]
    pub(crate) crop: Option<[u32; 4]>,
    /// Threads to use [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=parse::MAX_THREADS))]
    pub(crate) threads: Option<u16>,
    /// Seed of the scene's own methods, in place of the scene's
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// How many of the worst places to list
    #[arg(long, value_name = "N", default_value_t = 8)]
    pub(crate) worst: usize,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Show nothing but warnings, errors and the result
    #[arg(short, long)]
    pub(crate) quiet: bool,
}
