//! Spheres that provably contain a shape.
//!
//! # The search
//!
//! Let phi be the signed distance to the shape, negative inside. A ball around c with the radius
//! E - phi(c) reaches out of the shape by at most E. So the least overshoot of some centres is
//!
//! ```text
//! E = max over p in the shape of min over i of ( |p - c_i| + phi(c_i) )
//! ```
//!
//! `search` chooses centres, `descent` moves them down the gradient of a soft maximum over all
//! points that reach out far, `search` moves single balls from where they are of little use to
//! where they are needed, and descends again. The points are corners of the balls' shares of
//! polyhedra (`cells`) where these are round or have few faces. Elsewhere they are points of a triangulation
//! (`points`, `nearest`): one with fewer points where the surface is fine, one with more where the surface is
//! coarse (`refine`). Nothing of this has to be right:
//! `certificate` finds the radii and their overshoot anew, and lets balls go that a cover does not need.
//!
//! # The proof
//!
//! 1. **Shares.** The power of a point p with respect to a ball (c, r) is |p - c|² - r². Each point of
//!    a set belongs to the ball with respect to which its power is the least. That divides the set,
//!    whatever the radii were. So the set is covered if each ball contains its own share. And if
//!    any balls cover the set, each contains its share with respect to them: a verdict by shares
//!    loses nothing.
//! 2. **Corners.** The share of a ball is the set, cut by one half-space for each other ball. The set
//!    is a region that a closed surface of polygons bounds (winds around). Each cut removes what of
//!    the surface lies outside of the half-space and closes the surface along its plane. Whatever
//!    a closed surface winds around is in the convex hull of its points, and a ball is convex: it
//!    contains the share if it contains the points of the cut surface. No sample, no subdivision, and
//!    no void goes unnoticed: its corners are points of a cut surface. A surface that is not closed
//!    is cut polygon by polygon, and covered as a surface. Polygons that close a cut may have gaps
//!    and holes. A later cut of them joins crossings as they follow each other along its line, those
//!    of pieces and holes in one plane together: the points stay within what the surface bounds. If
//!    the later plane is that of the polygon to rounding, a point may be in a gap: so a verdict
//!    tests the point that it names.
//! 3. **Rounding.** A cut decides once for each point on which side it lies, and makes one point
//!    for each edge that crosses the plane. So the surface stays closed, whatever is rounded.
//!    Rounding moves polygons by some units in the last place in each cut, less than 1e-12 in all
//!    (lengths are of the order of one here). A point keeps its winding number as long as no
//!    polygon moves across it, and is near the hull of a polygon that does. The half-spaces
//!    are moved outward by more than all of this (1e-11): so a point of a share cannot be lost
//!    between two half-spaces that nearly agree. The radii are enlarged by more than the sum.
//! 4. **Round forms** are proven on polyhedra that contain them: prisms and pyramids whose sides
//!    touch the circles, and rings between tangents of a meridian.
//! 5. **Hulls** are proven on their polygons, if these are closed and even to 5e-7, else on the
//!    triangles of a hull made anew (`hull`). Each point of a hull is within its unevenness of what the
//!    polygons bound (`convex`): so radii are enlarged by that, once.
//! 6. **Overshoot.** A ball reaches out by at most r + phi(c). The depth of a point in a hull is its
//!    least distance from the planes of the faces, moved inward until the faces, which f32 bends,
//!    lie outside of them; in a round form it is a formula. In a mesh it is the least distance that a plane
//!    shows between the point and a triangle; the side is found by the sum of solid angles. The depth in a
//!    compound is the depth in one of its parts, a lower bound.
//!
//! A verdict (`verify`) is the same proof for given radii. A capsule in balls along its axis is proven by a formula.
//! Other round forms are cut into wedges (`wedge`), halved where the proof fails, until the polyhedra are
//! within 1e-7 of the diameter. A corner of a share that is outside of its ball is moved into the form. If it
//! is then outside of all balls, it is the point that is uncovered.

mod cells;
mod certificate;
mod closed_form;
mod convex;
mod descent;
mod error;
mod fit;
mod form;
mod hull;
mod mesh;
mod nearest;
mod nearest_point;
mod options;
mod point_tree;
mod points;
mod random;
mod read;
mod refine;
mod search;
mod solid;
mod sphere_cover;
mod surface;
mod verify;
mod volume;
mod wedge;

pub use error::CoverError;
pub use options::CoverOptions;
pub use sphere_cover::{Extent, SphereCover};
pub use verify::{Coverage, verify_cover};
