//! nearmiss

pub mod narrow_phase;
pub mod polynomial;
