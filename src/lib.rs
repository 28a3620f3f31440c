//! nearmiss

pub mod broad_phase;
