//! Two threads of one process against two processes of one thread each, in throughput: `cargo bench --bench scaling`.
//!
//! Two processes share nothing but the machine, so they are what two threads can reach at best. Rounds of both alternate
//! and the median ratio is printed; 1 is all there is. Of photon maps each system is timed by itself, by the program's
//! own profile.

#![expect(clippy::print_stdout, reason = "a benchmark reports its figures")]

use std::path::PathBuf;
use std::process::{Child, Command};
use std::time::Instant;

const ROUNDS: usize = 5;

fn file(label: &str, kind: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("scaling-{label}.{kind}"))
}

/// Starts a render with these fields of `/Render`; its profile goes to a file of its label.
fn start(scene: &str, threads: u32, samples: u32, label: &str, fields: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_pipeline"))
        .arg("run")
        .arg(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(scene))
        .args([
            "--quiet",
            "--samples",
            &samples.to_string(),
            "--threads",
            &threads.to_string(),
        ])
        .args(
            fields
                .iter()
                .flat_map(|field| ["--set".into(), format!("/Render.{field}")]),
        )
        .arg("-o")
        .arg(file(label, "exr"))
        .arg("--profile")
        .arg(file(label, "json"))
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

/// Seconds that systems took, as a process wrote it: those whose names contain one of `systems`.
fn seconds_of(systems: &[&str], label: &str) -> f64 {
    let profile = std::fs::read_to_string(file(label, "json")).expect("a profile that was written");
    let profile: serde_json::Value = serde_json::from_str(&profile).expect("JSON");
    let lines = profile.as_array().expect("a line for each system").iter();
    let is_asked_for = |line: &&serde_json::Value| {
        let name = line["system"].as_str().expect("a name");
        systems.iter().any(|system| name.contains(system))
    };
    let seconds = |line: &serde_json::Value| line["seconds"].as_f64().expect("seconds");
    lines.filter(is_asked_for).map(seconds).sum()
}

fn print(name: &str, mut ratios: Vec<f64>) {
    ratios.sort_by(f64::total_cmp);
    println!("{name}: {:.3} of two processes ({ratios:.3?})", ratios[ROUNDS / 2]);
}

fn paths() {
    const SAMPLES: u32 = 32;
    for scene in [
        "tests/references/cornell/scene.ron",
        "tests/references/cornell_glass/scene.ron",
    ] {
        let ratios = (0..ROUNDS).map(|_| {
            let started = Instant::now();
            let together = wait(vec![start(scene, 2, SAMPLES, "both", &[])], started);
            let started = Instant::now();
            let apart = ["first", "second"].map(|label| start(scene, 1, SAMPLES, label, &[]));
            // Two processes make two pictures.
            wait(apart.into(), started) / (2.0 * together)
        });
        print(scene, ratios.collect());
    }
}

/// The systems of photon maps, each by its own time: the rest of a render hides them.
fn photons() {
    const SAMPLES: u32 = 8;
    const SCENE: &str = "tests/references/cornell_glass/scene.ron";
    const FIELDS: [&str; 6] = [
        "LightTransport.direct=PhotonMap",
        "LightTransport.caustic=PhotonMap",
        "LightTransport.indirect=PhotonMap",
        "DirectPhotonMap.photons=1000000",
        "CausticPhotonMap.photons=1000000",
        "IndirectPhotonMap.photons=1000000",
    ];
    const SYSTEMS: [(&str, &[&str]); 4] = [
        ("emitting and tracing", &["emit_photons", "trace_photons"]),
        ("storing", &["store_photons"]),
        ("building", &["build_photon_map"]),
        ("gathering", &["gather_photons"]),
    ];
    let mut ratios = [const { Vec::new() }; SYSTEMS.len()];
    for _ in 0..ROUNDS {
        let started = Instant::now();
        wait(vec![start(SCENE, 2, SAMPLES, "both", &FIELDS)], started);
        let apart = ["first", "second"].map(|label| start(SCENE, 1, SAMPLES, label, &FIELDS));
        wait(apart.into(), started);
        for ((_, systems), ratios) in SYSTEMS.iter().zip(&mut ratios) {
            let [both, first, second] = ["both", "first", "second"].map(|label| seconds_of(systems, label));
            ratios.push(0.5 * (first + second) / (2.0 * both));
        }
    }
    for ((name, _), ratios) in SYSTEMS.iter().zip(ratios) {
        print(&format!("{name} photons"), ratios);
    }
}

/// The filling of the irradiance cache: camera rays, choice, rays of records, and the octree together.
fn records() {
    const FIELDS: [&str; 1] = ["LightTransport.indirect=IrradianceCache"];
    const SYSTEMS: [&str; 6] = [
        "irradiance_cache::fill::generate_rays",
        "find_sites",
        "choose_sites",
        "sample_records",
        "insert_records",
        "maintain_octree",
    ];
    for scene in [
        "tests/references/cornell/scene.ron",
        "tests/references/small_interior/scene.ron",
    ] {
        let ratios = (0..ROUNDS).map(|_| {
            let started = Instant::now();
            wait(vec![start(scene, 2, 1, "both", &FIELDS)], started);
            let apart = ["first", "second"].map(|label| start(scene, 1, 1, label, &FIELDS));
            wait(apart.into(), started);
            let [both, first, second] = ["both", "first", "second"].map(|label| seconds_of(&SYSTEMS, label));
            0.5 * (first + second) / (2.0 * both)
        });
        print(&format!("filling the irradiance cache, {scene}"), ratios.collect());
    }
}

fn main() {
    records();
    photons();
    paths();
}
