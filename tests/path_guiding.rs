//! Path guiding: the same pictures as plain path tracing, and less noise where light is uneven.

#![expect(clippy::print_stdout, reason = "the variances are the result")]

mod program;

use film::ExrImage;
use program::{project, render};

const SIZE: [&str; 2] = ["--resolution", "96x96"];

/// Mean of an image and the variance of that mean, from the batches of its pixels; green, where eyes and most light are.
fn mean_and_variance(image: &ExrImage) -> (f64, f64) {
    let sum = |layer: &str| {
        let pixels = image.rgb(layer).expect("a layer").pixels;
        (pixels.iter().map(|p| f64::from(p[1])).sum::<f64>(), pixels.len() as f64)
    };
    let ((light, count), (variance, _)) = (sum(""), sum("variance"));
    (light / count, variance / (count * count))
}

#[test]
fn guided_paths_find_the_same_light_with_less_noise_where_it_is_uneven() {
    const GUIDED: [&str; 1] = ["/Render.PathGuiding.mix=0.5"];
    for (name, plain, guided, least_gain) in [
        (
            "scenes/spotlit.ron",
            &["--variant", "/Render{paths=plain}"] as &[&str],
            &[] as &[&str],
            2.0,
        ),
        ("tests/references/small_interior/scene.ron", &[], &GUIDED, 0.0),
        ("tests/references/cornell/scene.ron", &[], &GUIDED, 0.0),
    ] {
        let measured = |options: &[&str], fields: &[&str]| {
            let options = [&SIZE[..], &["--samples", "64"], options].concat();
            mean_and_variance(&render(&project(name), &options, fields))
        };
        let ((plain, plain_variance), (guided, guided_variance)) = (measured(plain, &[]), measured(&[], guided));
        let z = (guided - plain) / (guided_variance + plain_variance).sqrt();
        let gain = plain_variance / guided_variance;
        println!("{name}: {guided} guided, {plain} plain, z = {z:.2}; variance {gain:.2} times lower");
        // Four standard errors, three scenes: a false alarm in 5,000 changes of the random numbers.
        assert!(z.abs() < 4.0, "{name}: {guided} against {plain}, z = {z}");
        assert!(gain > least_gain, "{name}: {gain}");
    }
}

#[test]
fn guided_paths_are_the_same_on_any_number_of_threads() {
    let picture = |threads: &str| {
        let options = [&SIZE[..], &["--samples", "4", "--threads", threads]].concat();
        render(
            &project("scenes/spotlit.ron"),
            &options,
            &["/Render.PathGuiding.photons=5000"],
        )
        .rgb("")
        .expect("R, G, B")
        .pixels
    };
    let first = picture("1");
    for threads in ["2", "3"] {
        assert!(picture(threads) == first, "{threads} threads");
    }
}
