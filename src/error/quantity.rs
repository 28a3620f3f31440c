//! The numbers of an input, as errors name them.

use std::fmt;

/// Magnitude beyond which an input, or a quantity that follows from it, is refused (SI units).
///
/// Up to it no linear stage of the pipeline can overflow; squares are formed of scaled numbers.
pub const MAX_MAGNITUDE: f64 = 1e300;

/// The number of an input to which an error refers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Quantity {
    /// The time of a knot, s.
    Time,
    /// Component x, y or z (0, 1, 2) of a position, m.
    Position(usize),
    /// Component x, y or z (0, 1, 2) of a velocity, m/s.
    Velocity(usize),
    /// A coefficient of a polynomial, by power and component.
    Coefficient {
        /// Power of time that it multiplies, 0 to 7.
        power: usize,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// A control point, by number and component.
    ControlPoint {
        /// The control point, counted from 0: of its piece, or of the whole B-spline.
        point: usize,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// Component x, y, z or w (0, 1, 2, 3) of a rotation's quaternion.
    Rotation(usize),
    /// Component x, y or z (0, 1, 2) of an angular velocity, rad/s.
    AngularVelocity(usize),
    /// A distance that the motion covers, or a bound of it, m.
    Distance,
    /// A speed that follows from the input, or a bound of it, m/s.
    Speed,
    /// A bound of the angular speed that follows from the times of rotations, rad/s.
    AngularSpeed,
    /// An acceleration that follows from the input, or a bound of it, m/s².
    Acceleration,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const AXES: [&str; 4] = ["x", "y", "z", "w"];
        match *self {
            Self::Time => write!(f, "time"),
            Self::Position(axis) => write!(f, "position {}", AXES[axis]),
            Self::Velocity(axis) => write!(f, "velocity {}", AXES[axis]),
            Self::Coefficient { power, axis } => {
                write!(f, "coefficient of t^{power} in {}", AXES[axis])
            }
            Self::ControlPoint { point, axis } => {
                write!(f, "control point {point} in {}", AXES[axis])
            }
            Self::Rotation(axis) => write!(f, "rotation {}", AXES[axis]),
            Self::AngularVelocity(axis) => write!(f, "angular velocity {}", AXES[axis]),
            Self::Distance => write!(f, "the distance covered"),
            Self::Speed => write!(f, "the speed"),
            Self::AngularSpeed => write!(f, "the angular speed"),
            Self::Acceleration => write!(f, "the acceleration"),
        }
    }
}
