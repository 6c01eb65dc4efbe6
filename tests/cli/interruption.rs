//! Ctrl-C: what is there is written, and resuming gives the bits of a render that nobody disturbed.

#![cfg(unix)]

use crate::program::{BALLS, Folder, assert_whole_png};
use std::fs::File;
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Enough for a second or more, in many waves.
const OPTIONS: &str = "--samples 600 --resolution 64x64 --set /Render.CausticPhotonMap.photons=20000";
/// Longer than any of these runs may take on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// Runs a command and sends it a signal, `delay` after it began to say something.
fn interrupt(folder: &Folder, line: &str, signal: &str, delay: Duration) -> (ExitStatus, String) {
    let log = folder.path("log");
    let mut command = folder.command(line);
    let mut child = command
        .stdout(Stdio::null())
        .stderr(File::create(&log).unwrap())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while std::fs::metadata(&log).unwrap().len() == 0 && child.try_wait().unwrap().is_none() {
        assert!(begun.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(delay);
    // It may be gone already, which the caller sees from the exit code.
    let _ = Command::new("kill")
        .args([signal, &child.id().to_string()])
        .stderr(Stdio::null())
        .status()
        .unwrap();
    let status = child.wait().unwrap();
    let said = String::from_utf8(folder.bytes("log")).unwrap();
    std::fs::remove_file(log).unwrap();
    assert!(!said.contains("panicked"), "{said}");
    (status, said)
}

#[test]
fn resuming_gives_the_same_bits() {
    let folder = Folder::with_scene(BALLS);
    folder.succeed(&format!("run scene.ron -o whole.exr -o whole.png {OPTIONS}"));
    let mut interrupted = 0;
    for delay in [0, 40, 150, 300, 600] {
        let line = format!("run scene.ron -o part.exr -o part.png {OPTIONS}");
        let (status, said) = interrupt(&folder, &line, "-INT", Duration::from_millis(delay));
        film::read_exr(&folder.path("part.exr")).unwrap();
        assert_whole_png(&folder.bytes("part.png"));
        if status.code() == Some(0) {
            continue;
        }
        interrupted += 1;
        assert_eq!(status.code(), Some(130), "{said}");
        assert!(said.contains("interrupted: writing what there is"), "{said}");
        assert!(said.contains("--resume"), "{said}");
        assert!(
            folder.names().contains(&"part.exr.partial".to_owned()),
            "{:?}",
            folder.names()
        );
        // Once more interrupted, with other tiles and threads, and then to the end.
        let line = format!("{line} --resume --tile-size 7 --threads 3");
        interrupt(&folder, &line, "-INT", Duration::from_millis(100));
        if folder.names().contains(&"part.exr.partial".to_owned()) {
            folder.succeed(&line);
        }
        assert!(
            folder.bytes("part.exr") == folder.bytes("whole.exr"),
            "interrupted after {delay} ms"
        );
        assert!(
            folder.bytes("part.png") == folder.bytes("whole.png"),
            "interrupted after {delay} ms"
        );
        assert_eq!(
            folder.names(),
            ["part.exr", "part.png", "scene.ron", "whole.exr", "whole.png"]
        );
    }
    assert!(interrupted > 1, "the render is too short to be interrupted");
}

/// Records that take a second or more, then few samples.
const CACHED: &str = "--samples 4 --resolution 32x32 --set /Render.LightTransport.indirect=IrradianceCache \
                      --set /Render.IrradianceCache.rays=8000";

#[test]
fn a_cache_that_is_not_filled_is_made_anew() {
    let folder = Folder::with_scene(BALLS);
    folder.succeed(&format!("run scene.ron -o whole.exr -o whole.png {CACHED}"));
    let line = format!("run scene.ron -o part.exr -o part.png {CACHED}");
    let mut interrupted = 0_u32;
    for delay in [50, 200, 400] {
        let (status, said) = interrupt(&folder, &line, "-INT", Duration::from_millis(delay));
        let image = film::read_exr(&folder.path("part.exr")).unwrap();
        assert_whole_png(&folder.bytes("part.png"));
        if status.code() == Some(0) {
            continue;
        }
        assert_eq!(status.code(), Some(130), "{said}");
        // Without records no path is traced.
        let pixels = image.rgb("").unwrap().pixels;
        interrupted += u32::from(pixels.iter().flatten().all(|value| *value == 0.0));
        folder.succeed(&format!("{line} --resume --threads 3"));
        for kind in ["exr", "png"] {
            let [part, whole] = ["part", "whole"].map(|name| folder.bytes(&format!("{name}.{kind}")));
            assert!(part == whole, "{kind}, interrupted after {delay} ms");
        }
        assert_eq!(
            folder.names(),
            ["part.exr", "part.png", "scene.ron", "whole.exr", "whole.png"]
        );
    }
    assert!(interrupted > 0, "the cache is filled too soon to be interrupted");
}

#[test]
fn an_interrupted_audit_leaves_nothing_or_a_whole_map() {
    let folder = Folder::with_scene(BALLS);
    // While its own methods render, then while they fill their cache: nothing is known yet.
    for own in ["--samples 4000000", CACHED] {
        let line = format!("audit scene.ron -o map.exr -o map.png --budget 1h {own}");
        let (status, said) = interrupt(&folder, &line, "-INT", Duration::from_millis(50));
        assert_eq!(status.code(), Some(130), "{said}");
        assert_eq!(folder.names(), ["scene.ron"], "{said}");
    }
    // While it traces: what is known by then is told.
    let line = "audit scene.ron -o map.exr -o map.png --budget 1h --blocks 4";
    let mut delay = Duration::from_millis(500);
    loop {
        let (status, said) = interrupt(&folder, line, "-INT", delay);
        assert_eq!(status.code(), Some(130), "{said}");
        if folder.names() != ["scene.ron"] {
            break;
        }
        assert!(delay < PATIENCE, "nothing was traced");
        delay *= 2;
    }
    assert_eq!(folder.names(), ["map.exr", "map.png", "scene.ron"]);
    assert_whole_png(&folder.bytes("map.png"));
    film::read_exr(&folder.path("map.exr")).unwrap();
}

#[test]
fn termination_writes_the_image_too() {
    let folder = Folder::with_scene(BALLS);
    for signal in ["-TERM", "-HUP"] {
        let line = "run scene.ron -o image.exr --samples 4000000";
        let (status, said) = interrupt(&folder, line, signal, Duration::from_millis(50));
        assert_eq!(status.code(), Some(130), "{said}");
        film::read_exr(&folder.path("image.exr")).unwrap();
    }
}

#[test]
fn a_checkpoint_of_another_scene_is_refused() {
    let folder = Folder::with_scene(BALLS);
    let line = "run scene.ron -o image.exr --samples 4000000";
    interrupt(&folder, line, "-INT", Duration::from_millis(50));
    for change in ["--seed 9", "--set /Render.Film.exposure=1", "--resolution 8x8"] {
        let ran = folder.run(&format!("{line} --resume {change}"));
        assert_eq!(ran.code, Some(2), "{change}\n{}", ran.stderr);
        assert!(ran.stderr.contains("image.exr.partial"), "{}", ran.stderr);
    }
    folder.write("image.exr.partial", "rubbish");
    let ran = folder.run(&format!("{line} --resume"));
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
    assert!(ran.stderr.contains("image.exr.partial"), "{}", ran.stderr);
}

#[test]
fn nothing_to_resume_is_a_warning() {
    let folder = Folder::with_scene(BALLS);
    let ran = folder.succeed("run scene.ron -o image.exr --resume");
    assert!(ran.stderr.contains("image.exr.partial"), "{}", ran.stderr);
}
