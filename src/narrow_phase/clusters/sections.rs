//! The parts of a span in which both rotations are cubics.

use crate::accuracy::Accuracy;
use crate::enclosure::UncertainCubic;
use crate::narrow_phase::BodyView;
use crate::narrow_phase::relative::RelativeCubic;
use crate::orientation::{BakedRotation, Turning, TurningSection};
use crate::spans::{Span, common_part};

/// A part of a span between neighbouring cuts of both bodies' rotations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Section {
    pub(super) span: Span,
    /// Sections of the rotations; `None` for a body that does not turn.
    turns: [Option<TurningSection>; 2],
}

/// Calls `visit` with the parts of a walk that have a distance, those with a small one first: they
/// rule out most others.
pub(super) fn nearest_first<'a>(
    sections: Sections<'a>,
    distance: &dyn Fn(&Section) -> Option<f64>,
    visit: &mut dyn FnMut(&Section),
) {
    let mut sections =
        sections.filter_map(|section| distance(&section).map(|distance| (distance, section)));
    let Some(first) = sections.next() else {
        return;
    };
    let Some(second) = sections.next() else {
        // Most bodies do not turn.
        return visit(&first.1);
    };
    let mut order: Vec<(f64, Section)> = Vec::with_capacity(Sections::USUAL);
    order.extend([first, second]);
    while !order.is_empty() {
        order.extend(sections.by_ref().take(Sections::BLOCK - order.len()));
        order.sort_by(|x, y| x.0.total_cmp(&y.0));
        order.drain(..).for_each(|(_, section)| visit(&section));
        order.extend(sections.next());
    }
}

/// Calls `visit` once with each part of a span that does not begin before `after` (s) and meets an
/// interval (s). If there are many, only parts matter in which a bounding sphere is within a distance (m):
/// `near` returns its motion and that distance, or `None` if that is never so.
pub(super) fn each_near<'a>(
    sections: &dyn Fn((f64, f64)) -> Sections<'a>,
    (interval, after): ((f64, f64), f64),
    near: &dyn Fn() -> Option<(RelativeCubic, UncertainCubic, f64)>,
    visit: &mut dyn FnMut(&Section),
) {
    let mut visited = after;
    let mut visit_all = |times: (f64, f64)| {
        for section in sections(times) {
            if section.span.start >= visited {
                visited = section.span.end.max(section.span.start.next_up());
                visit(&section);
            }
        }
    };
    if sections(interval).nth(Sections::FEW).is_none() {
        visit_all(interval);
    } else if let Some((cubic, enclosed, distance)) = near() {
        cubic.each_time_within(&enclosed, distance, |time| {
            if let Some(times) = common_part((time.earliest, time.latest), interval) {
                visit_all(times);
            }
        });
    }
}

/// Iterator over the parts of a span between cuts of either body's rotation, in time order: those
/// that overlap or touch an interval.
#[derive(Debug)]
pub(super) struct Sections<'a> {
    span: Span,
    turning: [Option<&'a Turning>; 2],
    accuracy: Accuracy,
    turns: [Option<TurningSection>; 2],
    /// An instant of the next part, s.
    time: f64,
    until: f64,
    is_done: bool,
}

impl<'a> Sections<'a> {
    /// Parts of a span that are put in order at a time: a span may have any number.
    const BLOCK: usize = 1024;
    /// Room for those of one revolution of each body, and more.
    const USUAL: usize = 24;
    /// Largest number of parts of which each is tested by itself.
    const FEW: usize = 4;

    /// Returns the walk through the parts of a span that meet an interval (s).
    pub(super) fn of(
        (a, b): (&BodyView<'a>, &BodyView<'a>),
        span: Span,
        accuracy: Accuracy,
        (from, to): (f64, f64),
    ) -> Self {
        Self {
            span,
            turning: [a.turning, b.turning],
            accuracy,
            turns: [None; 2],
            // One step of f64 early, so that a part that ends at `from` is included. Parts that end earlier have no
            // results in the interval: results are rounded to instants of their part.
            time: from.next_down().max(span.start),
            until: to.min(span.end),
            is_done: from > span.end || to < span.start,
        }
    }
}

impl Section {
    /// Returns the middle of the part that lies within an interval (s), if it meets that.
    pub(super) fn middle(&self, (from, to): (f64, f64)) -> Option<f64> {
        let (start, end) = (from.max(self.span.start), to.min(self.span.end));
        (start <= end).then_some(start + 0.5 * (end - start))
    }
}

impl Iterator for Sections<'_> {
    type Item = Section;

    fn next(&mut self) -> Option<Section> {
        if self.is_done {
            return None;
        }
        let (mut start, mut end) = (self.span.start, self.span.end);
        for (turn, turning) in self.turns.iter_mut().zip(self.turning) {
            let Some(turning) = turning else {
                continue;
            };
            let known =
                turn.filter(|section| section.start <= self.time && self.time < section.end);
            let section = known.unwrap_or_else(|| turning.section_at(self.time, self.accuracy));
            (start, end) = (start.max(section.start), end.min(section.end));
            *turn = Some(section);
        }
        self.is_done = end >= self.span.end || end > self.until;
        self.time = end;
        let span = Span {
            start,
            end,
            ..self.span
        };
        let turns = self.turns;
        Some(Section { span, turns })
    }
}

/// The cubics of both bodies' rotations, over the sections met last and over the parts of these.
#[derive(Debug, Default)]
pub(super) struct Rotations {
    sections: [Option<(TurningSection, BakedRotation)>; 2],
    /// `None` for a part that is the whole section.
    parts: [Option<BakedRotation>; 2],
}

impl Rotations {
    /// Returns the rotations over a part, `None` for a body that does not turn.
    pub(super) fn over(
        &mut self,
        views: [&BodyView<'_>; 2],
        section: &Section,
        accuracy: Accuracy,
    ) -> [Option<&BakedRotation>; 2] {
        let ends = (section.span.start, section.span.end);
        for (body, view) in views.iter().enumerate() {
            let (Some(turning), Some(turn)) = (view.turning, &section.turns[body]) else {
                continue;
            };
            if self.sections[body]
                .as_ref()
                .is_none_or(|(met, _)| met != turn)
            {
                self.sections[body] = Some((*turn, turning.bake(turn, accuracy)));
            }
            let whole = self.sections[body].as_ref().map(|(_, baked)| baked);
            let cut = whole.filter(|_| ends != (turn.start, turn.end));
            self.parts[body] = cut.map(|baked| baked.part(ends));
        }
        [0, 1].map(|body| {
            let whole = self.sections[body].as_ref().map(|(_, baked)| baked);
            self.parts[body].as_ref().or(whole)
        })
    }
}
