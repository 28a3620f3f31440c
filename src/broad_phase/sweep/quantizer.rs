//! Monotone conversion to 16-bit grid coordinates.

use parry3d::bounding_volume::Aabb;

/// Grid coordinates per axis.
pub(super) const STEPS: u32 = 1 << 16;

/// An order-preserving map of each axis onto 16-bit integers.
///
/// Every operation of [`quantized`](Self::quantized) is monotone. Subtraction, multiplication by a positive
/// number, clamping and rounding never turn `v <= w` into `quantized(v) > quantized(w)`, overflow to infinity
/// included. So if two boxes overlap, `a.low <= b.high` holds in grid coordinates too. A grid box
/// needs no outward rounding, and values outside the range may be clamped. The choice of range
/// cannot lose a pair; it only decides how many are found in vain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantizer {
    /// Lanes: three axes of the low corner, three of the high one, two unused.
    origin: [f32; 8],
    factor: [f32; 8],
}

/// A box in grid coordinates, and the cell its low corner is sorted to: 16 bytes.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(super) struct QuantizedBox {
    pub(super) low: [u16; 3],
    pub(super) high: [u16; 3],
    pub(super) cell: u32,
}

impl Quantizer {
    /// Adding this to a number in 0..=65,535 rounds it to an integer, in the lowest 16 bits.
    const SHIFT: f32 = 8_388_608.0;

    /// Returns the map of `low..=high` (finite) on each axis to the whole grid.
    #[allow(
        clippy::cast_possible_truncation,
        reason = "to the nearest f32: it need not be exact"
    )]
    pub(super) fn new(range: [(f32, f32); 3]) -> Self {
        let mut scale = Self {
            origin: [0.0; 8],
            factor: [1.0; 8],
        };
        for (axis, (low, high)) in range.into_iter().enumerate() {
            let width = f64::from(high) - f64::from(low);
            // Positive and finite, so that no product is NaN.
            let factor = (f64::from(STEPS - 1) / width)
                .clamp(f64::from(f32::MIN_POSITIVE), f64::from(f32::MAX));
            for lane in [axis, axis + 3] {
                scale.origin[lane] = low;
                scale.factor[lane] = factor as f32;
            }
        }
        scale
    }

    /// Returns the grid coordinates of both corners, in the map's lanes.
    #[inline(always)]
    pub(super) fn quantized(&self, aabb: &Aabb) -> [u16; 8] {
        let (low, high) = (aabb.mins, aabb.maxs);
        let metres = [low.x, low.y, low.z, high.x, high.y, high.z, 0.0, 0.0];
        let mut steps = [0_u16; 8];
        for lane in 0..8 {
            let coordinate = (metres[lane] - self.origin[lane]) * self.factor[lane];
            // Comparisons instead of `clamp`: there is no NaN, and these are one instruction each.
            let coordinate = if coordinate > 0.0 { coordinate } else { 0.0 };
            let coordinate = if coordinate < 65_535.0 {
                coordinate
            } else {
                65_535.0
            };
            steps[lane] = lowest_bits(coordinate + Self::SHIFT);
        }
        steps
    }
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "the lowest 16 bits are what is wanted"
)]
#[inline(always)]
fn lowest_bits(number: f32) -> u16 {
    number.to_bits() as u16
}

/// Returns the number of the part, of `parts` equal ones of an axis, that contains a grid
/// coordinate; keeps the order.
#[inline(always)]
pub(super) fn axis_part(quantized: u16, parts: u32) -> u32 {
    (u32::from(quantized) * parts) >> 16
}

#[cfg(test)]
mod tests {
    use parry3d::math::Vector;

    use super::*;

    /// Returns numbers of every kind, in order.
    fn ladder() -> Vec<f32> {
        let mut numbers = vec![0.0, f32::MAX, f32::MIN_POSITIVE, f32::from_bits(1)];
        for exponent in -126_i16..128 {
            let power = f32::from(exponent).exp2();
            numbers.extend([power, power.next_up(), power.next_down(), 1.3 * power]);
        }
        numbers.retain(|number| number.is_finite());
        numbers.extend(numbers.clone().iter().map(|number| -number));
        numbers.sort_by(f32::total_cmp);
        numbers
    }

    #[test]
    fn order_is_kept_for_every_range() {
        let numbers = ladder();
        let ends = [
            (0.0, 0.0),
            (-f32::MAX, f32::MAX),
            (f32::MAX, f32::MAX),
            (-1.0, 1.0),
            (1e5, 1e5_f32.next_up()),
            (0.0, f32::from_bits(1)),
            (3.0, 1e9),
        ];
        for range in ends {
            let scale = Quantizer::new([range; 3]);
            let mut last = 0;
            for &number in &numbers {
                let corner = Vector::splat(number);
                let quantized = scale.quantized(&Aabb::new(corner, corner));
                let axes = [
                    quantized[0],
                    quantized[1],
                    quantized[2],
                    quantized[3],
                    quantized[4],
                    quantized[5],
                ];
                assert!(axes.iter().all(|&step| step == axes[0]), "{quantized:?}");
                assert!(axes[0] >= last, "{number} in {range:?}");
                last = axes[0];
            }
        }
    }

    #[test]
    fn a_range_fills_the_grid() {
        let scale = Quantizer::new([(-2.0, 6.0); 3]);
        let quantized = scale.quantized(&Aabb::new(Vector::splat(-2.0), Vector::splat(6.0)));
        assert_eq!([quantized[0], quantized[3]], [0, 65_535]);
        let quantized = scale.quantized(&Aabb::new(Vector::splat(2.0), Vector::splat(100.0)));
        // The middle is half a step from two numbers.
        assert!((32_767..=32_768).contains(&quantized[0]));
        assert_eq!(quantized[3], 65_535);
    }

    #[test]
    fn parts_share_the_axis_evenly() {
        assert_eq!(axis_part(0, 7), 0);
        assert_eq!(axis_part(65_535, 7), 6);
        assert_eq!(axis_part(32_768, 2), 1);
        assert_eq!(axis_part(32_767, 2), 0);
    }
}
