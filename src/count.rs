//! Counts and numbers of bodies, pieces, spheres and the like are stored in 32 bits: longer lists do not fit into
//! memory.

/// Converts a count, or a number of one of so many, to 32 bits.
#[inline(always)]
#[allow(
    clippy::cast_possible_truncation,
    reason = "longer lists do not fit into memory"
)]
pub(crate) const fn short(count: usize) -> u32 {
    debug_assert!(count <= u32::MAX as usize);
    count as u32
}

/// Converts a count to a number: exact below 2^53.
#[inline(always)]
#[allow(
    clippy::cast_precision_loss,
    reason = "the memory for 2^53 of anything does not exist"
)]
pub(crate) const fn as_f64(count: usize) -> f64 {
    count as f64
}

/// Converts a number to a count: rounded towards zero, at least 0, at most 2^32 - 1.
#[inline(always)]
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturates"
)]
pub(crate) const fn whole(number: f64) -> u32 {
    number as u32
}

/// Returns true if some are more than three quarters of all.
pub(crate) const fn are_most(some: usize, all: usize) -> bool {
    4 * some > 3 * all
}
