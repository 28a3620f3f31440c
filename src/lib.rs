//! nearmiss

pub mod polynomial;
