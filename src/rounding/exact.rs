//! Exact vectors, for tests of error bounds.

use dashu::rational::RBig;
use glam::DVec3;
use rand::RngExt;
use rand::rngs::ChaCha8Rng;

/// A vector without rounding.
#[derive(Clone, Debug)]
pub(crate) struct Exact([RBig; 3]);

/// Returns a finite number without rounding.
pub(crate) fn number(x: f64) -> RBig {
    RBig::try_from(x).unwrap_or_else(|_| unreachable!("{x} is finite"))
}

/// Returns a vector with coordinates up to `half` in absolute value.
pub(crate) fn vector(rng: &mut ChaCha8Rng, half: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| half * rng.random_range(-1.0..1.0)))
}

impl Exact {
    pub(crate) fn of(vector: DVec3) -> Self {
        Self(vector.to_array().map(number))
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self([0, 1, 2].map(|axis| &self.0[axis] + &other.0[axis]))
    }

    pub(crate) fn minus(&self, other: &Self) -> Self {
        Self([0, 1, 2].map(|axis| &self.0[axis] - &other.0[axis]))
    }

    pub(crate) fn times(&self, factor: &RBig) -> Self {
        Self(self.0.each_ref().map(|x| x * factor))
    }

    pub(crate) fn dot(&self, other: &Self) -> RBig {
        let products = self.0.iter().zip(&other.0).map(|(x, y)| x * y);
        products.fold(RBig::ZERO, |sum, product| sum + product)
    }

    /// Returns the length, rounded.
    pub(crate) fn length(&self) -> f64 {
        DVec3::from_array(self.0.each_ref().map(|x| x.to_f64().value())).length()
    }

    /// Returns true if the coordinate along a normal of any length is within `error` of `found`.
    pub(crate) fn is_at_height(&self, normal: DVec3, found: &RBig, error: f64) -> bool {
        let error = number(error);
        let opposite = self.times(&number(-1.0));
        self.is_not_above(normal, &(found + &error))
            && opposite.is_not_above(normal, &(error - found))
    }

    /// Returns true if the coordinate along a normal of any length is at most `most`.
    pub(crate) fn is_not_above(&self, normal: DVec3, most: &RBig) -> bool {
        let normal = Self::of(normal);
        let (height, square) = (self.dot(&normal), normal.dot(&normal));
        // height / length <= most: by squares, where the signs are the same.
        let (a, b) = (&height * &height, most * most * &square);
        match (height >= RBig::ZERO, *most >= RBig::ZERO) {
            (true, true) => a <= b,
            (false, false) => a >= b,
            (is_positive, _) => !is_positive,
        }
    }

    /// Returns true if the vector is at most as long as `length`, compared without rounding.
    pub(crate) fn is_within(&self, length: f64) -> bool {
        self.is_within_exactly(&number(length))
    }

    pub(crate) fn is_within_exactly(&self, length: &RBig) -> bool {
        let [x, y, z] = &self.0;
        *length >= RBig::ZERO && x * x + y * y + z * z <= length * length
    }

    /// Returns true if no coordinate exceeds that of `half` in absolute value.
    pub(crate) fn is_within_box(&self, half: DVec3) -> bool {
        let mut coordinates = self.0.iter().zip(half.to_array());
        coordinates.all(|(x, half)| -number(half) <= *x && *x <= number(half))
    }

    /// Returns control point number `point` (0 to 3) of the part between two shares.
    pub(crate) fn blossom(points: &[Self; 4], point: usize, ends: &[RBig; 2]) -> Self {
        let mut points = points.to_vec();
        for step in 0..3 {
            let share = &ends[usize::from(step < point)];
            points = points
                .windows(2)
                .map(|two| two[0].plus(&two[1].minus(&two[0]).times(share)))
                .collect();
        }
        points.swap_remove(0)
    }
}
