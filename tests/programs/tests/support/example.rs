//! The examples as programs, for the tests that run them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

pub(crate) fn example(name: &str) -> Command {
    /// By name.
    static EXAMPLES: LazyLock<BTreeMap<String, PathBuf>> = LazyLock::new(build);
    Command::new(&EXAMPLES[name])
}

/// Builds the examples as `cargo test` does, which leaves nothing to do after it, and as the test was built:
/// in the same place, with the same profile and features. (Cargo holds no lock while tests run.)
fn build() -> BTreeMap<String, PathBuf> {
    let features = [
        ("default", cfg!(feature = "default")),
        ("parallel", cfg!(feature = "parallel")),
        ("live", cfg!(feature = "live")),
        ("serde", cfg!(feature = "serde")),
        ("recording", cfg!(feature = "recording")),
        ("mint", cfg!(feature = "mint")),
    ];
    let features: Vec<&str> = features
        .iter()
        .filter_map(|&(feature, is_on)| is_on.then_some(feature))
        .collect();
    let test = std::env::current_exe().unwrap();
    let profile = match test.ancestors().nth(2).and_then(Path::file_name) {
        Some(folder) if folder != "debug" => folder.to_str().unwrap(),
        _ => "test",
    };
    // Also of a test of another member.
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = here
        .ancestors()
        .find(|folder| folder.join("Cargo.lock").exists());
    let root = root.unwrap();
    let built = Command::new(env!("CARGO"))
        .args(["build", "--examples", "--profile", profile])
        .args(["--no-default-features", "--features", &features.join(",")])
        .arg("--target-dir")
        .arg(Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap())
        .arg("--message-format=json-render-diagnostics")
        .current_dir(root)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success(), "no examples to test: {said}");
    let messages = std::str::from_utf8(&built.stdout).unwrap().lines();
    messages
        .map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap())
        .filter(|message| message["target"]["kind"][0] == "example")
        .filter_map(|message| {
            let name = message["target"]["name"].as_str()?.to_owned();
            Some((name, message["executable"].as_str()?.into()))
        })
        .collect()
}

/// An empty folder of its own for each test.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("nearmiss-{name}-{}", std::process::id()));
    // Left by an earlier process of the same number.
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir(&folder).unwrap();
    folder
}

/// Returns the output of a program: text in which nothing is left that a terminal obeys.
pub(crate) fn plain(said: &[u8]) -> String {
    let said = std::str::from_utf8(said).unwrap().to_owned();
    let obeyed = |character: char| {
        let turns = ('\u{202a}'..='\u{202e}').contains(&character);
        turns || (character.is_control() && character != '\n')
    };
    assert!(!said.contains(obeyed), "{said:?}");
    said
}
