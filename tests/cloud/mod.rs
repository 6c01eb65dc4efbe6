//! Reading the point clouds that `photons` and `records` write.

use std::path::Path;

/// The header of a PLY file, the number of its points, and the bytes of the points.
pub(crate) fn read_cloud(path: impl AsRef<Path>) -> (String, usize, Vec<u8>) {
    const END: &[u8] = b"end_header\n";
    let mut written = std::fs::read(path).expect("a file that was written");
    let is_end = |window: &[u8]| window == END;
    let end = written.windows(END.len()).position(is_end).expect("a header") + END.len();
    let header = std::str::from_utf8(&written[..end]).expect("text").to_owned();
    let count = header.lines().find_map(|line| line.strip_prefix("element vertex "));
    let count = count.expect("a count").parse().expect("a number");
    (header, count, written.split_off(end))
}
