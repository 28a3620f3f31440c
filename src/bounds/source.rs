//! The cubics of a body and its placement in the frame, from which its boxes are formed.

use super::builder::BoundsBuilder;
use super::compact_cubic::CompactCubic;
use super::compact_trajectory::CompactView;
use super::cubic_run::{CubicRun, largest};
use super::frame::{Frame, Padding};
use super::placement::FramePlacement;
use super::straight_pieces::StraightPieces;
use super::sub_cubic::SubCubic;
use crate::knots::Knots;
use crate::simd::prefetch;
use crate::trajectory::Segment;
use std::slice::from_ref;

/// A cubic from which bounds are formed.
pub(crate) trait BoundingCubic {
    /// Returns the whole cubic between two knots, relative to the body's anchor (frame's unit).
    fn sub_cubic(&self, knots: (f64, f64), placement: &FramePlacement) -> SubCubic;
}

/// A source of boxes: a body's cubics and their placement in the frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CubicSource<'a, C> {
    pub(crate) knots: Knots<'a>,
    /// The cubics of the plan; none of straight motions.
    cubics: &'a [C],
    /// The complete runs of the cubics.
    runs: &'a [CubicRun],
    pub(crate) placement: FramePlacement,
}

impl<'a, C: BoundingCubic> CubicSource<'a, C> {
    /// Returns a whole cubic, listed or beyond the list.
    #[inline(always)]
    pub(crate) fn sub_cubic<const UNLISTED: bool>(&self, number: usize) -> SubCubic {
        if UNLISTED {
            return self.sub_cubic_of_extended(number);
        }
        let knots = self.knots.own();
        self.own_sub_cubic(number, (knots[number], knots[number + 1]))
    }

    /// Returns a whole cubic of the plan.
    #[inline(always)]
    fn own_sub_cubic(&self, number: usize, ends: (f64, f64)) -> SubCubic {
        match self.cubics.get(number) {
            Some(cubic) => cubic.sub_cubic(ends, &self.placement),
            None => SubCubic::anywhere(ends),
        }
    }

    #[inline(never)]
    fn sub_cubic_of_extended(&self, number: usize) -> SubCubic {
        let ends = (self.knots.at(number), self.knots.at(number + 1));
        match self.knots.segment_beyond(number) {
            None => self.own_sub_cubic(number - self.knots.before(), ends),
            Some(segment) => segment.sub_cubic(ends, &self.placement),
        }
    }

    /// Returns the straight motions and the knots between them, if nothing else is followed from an instant (s) on.
    #[inline(always)]
    pub(crate) fn straight_from(&self, from: f64) -> Option<StraightPieces<'a>> {
        let plan = (self.knots.plan()?, self.knots.before());
        StraightPieces::placed(plan, from, || self.placement)
    }

    /// Prefetches a cubic, given its number among those of the plan.
    #[inline(always)]
    pub(crate) fn fetch(&self, number: usize) {
        if let Some(cubic) = self.cubics.get(number) {
            prefetch(from_ref(cubic));
        }
    }

    /// Returns true if the cubics have runs, and all cubics are the plan's own.
    #[inline(always)]
    pub(crate) const fn is_in_runs(&self) -> bool {
        !self.runs.is_empty() && !self.knots.has_unlisted_cubics()
    }

    /// Prefetches the data that [`pass`](Self::pass) would read, or the first cubic if no run fits;
    /// returns the number of the next cubic.
    #[inline(always)]
    pub(crate) fn fetch_first(&self, first: usize, end: usize) -> usize {
        if let Some((run, count)) = largest(self.runs, self.cubics.len(), first, end) {
            prefetch(from_ref(run));
            first + count
        } else {
            self.fetch(first);
            first + 1
        }
    }

    /// Adds the largest run of cubics from `first` to before `end` to a builder. Returns the next
    /// cubic's number, or `None` if no run fits.
    #[inline(always)]
    pub(crate) fn pass<const MOVES: bool, const UNLISTED: bool>(
        &self,
        builder: &mut BoundsBuilder<MOVES>,
        (first, end): (usize, usize),
    ) -> Option<usize> {
        if !UNLISTED {
            let (run, count) = largest(self.runs, self.cubics.len(), first, end)?;
            let until = self.knots.own()[first + count];
            builder.pass(&run.unpack(self.placement.factor), until);
            return Some(first + count);
        }
        let (before, cubics) = (self.knots.before(), self.cubics.len());
        let own = (first.checked_sub(before)?, (end - before).min(cubics));
        let (run, count) = largest(self.runs, cubics, own.0, own.1)?;
        let until = self.knots.at(first + count);
        builder.pass(&run.unpack(self.placement.factor), until);
        Some(first + count)
    }
}

impl<'a> CubicSource<'a, CompactCubic> {
    /// Returns the source of a body with a compact trajectory; `knots` may extend beyond that.
    pub(crate) fn compact(
        knots: Knots<'a>,
        view: &CompactView<'a>,
        padding: &Padding,
        frame: &Frame,
    ) -> Self {
        let mut anchor = view.frame;
        if view.compact_cubics.is_empty() {
            anchor.origin = knots.origin().unwrap_or(anchor.origin);
        }
        Self {
            knots,
            cubics: view.compact_cubics,
            runs: view.runs,
            placement: FramePlacement::new(anchor, view.size, padding, frame),
        }
    }
}

impl<'a, C> CubicSource<'a, C> {
    /// Returns the source of a body of straight motions, with these knots.
    #[inline(always)]
    pub(crate) fn straight(knots: Knots<'a>, padding: &Padding, frame: &Frame) -> Self {
        Self {
            knots,
            cubics: &[],
            runs: &[],
            // Not anchored at its state, which may be far away if the state is old.
            placement: FramePlacement::of_frame(padding, frame),
        }
    }
}

impl<'a> CubicSource<'a, Segment> {
    /// Returns the source of a body without a compact trajectory, for a few boxes.
    #[inline(always)]
    pub(crate) fn plain(
        (knots, segments): (Knots<'a>, &'a [Segment]),
        padding: &Padding,
        frame: &Frame,
    ) -> Self {
        if !knots.straight_motions().is_empty() {
            return Self::straight(knots, padding, frame);
        }
        Self::of_plan((knots, segments), padding, frame)
    }

    #[inline(never)]
    fn of_plan(
        (knots, segments): (Knots<'a>, &'a [Segment]),
        padding: &Padding,
        frame: &Frame,
    ) -> Self {
        let origin = segments.first().map(Segment::origin);
        let anchor = Frame {
            origin: origin.or_else(|| knots.origin()).unwrap_or(frame.origin),
            power: frame.power,
        };
        Self {
            knots,
            cubics: segments,
            runs: &[],
            placement: FramePlacement::new(anchor, 0.0, padding, frame),
        }
    }
}

impl BoundingCubic for CompactCubic {
    #[inline(always)]
    fn sub_cubic(&self, knots: (f64, f64), placement: &FramePlacement) -> SubCubic {
        SubCubic::whole(self, knots, placement.factor)
    }
}

impl BoundingCubic for Segment {
    #[inline(always)]
    fn sub_cubic(&self, knots: (f64, f64), placement: &FramePlacement) -> SubCubic {
        match CompactCubic::of(self, knots, &placement.anchor) {
            Some(compact_cubic) => SubCubic::whole(&compact_cubic, knots, 1.0),
            None => SubCubic::anywhere(knots),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::SliceInterval;
    use super::*;
    use crate::hitbox::{Hitbox, Sphere};
    use glam::{DVec3, Vec4};
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// The rounding of a placement covers the conversion of a hitbox to f32: each of offset, radius
    /// and margin once the largest, and once below f32's resolution.
    #[test]
    fn hitboxes_are_within_their_rounding() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for round in 0..3_000 {
            let unit = [1.0, 1e6, 1e-42][round % 3];
            let sizes =
                [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]][round / 3 % 4];
            let [offset, radius, margin] =
                sizes.map(|size| size * unit * rng.random_range(0.5..1.0));
            let mut coordinate = || rng.random_range(-1.0..1.0);
            let offset = DVec3::new(coordinate(), coordinate(), coordinate()) * offset;
            let Ok(hitbox) = Hitbox::cluster(vec![Sphere { offset, radius }]) else {
                unreachable!("all is finite")
            };
            let frame = Frame::OF_NOTHING;
            let padding = Padding::of(&hitbox, margin, &frame);
            let placement = FramePlacement::new(frame, 0.0, &padding, &frame);
            // In f64 their rounding does not show.
            let reach = radius + 0.5 * margin;
            let wide = |lanes: Vec4| lanes.truncate().as_dvec3();
            let low = wide(placement.low) - f64::from(placement.constant_rounding);
            let high = wide(placement.high) + f64::from(placement.constant_rounding);
            let holds = low.cmple(offset - reach).all() && high.cmpge(offset + reach).all();
            assert!(holds, "{hitbox:?} {margin}");
            let far = offset.length() + reach;
            assert!(
                f64::from(placement.reach + placement.constant_rounding) >= far * (1.0 - 1e-15)
            );
        }
    }

    /// Bodies far from the scene's middle, at rest or fast: the box contains all positions, and the
    /// fat line's deviation holds.
    #[test]
    fn places_far_away_are_within_their_rounding() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for round in 0..3_000 {
            let mut vector =
                |half: f64| DVec3::from_array([0; 3].map(|_| half * rng.random_range(-1.0..1.0)));
            let (origin, way) = (vector(1e6), vector([0.0, 1e6][round % 2]));
            let anchor = Frame {
                origin,
                ..Frame::OF_NOTHING
            };
            let placement = FramePlacement::new(anchor, 0.0, &Padding::NONE, &Frame::OF_NOTHING);
            let way = way.as_vec3();
            let piece = SubCubic {
                points: [0.0, 1.0, 2.0, 3.0].map(|step| (way * (step / 3.0)).extend(0.0)),
                spread: 0.0,
                splits: 0.0,
                from: 0.0,
                to: 1.0,
            };
            let (fat_line, aabb) =
                BoundsBuilder::alone(&piece, &SliceInterval::new(0.0, 1.0)).finish(&placement, 0);
            let [low, high] = [aabb.mins, aabb.maxs]
                .map(|edge| DVec3::new(edge.x.into(), edge.y.into(), edge.z.into()));
            let line = |lanes: [f32; 3]| DVec3::from_array(lanes.map(f64::from));
            for (share, point) in [(0.0, piece.points[0]), (1.0, piece.points[3])] {
                let position = origin + point.truncate().as_dvec3();
                assert!(
                    low.cmple(position).all() && high.cmpge(position).all(),
                    "{round}"
                );
                let deviation =
                    position.distance(line(fat_line.start) + share * line(fat_line.change));
                assert!(
                    deviation <= f64::from(fat_line.radius),
                    "{deviation} {fat_line:?}"
                );
            }
        }
    }
}
