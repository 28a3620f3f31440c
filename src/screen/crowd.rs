//! The error of a search that found too much: it names a body from the crowd.
//!
//! Some bodies are asked which others come near, each in another part of its time if plans are long. Each body counts as
//! its bounding sphere. So the answer takes about as long for clusters as for balls, and for long plans as for short ones.

use super::one::AskedShape;
use crate::conflict::Conflict;
use crate::count::as_f64;
use crate::error::{Crowd, Error};
use crate::id::BodyId;
use crate::query::Query;
use crate::scene::{Body, Scene};
use crate::window::Window;

/// Bodies that are asked. A question takes as long as the scene has bodies.
const SAMPLE: usize = 16;
/// Spans of all pairs of a body, at most about; four of each pair in any case.
const SPANS: usize = 1 << 14;

impl Scene {
    /// Returns the error of a search that found more spans than a limit in a window, at a margin (m).
    pub(crate) fn too_crowded(&self, limit: usize, window: Window, margin: f64) -> Error {
        Error::TooCrowded {
            limit,
            crowd: self.crowd(window, margin, limit / self.len().max(1)),
        }
    }

    /// Returns the body of a sample that comes near most others; the first one that comes near more than `enough`, if there
    /// is one.
    fn crowd(&self, window: Window, margin: f64, enough: usize) -> Option<Crowd> {
        let ids: Vec<BodyId> = self.bodies().map(|(id, _)| id).collect();
        let cubics = |body: &Body| 1 + body.trajectory.cubics().len();
        let all_cubics: usize = self.bodies().map(|(_, body)| cubics(body)).sum();
        let (asked, stride) = (ids.len().min(SAMPLE), (ids.len() / SAMPLE).max(1));
        let mut largest: Option<Crowd> = None;
        for number in 0..asked {
            // Not in equal strides: no order in which bodies are put in hides some kinds of them.
            let id = ids[number * ids.len() / asked + number % stride];
            let body = self.body(id)?;
            let spans_of_a_pair = cubics(body) + all_cubics / ids.len();
            let parts = spans_of_a_pair.div_ceil((SPANS / ids.len()).max(4));
            let life = window.intersection(body.trajectory.domain());
            let part = life.and_then(|life| part_of(life, number * parts / asked, parts));
            let crowd = part.and_then(|part| self.crowd_around((id, body), part, margin));
            if let Some(crowd) = crowd.filter(|crowd| crowd.is_larger_than(largest)) {
                largest = Some(crowd);
                if crowd.others > enough {
                    break;
                }
            }
        }
        largest
    }

    /// Returns the crowd around one body; `None` if it is alone.
    fn crowd_around(
        &self,
        (own_id, body): (BodyId, &Body),
        window: Window,
        margin: f64,
    ) -> Option<Crowd> {
        let query = Query::new(window).with_margin(margin);
        let asked = self.conflicts_of_one((own_id, body), &query, AskedShape::BoundingSphere);
        let conflicts = asked.ok()?;
        let mut others: Vec<BodyId> = conflicts
            .iter()
            .filter_map(|one| one.other(own_id))
            .collect();
        others.sort_unstable();
        others.dedup();
        Some(Crowd {
            id: own_id,
            tag: body.tag,
            time: densest_instant(&conflicts)?,
            others: others.len(),
        })
    }
}

/// Returns a part of a window by its number among so many, or `None` if the window is not closed.
fn part_of(window: Window, number: usize, parts: usize) -> Option<Window> {
    let at = |number: usize| {
        let share = as_f64(number) / as_f64(parts);
        (window.start() + share * window.duration()).min(window.end())
    };
    let part = Window::new(at(number), at(number + 1)).ok();
    part.filter(|part| part.is_closed())
}

/// Returns the first instant (s) at which most of some conflicts, sorted by their beginnings, last; `None` if there are none.
fn densest_instant(conflicts: &[Conflict]) -> Option<f64> {
    let mut exits: Vec<f64> = conflicts.iter().map(|conflict| conflict.exit).collect();
    exits.sort_unstable_by(f64::total_cmp);
    let (mut over, mut most, mut densest) = (0, 0, None);
    for (begun, conflict) in (1..).zip(conflicts) {
        while exits[over] < conflict.enter {
            over += 1;
        }
        if begun - over > most {
            (most, densest) = (begun - over, Some(conflict.enter));
        }
    }
    densest
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failure fails the test")]

    use super::*;
    use crate::hitbox::Hitbox;
    use crate::layers::Layers;
    use crate::scene::Body;
    use crate::trajectory::{State, Trajectory};
    use glam::{DQuat, DVec3};

    /// A tenth of the bodies fly through one place at one instant, in two kinds that see only each other. All others are far
    /// apart.
    #[test]
    fn a_crowd_of_an_instant_is_found() {
        let (mut scene, ball) = (Scene::new(), Hitbox::sphere(0.05).unwrap());
        for number in 0..1_000_u32 {
            let layers = [Layers::new(1, 2), Layers::new(2, 1)][usize::from(number % 20 == 0)];
            let state = if number % 10 == 0 {
                let turned = DQuat::from_rotation_z(f64::from(number)) * DVec3::X;
                State::new(
                    12.34,
                    DVec3::ZERO,
                    (50.0 + 0.1 * f64::from(number)) * turned,
                )
            } else {
                State::new(
                    0.0,
                    DVec3::new(f64::from(number), 0.0, 50.0) * 100.0,
                    DVec3::X,
                )
            };
            let body = Body::new(Trajectory::coasting(state).unwrap());
            let body = body.with_hitbox(ball.clone()).with_layers(layers);
            scene.insert(body.with_tag(number.into())).unwrap();
        }
        let window = Window::new(0.0, 1_000.0).unwrap();
        let Error::TooCrowded { crowd, limit: 7 } = scene.too_crowded(7, window, 0.0) else {
            unreachable!("another error")
        };
        let crowd = crowd.unwrap();
        assert_eq!((crowd.tag % 10, crowd.others), (0, 50));
        assert!((crowd.time - 12.34).abs() < 0.01, "{crowd}");
        assert!(
            scene
                .body(crowd.id)
                .is_some_and(|body| body.tag == crowd.tag)
        );
        let alone = scene.too_crowded(7, Window::new(0.0, 12.0).unwrap(), 0.0);
        assert!(matches!(alone, Error::TooCrowded { crowd: None, .. }));
    }

    /// Each body is asked about another part of its time: which one does not matter where all stay together.
    #[test]
    fn a_crowd_with_long_plans_is_found() {
        let mut scene = Scene::new();
        for number in 0..20_u32 {
            let state = |knot: u32| {
                let place = DVec3::new(f64::from(number), f64::from(knot % 7), 0.0) * 0.1;
                State::new(f64::from(knot), place, DVec3::ZERO)
            };
            let states: Vec<State> = (0..3_000).map(state).collect();
            let body = Body::new(Trajectory::from_states(&states).unwrap());
            scene.insert(body.with_tag(number.into())).unwrap();
        }
        for window in [Window::ALL, Window::new(7.5, 8.5).unwrap()] {
            let Error::TooCrowded { crowd, .. } = scene.too_crowded(7, window, 5.0) else {
                unreachable!("another error")
            };
            let crowd = crowd.unwrap();
            assert_eq!(crowd.others, 19, "{crowd}");
            assert!(window.contains(crowd.time) && (0.0..3_000.0).contains(&crowd.time));
        }
    }
}
