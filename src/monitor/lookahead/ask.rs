//! Contacts of a plan that no body follows: for [`Monitor::what_if`](crate::Monitor::what_if).

use super::super::monitored_bodies::MonitoredBody;
use super::super::slice::NearBody;
use super::LookaheadSearch;
use crate::bounds::CubicSource;
use crate::narrow_phase::{BodyView, Contact, contacts, may_touch};
use crate::rounding::exact_interval;
use crate::scene::Scene;
use crate::spans::{common_part, common_window, in_order, spans};

impl LookaheadSearch {
    /// Calls `visit` with each contact of a plan that no body follows with another body, within
    /// `from..=to` (s).
    ///
    /// Only spans in which slices report the other body near are examined: in a long lookahead with fast
    /// traffic, a body crosses the boxes of hundreds, each for a moment.
    ///
    /// The slot is that of the plan's body, which need not be there yet. `admits` tells with which
    /// slots it may be a pair.
    pub(in crate::monitor) fn contacts_with(
        &self,
        scene: &Scene,
        (slot, monitored, own): (u32, &MonitoredBody, &BodyView<'_>),
        margin: f64,
        (from, to): (f64, f64),
        admits: &dyn Fn(u32) -> bool,
        mut visit: impl FnMut(u32, (f64, f64), &BodyView<'_>, &Contact),
    ) {
        let mut neighbours = self.neighbours(scene, (monitored, own), (from, to));
        let have_partners = scene.len() > 1 && scene.admits_all(self.grid.margin);
        if scene.in_slot(slot).is_none() && !have_partners {
            // It may be the first partner of bodies that are in no slice.
            let (from, to) = exact_interval((from, to));
            let alone = self.monitored.without_partner();
            neighbours.extend(alone.map(|slot| NearBody { slot, from, to }));
        }
        self.add_half_spaces(own, (from, to), &mut neighbours);
        neighbours.sort_unstable_by_key(|neighbour| neighbour.slot);
        let (mut near, mut found) = (Vec::new(), Vec::new());
        for times in neighbours.chunk_by(|one, next| one.slot == next.slot) {
            let other = times[0].slot;
            let admitted = other != slot && admits(other);
            let Some(view) = self.monitored.view(scene, other).filter(|_| admitted) else {
                continue;
            };
            let [(_, a), (_, b)] = in_order((slot, own), (other, &view));
            let Some(window) = common_window(&a.knots, &b.knots, (from, to)) else {
                continue;
            };
            let searched = exact_interval(window);
            near.clear();
            for time in times {
                if let Some(part) = common_part((time.from, time.to), searched) {
                    let touching = spans(&a.knots, &b.knots, part.0, part.1)
                        .filter(|&span| may_touch(a, b, span, margin, part));
                    near.extend(touching);
                }
            }
            // A span is solved as a whole, and once, in however many slices it is.
            near.sort_unstable_by_key(|span| (span.cubic_a, span.cubic_b));
            near.dedup();
            found.clear();
            contacts(a, b, near.iter().copied(), margin, window, &mut found);
            for contact in &found {
                visit(other, window, &view, contact);
            }
        }
    }

    /// Adds the half-spaces, which slices know nothing of; of a half-space, all other bodies.
    fn add_half_spaces(
        &self,
        own: &BodyView<'_>,
        (from, to): (f64, f64),
        neighbours: &mut Vec<NearBody>,
    ) {
        let (from, to) = exact_interval((from, to));
        let throughout = |slot| NearBody { slot, from, to };
        if own.is_half_space() {
            neighbours.clear();
            let all = (0_u32..).take(self.monitored.len());
            neighbours.extend(all.map(throughout));
        } else {
            let planes = self.monitored.half_spaces().iter().copied();
            neighbours.extend(planes.map(throughout));
        }
    }

    /// Returns the bodies that may be near a plan within `from..=to` (s), and when; perhaps its own, in any
    /// order.
    fn neighbours(
        &self,
        scene: &Scene,
        (monitored, own): (&MonitoredBody, &BodyView<'_>),
        (from, to): (f64, f64),
    ) -> Vec<NearBody> {
        let window = exact_interval((from, to));
        let knots = (own.knots, own.segments);
        let source = CubicSource::plain(knots, &monitored.padding, &self.grid.frame);
        let (mut scratch, mut neighbours) = (self.pool.take(), Vec::new());
        let bodies = self.bodies(scene);
        if self.recent.len() > 0 {
            // What slices know of these is out of date, wherever it is.
            let ends = [window.0, window.1];
            scratch.block.form_one(&self.grid.frame, &source, &ends);
            for own in &scratch.block.slices[0].boxes {
                self.recent
                    .meeting(&bodies, window, &own.aabb, &mut neighbours);
            }
        }
        let covered = self.slices.iter();
        let covered: Vec<_> = covered
            .filter(|slice| slice.covers_some_of(window))
            .collect();
        for slice in &covered {
            slice.list_changed(&mut neighbours);
            if slice.is_placed() {
                let (index, interval) = (&slice.index, slice.interval);
                index.neighbours(&bodies, interval, &source, &mut scratch, &mut neighbours);
            }
        }
        let count = self.grid.slices_to_search();
        let runs = covered.chunk_by(|one, next| {
            one.is_placed() == next.is_placed() && one.number + 1 == next.number
        });
        for run in runs.filter(|run| !run[0].is_placed()) {
            // The window may begin and end within a slice.
            let groups = ((run.len() + count / 2) / count).max(1);
            for slices in run.chunks(run.len().div_ceil(groups)) {
                let queries = &self.query_indexes;
                queries.neighbours(
                    &bodies,
                    (slices, window),
                    &source,
                    &mut scratch,
                    &mut neighbours,
                );
            }
        }
        neighbours
    }
}
