//! Disks that are full, and readers that go away.

#![cfg(unix)]

use crate::program::{BALLS, Folder, binary, finish};
use std::io::Read;
use std::process::{Command, Stdio};

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_with_a_remedy() {
    let folder = Folder::with_scene(BALLS);
    for name in ["full.exr", "full.png"] {
        std::os::unix::fs::symlink("/dev/full", folder.path(name)).unwrap();
        let ran = folder.run(&format!("run scene.ron -o {name}"));
        assert_eq!(ran.code, Some(1), "{}", ran.stderr);
        assert!(
            ran.stderr.contains(name) && ran.stderr.contains("free some space"),
            "{}",
            ran.stderr
        );
    }
}

#[test]
fn a_quota_keeps_the_old_files() {
    let folder = Folder::with_scene(BALLS);
    folder.write("image.exr", "old");
    // The shell hands the ignored signal on, so that the limit shows as an error.
    let line = "trap '' XFSZ; ulimit -f 2; exec \"$0\" run scene.ron -o image.exr -q";
    let mut command = Command::new("sh");
    command.args(["-c", line]).arg(binary()).current_dir(folder.path(""));
    let ran = finish(&mut command);
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    assert!(ran.stderr.contains("cannot write image.exr"), "{}", ran.stderr);
    assert_eq!(folder.bytes("image.exr"), b"old");
    assert_eq!(folder.names(), ["image.exr", "scene.ron"]);
}

#[test]
fn a_reader_may_leave_early() {
    let folder = Folder::new();
    let mut child = folder
        .command("schema")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!((child.wait().unwrap().code(), said.as_str()), (Some(0), ""));
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_may_be_full() {
    let folder = Folder::new();
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut command = folder.command("schema");
    let child = command.stdout(full).stderr(Stdio::piped()).spawn().unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("standard output"));
}
