//! Four ways to the same indirect light: paths, photons that are gathered, records, and patches. All pairs agree.
//!
//! They share cameras, materials and rays, and nothing else: what two of them agree on is not a mistake of either. Each pair may
//! differ by the noise of both, which is measured over seeds that move photons, records and patches too, and by what each is
//! known to be off by.

#![expect(clippy::print_stdout, reason = "the matrix is printed")]

mod program;

use film::{RgbImage, Welch, block_means, t_quantile};
use program::{project, render};

/// Pixels of a side of the images, and of a block.
const RESOLUTION: &str = "48x48";
const BLOCK: u32 = 8;

/// Renders with seeds of their own, whose spread is the noise.
const SEEDS: u32 = 4;

/// Chance that noise alone makes a comparison fail, were all distributions normal. A pair has four: three means, and the blocks.
const SIGNIFICANCE: f64 = 0.01;

/// Blocks darker than this share of the mean are looked at relative to it: in the dark there is little to be relative to.
const DARK: f64 = 0.25;

/// A method and what it is known to be off by.
struct Method {
    name: &'static str,
    fields: &'static [&'static str],
    samples: &'static str,
    /// Relative, of the mean of the indirect light.
    mean_bias: f64,
    /// Relative, of any block of it.
    block_bias: f64,
}

const METHODS: [Method; 4] = [
    Method {
        name: "paths",
        fields: &["/Render.LightTransport.indirect=PathTrace"],
        samples: "128",
        mean_bias: 0.0,
        block_bias: 0.0,
    },
    // Discs of density estimates hang over edges and lose light there, one reflection away: in the Cornell box 1.5 % of it with
    // 100,000 photons, 0.5 % with 400,000, and nothing that can be told from noise with 1,600,000.
    Method {
        name: "photons",
        fields: &[
            "/Render.LightTransport.indirect=FinalGather",
            "/Render.FinalGather.rays=32",
            "/Render.DirectPhotonMap.photons=200000",
            "/Render.IndirectPhotonMap.photons=200000",
        ],
        samples: "8",
        mean_bias: 0.012,
        block_bias: 0.03,
    },
    // Interpolation blurs what changes within the spacing of records, in corners and at contacts. That is a matter of pixels, which
    // are large here.
    Method {
        name: "records",
        fields: &[
            "/Render.LightTransport.indirect=IrradianceCache",
            "/Render.IrradianceCache.rays=256",
            "/Render.IrradianceCache.min_weight=20",
            "/Render.IrradianceCache.min_spacing=0.5",
        ],
        samples: "16",
        mean_bias: 0.003,
        block_bias: 0.025,
    },
    // Nothing smaller than a patch is seen, and a hundredth of the exchanged light is extrapolated.
    Method {
        name: "patches",
        fields: &[
            "/Render.LightTransport.indirect=Radiosity",
            "/Render.Radiosity.rays=128",
        ],
        samples: "16",
        mean_bias: 0.005,
        block_bias: 0.03,
    },
];

/// Renders of one method, the indirect light alone.
struct Measured {
    /// Of all seeds, block by block and channel by channel.
    blocks: Vec<f64>,
    /// Of each channel.
    means: [f64; 3],
    /// Variance of each of `means`.
    mean_variances: [f64; 3],
    /// Standard error of a block, relative as blocks are compared: the root of the mean square.
    block_noise: f64,
}

impl Measured {
    fn of(scene: &str, method: &Method) -> Self {
        let image = |seed: u32| {
            let seed = seed.to_string();
            let options = ["--resolution", RESOLUTION, "--samples", method.samples, "--seed", &seed];
            let path = project(&format!("tests/references/{scene}/scene.ron"));
            let image = render(&path, &options, method.fields);
            block_means(&image.rgb("indirect").expect("the layer"), BLOCK)
        };
        let images: Vec<RgbImage> = (1..=SEEDS).map(image).collect();
        let values = |image: &RgbImage| -> Vec<f64> {
            let values = image.pixels.as_flattened();
            values.iter().map(|value| f64::from(*value)).collect()
        };
        let runs: Vec<Vec<f64>> = images.iter().map(values).collect();
        let count = runs[0].len();
        let (blocks, variances): (Vec<f64>, Vec<f64>) = (0..count)
            .map(|i| mean_and_variance(runs.iter().map(|run| run[i])))
            .unzip();
        let channel = |run: &[f64], c: usize| run.iter().skip(c).step_by(3).sum::<f64>() * 3.0 / count as f64;
        let of_channel = [0, 1, 2].map(|c| mean_and_variance(runs.iter().map(|run| channel(run, c))));
        let scales = scales(&blocks);
        let squares = variances
            .iter()
            .zip(&scales)
            .map(|(variance, scale)| variance / (scale * scale));
        Self {
            block_noise: (squares.sum::<f64>() / count as f64).sqrt(),
            means: of_channel.map(|(mean, _)| mean),
            mean_variances: of_channel.map(|(_, variance)| variance),
            blocks,
        }
    }
}

/// The mean of some values, and the variance of that mean.
fn mean_and_variance(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = f64::from(SEEDS);
    let mean = values.clone().sum::<f64>() / count;
    let squares: f64 = values.map(|value| (value - mean) * (value - mean)).sum();
    (mean, squares / (count * (count - 1.0)))
}

/// What differences of each block are relative to.
fn scales(blocks: &[f64]) -> Vec<f64> {
    let mean = |c: usize| blocks.iter().skip(c).step_by(3).sum::<f64>() * 3.0 / blocks.len() as f64;
    let dark = [0, 1, 2].map(|c| DARK * mean(c));
    blocks
        .iter()
        .enumerate()
        .map(|(i, block)| block.max(dark[i % 3]))
        .collect()
}

/// Compares two methods, prints what was found and what is allowed, and says whether they agree.
fn agree(scene: &str, [one, other]: [(&Method, &Measured); 2]) -> bool {
    let freedom = f64::from(SEEDS) - 1.0;
    let off = |c: usize| {
        let mut found = Welch::default();
        let variances = [one.1, other.1].map(|side| (side.mean_variances[c], freedom));
        found.add(one.1.means[c] - other.1.means[c], variances);
        let scale = 0.5 * (one.1.means[c] + other.1.means[c]);
        let noise = t_quantile(SIGNIFICANCE, found.freedom()) * found.standard_error() / scale;
        (found.difference() / scale, one.0.mean_bias + other.0.mean_bias + noise)
    };
    let means = [0, 1, 2].map(off);
    let scales = scales(&one.1.blocks);
    let count = scales.len();
    let noise = (one.1.block_noise.powi(2) + other.1.block_noise.powi(2)).sqrt();
    let pooled = freedom * count as f64;
    let allowed = one.0.block_bias + other.0.block_bias + t_quantile(SIGNIFICANCE / count as f64, pooled) * noise;
    let pairs = one.1.blocks.iter().zip(&other.1.blocks).zip(&scales);
    let mut blocks: Vec<f64> = pairs.map(|((a, b), scale)| (a - b) / scale).map(f64::abs).collect();
    blocks.sort_by(f64::total_cmp);
    let (median, worst) = (blocks[count / 2], blocks[count - 1]);
    let (mean, mean_allowed) = means
        .into_iter()
        .max_by(|a, b| (a.0.abs() / a.1).total_cmp(&(b.0.abs() / b.1)))
        .expect("three channels");
    let percent = |share: f64| format!("{:.2} %", 100.0 * share);
    println!(
        "{scene:15} {:8} {:8} mean off by {:>7} of {:>6}, blocks by {:>6} at the median, {:>7} at most of {:>7}",
        one.0.name,
        other.0.name,
        percent(mean),
        percent(mean_allowed),
        percent(median),
        percent(worst),
        percent(allowed)
    );
    means.iter().all(|(off, allowed)| off.abs() <= *allowed) && worst <= allowed
}

fn assert_agreement(scene: &str) {
    let measured: Vec<(&Method, Measured)> = METHODS
        .iter()
        .map(|method| (method, Measured::of(scene, method)))
        .collect();
    let mut all = true;
    for (i, (method, found)) in measured.iter().enumerate() {
        for (other_method, other) in &measured[i + 1..] {
            all &= agree(scene, [(method, found), (other_method, other)]);
        }
    }
    assert!(all, "{scene}: methods differ by more than they may");
}

#[test]
fn four_methods_agree_in_the_cornell_box() {
    assert_agreement("cornell");
}

#[test]
fn four_methods_agree_in_a_closed_furnace() {
    assert_agreement("furnace80");
}

#[test]
fn four_methods_agree_in_a_furnished_room() {
    assert_agreement("small_interior");
}
