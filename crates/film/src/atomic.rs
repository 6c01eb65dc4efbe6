//! Files that are either complete or not there.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process;

/// Why a file could not be written. What was at the path before is still there.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[error("cannot write {}: {source}; {}", path.display(), remedy(source))]
pub struct WriteError {
    /// The file that was to be written.
    pub path: PathBuf,
    /// What the system, or the encoder, reported.
    pub source: io::Error,
}

/// Suggests what to do about an error.
fn remedy(error: &io::Error) -> &'static str {
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::WriteZero => {
            "free some space, or write to another disk"
        }
        ErrorKind::FileTooLarge => "lower the resolution, or write to another disk",
        ErrorKind::NotFound | ErrorKind::NotADirectory => "create its folder first, or choose another path",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "make the folder and file writable, or choose another path"
        }
        ErrorKind::IsADirectory | ErrorKind::InvalidInput | ErrorKind::InvalidFilename => "give the path of a file",
        _ => "check the path and the disk, or choose another path",
    }
}

/// Writes a file so that its path never shows an unfinished one.
///
/// - `path`: where it shall be. A symbolic link is followed; a device or pipe is written to directly.
/// - `write`: writes the content, from position 0 of an empty file; it may seek.
///
/// The content goes to a temporary file in the same folder, which is forced to the disk and then
/// renamed. On any error, or a panic in `write`, the temporary file is removed and the old file left as
/// it was.
///
/// # Errors
///
/// [`WriteError`]: no such folder, no permission, a folder or read-only file at the path, a full disk,
/// or an error that `write` returned.
pub fn atomic_write(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<(), WriteError> {
    replace_file(path, write).map_err(|source| WriteError {
        path: path.to_owned(),
        source,
    })
}

fn replace_file(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let old = match fs::metadata(path) {
        Ok(metadata) => Some(metadata),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => return Err(error),
    };
    if let Some(old) = &old {
        if old.is_dir() {
            return Err(ErrorKind::IsADirectory.into());
        }
        if !old.is_file() {
            return fill(OpenOptions::new().write(true).open(path)?, write).map(drop);
        }
        if old.permissions().readonly() {
            return Err(ErrorKind::PermissionDenied.into());
        }
    }
    let target = if old.is_some() {
        fs::canonicalize(path)?
    } else {
        path.to_owned()
    };
    let (temporary, file) = Temporary::create_beside(&target)?;
    let file = fill(file, write)?;
    if let Some(old) = old {
        file.set_permissions(old.permissions())?;
    }
    file.sync_all()?;
    drop(file);
    temporary.rename_to(&target)?;
    sync_folder(&target);
    Ok(())
}

/// Runs the caller's closure and makes sure that what it wrote has left the buffer.
fn fill(file: File, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<File> {
    let mut writer = BufWriter::with_capacity(1 << 16, file);
    let result = write(&mut writer).and_then(|()| writer.flush());
    // Taken apart, not dropped: dropping would try to write the rest once more.
    let (file, _unwritten) = writer.into_parts();
    result.map(|()| file)
}

/// Makes the rename itself durable. Not every file system can; the file is complete either way.
fn sync_folder(target: &Path) {
    if let Ok(folder) = File::open(folder_of(target)) {
        let _ = folder.sync_all();
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// A file that disappears unless it is renamed.
struct Temporary(PathBuf);

impl Temporary {
    fn create_beside(target: &Path) -> io::Result<(Self, File)> {
        const ATTEMPTS: u32 = 1000;
        let name = target.file_name().ok_or(ErrorKind::InvalidInput)?;
        for attempt in 0..ATTEMPTS {
            let mut hidden = OsString::from(".");
            hidden.push(name);
            hidden.push(format!(".{}-{attempt}.tmp", process::id()));
            let path = folder_of(target).join(hidden);
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => return Ok((Self(path), file)),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
        Err(ErrorKind::AlreadyExists.into())
    }

    fn rename_to(self, target: &Path) -> io::Result<()> {
        fs::rename(&self.0, target)
        // Dropping finds nothing to remove after a rename, and the temporary file after a failed one.
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Seek, SeekFrom};

    fn names_in(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn writes_and_replaces() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        for content in [b"first", b"later"] {
            atomic_write(&path, |w| w.write_all(content)).unwrap();
            assert_eq!(fs::read(&path).unwrap(), content);
        }
        atomic_write(&path, |w| {
            w.write_all(b"xxxx")?;
            w.seek(SeekFrom::Start(1))?;
            w.write_all(b"y")
        })
        .unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"xyxx");
        assert_eq!(names_in(folder.path()), ["a.bin"]);
    }

    #[test]
    fn failure_keeps_the_old_file_and_no_rest() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        fs::write(&path, "old").unwrap();
        let error = atomic_write(&path, |w| {
            w.write_all(&[0; 100_000])?;
            Err(ErrorKind::StorageFull.into())
        })
        .unwrap_err();
        assert!(error.to_string().contains("free some space"), "{error}");
        assert!(error.to_string().contains("a.bin"), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        let panicked = std::panic::catch_unwind(|| {
            let _ = atomic_write(&path, |_| std::panic::resume_unwind(Box::new(())));
        });
        assert!(panicked.is_err());
        assert_eq!(names_in(folder.path()), ["a.bin"]);
    }

    #[test]
    fn bad_places_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let refuse = |path: &Path| {
            let error = atomic_write(path, |w| w.write_all(b"x")).unwrap_err();
            (error.source.kind(), error.to_string())
        };
        let (kind, text) = refuse(&folder.path().join("none/a.bin"));
        assert_eq!(kind, ErrorKind::NotFound);
        assert!(text.contains("create its folder"), "{text}");
        let (kind, text) = refuse(folder.path());
        assert_eq!(kind, ErrorKind::IsADirectory);
        assert!(text.contains("path of a file"), "{text}");
        let path = folder.path().join("kept.bin");
        fs::write(&path, "old").unwrap();
        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).unwrap();
        assert_eq!(refuse(&path).0, ErrorKind::PermissionDenied);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        let (kind, _) = refuse(&path.join("below.bin"));
        assert_eq!(kind, ErrorKind::NotADirectory);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn full_disk_and_links() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let error = atomic_write(Path::new("/dev/full"), |w| w.write_all(b"x")).unwrap_err();
        assert_eq!(error.source.kind(), ErrorKind::StorageFull);
        atomic_write(Path::new("/dev/null"), |w| w.write_all(b"x")).unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());

        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        fs::write(&real, "old").unwrap();
        fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).unwrap();
        symlink("real", &link).unwrap();
        atomic_write(&link, |w| w.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&real).unwrap(), b"new");
        assert_eq!(fs::metadata(&real).unwrap().permissions().mode() & 0o777, 0o640);
    }
}
