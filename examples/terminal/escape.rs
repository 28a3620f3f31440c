//! A user's data as a terminal may show them: on one line, with nothing in it that a terminal obeys.

use std::fmt::Write;
use std::path::Path;

/// Escapes what is not printed, and bytes that are no text.
pub(crate) fn escaped(bytes: &[u8]) -> String {
    let mut shown = String::new();
    for chunk in bytes.utf8_chunks() {
        for character in chunk.valid().chars() {
            match character {
                '"' | '\'' | '\\' => shown.push(character),
                _ => shown.extend(character.escape_debug()),
            }
        }
        for byte in chunk.invalid() {
            // Writing to a string does not fail.
            let _ = write!(shown, "\\x{byte:02x}");
        }
    }
    shown
}

/// Returns the name of a file, escaped.
pub(crate) fn name(path: &Path) -> String {
    escaped(path.as_os_str().as_encoded_bytes())
}

/// Returns a value in quotation marks, escaped; of a long one its beginning and its length.
pub(crate) fn quoted(value: &[u8]) -> String {
    /// Bytes; more do not help to find the value.
    const MAX: usize = 80;
    if value.len() <= MAX {
        return format!("\"{}\"", escaped(value));
    }
    // A character has up to four bytes.
    let begins = |&end: &usize| value[end] & 0b1100_0000 != 0b1000_0000;
    let end = (MAX - 3..=MAX).rev().find(begins).unwrap_or(MAX);
    let beginning = escaped(&value[..end]);
    format!("\"{beginning}\"... ({} bytes)", value.len())
}
