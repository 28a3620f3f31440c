//! Nanoseconds per box of the broad phase methods, on boxes of all shapes.
fn main() {}
