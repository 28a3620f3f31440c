//! Formatted numbers for people.

use std::fmt;

/// A number in a line: with three decimals, or the line's precision; with an exponent where
/// decimals would not show it.
pub(crate) struct Readable(pub(crate) f64);

impl fmt::Display for Readable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        let decimals = f.precision().unwrap_or(3);
        // Zero, infinities and NaN need no exponent.
        if size > 0.0 && size < 1e-3 || size >= 1e15 && size.is_finite() {
            write!(f, "{:.decimals$e}", self.0)
        } else {
            write!(f, "{:.decimals$}", self.0)
        }
    }
}
