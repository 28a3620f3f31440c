//! The README quotes what its two programs print.
//!
//! `tests/readme_programs` has both programs as they stand in the README, letter by letter. They are run here, and what
//! they print is kept.

#![allow(clippy::unwrap_used, reason = "a failure fails the test")]

use std::cell::RefCell;

thread_local! {
    /// Lines printed on this thread.
    static PRINTED: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// Keeps a line instead of printing it.
macro_rules! println {
    ($($line:tt)*) => {
        crate::PRINTED.with_borrow_mut(|lines| lines.push(format!($($line)*)))
    };
}

/// Defines a module of a program, with its text and a function that runs it.
macro_rules! program {
    ($name:ident, $file:literal) => {
        mod $name {
            include!($file);

            pub(super) const TEXT: &str = include_str!($file);

            /// Returns the lines that the program prints.
            pub(super) fn printed() -> Vec<String> {
                main().unwrap();
                super::PRINTED.take()
            }
        }
    };
}

program!(in_fifteen_lines, "readme_programs/in_fifteen_lines.rs");
program!(in_a_loop, "readme_programs/in_a_loop.rs");

const README: &str = include_str!("../README.md");

/// Returns the README with single spaces.
fn readme() -> String {
    let words: Vec<&str> = README.split_whitespace().collect();
    words.join(" ")
}

#[test]
fn the_programs_are_those_of_the_readme() {
    let blocks = README.split("```rust\n").skip(1);
    let programs: Vec<&str> = blocks
        .map(|block| block.split("```").next().unwrap())
        .collect();
    assert_eq!(programs, [in_fifteen_lines::TEXT, in_a_loop::TEXT]);
}

#[test]
fn the_first_program_prints_what_the_readme_says() {
    let printed = in_fifteen_lines::printed();
    let [conflict] = &printed[..] else {
        panic!("{printed:?}");
    };
    assert!(readme().contains(&format!("It prints `{conflict}`")));
}

#[test]
fn the_loop_prints_what_the_readme_says() {
    let printed = in_a_loop::printed();
    let [predicted, revised, began, ended] = &printed[..] else {
        panic!("{printed:?}");
    };
    let readme = readme();
    assert!(
        readme.contains(&format!("It prints `{predicted}`")),
        "{predicted}"
    );
    // Dots stand for what is left out.
    for (line, shown) in [
        (revised, "at 0.12 s revised: ... to 2.10 s, ..."),
        (began, "at 1.90 s began: ..."),
        (ended, "at 2.10 s ended (separated): ..."),
    ] {
        let parts: Vec<&str> = shown.split("...").collect();
        let is_as_shown = line.starts_with(parts[0]) && line.contains(parts[1]);
        assert!(is_as_shown && readme.contains(shown), "{line}");
    }
}
