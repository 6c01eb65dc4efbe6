//! The image depends on the scene alone.

use crate::program::{BALLS, Folder};

#[test]
fn threads_and_tiles_change_no_bit() {
    let folder = Folder::with_scene(BALLS);
    folder.succeed("run scene.ron -o first.exr -o first.png --threads 1 --tile-size 32");
    for threads in 1..=3 {
        for tile in [8, 32, 5] {
            let options = format!("--threads {threads} --tile-size {tile}");
            folder.succeed(&format!("run scene.ron -o other.exr -o other.png {options}"));
            assert!(folder.bytes("other.exr") == folder.bytes("first.exr"), "{options}");
            assert!(folder.bytes("other.png") == folder.bytes("first.png"), "{options}");
        }
    }
    let image = film::read_exr(&folder.path("first.exr")).unwrap();
    let caustic = image.rgb("caustic").unwrap();
    assert!(
        caustic.pixels.iter().flatten().any(|value| *value > 0.0),
        "the photon map must take part"
    );
}

#[test]
fn the_place_of_the_scene_changes_no_bit() {
    let (here, there) = (Folder::with_scene(BALLS), Folder::with_scene(BALLS));
    here.succeed("run scene.ron -o image.exr");
    there.succeed("run scene.ron -o image.exr");
    assert!(here.bytes("image.exr") == there.bytes("image.exr"));
}
