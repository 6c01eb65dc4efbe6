//! Photon maps on disk, to be taken up again by another render or read by other programs.
//!
//! Little-endian throughout:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `PIPEPHOT` |
//! | 4 | version, 1 |
//! | 32 | key: a hash of whatever decides the photons |
//! | 24 | origin: the point of the scene file's world that positions count from, three f64 in metres |
//! | 4 | number of maps |
//! | 4 + 8 | of each map: kind (0 direct, 1 caustic, 2 indirect), number n of photons |
//! | 40 n | its photons: position (3 f32, metres), flux (3 f32, W), direction and normal (u32, octahedral), path and bounce (u32) |
//! | 8 | checksum of everything before: FNV-1a, 64 bits |
//!
//! Photons stand in (path, bounce) order, their flux divided by the number emitted.

use crate::checked_file::{CheckedFileError, CheckedReader, CheckedWriter, FileKind};
use crate::{Photon, SceneOrigin};
use radiometry::Rgb;
use std::io::{self, Read, Write};
use transport::MapKind;

const KIND: FileKind = FileKind {
    magic: *b"PIPEPHOT",
    version: 1,
    noun: "photon",
    command: "photons",
};

/// Bytes of a photon.
const PHOTON_BYTES: usize = 40;

/// The photons of one map.
pub type PhotonsOfKind = (MapKind, Vec<Photon>);

/// Why a photon file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PhotonFileError {
    /// It is no whole file of photons.
    #[error(transparent)]
    File(#[from] CheckedFileError),
    /// It belongs to another scene or other settings.
    #[error(
        "its photons belong to another scene, seed or resolution, or to other settings; write it anew with `pipeline photons` and the same options"
    )]
    Key,
    /// A map is of no kind, or there twice.
    #[error("it is damaged: its maps are not one of each kind; write it anew with `pipeline photons`")]
    Kind,
    /// A photon has no place or no flux.
    #[error(
        "it is damaged: photon {row} of the {kind} map is not finite or has negative flux; write it anew with `pipeline photons`"
    )]
    BadPhoton {
        /// Name of its map.
        kind: &'static str,
        /// Its place in the map.
        row: u64,
    },
}

impl From<io::Error> for PhotonFileError {
    fn from(error: io::Error) -> Self {
        Self::File(CheckedFileError::Io(error))
    }
}

/// Writes photon maps so that [`read_photons`] restores them bit for bit.
///
/// - `key`: a hash of everything that must agree for the photons to be of use.
///
/// # Errors
/// Whatever the writer reports. Give it a buffered one, within [`film::atomic_write`].
pub fn write_photons(
    writer: &mut impl Write,
    key: &[u8; 32],
    origin: SceneOrigin,
    maps: &[PhotonsOfKind],
) -> io::Result<()> {
    let mut file = CheckedWriter::begin(writer, &KIND)?;
    file.put(key)?;
    for coordinate in origin.0.to_array() {
        file.put(&coordinate.to_le_bytes())?;
    }
    file.put(&(maps.len() as u32).to_le_bytes())?;
    for (kind, photons) in maps {
        file.put(&(*kind as u32).to_le_bytes())?;
        file.put(&(photons.len() as u64).to_le_bytes())?;
        for photon in photons {
            file.put(&bytes_of(photon))?;
        }
    }
    file.end()
}

/// Reads photon maps that [`write_photons`] wrote.
///
/// - `key`: that of this render; the file must agree.
///
/// # Errors
/// A [`PhotonFileError`] that says what is wrong. No photon of a bad file gets through.
pub fn read_photons(reader: &mut impl Read, key: &[u8; 32]) -> Result<Vec<PhotonsOfKind>, PhotonFileError> {
    let mut file = CheckedReader::begin(reader, KIND)?;
    if file.take::<32>()? != *key {
        return Err(PhotonFileError::Key);
    }
    // The key covers the geometry, and so the origin; it stands there for other programs.
    file.take::<24>()?;
    let count = u32::from_le_bytes(file.take()?);
    if count as usize > MapKind::COUNT {
        return Err(PhotonFileError::Kind);
    }
    let mut maps: Vec<PhotonsOfKind> = Vec::new();
    for _ in 0..count {
        let number = u32::from_le_bytes(file.take()?);
        let kind = MapKind::ALL.into_iter().find(|kind| *kind as u32 == number);
        let kind = kind.ok_or(PhotonFileError::Kind)?;
        if maps.iter().any(|(known, _)| *known == kind) {
            return Err(PhotonFileError::Kind);
        }
        let photons = file.rows(|bytes, row| good_photon(bytes, kind, row))?;
        maps.push((kind, photons));
    }
    file.end()?;
    Ok(maps)
}

fn good_photon(bytes: &[u8; PHOTON_BYTES], kind: MapKind, row: u64) -> Result<Photon, PhotonFileError> {
    let photon = photon_of(bytes);
    let is_good = photon.position.iter().all(|value| value.is_finite())
        && photon
            .flux
            .to_array()
            .iter()
            .all(|value| value.is_finite() && *value >= 0.0);
    let kind = kind.name();
    is_good
        .then_some(photon)
        .ok_or(PhotonFileError::BadPhoton { kind, row })
}

fn bytes_of(photon: &Photon) -> [u8; PHOTON_BYTES] {
    let [x, y, z] = photon.position.map(f32::to_bits);
    let [r, g, b] = photon.flux.to_array().map(f32::to_bits);
    let words = [
        x,
        y,
        z,
        r,
        g,
        b,
        photon.direction,
        photon.normal,
        photon.path,
        photon.bounce,
    ];
    let mut bytes = [0; PHOTON_BYTES];
    for (place, word) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(words) {
        *place = word.to_le_bytes();
    }
    bytes
}

fn photon_of(bytes: &[u8; PHOTON_BYTES]) -> Photon {
    let words = bytes.as_chunks::<4>().0;
    let word = |i: usize| u32::from_le_bytes(words[i]);
    let number = |i: usize| f32::from_bits(word(i));
    Photon {
        position: [number(0), number(1), number(2)],
        flux: Rgb::new(number(3), number(4), number(5)),
        direction: word(6),
        normal: word(7),
        path: word(8),
        bounce: word(9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: [u8; 32] = [7; 32];

    fn maps() -> Vec<PhotonsOfKind> {
        let photon = |path: u32| Photon {
            position: [path as f32, -1.5, 2.0],
            flux: Rgb::new(0.25, 0.5, path as f32),
            direction: path << 20,
            normal: 5,
            path,
            bounce: 2,
        };
        vec![
            (MapKind::Indirect, (0..9000).map(photon).collect()),
            (MapKind::Direct, vec![]),
        ]
    }

    fn written() -> Vec<u8> {
        let mut bytes = Vec::new();
        write_photons(&mut bytes, &KEY, SceneOrigin::default(), &maps()).unwrap();
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Vec<PhotonsOfKind>, PhotonFileError> {
        read_photons(&mut &*bytes, &KEY)
    }

    fn is_cut_off(error: &PhotonFileError) -> bool {
        matches!(error, PhotonFileError::File(CheckedFileError::Truncated { .. }))
    }

    #[test]
    fn what_is_written_is_read_again() {
        assert_eq!(read(&written()).unwrap(), maps());
    }

    #[test]
    fn every_damage_is_found() {
        let good = written();
        for length in (0..good.len()).step_by(997).chain([good.len() - 1]) {
            let error = read(&good[..length]).unwrap_err();
            assert!(is_cut_off(&error), "{length}: {error}");
        }
        for place in (0..good.len()).step_by(499).chain(0..100) {
            let mut bad = good.clone();
            bad[place] ^= 0x41;
            // The origin counts in the checksum alone.
            assert!(read(&bad).is_err(), "byte {place} may be anything");
        }
    }

    #[test]
    fn a_file_that_claims_too_much_takes_no_memory_for_it() {
        let mut bytes = written()[..KIND.magic.len() + 4 + 32 + 24].to_vec();
        bytes.extend(1_u32.to_le_bytes());
        bytes.extend(0_u32.to_le_bytes());
        bytes.extend(u64::MAX.to_le_bytes());
        assert!(is_cut_off(&read(&bytes).unwrap_err()));
    }

    #[test]
    fn photons_without_a_place_are_refused() {
        let mut maps = maps();
        maps[0].1[3].position[1] = f32::NAN;
        let mut bytes = Vec::new();
        write_photons(&mut bytes, &KEY, SceneOrigin::default(), &maps).unwrap();
        let error = read(&bytes).unwrap_err();
        assert!(matches!(error, PhotonFileError::BadPhoton { row: 3, .. }), "{error}");
    }
}
