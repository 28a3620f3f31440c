//! A file that a run makes: there whole at the end, or what was there before.

use super::escape::name;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Result as Done};
use std::path::{Path, PathBuf};

/// Names of what the process holds open already: `> file` made it, `>> file` holds more than ours.
const OPEN_FILES: [&str; 4] = ["/dev/stdout", "/dev/stderr", "/dev/fd", "/proc"];

/// The file of a run's result, checked before the work starts.
#[derive(Debug)]
pub(crate) struct Product {
    path: PathBuf,
    way: Way,
}

#[derive(Debug)]
enum Way {
    /// Into a new file beside this one, which takes its name when it is whole.
    Beside(PathBuf),
    /// Into what has the name: a device, a pipe, an open file, or a link to nothing yet. It is not
    /// ours to remove or replace.
    Straight,
}

impl Product {
    /// Refuses what cannot be written. Leaves nothing behind, and opens no pipe or device.
    pub(crate) fn at(path: &Path) -> Result<Self, String> {
        let explain = |error| format!("{}: {error}", name(path));
        let way = match path.metadata() {
            Ok(found) if found.is_dir() => return Err(explain(ErrorKind::IsADirectory.into())),
            Ok(found) if !found.is_file() || is_open(path) => Way::Straight,
            // A link stays one: the file that it leads to is replaced.
            Ok(_) => Way::Beside(check_old(path).map_err(explain)?),
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(explain(error)),
            Err(_) if names_folder(path) => return Err(explain(ErrorKind::NotADirectory.into())),
            Err(_) if path.is_symlink() => Way::Straight,
            Err(_) => Way::Beside(path.to_owned()),
        };
        if let Way::Beside(target) = &way {
            let (beside, _) = create_beside(target).map_err(explain)?;
            std::fs::remove_file(beside).map_err(explain)?;
        }
        Ok(Self {
            path: path.to_owned(),
            way,
        })
    }

    /// Has the content written. An error is explained with the name of the file.
    pub(crate) fn write(&self, content: impl FnOnce(File) -> Done<()>) -> Result<(), String> {
        match &self.way {
            Way::Beside(target) => replace(target, content),
            Way::Straight => write_straight(&self.path, content),
        }
        .map_err(|error| format!("{}: {error}", name(&self.path)))
    }
}

/// Returns true if a name is that of a folder, whether there is one or not: it ends with a separator.
fn names_folder(path: &Path) -> bool {
    let text = path.as_os_str().to_string_lossy();
    text.ends_with(std::path::is_separator)
}

/// Returns true if two names of a command line are those of one file, which need not be there yet. Two names of one
/// terminal or device are no conflict.
pub(crate) fn is_same_file(one: &Path, other: &Path) -> bool {
    matches!((place(one), place(other)), (Some(one), Some(other)) if one == other)
}

/// Returns true if what is read from a path, where `-` is standard input, comes from this file. Not every system tells
/// where standard input comes from.
pub(crate) fn is_source(path: &Path, file: &Path) -> bool {
    if path == Path::new("-") {
        is_standard_input(file)
    } else {
        is_same_file(path, file)
    }
}

#[cfg(unix)]
fn is_standard_input(path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |path: &Path| {
        let found = path.metadata().ok().filter(std::fs::Metadata::is_file)?;
        Some((found.dev(), found.ino()))
    };
    let read = identity(Path::new("/dev/stdin"));
    read.is_some() && read == identity(path)
}

#[cfg(not(unix))]
fn is_standard_input(_: &Path) -> bool {
    false
}

/// Returns the place of a file, whatever it is called; of none that is there, the place where it would be.
fn place(path: &Path) -> Option<PathBuf> {
    match path.metadata() {
        Ok(found) if !found.is_file() => None,
        Ok(_) => path.canonicalize().ok(),
        Err(_) => {
            let folder = path.parent()?;
            // Of a name alone.
            let folder = Some(folder).filter(|folder| !folder.as_os_str().is_empty());
            let folder = folder.unwrap_or(Path::new(".")).canonicalize().ok()?;
            Some(folder.join(path.file_name()?))
        }
    }
}

fn is_open(path: &Path) -> bool {
    OPEN_FILES.iter().any(|open| path.starts_with(open))
}

/// A file that may not be written may not be replaced either.
fn check_old(path: &Path) -> Done<PathBuf> {
    OpenOptions::new().append(true).open(path)?;
    path.canonicalize()
}

fn write_straight(path: &Path, content: impl FnOnce(File) -> Done<()>) -> Done<()> {
    let file = OpenOptions::new().append(true).create(true).open(path)?;
    match content(file) {
        // A reader that has seen enough.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

fn replace(target: &Path, content: impl FnOnce(File) -> Done<()>) -> Done<()> {
    let (beside, file) = create_beside(target)?;
    let result = content(file)
        .and_then(|()| match target.metadata() {
            Ok(old) => std::fs::set_permissions(&beside, old.permissions()),
            Err(_) => Ok(()),
        })
        .and_then(|()| std::fs::rename(&beside, target));
    result.inspect_err(|_| {
        // It is the first error that counts.
        let _ = std::fs::remove_file(&beside);
    })
}

/// A new file in the same folder, under a name that nobody else uses. A process that was killed may
/// have left one under a number that is used again.
fn create_beside(target: &Path) -> Done<(PathBuf, File)> {
    const MAX_TRIES: u32 = 100;
    let mut number = 0;
    loop {
        let beside = format!(".nearmiss-{}-{number}.partial", std::process::id());
        let path = target.with_file_name(beside);
        match File::create_new(&path) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists && number < MAX_TRIES => {
                number += 1;
            }
            result => return result.map(|file| (path, file)),
        }
    }
}
