//! Stretches of a part as shares of it, and how often they are halved.

/// A stretch of a part: its ends, as shares of the part.
pub(super) type Shares = (f64, f64);

/// Number of times that a short stretch is halved where there are many pairs of spheres. With 3, pairs of 125 spheres
/// took 0.97 times as long, and 1.01 to 1.34 if they turn.
pub(super) const FEWEST_HALVINGS: i32 = 2;

/// Number of times that a long stretch is halved.
pub(super) const MOST_HALVINGS: i32 = 5;

/// The stretch that is the whole part.
pub(super) const WHOLE: Shares = (0.0, 1.0);
