//! Files that commands write: whole or not at all, where they were asked for, and with the permissions they had.

use std::fs::{self, File, Metadata};
use std::io::{Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};

/// Links that lead from one to the next are followed so often, as the system does.
const MOST_LINKS: usize = 40;

/// Writes a file beside its place and moves it there.
///
/// Links are followed. A file that is there keeps its permissions, and as far as the system allows it its owner and
/// group; a new one gets those that the umask leaves. What is no regular file, such as a pipe, is written as it is.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let Some(place) = followed(path)? else { return fs::write(path, bytes) };
    let there = match fs::metadata(&place) {
        Ok(there) if !there.is_file() => return fs::write(&place, bytes),
        Ok(there) => Some(there),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => return Err(error),
    };
    let mut builder = tempfile::Builder::new();
    // Until it has its permissions, one that replaces another is only its writer's.
    #[cfg(unix)]
    if there.is_none() {
        use std::os::unix::fs::PermissionsExt;
        // The umask takes from it what the user wants taken.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    // What the system says is said of the file, not of the one beside it.
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

/// The folder that a file is in.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Where links lead to, there or not; none where only the system can follow them, as into a pipe.
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
    // Round and round: the system says so.
    fs::metadata(path).map(|_| None)
}

/// Gives a file the permissions of one that was there, and its owner and group where that is allowed.
#[cfg(unix)]
fn keep(file: &File, there: &Metadata) -> Result<()> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
    let new = file.metadata()?;
    if new.uid() != there.uid() {
        // Only an administrator may give a file away; else it is its writer's.
        let _where_allowed = fchown(file, Some(there.uid()), None);
    }
    let mut mode = there.mode() & 0o777;
    if new.gid() != there.gid() && fchown(file, None, Some(there.gid())).is_err() {
        // Another group gets what all others get.
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
