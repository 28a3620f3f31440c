//! Certified enclosures of a cubic's least distance from the origin, its time, and the side of a
//! threshold, with proof against rounding.
//!
//! The input is an [`UncertainCubic`]: four Bézier control points in `f64`, and a bound for how far
//! the exact relative motion can be from the cubic that they define. The answers are
//! [`LeastDistance`] and [`Stretches`]. Every bound below is a worst case for IEEE 754 binary64,
//! rounded to nearest; fused operations are not used and would not break it. The same input gives
//! the same bits on every machine.
//!
//! # Symbols
//!
//! | symbol | meaning |
//! |---|---|
//! | u | 2^-53, the largest relative error of one operation |
//! | n u | stands for n u / (1 - n u): the relative error of a term that passes n roundings |
//! | s | parameter in 0..=1; x: the same on a part, counted from its base (one of its ends) |
//! | h | the cubic defined by the given control points, taken as exact; h', h'' by x |
//! | E | bound on the distance of h from the exact motion, at all s |
//! | M | largest norm of a given control point |
//! | F | E + 9 u M: the same as E for any part computed from the control points (section 1) |
//! | d | the squared norm of a cubic, of degree 6, with Bernstein coefficients d0..d6 |
//! | k0..k3 | computed control points of a part, k0 at its base; m: the norm of k0 |
//! | δj | kj - k0; A: the largest of their norms |
//!
//! Norms are Euclidean; an error of at most c |v| in every component v of a vector is one of at
//! most c times its norm. A factor 1 + 2^-40 on the bounds covers all terms of second order and the
//! rounding of the bounds themselves, an additive 1e-150 covers underflow (section 7).
//!
//! Three ideas keep the bounds small. The error is carried as a length, in front of the squares:
//! if h is known to E, so is its least norm, however small it is (an error of the square, seen
//! from a norm m, is divided by 2 m). Parts are computed from the given control points, never from
//! other parts, so the error does not grow with the depth of a search. And squared distances are
//! compared as differences from the one at a nearby point.
//!
//! # 1. Parts
//!
//! A control point of the part over a..=b is formed in three steps of (1 - t) p + t q, with t = a
//! or b (the blossom; where a = 0 or b = 1 it is de Casteljau's scheme). A term passes at most
//! three roundings per step (1 - t, the product, the sum), nine in all. The weights are not
//! negative and sum to one, hence
//!
//! ```text
//! |computed - exact control point| <= 9 u M        for every part, however short
//! ```
//!
//! and by convexity the same holds all along the part, and for single points.
//!
//! # 2. Squares
//!
//! ```text
//! d0 = h0·h0        d2 = (2 h0·h2 + 3 h1·h1)/5    d4 = (2 h1·h3 + 3 h2·h2)/5    d6 = h3·h3
//! d1 = h0·h1        d3 = (h0·h3 + 9 h1·h2)/10     d5 = h2·h3
//! ```
//!
//! A scalar product of p and q has an error of 3 u |p| |q|, the weighted sums four roundings more
//! (factor, sum, and 0.2 or 0.1, themselves rounded), and the weights sum to one: 7 u M² for the
//! points as computed. 8 u M² is used; it covers the rounding of M² and of one sum. Control
//! points wrong by e add 2 M e + e². Between its ends, d lies between its least and its greatest
//! coefficient.
//!
//! # 3. Difference form
//!
//! With aj = k0·δj and gij = δi·δj the Bernstein coefficients of d - m² on a part are exactly
//!
//! ```text
//! e1 = a1                          e3 = (a3 + 9 (a1 + a2 + g12))/10                e5 = a2 + a3 + g23
//! e2 = (2 a2 + 6 a1 + 3 g11)/5     e4 = (2 (a1 + a3 + g13) + 3 (2 a2 + g22))/5     e6 = 2 a3 + g33
//! ```
//!
//! δj has a relative error of u, hence aj one of 4 u m |δj|, and gij one of 5 u |δi| |δj|. The
//! roundings that each term passes, times its weight:
//!
//! | | terms of m A | terms of A² |
//! |---|---|---|
//! | e2 | 8/5 × 9 = 14.4 | 3/5 × 9 = 5.4 |
//! | e3 | 19/10 × 10 = 19 | 9/10 × 10 = 9 |
//! | e4 | 4/5 × 9 + 6/5 × 9 = 18 | 2/5 × 9 + 3/5 × 10 = 9.6 |
//! | e5 | 2 × 6 = 12 | 1 × 6 = 6 |
//! | e6 | 2 × 5 = 10 | 1 × 6 = 6 |
//!
//! ```text
//! |error of e1| <= 4 u m |δ1|        |error of e2..e6| <= u A (19 m + 10 A)
//! ```
//!
//! Unlike 8 u M², these vanish with the length of the part. Both are formed from one root, that of
//! m² A²: with m A for m |δ1|, and the roundings of the bounds themselves.
//!
//! # 4. A quadratic from below
//!
//! On 0..=1, x has the Bernstein coefficients k/6 and x² has k (k - 1)/30. So with lower bounds bk
//! of the coefficients ek, c1 = 6 b1, and c2 the least of 30 (bk - k b1) / (k (k - 1)) for k =
//! 2..=6:
//!
//! ```text
//! d(x) >= m² + c1 x + c2 x²
//! d(x) >= m² - depth,     depth = c1² / (4 c2)          where c1 < 0 and -c1 <= 2 c2,
//!                                 max(0, -(c1 + c2))    elsewhere;  at most max(0, -b1, .., -b6)
//! ```
//!
//! If k0 is a minimum up to rounding, c1 is of the order of u m A, so depth is of the order of u²
//! m²: the lower bound is m² but for a few roundings of m², even for m far below M. The computed m²
//! has a relative error of 3 u, and two differences follow; 6 u m² is subtracted. c2 takes at most
//! 15 times the error of a coefficient, and 4 roundings of terms of 54 m A + 9 A² in sum; it is
//! lowered by u (530 m A + 200 A²). The quadratic also tells beyond which x the distance is
//! certainly above a bound.
//!
//! # 5. The least distance
//!
//! A guess (samples and Newton steps; not trusted) divides 0..=1 in two parts that have it as
//! their base. Where their lower bounds are not good enough, the part with the smallest is divided,
//! and so on, best first. With m the least norm met at a base, and B the least lower bound of all
//! parts, each rounded outward,
//!
//! ```text
//! low = max(0, sqrt(B) - F)        high = m + F
//! ```
//!
//! enclose the least exact distance, whenever the search stops: a part's computed cubic is nowhere
//! farther than F from the exact motion. It stops where sqrt(B) >= m - max(F/4, 8 u M), or where m
//! is below 16 u M (the spacing of s below 1 alone moves h by up to 6 u M), or at a limit of work.
//!
//! **When.** At a minimiser of the exact distance that distance is at most m + F, the computed one
//! at most m + 2 F. What the quadratics of all parts leave below that bound is a first enclosure of
//! all minimisers; its width is of the order of sqrt(m F / c2), the best that values can tell.
//! Long parts may leave far more: where the guess is an end of 0..=1, the distance is tight at once,
//! however coarse the quadratic of all the rest. So a wide enclosure is trimmed on both sides. The
//! outermost part that can be below the bound is divided, and dropped once it cannot. This goes on
//! until a point below the bound is at least half as far out as the enclosure reaches. At most 32
//! parts are looked at on a side.
//!
//! Slopes tell more. The error is a cubic that stays below F on the part, so by Markov's
//! inequalities (along any direction) its three derivatives by x stay below 18 F, 96 F and 192 F.
//! So at the base h·h' is known to F |h'| + 18 F |h|; let G be the largest value it can have. Over
//! the first enclosure,
//! |h'|² + h·h'' is at least its value at the base, less the errors of that, less the reach of the
//! enclosure times a bound of its derivative 3 h'·h'' + h·h'''; let that be L. If L > 0 the exact
//! squared distance is strictly convex there, and no minimiser, at the ends of 0..=1 neither, is
//! farther than G/L from the base. That is of the order of F/|h'|: the square of the first. (Where
//! the exact motion is no cubic, as that of turning spheres, the first enclosure is the answer.)
//!
//! # 6. Stretches
//!
//! For a threshold R between R1 and R2, |h| < R1 - E is certainly inside, |h| > R2 + E certainly
//! outside. Parts are judged by the coefficients of section 2, with e = 9 u M:
//!
//! - all on one side of a squared threshold: then so is the part;
//! - certain signs that change once, with at most one uncertain coefficient where they change: by
//!   Descartes' rule of signs in Bernstein form it is crossed exactly once. Newton's method
//!   finds where; then the nearest points are sought at which the computed distance differs from
//!   the threshold by F and a few roundings. As there is no second crossing, all of the part before
//!   the one and beyond the other is certain;
//! - otherwise the quadratic of section 4 cuts off the outside, or the part is divided;
//! - a part within four times the error of the threshold is undecided: dividing it gains nothing.
//!
//! An undecided stretch therefore ends where the distance differs from the threshold by a few F
//! (about one at a crossing). At a crossing with the closing speed v, per unit of s, it is 2 F / v
//! long; at a touch its length is of the order of sqrt(F).
//!
//! # 7. Range
//!
//! The input is multiplied by a power of two first, so that the largest coordinate (or the error,
//! if that is larger) lies in 1..2: all squares, and products of two squares, are in range then.
//! Scaling is exact but for results below 2^-1022, which 1e-150, added to the error, covers. What
//! underflow takes from a bound of squares is below 1e-174 (the root of a product m² A² that is
//! lost is below 1e-161, and meets 530 u); 1e-150 is added to each, and does not show. The answer
//! is multiplied back, and moved outward by a unit in the last place where that is not exact. So
//! subnormal control points are served like all others. Flushing of subnormal numbers to zero must
//! be off in the threads that call this. Blocks of kernels are not scaled; they are proven for
//! sizes from 1e-50 to 1e50 alone.
//!
//! # 8. Measured
//!
//! `NEARMISS_SEEDS=0..2500 cargo test --release --test oracle -- --ignored --nocapture`: questions
//! to whole scenes, each two trajectories from states, a margin and a window; every answer verified
//! in exact integer arithmetic by the signs of `distance² - threshold²` over the intervals that its
//! certificate names, a fiftieth of them by isolating all roots. Half of the questions and all of
//! some families ask for a margin within 1e-6, 1e-9, 1e-12, a rounding, or nothing of the least
//! distance: hence the unresolved ones. L is the local scale. (`Beyond` extrapolates and coasts.
//! Medians and 99.9 % are upper ends of bins, a quarter of a binary order wide. An earlier version
//! was asked 10,010,000 questions of the other families, with the same outcome, and widths of
//! 5.4e-15 at most.)
//!
//! | family | questions | isolated | conflicts | unresolved | false negatives | false positives | violations | width/L, median | 99.9 % | largest |
//! |---|---|---|---|---|---|---|---|---|---|---|
//! | Random | 250,000 | 5,000 | 204,558 | 47,262 | 0 | 0 | 0 | 2.5e-15 | 4.2e-15 | 4.7e-15 |
//! | Grazing | 250,000 | 5,000 | 165,261 | 94,719 | 0 | 0 | 0 | 2.5e-15 | 4.2e-15 | 4.4e-15 |
//! | Gap | 250,000 | 5,000 | 237,627 | 94,801 | 0 | 0 | 0 | 2.5e-15 | 4.2e-15 | 4.7e-15 |
//! | Docking | 250,000 | 5,000 | 211,513 | 105,792 | 0 | 0 | 0 | 2.1e-15 | 3.6e-15 | 4.4e-15 |
//! | Multiple | 250,000 | 5,000 | 196,365 | 75,838 | 0 | 0 | 0 | 1.8e-15 | 3.6e-15 | 3.7e-15 |
//! | Parallel | 250,000 | 5,000 | 212,708 | 84,805 | 0 | 0 | 0 | 8.9e-16 | 4.2e-15 | 4.0e-15 |
//! | AtKnot | 250,000 | 5,000 | 230,455 | 49,967 | 0 | 0 | 0 | 1.5e-15 | 3.0e-15 | 3.4e-15 |
//! | AtWindowEnd | 250,000 | 5,000 | 196,437 | 47,873 | 0 | 0 | 0 | 2.5e-15 | 4.2e-15 | 4.3e-15 |
//! | Durations | 250,000 | 5,000 | 204,196 | 47,628 | 0 | 0 | 0 | 2.5e-15 | 4.2e-15 | 4.5e-15 |
//! | Far | 250,000 | 5,000 | 204,797 | 53,423 | 0 | 0 | 0 | 2.5e-15 | 4.2e-15 | 4.3e-15 |
//! | MixedScales | 250,000 | 5,000 | 205,206 | 47,408 | 0 | 0 | 0 | 2.5e-15 | 4.2e-15 | 4.9e-15 |
//! | Beyond | 250,000 | 5,000 | 232,415 | 50,562 | 0 | 0 | 0 | 2.5e-15 | 1.6e-13 | 6.3e-13 |

mod crossing_estimate;
mod crossings;
mod cubic;
mod minimum;
mod minorant;
mod part;
mod reach;
mod scaled;
mod stationary;
mod stretches;
mod thresholds;

pub use cubic::{
    DistanceEnclosure, Effort, LeastDistance, OutOfRange, ParameterEnclosure, Stretch, Threshold,
    UncertainCubic, Verdict,
};
pub(crate) use minimum::{enclosure, target};
pub(crate) use minorant::Minorant;
pub(crate) use part::{from_nearer, part, reversed, split, squared_distance};
pub(crate) use scaled::part_error;
pub use stretches::Stretches;
