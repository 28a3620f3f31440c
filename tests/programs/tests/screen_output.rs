//! `screen --output`: a file is written whole or left as it was; what is no file is never removed.

#![cfg(unix)]
#![allow(
    clippy::unwrap_used,
    reason = "a file or process that fails, fails the test"
)]

#[path = "support/example.rs"]
mod example;

use example::{example, folder, plain};
use std::fmt::Write as _;
use std::fs::File;
use std::io::Read;
use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const OLD: &str = "what was there before\n";

/// Many bodies at one place: a table of more than a pipe holds.
fn crowd(folder: &Path) -> PathBuf {
    let mut states = "body,t,px,py,pz,vx,vy,vz\n".to_owned();
    for body in 0..100 {
        writeln!(states, "{body},0,0,0,0,0,0,0\n{body},1,0,0,0,0,0,0").unwrap();
    }
    let path = folder.join("states.csv");
    std::fs::write(&path, states).unwrap();
    path
}

fn screen(states: &Path, output: &Path) -> Command {
    let mut screen = example("screen");
    screen.arg(states).arg("--output").arg(output);
    screen
}

fn said(result: &Output) -> String {
    plain(&result.stderr)
}

/// All names in a folder, in order.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

fn rows(path: &Path) -> usize {
    std::fs::read_to_string(path).unwrap().lines().count()
}

#[test]
fn a_file_is_replaced_when_all_is_written() {
    let folder = folder("replaced");
    let states = crowd(&folder);
    let (file, link) = (folder.join("out.csv"), folder.join("link.csv"));
    std::fs::write(&file, OLD).unwrap();
    std::fs::set_permissions(&file, PermissionsExt::from_mode(0o640)).unwrap();
    symlink("out.csv", &link).unwrap();
    let result = screen(&states, &link).output().unwrap();
    assert!(result.status.success(), "{}", said(&result));
    assert_eq!(rows(&file), 1 + 100 * 99 / 2);
    assert!(link.is_symlink());
    assert_eq!(file.metadata().unwrap().permissions().mode() & 0o777, 0o640);
    assert_eq!(names(&folder), ["link.csv", "out.csv", "states.csv"]);
}

#[test]
fn a_file_that_cannot_be_written_whole_stays_as_it_was() {
    let folder = folder("full");
    let states = crowd(&folder);
    let file = folder.join("out.csv");
    std::fs::write(&file, OLD).unwrap();
    let screen = screen(&states, &file);
    // No file may grow; the program is told so by an error instead of a signal.
    let result = Command::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -f 0; exec \"$@\"", "sh"])
        .arg(screen.get_program())
        .args(screen.get_args())
        .output()
        .unwrap();
    assert_eq!(result.status.code(), Some(1), "{}", said(&result));
    assert!(said(&result).contains("out.csv"), "{}", said(&result));
    assert_eq!(std::fs::read_to_string(&file).unwrap(), OLD);
    assert_eq!(names(&folder), ["out.csv", "states.csv"]);
}

#[test]
fn a_pipe_is_written_to_and_never_removed() {
    let folder = folder("pipe");
    let states = crowd(&folder);
    let pipe = folder.join("pipe");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    let mut child = screen(&states, &pipe).spawn().unwrap();
    let mut read = String::new();
    File::open(&pipe)
        .unwrap()
        .read_to_string(&mut read)
        .unwrap();
    assert!(child.wait().unwrap().success());
    assert_eq!(read.lines().count(), 1 + 100 * 99 / 2);
    // One who reads a byte and leaves.
    let mut child = screen(&states, &pipe).spawn().unwrap();
    File::open(&pipe).unwrap().read_exact(&mut [0]).unwrap();
    assert!(child.wait().unwrap().success());
    assert!(pipe.metadata().unwrap().file_type().is_fifo());
    assert_eq!(names(&folder), ["pipe", "states.csv"]);
}

#[test]
fn an_open_file_is_appended_to() {
    let folder = folder("open");
    let states = crowd(&folder);
    let file = folder.join("out.csv");
    std::fs::write(&file, OLD).unwrap();
    let result = screen(&states, Path::new("/dev/stdout"))
        .stdout(File::options().append(true).open(&file).unwrap())
        .output()
        .unwrap();
    assert!(result.status.success(), "{}", said(&result));
    assert!(std::fs::read_to_string(&file).unwrap().starts_with(OLD));
    assert_eq!(rows(&file), 2 + 100 * 99 / 2);
}

#[test]
fn the_states_are_not_overwritten() {
    let folder = folder("same");
    let states = crowd(&folder);
    let before = std::fs::read_to_string(&states).unwrap();
    symlink("states.csv", folder.join("link.csv")).unwrap();
    for output in ["states.csv", "link.csv", "./states.csv"] {
        let result = screen(&states, &folder.join(output)).output().unwrap();
        assert_eq!(result.status.code(), Some(2), "{}", said(&result));
        assert!(said(&result).contains("the file of states itself"));
        assert_eq!(std::fs::read_to_string(&states).unwrap(), before);
    }
}

/// `-` is the standard input that comes from the file.
#[test]
fn the_file_of_standard_input_is_not_overwritten() {
    let folder = folder("same-input");
    let states = crowd(&folder);
    let before = std::fs::read_to_string(&states).unwrap();
    symlink("states.csv", folder.join("link.csv")).unwrap();
    std::fs::write(folder.join("other.csv"), OLD).unwrap();
    for (output, code) in [
        ("states.csv", 2),
        ("link.csv", 2),
        ("other.csv", 0),
        ("new.csv", 0),
    ] {
        let output = folder.join(output);
        let mut screen = screen(Path::new("-"), &output);
        let result = screen.stdin(File::open(&states).unwrap()).output().unwrap();
        assert_eq!(result.status.code(), Some(code), "{}", said(&result));
        if code == 0 {
            assert_eq!(rows(&output), 1 + 100 * 99 / 2);
        } else {
            assert!(said(&result).contains("the file of states itself"));
        }
        assert_eq!(std::fs::read_to_string(&states).unwrap(), before);
    }
}

/// Also beside states from standard input; no file of that name is made.
#[test]
fn a_hyphen_is_standard_output() {
    let folder = folder("hyphen");
    let states = crowd(&folder);
    for source in [&states, Path::new("-")] {
        let mut screen = screen(source, Path::new("-"));
        let screen = screen.stdin(File::open(&states).unwrap());
        let result = screen.current_dir(&folder).output().unwrap();
        assert!(result.status.success(), "{}", said(&result));
        let lines = result.stdout.split(|&byte| byte == b'\n').count() - 1;
        assert_eq!(lines, 1 + 100 * 99 / 2);
        assert_eq!(names(&folder), ["states.csv"]);
    }
}

#[test]
fn what_cannot_be_written_is_told_before_the_states_are_read() {
    let folder = folder("nowhere");
    for output in ["no-such-folder/out.csv", ".", "new/"] {
        let result = screen(&folder.join("absent.csv"), &folder.join(output))
            .output()
            .unwrap();
        assert_eq!(result.status.code(), Some(1), "{}", said(&result));
        assert!(!said(&result).contains("absent"), "{}", said(&result));
    }
    assert_eq!(names(&folder).len(), 0);
}
