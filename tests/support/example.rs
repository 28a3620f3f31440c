//! The examples as programs, for the tests that run them.

use std::path::{Path, PathBuf};
use std::process::Command;

/// An example beside the test's own binary: `cargo test` builds both.
pub(crate) fn example(name: &str) -> Command {
    let tests = std::env::current_exe().unwrap();
    let example = tests
        .parent()
        .and_then(Path::parent)
        .unwrap()
        .join("examples")
        .join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    assert!(
        example.exists(),
        "{} is missing: run `cargo build --example {name}` with the tests' profile, or all tests",
        example.display()
    );
    Command::new(example)
}

/// An empty folder of its own for each test.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("nearmiss-{name}-{}", std::process::id()));
    // Left by an earlier process of the same number.
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir(&folder).unwrap();
    folder
}
