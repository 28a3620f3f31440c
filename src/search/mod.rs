//! From candidates of a slice to spans that are solved, in memory that stays from one run to the next.

mod arrange;
mod scratch;
mod sift;

pub(crate) use arrange::Arranger;
pub(crate) use scratch::Scratch;
pub(crate) use sift::Question;
