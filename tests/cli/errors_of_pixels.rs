//! The variance layer, and rendering until the error is small enough.

use crate::program::{BALLS, Folder};
use film::{ExrImage, RgbImage, compare, read_exr};

fn image(folder: &Folder, name: &str) -> ExrImage {
    read_exr(&folder.path(name)).unwrap()
}

fn beauty(folder: &Folder, name: &str) -> RgbImage {
    image(folder, name).rgb("").unwrap()
}

#[test]
fn the_variance_is_the_spread_over_seeds() {
    const SEEDS: u32 = 48;
    let folder = Folder::with_scene(BALLS);
    let (mut sums, mut squares, mut told) = (vec![[0.0_f64; 3]; 256], vec![[0.0_f64; 3]; 256], 0.0);
    for seed in 0..SEEDS {
        folder.succeed(&format!(
            "run scene.ron -o out.exr --seed {seed} --samples 64 --resolution 16x16 --set /Render.LightTransport.caustic=Off"
        ));
        let found = image(&folder, "out.exr");
        let variance = found.rgb("variance").unwrap();
        told += variance.pixels.iter().flatten().map(|v| f64::from(*v)).sum::<f64>() / f64::from(SEEDS);
        for (i, pixel) in found.rgb("").unwrap().pixels.iter().enumerate() {
            for (c, value) in pixel.iter().enumerate() {
                sums[i][c] += f64::from(*value);
                squares[i][c] += f64::from(*value) * f64::from(*value);
            }
        }
    }
    let n = f64::from(SEEDS);
    let spread: f64 = sums
        .iter()
        .flatten()
        .zip(squares.iter().flatten())
        .map(|(sum, squares)| (squares - sum * sum / n) / (n - 1.0))
        .sum();
    assert!((told / spread - 1.0).abs() < 0.1, "{told} told, {spread} found");
}

#[test]
fn without_variance_there_is_one_sequence_and_no_layer() {
    let folder = Folder::with_scene(BALLS);
    folder.succeed("run scene.ron -o with.exr");
    folder.succeed("run scene.ron -o without.exr --set /Render.Film.variance=false");
    assert!(image(&folder, "with.exr").rgb("variance").is_some());
    assert!(image(&folder, "without.exr").rgb("variance").is_none());
    let ran = folder.run("run scene.ron -o out.exr --until 2% --set /Render.Film.variance=false");
    assert!(
        ran.code == Some(2) && ran.stderr.contains("error[no-variance]"),
        "{}",
        ran.stderr
    );
}

#[test]
fn it_stops_on_a_whole_pass_with_the_error_that_was_asked_for() {
    let folder = Folder::with_scene(BALLS);
    let traced = "--resolution 24x24 --set /Render.LightTransport.caustic=Off --tile-size 8";
    folder.succeed(&format!("run scene.ron -o truth.exr --samples 16384 --seed 9 {traced}"));
    for (threads, asked) in [(1, 0.05), (2, 0.05), (3, 0.05), (2, 0.02)] {
        let ran = folder.succeed(&format!(
            "run scene.ron -o out.exr --until {asked} --threads {threads} {traced}"
        ));
        let samples: u32 = ran
            .stderr
            .split(" samples a pixel")
            .next()
            .unwrap()
            .split_whitespace()
            .last()
            .unwrap()
            .parse()
            .unwrap();
        assert!(ran.stderr.contains("estimated relative error"), "{}", ran.stderr);
        let error = compare(&beauty(&folder, "out.exr"), &beauty(&folder, "truth.exr"), 0)
            .unwrap()
            .rel_mse
            .sqrt();
        assert!(
            error < 1.5 * asked && error > asked / 2.5,
            "asked for {asked}, got {error}"
        );
        // Nothing but the number of samples is different from a plain render.
        folder.succeed(&format!("run scene.ron -o plain.exr --samples {samples} {traced}"));
        assert!(
            folder.bytes("plain.exr") == folder.bytes("out.exr"),
            "{samples} samples"
        );
        assert!(!folder.names().iter().any(|name| name.ends_with(".partial")));
    }
    folder.succeed(&format!("run scene.ron -o out.exr --until 0.01% --samples 64 {traced}"));
    folder.succeed(&format!("run scene.ron -o plain.exr --samples 64 {traced}"));
    assert!(folder.bytes("plain.exr") == folder.bytes("out.exr"));
}

#[test]
fn errors_that_cannot_be_asked_for_are_refused() {
    let folder = Folder::with_scene(BALLS);
    for bad in ["0", "200%", "abc", "-1%", "nan", "100%"] {
        let ran = folder.run(&format!("run scene.ron --until={bad}"));
        assert!(
            ran.code == Some(2) && ran.stderr.contains("above 0 and below 100 %"),
            "{bad}: {}",
            ran.stderr
        );
    }
}
