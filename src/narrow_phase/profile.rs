//! Distance of two spheres as a function of the time of a span, and the intervals in which it is within a threshold.
//!
//! Between neighbouring stationary points the distance is monotonic, so each crossing of the
//! threshold is bracketed; it is solved on the relative position vector. Everything is found on
//! the whole span first and clipped to the window afterwards, so that an interval has the same bits
//! whatever the window.

use super::crossing::{ProfileNode, crossing};
use super::dips::{DistanceExtrema, may_be_hidden};
use super::relative::RelativeCubic;
use super::squared_distance::is_monotonic;
use super::stationary::{MAX_STATIONARY, MAXIMUM_ERROR, stationary_points};
use crate::conflict::Clip;
use crate::rounding::norm;

/// An instant of a span with its centre distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProfilePoint {
    pub(crate) time: f64,
    /// Centre distance, m.
    pub(crate) distance: f64,
    /// Rounding of a distance that is constant over the span, m; else 0.
    pub(crate) plateau: f64,
}

/// Distance over a span: its values at the nodes. It is monotonic between neighbouring ones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DistanceProfile {
    /// The ends of the span, and the stationary points between them.
    nodes: [ProfileNode; MAX_STATIONARY + 2],
    count: usize,
    /// Rounding of a constant distance, as [`ProfilePoint::plateau`].
    plateau: f64,
}

impl DistanceProfile {
    pub(crate) fn of(cubic: &RelativeCubic) -> Self {
        if cubic.is_constant() {
            Self::constant(cubic)
        } else {
            Self::changing(cubic)
        }
    }

    /// Returns the profile of a constant distance: differences at the ends are rounding.
    #[cold]
    fn constant(cubic: &RelativeCubic) -> Self {
        let first = ProfileNode::first(cubic);
        let mut profile = Self::from(first);
        profile.plateau = cubic.tolerance();
        profile.push(ProfileNode {
            distance: first.distance,
            ..ProfileNode::last(cubic)
        });
        profile
    }

    // Not inlined: a profile is formed where its caller wants it, instead of moved there.
    #[inline(never)]
    fn changing(cubic: &RelativeCubic) -> Self {
        let mut profile = Self::from(ProfileNode::first(cubic));
        if is_monotonic(cubic) {
            profile.push(ProfileNode::last(cubic));
            return profile;
        }
        for s in stationary_points(cubic) {
            profile.push(ProfileNode::at(cubic, s));
        }
        profile.push(ProfileNode::last(cubic));
        let distances = profile.nodes().iter().map(|node| node.distance);
        if may_be_hidden(cubic, distances.fold(f64::INFINITY, f64::min)) {
            profile.count = 0;
            let extrema = DistanceExtrema::of(cubic);
            extrema
                .as_slice()
                .iter()
                .for_each(|node| profile.push(*node));
        }
        profile
    }

    const fn from(first: ProfileNode) -> Self {
        Self {
            nodes: [first; MAX_STATIONARY + 2],
            count: 1,
            plateau: 0.0,
        }
    }

    const fn push(&mut self, node: ProfileNode) {
        self.nodes[self.count] = node;
        self.count += 1;
    }

    /// Returns true if the distance falls to `radius` somewhere; else there are no
    /// [intervals within it](Self::intervals_within).
    pub(crate) fn comes_within(&self, cubic: &RelativeCubic, radius: f64) -> bool {
        let threshold = radius + cubic.tolerance();
        self.nodes().iter().any(|node| node.distance <= threshold)
    }

    /// Calls `visit` with a bound of the distance in each of so many equal parts of a stretch, to rounding, m. The ends of
    /// the stretch are local parameters.
    #[inline]
    pub(super) fn each_largest_in_parts(
        &self,
        cubic: &RelativeCubic,
        ((start, end), parts): ((f64, f64), usize),
        mut visit: impl FnMut(f64),
    ) {
        let within = |node: &&ProfileNode| node.s >= start;
        let mut nodes = self.nodes().iter().filter(within).peekable();
        let forms = cubic.power_forms();
        let mut before = norm(forms.at(start).0);
        for part in 1..=parts {
            let part_end = start + part as f64 / parts as f64 * (end - start);
            let after = norm(forms.at(part_end).0);
            let mut largest = before.max(after);
            while let Some(node) = nodes.next_if(|node| node.s <= part_end) {
                // Where the distance is tiny its square has no more digits.
                largest = largest.max(node.distance.hypot(MAXIMUM_ERROR * cubic.size));
            }
            visit(largest);
            before = after;
        }
    }

    /// Returns the distances at the start and at the end of the span, m.
    pub(super) fn at_ends(&self) -> [f64; 2] {
        [self.nodes[0].distance, self.nodes[self.count - 1].distance]
    }

    /// Returns true if the distance is constant over the span.
    pub(super) const fn is_plateau(&self) -> bool {
        self.plateau > 0.0
    }

    fn nodes(&self) -> &[ProfileNode] {
        &self.nodes[..self.count]
    }

    fn instant(&self, node: &ProfileNode) -> ProfilePoint {
        ProfilePoint {
            time: node.time,
            distance: node.distance,
            plateau: self.plateau,
        }
    }

    /// Returns the earliest instant of least distance in the overlap of `from..=to` and the span.
    pub(crate) fn closest(&self, cubic: &RelativeCubic, from: f64, to: f64) -> ProfilePoint {
        let interval = (from.max(cubic.start), to.min(cubic.end));
        let clip = Clip {
            at_enter: true,
            at_exit: true,
        };
        self.closest_in(cubic, interval, clip)
    }

    /// Returns the earliest instant of least distance of an interval within the threshold. Ends that are not clipped are
    /// crossings of the threshold: the distance there exceeds that of a node inside, whatever
    /// rounding says.
    ///
    /// An instant that is the result of an interval is also that of each clipped part that contains it, unless the distance
    /// is constant: at a clipped end the distance is not below that of the node from which it rises there, whatever rounding
    /// says.
    pub(super) fn closest_in(
        &self,
        cubic: &RelativeCubic,
        (from, to): (f64, f64),
        clip: Clip,
    ) -> ProfilePoint {
        let point_at = |time: f64, least: f64| ProfilePoint {
            time,
            distance: cubic.distance(cubic.parameter(time)).max(least),
            plateau: self.plateau,
        };
        let mut closest = None;
        let mut include = |point: ProfilePoint| {
            closest = Some(closest.map_or(point, |first: ProfilePoint| first.or_lower(point)));
        };
        // The distances of the two nodes between which an instant lies, if it is none of a node.
        let around = |time: f64| {
            let next = self.nodes().iter().position(|node| node.time >= time)?;
            let [before, after] = self.nodes.get(next.checked_sub(1)?..=next)? else {
                return None;
            };
            (after.time > time).then_some((before.distance, after.distance))
        };
        if self.plateau > 0.0 || from <= cubic.start {
            include(ProfilePoint {
                time: from,
                ..self.instant(&self.nodes[0])
            });
        } else if clip.at_enter
            && let Some((before, after)) = around(from)
            && before <= after
        {
            include(point_at(from, before));
        }
        for node in self.nodes() {
            if from <= node.time && node.time <= to {
                include(self.instant(node));
            }
        }
        if clip.at_exit
            && to < cubic.end
            && let Some((before, after)) = around(to)
            && before > after
        {
            include(point_at(to, after));
        }
        closest.unwrap_or_else(|| point_at(from, 0.0))
    }

    /// Calls `found` with the ends (s) and the instant of least distance of each maximal
    /// interval within `radius` that overlaps `from..=to`, clipped to it. They come in time order.
    /// Distances within rounding of the radius count.
    pub(crate) fn intervals_within(
        &self,
        cubic: &RelativeCubic,
        radius: f64,
        (from, to): (f64, f64),
        mut found: impl FnMut((f64, f64), ProfilePoint),
    ) {
        let threshold = radius + cubic.tolerance();
        let nodes = self.nodes();
        let is_inside = |node: &ProfileNode| node.distance <= threshold;
        let mut k = 0;
        while k < nodes.len() {
            if !is_inside(&nodes[k]) {
                k += 1;
                continue;
            }
            let first = k;
            while k + 1 < nodes.len() && is_inside(&nodes[k + 1]) {
                k += 1;
            }
            let last = k;
            k += 1;
            // Crossings lie between nodes: those beyond the window need not be solved.
            let (before, after) = (first.checked_sub(1).map(|k| &nodes[k]), nodes.get(k));
            if before.is_some_and(|node| node.time > to)
                || after.is_some_and(|node| node.time < from)
            {
                continue;
            }
            let (first, last) = (&nodes[first], &nodes[last]);
            let enter = match before {
                Some(outside) if first.time > from => crossing(cubic, radius, first, outside),
                Some(_) => from,
                None => first.time,
            };
            let exit = match after {
                Some(outside) if last.time < to => crossing(cubic, radius, last, outside),
                Some(_) => to,
                None => last.time,
            };
            let (enter, exit) = (enter.max(from), exit.min(to));
            if enter <= exit {
                let clip = Clip {
                    at_enter: enter <= from,
                    at_exit: exit >= to,
                };
                let closest = self.closest_in(cubic, (enter, exit), clip);
                found((enter, exit), closest);
            }
        }
    }
}

impl ProfilePoint {
    /// Returns the lower of two instants, `self` being the earlier; the earlier one of ties.
    /// Plateaus also tie within rounding.
    pub(crate) fn or_lower(self, later: Self) -> Self {
        let tie = self.plateau.min(later.plateau);
        if later.distance < self.distance - tie {
            later
        } else {
            self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rounding::exact::vector;
    use crate::rounding::{UNIT_ROUNDOFF, largest_norm};
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Returns a motion of one second from `start` on (s), good to so many roundings of its size.
    fn any_cubic(rng: &mut ChaCha8Rng, start: f64, roundings: f64) -> RelativeCubic {
        let points = [0; 4].map(|_| vector(rng, 1.0));
        let size = largest_norm(&points);
        RelativeCubic {
            start,
            end: start + 1.0,
            points,
            error: roundings * UNIT_ROUNDOFF * size,
            size,
        }
    }

    /// The largest distance in a part of a stretch: no instant of it is farther, and one is as far.
    #[test]
    fn no_instant_of_a_part_is_farther_than_its_largest_distance() {
        const PARTS: usize = 4;
        const SAMPLES: usize = 256;
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut peaks = 0;
        for round in 0..2_000 {
            let cubic = any_cubic(&mut rng, 0.0, 0.0);
            let stretch = if round % 2 == 0 {
                (0.0, 1.0)
            } else {
                (rng.random_range(0.0..0.5), rng.random_range(0.5..1.0))
            };
            let mut largest = Vec::new();
            let profile = DistanceProfile::of(&cubic);
            profile.each_largest_in_parts(&cubic, (stretch, PARTS), |one| largest.push(one));
            assert_eq!(largest.len(), PARTS);
            for (part, largest) in largest.into_iter().enumerate() {
                let distance = |sample: usize| {
                    let share = (part as f64 + sample as f64 / SAMPLES as f64) / PARTS as f64;
                    cubic.distance(stretch.0 + share * (stretch.1 - stretch.0))
                };
                let sampled = (0..=SAMPLES).map(distance).fold(0.0, f64::max);
                let more = largest - sampled;
                assert!((-1e-12..1e-3).contains(&more), "{round} {part} {more}");
                peaks += u32::from(largest > distance(0).max(distance(SAMPLES)) + 1e-9);
            }
        }
        assert!(peaks > 300, "{peaks}");
    }
}
