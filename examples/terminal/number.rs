//! Numbers as files have them.

/// The shortest digits that read back as the same number; an exponent where that is shorter.
pub(crate) fn shortest(value: f64) -> String {
    let plain = value == 0.0 || (1e-5..1e16).contains(&value.abs());
    if plain {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}
