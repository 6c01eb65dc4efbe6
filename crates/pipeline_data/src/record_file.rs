//! Irradiance records on disk, to be taken up again by another render or read by other programs.
//!
//! Little-endian throughout:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `PIPERECS` |
//! | 4 | version, 2 |
//! | 32 | first key: a hash of whatever decides the light of the records |
//! | 32 | second key: a hash of the view that they were made for |
//! | 8 | checksum of a file for another view that these began with, 0 if there was none |
//! | 24 | origin: the point of the scene file's world that positions count from, three f64 in metres |
//! | 8 | of each depth, that of the records that the eye reads first: number n of records |
//! | 120 n | its records, numbers in f32: position (3, metres), normal (3, unit), irradiance (3, W·m⁻²), its gradient as the normal turns (9, W·m⁻² per radian: x, y, z of red, of green, of blue) and as the place moves (9, W·m⁻³), range, least range, distance of what is nearest (metres, infinite where there is nothing) |
//! | 8 | checksum of everything before: FNV-1a, 64 bits |
//!
//! Records stand in the order in which they were made, their ranges as neighbours have left them.

use crate::checked_file::{CheckedFileError, CheckedReader, CheckedWriter, FileKind};
use crate::{RECORD_DEPTHS, SceneOrigin};
use bevy_ecs::resource::Resource;
use radiometry::Rgb;
use std::io::{self, Read, Write};
use transport::{IrradianceRecord, RgbGradient};

const KIND: FileKind = FileKind {
    magic: *b"PIPERECS",
    version: 2,
    noun: "record",
    command: "records",
};

/// Numbers of a record.
const NUMBERS: usize = size_of::<IrradianceRecord>() / size_of::<f32>();
/// Bytes of a record.
const RECORD_BYTES: usize = NUMBERS * size_of::<f32>();

/// What the square of the length of a normal may be off by.
const UNIT_TOLERANCE: f32 = 1e-3;

/// What records have to agree with to be of use again. Written by `irradiance_cache`; absent where records change during a
/// render.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordKeys {
    /// A hash of all that decides the light of the records. Without it they are of no use.
    pub light: [u8; 32],
    /// A hash of all that decides which places are asked. Records for another view are a beginning.
    pub view: [u8; 32],
}

/// Checksum of the file of records for another view that the cache began with: the image has other bits than without. Written by
/// `irradiance_cache`; absent where there was none.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct BorrowedRecords(pub u64);

/// What a file of records holds.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredRecords {
    /// Whether they were made for the same view, so that none is missing.
    pub is_complete: bool,
    /// What an image of them depends on: this file, if it is for another view, or the one for another view that it began with.
    pub borrowed: Option<BorrowedRecords>,
    /// By depth and number.
    pub records: RecordsByDepth,
}

/// The records of each depth, by number.
pub type RecordsByDepth = [Vec<IrradianceRecord>; RECORD_DEPTHS];

/// Why a record file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordFileError {
    /// It is no whole file of records.
    #[error(transparent)]
    File(#[from] CheckedFileError),
    /// Its light is another.
    #[error(
        "its records belong to another scene, light or seed, or to other settings; only camera and film may differ: write it anew with `pipeline records` and the same options"
    )]
    Key,
    /// A record cannot be one.
    #[error("it is damaged: {what} of record {row} {must}; write it anew with `pipeline records`")]
    BadRecord {
        /// What is wrong about it.
        what: &'static str,
        /// What it must be.
        must: &'static str,
        /// Its number.
        row: u64,
    },
}

impl From<io::Error> for RecordFileError {
    fn from(error: io::Error) -> Self {
        Self::File(CheckedFileError::Io(error))
    }
}

/// Writes records so that [`read_records`] restores them bit for bit.
///
/// - `borrowed`: what the cache began with.
///
/// # Errors
/// Whatever the writer reports. Give it a buffered one, within [`film::atomic_write`].
pub fn write_records(
    writer: &mut impl Write,
    keys: &RecordKeys,
    borrowed: Option<BorrowedRecords>,
    origin: SceneOrigin,
    records: &RecordsByDepth,
) -> io::Result<()> {
    let mut file = CheckedWriter::begin(writer, &KIND)?;
    file.put(&keys.light)?;
    file.put(&keys.view)?;
    file.put(&borrowed.map_or(0, |borrowed| borrowed.0).to_le_bytes())?;
    for coordinate in origin.0.to_array() {
        file.put(&coordinate.to_le_bytes())?;
    }
    for records in records {
        file.put(&(records.len() as u64).to_le_bytes())?;
        for record in records {
            file.put(&bytes_of(*record))?;
        }
    }
    file.end()
}

/// Reads records that [`write_records`] wrote.
///
/// - `keys`: those of this render; the light of the file must agree.
///
/// # Errors
/// A [`RecordFileError`] that says what is wrong. No record of a bad file gets through.
pub fn read_records(reader: &mut impl Read, keys: &RecordKeys) -> Result<StoredRecords, RecordFileError> {
    let mut file = CheckedReader::begin(reader, KIND)?;
    if file.take()? != keys.light {
        return Err(RecordFileError::Key);
    }
    let is_complete = file.take()? == keys.view;
    let began_with = u64::from_le_bytes(file.take()?);
    // The key covers the geometry, and so the origin; it stands there for other programs.
    file.take::<24>()?;
    let mut records = RecordsByDepth::default();
    for records in &mut records {
        *records = file.rows(good_record)?;
    }
    let checksum = file.end()?;
    let borrowed = if is_complete { began_with } else { checksum };
    Ok(StoredRecords {
        is_complete,
        borrowed: (borrowed != 0).then_some(BorrowedRecords(borrowed)),
        records,
    })
}

/// Goes through the numbers of a record, in the order of the file. Whatever a record gains or loses is a line here.
fn each_number(record: &mut IrradianceRecord, mut visit: impl FnMut(&mut f32)) {
    let mut vector = |v: &mut [f32; 3]| v.iter_mut().for_each(&mut visit);
    vector(record.position.as_mut());
    vector(record.normal.as_mut());
    rgb(&mut record.irradiance, &mut vector);
    gradient(&mut record.rotation, &mut vector);
    gradient(&mut record.translation, &mut vector);
    visit(&mut record.range);
    visit(&mut record.least_range);
    visit(&mut record.nearest);
}

fn rgb(value: &mut Rgb, visit: &mut impl FnMut(&mut [f32; 3])) {
    let mut channels = value.to_array();
    visit(&mut channels);
    let [r, g, b] = channels;
    *value = Rgb::new(r, g, b);
}

fn gradient(value: &mut RgbGradient, visit: &mut impl FnMut(&mut [f32; 3])) {
    value.0.iter_mut().for_each(|channel| visit(channel.as_mut()));
}

fn bytes_of(mut record: IrradianceRecord) -> [u8; RECORD_BYTES] {
    let mut bytes = [0; RECORD_BYTES];
    let mut places = bytes.as_chunks_mut::<4>().0.iter_mut();
    each_number(&mut record, |number| {
        if let Some(place) = places.next() {
            *place = number.to_le_bytes();
        }
    });
    bytes
}

fn record_of(bytes: &[u8; RECORD_BYTES]) -> IrradianceRecord {
    let mut record = IrradianceRecord::default();
    let mut words = bytes.as_chunks::<4>().0.iter();
    each_number(&mut record, |number| {
        if let Some(word) = words.next() {
            *number = f32::from_le_bytes(*word);
        }
    });
    record
}

/// A record that the cache can live with, as all that it makes.
fn good_record(bytes: &[u8; RECORD_BYTES], row: u64) -> Result<IrradianceRecord, RecordFileError> {
    let record = record_of(bytes);
    let IrradianceRecord { position, normal, .. } = record;
    let gradients = [record.rotation, record.translation];
    let mut light = record.irradiance.to_array().into_iter();
    let checks = [
        (position.is_finite(), "the position", "must be finite"),
        (
            (normal.length_squared() - 1.0).abs() <= UNIT_TOLERANCE,
            "the normal",
            "must have length 1",
        ),
        (
            light.all(|value| value.is_finite() && value >= 0.0),
            "the irradiance",
            "must be finite and not negative",
        ),
        (
            gradients.iter().all(|g| g.0.iter().all(|v| v.is_finite())),
            "a gradient",
            "must be finite",
        ),
        (
            record.range.is_finite() && record.range > 0.0,
            "the range",
            "must be finite and above 0",
        ),
        (
            record.least_range.is_finite() && record.least_range >= 0.0,
            "the least range",
            "must be finite and not negative",
        ),
        (record.nearest > 0.0, "the nearest distance", "must be above 0"),
    ];
    match checks.into_iter().find(|(is_good, ..)| !is_good) {
        Some((_, what, must)) => Err(RecordFileError::BadRecord { what, must, row }),
        None => Ok(record),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const KEYS: RecordKeys = RecordKeys {
        light: [7; 32],
        view: [8; 32],
    };

    const BORROWED: Option<BorrowedRecords> = Some(BorrowedRecords(5));

    fn record(i: u32) -> IrradianceRecord {
        let number = i as f32;
        let slope = |scale: f32| RgbGradient([0.0, 1.0, 2.0].map(|c| Vec3::new(scale, -c, number)));
        IrradianceRecord {
            position: Vec3::new(number, -1.5, 2.0),
            normal: [Vec3::X, Vec3::Y, Vec3::NEG_Z][i as usize % 3],
            irradiance: Rgb::new(0.25, 0.5, number),
            rotation: slope(3.0),
            translation: slope(-5.0),
            range: 0.5 + number,
            least_range: 0.125,
            nearest: if i == 2 { f32::INFINITY } else { 0.25 },
        }
    }

    fn records() -> RecordsByDepth {
        [5000, 0, 7].map(|count| (0..count).map(record).collect())
    }

    fn bytes_with(records: &RecordsByDepth) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_records(&mut bytes, &KEYS, BORROWED, SceneOrigin::default(), records).unwrap();
        bytes
    }

    fn read(bytes: &[u8]) -> Result<StoredRecords, RecordFileError> {
        read_records(&mut &*bytes, &KEYS)
    }

    fn is_cut_off(error: &RecordFileError) -> bool {
        matches!(error, RecordFileError::File(CheckedFileError::Truncated { .. }))
    }

    #[test]
    fn every_number_of_a_record_has_its_place() {
        let mut count = 0;
        each_number(&mut record(1), |_| count += 1);
        assert_eq!(count, NUMBERS);
    }

    #[test]
    fn what_is_written_is_read_again() {
        let stored = read(&bytes_with(&records())).unwrap();
        assert!(stored.is_complete && stored.borrowed == BORROWED && stored.records == records());
        let of_another_view = RecordKeys { view: [9; 32], ..KEYS };
        let stored = read_records(&mut &*bytes_with(&records()), &of_another_view).unwrap();
        assert!(!stored.is_complete && stored.records == records());
        // The image depends on this file then.
        assert!(stored.borrowed.is_some() && stored.borrowed != BORROWED);
        let of_other_light = RecordKeys { light: [9; 32], ..KEYS };
        let error = read_records(&mut &*bytes_with(&records()), &of_other_light).unwrap_err();
        assert!(matches!(error, RecordFileError::Key), "{error}");
    }

    #[test]
    fn every_damage_is_found() {
        let good = bytes_with(&records());
        for length in (0..good.len()).step_by(2503).chain([good.len() - 1]) {
            let error = read(&good[..length]).unwrap_err();
            assert!(is_cut_off(&error), "{length}: {error}");
        }
        for place in (0..good.len()).step_by(5003).chain(0..200) {
            let mut bad = good.clone();
            bad[place] ^= 0x41;
            assert!(read(&bad).is_err(), "byte {place} may be anything");
        }
    }

    #[test]
    fn a_file_that_claims_too_much_takes_no_memory_for_it() {
        let mut bytes = bytes_with(&RecordsByDepth::default())[..8 + 4 + 32 + 32 + 8 + 24].to_vec();
        bytes.extend(u64::MAX.to_le_bytes());
        assert!(is_cut_off(&read(&bytes).unwrap_err()));
    }

    #[test]
    fn records_that_cannot_be_are_refused() {
        type Spoil = fn(&mut IrradianceRecord);
        let spoilers: [(&str, Spoil); 9] = [
            ("position", |record| record.position.y = f32::NAN),
            ("normal", |record| record.normal = Vec3::splat(1.0)),
            ("normal", |record| record.normal.x = f32::NAN),
            ("irradiance", |record| record.irradiance.g = -1e-6),
            ("irradiance", |record| record.irradiance.b = f32::INFINITY),
            ("gradient", |record| record.rotation.0[1].z = f32::NAN),
            ("range", |record| record.range = 0.0),
            ("least range", |record| record.least_range = f32::INFINITY),
            ("nearest", |record| record.nearest = f32::NAN),
        ];
        for (expected, spoil) in spoilers {
            let mut records = records();
            spoil(&mut records[0][3]);
            let error = read(&bytes_with(&records)).unwrap_err();
            assert!(matches!(error, RecordFileError::BadRecord { row: 3, .. }), "{error}");
            assert!(error.to_string().contains(expected), "{error}");
        }
    }
}
