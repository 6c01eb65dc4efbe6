//! Values of options: from text to numbers, with messages that say what is expected.

use std::path::{Path, PathBuf};
use std::time::Duration;

/// More threads than any machine this was written for has; above it, it is a slip of the finger.
pub(crate) const MAX_THREADS: i64 = 1024;
/// Above it, a tile holds more than a wave of paths.
pub(crate) const MAX_TILE: i64 = 1024;
/// Longest time limit: a year.
const MAX_SECONDS: f64 = 366.0 * 24.0 * 3600.0;

/// A file to write an image to.
pub(crate) fn output(text: &str) -> Result<PathBuf, String> {
    match Format::of(Path::new(text)) {
        Some(_) => Ok(text.into()),
        None => Err("the name must end in .exr or .png".into()),
    }
}

/// A kind of image file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    Exr,
    Png,
}

impl Format {
    /// The kind that the extension of a path asks for.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "exr" => Some(Self::Exr),
            "png" => Some(Self::Png),
            _ => None,
        }
    }
}

/// A file to write photons to.
pub(crate) fn photon_output(text: &str) -> Result<PathBuf, String> {
    cache_output(text, "photons")
}

/// A file to write records to.
pub(crate) fn record_output(text: &str) -> Result<PathBuf, String> {
    cache_output(text, "records")
}

fn cache_output(text: &str, own: &str) -> Result<PathBuf, String> {
    match CacheFormat::of(Path::new(text), own) {
        Some(_) => Ok(text.into()),
        None => Err(format!("the name must end in .png, .ply or .{own}")),
    }
}

/// A kind of file of photons or of records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CacheFormat {
    Png,
    Ply,
    /// The one that a render takes up again.
    Own,
}

impl CacheFormat {
    /// The kind that the extension of a path asks for.
    ///
    /// - `own`: the extension of files that a render takes up again.
    pub(crate) fn of(path: &Path, own: &str) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "png" => Some(Self::Png),
            "ply" => Some(Self::Ply),
            extension if extension == own => Some(Self::Own),
            _ => None,
        }
    }
}

/// A length of time: `90`, `30s`, `2m`, `1.5h`, `500ms`.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    let unit_at = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(unit_at);
    let number: f64 = number
        .trim()
        .parse()
        .map_err(|_| "give a number with a unit, such as 30s, 2m, 1h or 500ms".to_owned())?;
    let unit = match unit {
        "ms" => 0.001,
        "" | "s" => 1.0,
        "m" | "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(format!("`{unit}` is no unit of time; use ms, s, m or h")),
    };
    let seconds = number * unit;
    if seconds > 0.0 && seconds <= MAX_SECONDS {
        Ok(Duration::from_secs_f64(seconds))
    } else {
        Err("give a time above 0 and up to a year".into())
    }
}

/// A relative error: `2%`, `0.02`; above 0 and below 1.
pub(crate) fn relative_error(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix('%') {
        Some(number) => (number, 0.01),
        None => (text, 1.0),
    };
    match number.trim().parse::<f64>() {
        Ok(number) if number * scale > 0.0 && number * scale < 1.0 => Ok(number * scale),
        _ => Err("give an error above 0 and below 100 %, such as 2% or 0.02".into()),
    }
}

/// A share from 0 and below 1: `1%`, `0.01`.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    match text.trim().trim_end_matches('%').parse::<f64>() {
        Ok(0.0) => Ok(0.0),
        _ => relative_error(text).map_err(|_| "give a share from 0 and below 100 %, such as 1% or 0.01".into()),
    }
}

/// A share above a half and below 1: `99%`, `0.99`.
pub(crate) fn confidence(text: &str) -> Result<f64, String> {
    match relative_error(text) {
        Ok(share) if share > 0.5 => Ok(share),
        _ => Err("give a share above 50 % and below 100 %, such as 99% or 0.99".into()),
    }
}

/// Width and height in pixels: `640x480`.
pub(crate) fn resolution(text: &str) -> Result<[u32; 2], String> {
    let (width, height) = text
        .split_once(['x', 'X'])
        .ok_or("give width and height in pixels, such as 640x480")?;
    let side = |text: &str| match text.trim().parse() {
        Ok(side) if (1..=film::MAX_SIDE).contains(&side) => Ok(side),
        _ => Err(format!("each side must be a whole number from 1 to {}", film::MAX_SIDE)),
    };
    Ok([side(width)?, side(height)?])
}

/// A part of the film in pixels: `X0,Y0,X1,Y1`, the latter two exclusive.
pub(crate) fn crop(text: &str) -> Result<[u32; 4], String> {
    let numbers: Vec<u32> = text
        .split(',')
        .map(|part| part.trim().parse().ok())
        .collect::<Option<_>>()
        .ok_or("give four whole numbers, such as 0,0,64,64")?;
    match <[u32; 4]>::try_from(numbers) {
        Ok([x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok([x0, y0, x1, y1]),
        Ok(_) => {
            Err("the crop is empty; X1 and Y1 are the pixel after the last, so they must be above X0 and Y0".into())
        }
        Err(_) => Err("give four whole numbers, such as 0,0,64,64".into()),
    }
}

/// A limit of scenes: `prims=2000000`.
pub(crate) fn limit(text: &str) -> Result<(String, usize), String> {
    let (name, value) = text
        .split_once('=')
        .ok_or("give a name and a number, such as prims=2000000")?;
    if !scene_format::Limits::NAMES.contains(&name) {
        let names = scene_format::Limits::NAMES.join(", ");
        return Err(format!("there is no limit `{name}`; there are {names}"));
    }
    match value.parse() {
        Ok(value) => Ok((name.to_owned(), value)),
        Err(_) => Err("give a whole number from 0".into()),
    }
}

/// A number that is neither infinite nor NaN.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err("give a number".into()),
    }
}

/// A number from 0.
pub(crate) fn not_negative(text: &str) -> Result<f64, String> {
    match finite(text) {
        Ok(number) if number >= 0.0 => Ok(number),
        _ => Err("give a number from 0".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_have_units() {
        let ms = |text| duration(text).unwrap().as_millis();
        assert_eq!(ms("30s"), 30_000);
        assert_eq!(ms("2m"), 120_000);
        assert_eq!(ms("1.5h"), 5_400_000);
        assert_eq!(ms("500ms"), 500);
        assert_eq!(ms("90"), 90_000);
        for bad in ["", "s", "-3s", "0", "3 days", "NaN", "inf", "1e300h", "30 s s"] {
            assert!(duration(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn shares_are_checked() {
        assert_eq!((share("1%"), share("0"), share("0.5")), (Ok(0.01), Ok(0.0), Ok(0.5)));
        assert_eq!((confidence("99%"), confidence("0.95")), (Ok(0.99), Ok(0.95)));
        for bad in ["", "%", "-1%", "100%", "1", "NaN", "inf%", "1e400"] {
            assert!(share(bad).is_err() && confidence(bad).is_err(), "{bad}");
        }
        assert!(confidence("50%").is_err());
    }

    #[test]
    fn sizes_are_checked() {
        assert_eq!(resolution("640x480"), Ok([640, 480]));
        for bad in ["640", "0x1", "1x0", "70000x1", "-1x1", "x", "1x1x1", "1.5x1"] {
            assert!(resolution(bad).is_err(), "{bad}");
        }
        assert_eq!(crop("0, 1,2,3"), Ok([0, 1, 2, 3]));
        for bad in ["", "0,0,1", "0,0,0,1", "5,0,1,1", "0,0,1,1,1", "-1,0,1,1", "a,b,c,d"] {
            assert!(crop(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn limits_have_names() {
        assert_eq!(limit("prims=5"), Ok(("prims".to_owned(), 5)));
        for bad in ["prims", "prms=5", "prims=-1", "prims=many", "=", ""] {
            assert!(limit(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn outputs_have_a_known_extension() {
        assert!(output("a.exr").is_ok() && output("b/c.d.PNG").is_ok());
        for bad in ["a.jpg", "a", "", ".exr", "exr", "a.exr.gz"] {
            assert!(output(bad).is_err(), "{bad}");
        }
        assert!(photon_output("a.photons").is_ok() && record_output("a.Records").is_ok());
        assert!(photon_output("a.records").is_err() && record_output("a.photons").is_err());
    }
}
