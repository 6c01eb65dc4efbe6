//! Arguments: help, mistakes, exit codes.

use crate::program::{BALLS, Folder};

#[test]
fn help_goes_to_standard_output() {
    let ran = Folder::new().succeed("--help");
    assert_eq!(ran.stderr, "");
    insta::assert_snapshot!(ran.stdout, @"
    A global-illumination renderer whose data lives in an ECS

    Usage: pipeline <COMMAND>

    Commands:
      run      Render a scene to image files
      check    Load and check a scene, render nothing
      flatten  Write a composed scene as one layer without arcs
      explain  Say why a value is what it is: every opinion about it, and why each loser loses
      schema   List what a scene can say: components, fields, types, units, ranges, defaults
      stages   List schedules, sets and systems in the order they run
      profile  Render a scene and print what every system cost
      photons  Draw the photons of a scene as points, or write them to a file
      records  Draw the irradiance records of a scene as points, or write them to a file
      compare  Measure how far an image is from a reference
      audit    Look for bias: trace random parts of a scene, and test its own methods against them
      help     Print this message or the help of the given subcommand(s)

    Options:
      -h, --help     Print help
      -V, --version  Print version

    Exit codes: 0 done, 1 render or I/O failed, 2 bad command line or bad scene, 130 interrupted (image written).
    ");
    for command in [
        "run", "check", "flatten", "explain", "schema", "stages", "profile", "photons", "records", "compare", "audit",
    ] {
        let ran = Folder::new().succeed(&format!("{command} --help"));
        assert!(
            ran.stdout.contains(&format!("Usage: pipeline {command}")),
            "{}",
            ran.stdout
        );
    }
    assert!(Folder::new().succeed("--version").stdout.starts_with("pipeline "));
}

#[test]
fn mistakes_exit_with_2_and_say_what_is_expected() {
    let folder = Folder::with_scene(BALLS);
    for (line, expected) in [
        ("", "Usage: pipeline <COMMAND>"),
        ("rnu scene.ron", "'rnu'"),
        ("run", "<SCENE>"),
        ("run scene.ron --sample 3", "'--samples'"),
        ("run scene.ron -o image.jpg", "must end in .exr or .png"),
        ("run scene.ron -o image", "must end in .exr or .png"),
        ("photons scene.ron -o a.exr", "must end in .png, .ply or .photons"),
        ("records scene.ron -o a.exr", "must end in .png, .ply or .records"),
        ("records scene.ron", "--output <FILE>"),
        (
            "records scene.ron -o a.png",
            "add `--set /Render.LightTransport.indirect=IrradianceCache`",
        ),
        ("run scene.ron --samples 0", "0 is not in 1.."),
        ("run scene.ron --samples many", "invalid digit"),
        ("run scene.ron --threads 0", "0 is not in 1..=1024"),
        ("run scene.ron --threads 100000", "not in"),
        ("run scene.ron --tile-size 0", "0 is not in 1..=1024"),
        ("run scene.ron --seed -1", "'-1'"),
        ("run scene.ron --time-limit soon", "such as 30s, 2m, 1h or 500ms"),
        ("run scene.ron --time-limit 3days", "use ms, s, m or h"),
        ("run scene.ron --time-limit 0s", "above 0"),
        ("run scene.ron --resolution 640", "such as 640x480"),
        ("run scene.ron --resolution 0x480", "from 1 to 65536"),
        ("run scene.ron --resolution 999999x480", "from 1 to 65536"),
        ("run scene.ron --crop 1,2,3", "such as 0,0,64,64"),
        ("run scene.ron --crop 5,5,5,9", "the crop is empty"),
        ("run scene.ron --crop 0,0,33,8", "crop"),
        ("run scene.ron --frame NaN", "give a number"),
        ("run scene.ron --set /Nowhere.Film.exposure=1", "/Nowhere"),
        ("run scene.ron --set nonsense", "nonsense"),
        ("run scene.ron --variant nonsense", "nonsense"),
        ("run none.ron", "none.ron"),
        ("profile scene.ron --resume", "give them with -o"),
        ("run scene.ron -o a.png -o ./a.png", "./a.png is to be written twice"),
        (
            "run scene.ron --profile t.json --trace t.json",
            "t.json is to be written twice",
        ),
        (
            "profile scene.ron -o a.exr --trace a.exr",
            "a.exr is to be written twice",
        ),
        ("schema Camra", "did you mean `Camera`?"),
        ("compare one.exr", "<REFERENCE>"),
        ("compare one.exr two.exr", "one.exr"),
        ("stages none.ron", "none.ron"),
    ] {
        let ran = folder.run(line);
        assert_eq!(ran.code, Some(2), "{line}\n{}", ran.stderr);
        assert!(ran.stderr.contains(expected), "{line}\n{}", ran.stderr);
        assert_eq!(ran.stdout, "", "{line}");
    }
    assert_eq!(folder.names(), ["scene.ron"], "nothing may be written");
}

#[test]
fn places_that_cannot_be_written_fail_before_the_render() {
    let folder = Folder::with_scene(BALLS);
    folder.write("file", "");
    for path in ["none/image.exr", "file/image.png"] {
        let ran = folder.run(&format!("run scene.ron -o {path}"));
        assert_eq!(ran.code, Some(1), "{}", ran.stderr);
        assert!(
            ran.stderr.contains(path) && ran.stderr.contains("choose another place"),
            "{}",
            ran.stderr
        );
        assert!(!ran.stderr.contains("rendering"), "{}", ran.stderr);
    }
}
