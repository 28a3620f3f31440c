//! Questions about two bodies, without a scene.
//!
//! A scene answers the same about two of its bodies, to the last bit. Exception: beyond a body's knots, a touch within the
//! rounding of the way from there may be reported by the one and not by the other. Layers play no part: whoever names two
//! bodies means them. Errors name a body by its tag: give both bodies one ([`Body::with_tag`]).
//!
//! ```
//! use nearmiss::glam::DVec3;
//! use nearmiss::{Body, Query, State, Trajectory, Window, pair};
//!
//! let fly = [-9.0, 9.0].map(|t| State::new(t, DVec3::new(t, 3.0, 0.0), DVec3::X));
//! let drone = Body::new(Trajectory::from_states(&fly)?).with_tag(7);
//! let tower = Body::new(Trajectory::at_rest(DVec3::ZERO)?);
//!
//! let nearest = pair::closest_approach(&drone, &tower, Window::new(-9.0, 9.0)?)?;
//! assert!(nearest.is_some_and(|nearest| nearest.time == 0.0 && nearest.separation == 3.0));
//!
//! let conflicts = pair::conflicts(&drone, &tower, &Query::default().with_margin(5.0))?;
//! assert_eq!((conflicts.len(), conflicts[0].tag_a), (1, 7));
//! assert!((conflicts[0].enter + 4.0).abs() < 1e-12);
//! # Ok::<(), nearmiss::Error>(())
//! ```

use super::prepared::{checked_margin, lone_view};
use super::solve::{PairQuestion, SolveScratch, describe};
use crate::conflict::{CertifiedApproach, ClosestApproach, Conflict};
use crate::error::Error;
use crate::id::BodyId;
use crate::narrow_phase::{BodyView, certified_approach, may_touch};
use crate::query::Query;
use crate::rounding::exact_interval;
use crate::scene::{Body, planned};
use crate::spans::{Spans, common_window, spans};
use crate::window::Window;

/// Returns the least separation of two bodies within a window, and its time. `None` if they do not exist at the same time,
/// or both are half-spaces.
///
/// # Errors
///
/// [`Error::WindowNotClosed`] and [`Error::InBody`] as for [`Scene::screen`](crate::Scene::screen), or with
/// [`Error::TurningHalfSpace`].
#[doc(alias = "tca")]
#[doc(alias = "cpa")]
#[doc(alias = "miss distance")]
pub fn closest_approach(
    a: &Body,
    b: &Body,
    window: Window,
) -> Result<Option<ClosestApproach>, Error> {
    with_spans(a, b, window, |view_a, view_b, met, window| {
        crate::narrow_phase::closest_approach(view_a, view_b, met, window)
            .map(|approach| describe(&approach, view_a, view_b))
    })
}

/// Returns [`closest_approach`] with a proof, which takes longer.
///
/// # Errors
///
/// As [`closest_approach`].
pub fn certified_closest_approach(
    a: &Body,
    b: &Body,
    window: Window,
) -> Result<Option<CertifiedApproach>, Error> {
    with_spans(a, b, window, |view_a, view_b, met, window| {
        let (approach, error, time) = certified_approach(view_a, view_b, met, window)?;
        Some(CertifiedApproach {
            approach: describe(&approach, view_a, view_b),
            error,
            time,
        })
    })
}

/// Returns all conflicts of two bodies within the query's window and margin, in time order. A query
/// without a window asks about the time that their plans cover.
///
/// The ids are those that an empty scene would give to `a` and then to `b`.
///
/// # Errors
///
/// [`Error::Margin`], [`Error::NoPlan`], [`Error::WindowNotClosed`] and [`Error::InBody`] as for
/// [`Scene::screen`](crate::Scene::screen), or with [`Error::TurningHalfSpace`].
#[doc(alias = "contacts")]
#[doc(alias = "time of impact")]
pub fn conflicts(a: &Body, b: &Body, query: &Query) -> Result<Vec<Conflict>, Error> {
    let margin = checked_margin(query)?;
    let asked = query.window().or_else(|| planned([a, b].into_iter()));
    let window = asked.ok_or(Error::NoPlan)?;
    let (view_a, view_b) = (lone_view(a, window)?, lone_view(b, window)?);
    let id = |slot| BodyId {
        slot,
        generation: 0,
    };
    let mut found = Vec::new();
    let names = [(id(0), a.tag), (id(1), b.tag)];
    let (views, asked) = ((&view_a, &view_b), (margin, query.accuracy()));
    if let Some(question) = PairQuestion::of(names, views, asked, window.ends()) {
        push_all_conflicts(&question, &mut SolveScratch::default(), &mut found);
    }
    Ok(found)
}

/// Appends all conflicts of two bodies to a list, in time order.
pub(crate) fn push_all_conflicts(
    question: &PairQuestion<'_>,
    scratch: &mut SolveScratch,
    found: &mut Vec<Conflict>,
) {
    let (a, b) = question.views;
    // All instants that may be reported in it.
    let searched = exact_interval(question.window);
    let met = spans(&a.knots, &b.knots, searched.0, searched.1);
    let near = met.filter(|&span| may_touch(a, b, span, question.margin, searched));
    question.push_conflicts(near, scratch, found);
}

/// Returns the answer from the spans of a pair within a window, if both exist there. The answer is
/// about a and b as given.
fn with_spans<T>(
    a: &Body,
    b: &Body,
    window: Window,
    answer: impl FnOnce(&BodyView<'_>, &BodyView<'_>, Spans<'_>, (f64, f64)) -> Option<T>,
) -> Result<Option<T>, Error> {
    let [view_a, view_b] = [lone_view(a, window)?, lone_view(b, window)?];
    if view_a.is_half_space() && view_b.is_half_space() {
        return Ok(None);
    }
    let Some(window) = common_window(&view_a.knots, &view_b.knots, window.ends()) else {
        return Ok(None);
    };
    let met = spans(&view_a.knots, &view_b.knots, window.0, window.1);
    Ok(answer(&view_a, &view_b, met, window))
}
