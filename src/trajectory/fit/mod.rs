//! Motions of any kind, approximated by cubics with a known error.
//!
//! | file | content |
//! |---|---|
//! | `result` | the trajectory with its error |
//! | `options` | options of a fit |
//! | `place` | knots, as far apart as a tolerance allows |
//! | `motion` | functions of time |
//! | `velocity` | velocities that are not the derivative of the position |
//! | `fourth_derivative` | distance of a motion from its cubic, by bounds of the fourth derivative |
//! | `deviation` | error of one cubic between two states of a motion |
//! | `polynomials` | polynomials up to degree 7 |
//! | `reduction` | one cubic in place of a part of a polynomial, with the proven remainder |

mod deviation;
mod fourth_derivative;
mod motion;
mod options;
mod place;
mod polynomials;
mod reduction;
mod result;
mod velocity;

pub use options::FitOptions;
pub use result::Fit;
