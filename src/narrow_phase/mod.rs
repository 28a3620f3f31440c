//! The narrow phase: what happens between the two bodies of a candidate pair.

pub mod kernels;
