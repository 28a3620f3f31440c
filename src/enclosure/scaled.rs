//! Scaling by powers of two, so that squares and products of squares stay in range.

use super::{DistanceEnclosure, UncertainCubic};
use crate::blossom::ControlPolygon;
use crate::real::Real;
use crate::rounding::{UNIT_ROUNDOFF, scale_to_one};
use glam::DVec3;

/// 1 + 2^-40: covers all terms of second order and the rounding of the bounds themselves.
pub(super) const SECOND_ORDER: f64 = 1.0 + 1.0 / (1_u64 << 40) as f64;

/// Far above the loss of one formula by underflow, far below the rounding of a cubic of size one
/// and of its squares. Neither it nor its products with u are subnormal, which would be slow.
pub(super) const TINY: f64 = 1e-150;

/// Below this the square of a norm may have lost digits to underflow.
const SMALLEST_SQUARE: f64 = 1e-250;

/// A relative cubic scaled to a magnitude near one.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScaledCubic {
    pub(super) points: ControlPolygon,
    /// Bound on the distance between this cubic and the exact motion (E).
    pub(super) error: f64,
    /// Upper bound of the control points' norms (M).
    pub(super) size: f64,
    /// Power of two that restores lengths.
    unit: f64,
}

impl ScaledCubic {
    /// Returns the scaled cubic; control points and `error >= 0` must be finite.
    pub(super) fn new(&UncertainCubic { points, error }: &UncertainCubic) -> Self {
        let [a, b, c, d] = points;
        let largest = (a.abs().max(b.abs())).max(c.abs().max(d.abs()));
        let power = scale_to_one(largest.max_element().max(error));
        // Scaling loses at most 2^-1075 per component.
        let points = [a * power, b * power, c * power, d * power];
        let norms = points.iter().map(|point| norm_above(*point));
        Self {
            points,
            error: error * power + TINY,
            size: norms.fold(0.0, Real::max_or_other),
            unit: 1.0 / power,
        }
    }

    /// Returns a bound on the distance between any computed part and the exact motion (F).
    pub(super) fn part_error(&self) -> f64 {
        part_error(self.error, self.size, 0.0)
    }

    /// Returns an enclosure in the caller's unit.
    pub(super) fn restore(
        &self,
        DistanceEnclosure { low, high }: DistanceEnclosure,
    ) -> DistanceEnclosure {
        DistanceEnclosure {
            low: outward(low * self.unit, f64::next_down).max(0.0),
            high: outward(high * self.unit, f64::next_up),
        }
    }

    /// Returns a square in the caller's unit, in this cubic's unit; exact but for underflow.
    pub(super) fn scaled_square(&self, square: f64) -> f64 {
        square / self.unit / self.unit
    }

    /// Returns a lower bound of a length in the caller's unit, in this cubic's unit.
    pub(super) fn scaled_below(&self, length: f64) -> f64 {
        outward(length / self.unit, f64::next_down)
    }

    /// Returns an upper bound of a length in the caller's unit, in this cubic's unit.
    pub(super) fn scaled_above(&self, length: f64) -> f64 {
        outward(length / self.unit, f64::next_up)
    }
}

/// Returns a bound on the error of any part computed from a cubic of that error and size, and halved so many
/// times then: three roundings each.
#[inline(always)]
pub(crate) fn part_error(error: f64, size: f64, halvings: f64) -> f64 {
    (error + (9.0 + 3.0 * halvings) * UNIT_ROUNDOFF * size) * SECOND_ORDER
}

/// Returns the product of a length and a power of two, moved outward if it is not exact.
fn outward(product: f64, next: fn(f64) -> f64) -> f64 {
    if product.is_normal() {
        product
    } else {
        next(product)
    }
}

/// Returns an upper bound of the Euclidean norm; exactly zero for the zero vector.
pub(super) fn norm_above(vector: DVec3) -> f64 {
    let square = vector.dot(vector);
    if square > SMALLEST_SQUARE {
        square.sqrt() * (1.0 + 4.0 * UNIT_ROUNDOFF)
    } else {
        2.0 * vector.abs().max_element()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rounding::exact::{Exact, number, vector};
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Returns a size from the smallest to the largest numbers.
    fn size_of(rng: &mut ChaCha8Rng) -> f64 {
        10f64.powf(rng.random_range(-322.0..300.0))
    }

    #[test]
    fn norms_are_rounded_up() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for _ in 0..5_000 {
            let size = size_of(&mut rng).min(1e150);
            let vector = vector(&mut rng, size);
            assert!(Exact::of(vector).is_within(norm_above(vector)), "{vector}");
        }
    }

    /// The error of a cubic includes the scaling, and the error of its parts covers both.
    #[test]
    fn scaled_cubics_are_within_their_error() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for round in 0..5_000 {
            let large = size_of(&mut rng);
            let small = if round % 2 == 0 {
                large
            } else {
                size_of(&mut rng).min(large)
            };
            let points = [large, small, small, small].map(|size| vector(&mut rng, size));
            let error = if round % 3 == 0 { 0.0 } else { small };
            let cubic = ScaledCubic::new(&UncertainCubic { points, error });
            let factor = number(cubic.unit);
            for (point, given) in cubic.points.into_iter().zip(points) {
                let off = Exact::of(point).times(&factor).minus(&Exact::of(given));
                let room = (number(cubic.error) * &factor - number(error)) / &factor;
                assert!(
                    off.times(&(number(1.0) / &factor)).is_within_exactly(&room),
                    "{points:?}"
                );
            }
            let rounding = number(9.0 * UNIT_ROUNDOFF) * number(cubic.size);
            assert!(number(cubic.part_error()) >= number(cubic.error) + rounding);
        }
    }

    /// Lengths that are subnormal in one of the units or in both survive scaling and back.
    #[test]
    fn lengths_are_rounded_outward() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for _ in 0..5_000 {
            let size = size_of(&mut rng);
            let cubic = ScaledCubic::new(&UncertainCubic {
                points: [vector(&mut rng, size); 4],
                error: 0.0,
            });
            let factor = number(cubic.unit);
            let length = 10f64.powf(rng.random_range(-320.0..2.0));
            let given = length.min(1e300 / cubic.unit.max(1.0));
            let exact = number(given) * &factor;
            let restored = cubic.restore(DistanceEnclosure {
                low: given,
                high: given,
            });
            assert!(number(restored.low) <= exact && exact <= number(restored.high));
            let length = size_of(&mut rng).min(1e300 * cubic.unit.min(1.0));
            let exact = number(length) / &factor;
            assert!(number(cubic.scaled_below(length)) <= exact);
            assert!(exact <= number(cubic.scaled_above(length)));
        }
    }
}
