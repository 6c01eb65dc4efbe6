//! Two threads of one process against two processes of one thread each, in throughput: `cargo bench --bench scaling`.
//!
//! Two processes share nothing but the machine, so they are what two threads can reach at best. Rounds of both alternate
//! and the median ratio is printed; 1 is all there is.

#![expect(clippy::print_stdout, reason = "a benchmark reports its figures")]

use std::path::PathBuf;
use std::process::{Child, Command};
use std::time::Instant;

const ROUNDS: usize = 5;

fn start(scene: &str, threads: u32, label: &str) -> Child {
    let output = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("scaling-{label}.exr"));
    Command::new(env!("CARGO_BIN_EXE_pipeline"))
        .arg("run")
        .arg(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(scene))
        .args(["--quiet", "--samples", "32", "--threads", &threads.to_string(), "-o"])
        .arg(output)
        .spawn()
        .expect("the program starts")
}

/// Seconds until all of some processes have ended.
fn wait(children: Vec<Child>, started: Instant) -> f64 {
    for mut child in children {
        assert!(child.wait().expect("it runs").success(), "the scene renders");
    }
    started.elapsed().as_secs_f64()
}

fn main() {
    for scene in [
        "tests/references/cornell/scene.ron",
        "tests/references/cornell_glass/scene.ron",
    ] {
        let mut ratios: Vec<f64> = (0..ROUNDS)
            .map(|_| {
                let started = Instant::now();
                let together = wait(vec![start(scene, 2, "both")], started);
                let started = Instant::now();
                let apart = wait(vec![start(scene, 1, "first"), start(scene, 1, "second")], started);
                // Two processes make two pictures.
                apart / (2.0 * together)
            })
            .collect();
        ratios.sort_by(f64::total_cmp);
        println!("{scene}: {:.3} of two processes ({ratios:.3?})", ratios[ROUNDS / 2]);
    }
}
