//! Atomic writing of output files, with the permissions of the file that is replaced.

use std::fs::{self, File, Metadata};
use std::io::{Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// The name of standard input and output on the command line.
pub const STANDARD: &str = "-";
/// Most symbolic links to follow, as on Linux.
const MOST_LINKS: usize = 40;

/// Writes a temporary file in the same folder and renames it.
///
/// Symbolic links are followed. An existing file keeps its permissions and, where allowed, its
/// owner and group; a new one gets the umask's. A target that is no regular file, such as a pipe,
/// is written directly, and `-` is standard output.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    if path == Path::new(STANDARD) {
        let mut output = std::io::stdout().lock();
        return unless_broken(output.write_all(bytes).and_then(|()| output.flush()));
    }
    let Some(place) = followed(path)? else { return unless_broken(fs::write(path, bytes)) };
    let there = match fs::metadata(&place) {
        Ok(there) if !there.is_file() => return unless_broken(fs::write(&place, bytes)),
        Ok(there) => Some(there),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => return Err(error),
    };
    let mut builder = tempfile::Builder::new();
    // Not readable by others until it has the permissions of the file it replaces.
    #[cfg(unix)]
    if there.is_none() {
        use std::os::unix::fs::PermissionsExt;
        // The umask applies.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    // Errors name the file, not the temporary one.
    let beside =
        builder.tempfile_in(folder_of(&place)).map_err(|error| Error::from(error.kind()))?;
    let mut file = beside.as_file();
    file.write_all(bytes)?;
    if let Some(there) = there {
        keep(file, &there)?;
    }
    file.sync_all()?;
    beside.persist(&place).map_err(|error| error.error)?;
    Ok(())
}

/// Turns the error of a closed pipe into success.
pub fn unless_broken(result: Result<()>) -> Result<()> {
    result.or_else(|error| match error.kind() {
        ErrorKind::BrokenPipe => Ok(()),
        _ => Err(error),
    })
}

/// A temporary folder, removed when dropped. An error names its parent, not its random name.
pub fn temporary_folder() -> Result<TempDir> {
    tempfile::tempdir().map_err(|error| {
        let kind = error.kind();
        Error::new(kind, format!("{}: {kind}", std::env::temp_dir().display()))
    })
}

/// The folder of a file.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Target of symbolic links, existing or not; `None` if only the system can follow them, such as
/// links to a pipe.
fn followed(path: &Path) -> Result<Option<PathBuf>> {
    let mut place = path.to_owned();
    for _ in 0..MOST_LINKS {
        if let Ok(place) = place.canonicalize() {
            return Ok(Some(place));
        }
        if !fs::symlink_metadata(&place).is_ok_and(|there| there.is_symlink()) {
            return Ok(Some(place));
        }
        if place.exists() {
            return Ok(None);
        }
        let target = fs::read_link(&place)?;
        place = folder_of(&place).join(target);
    }
    // A loop: the system reports it.
    fs::metadata(path).map(|_| None)
}

/// Copies permissions and, where allowed, owner and group of the replaced file.
#[cfg(unix)]
fn keep(file: &File, there: &Metadata) -> Result<()> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
    let new = file.metadata()?;
    if new.uid() != there.uid() {
        // Only an administrator may change the owner.
        let _where_allowed = fchown(file, Some(there.uid()), None);
    }
    let mut mode = there.mode() & 0o777;
    if new.gid() != there.gid() && fchown(file, None, Some(there.gid())).is_err() {
        // A group that could not be kept gets the permissions of others.
        mode = mode & 0o707 | (mode & 0o007) << 3;
    }
    if file.metadata()?.mode() & 0o777 != mode {
        file.set_permissions(fs::Permissions::from_mode(mode))?;
    }
    Ok(())
}

#[cfg(not(unix))]
fn keep(file: &File, there: &Metadata) -> Result<()> {
    file.set_permissions(there.permissions())
}
