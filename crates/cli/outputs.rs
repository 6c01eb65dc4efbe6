//! Files to write: which, and whether they can be, before hours of work depend on it.

use crate::exit::Failure;
use crate::parse::Format;
use std::collections::BTreeSet;
use std::fs::{self, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// The files asked for, else an EXR and a PNG in the working directory that are named after the scene.
///
/// # Errors
/// The scene's name gives none.
pub(crate) fn or_default(asked: &[PathBuf], scene: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !asked.is_empty() {
        return Ok(asked.to_vec());
    }
    let stem = scene.file_stem().ok_or_else(|| {
        Failure::bad_input(format!(
            "`{}` is no scene file; give its path, such as scenes/ring.ron",
            scene.display()
        ))
    })?;
    let named = |extension: &str| {
        let mut name = stem.to_owned();
        name.push(".");
        name.push(extension);
        PathBuf::from(name)
    };
    Ok(vec![named("exr"), named("png")])
}

/// Makes sure that every file can be written, by making and removing a file beside it.
///
/// # Errors
/// The first that cannot.
pub(crate) fn check_writable<'p>(paths: impl IntoIterator<Item = &'p PathBuf>) -> Result<(), Failure> {
    for path in paths {
        probe(path).map_err(|error| {
            Failure::failed(format!(
                "cannot write {}: {error}; choose another place with -o",
                path.display()
            ))
        })?;
    }
    Ok(())
}

/// Makes sure that no file is written over another.
///
/// # Errors
/// The first that is named twice.
pub(crate) fn check_distinct<'p>(paths: impl IntoIterator<Item = &'p PathBuf>) -> Result<(), Failure> {
    let mut known = BTreeSet::new();
    for path in paths {
        // A folder has many names; the file need not be there yet.
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        let folder = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_path_buf());
        if !known.insert((folder, path.file_name())) {
            return Err(Failure::bad_input(format!(
                "{} is to be written twice; give each output, --profile and --trace a file of its own",
                path.display()
            )));
        }
    }
    Ok(())
}

fn probe(path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(old) if old.is_dir() => return Err(ErrorKind::IsADirectory.into()),
        Ok(old) if !old.is_file() => return Ok(()),
        Ok(old) if old.permissions().readonly() => return Err(ErrorKind::PermissionDenied.into()),
        Ok(_) => {}
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().ok_or(ErrorKind::InvalidInput)?);
    name.push(format!(".{}.probe", std::process::id()));
    let beside = path.with_file_name(name);
    OpenOptions::new().write(true).create_new(true).open(&beside)?;
    fs::remove_file(&beside)
}

/// True when the file has layers and exact numbers.
pub(crate) fn is_exr(path: &Path) -> bool {
    Format::of(path) == Some(Format::Exr)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_named_after_the_scene() {
        let names = or_default(&[], Path::new("scenes/my.ring.ron")).unwrap();
        assert_eq!(names, [Path::new("my.ring.exr"), Path::new("my.ring.png")]);
        let asked = [PathBuf::from("a.png")];
        assert_eq!(or_default(&asked, Path::new("x.ron")).unwrap(), asked);
        assert!(or_default(&[], Path::new("..")).is_err());
    }

    #[test]
    fn bad_places_are_found_and_no_probe_stays() {
        let folder = tempfile::tempdir().unwrap();
        let good = folder.path().join("a.exr");
        assert!(check_writable([&good]).is_ok());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        assert!(check_writable([&folder.path().join("none/a.exr")]).is_err());
        assert!(check_writable([&folder.path().to_path_buf()]).is_err());
    }
}
