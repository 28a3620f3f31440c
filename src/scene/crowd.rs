//! A search for a body that is near many others, for the error of a scene that is too crowded.

use super::partners::radius;
use super::{PairAdmission, Scene, SceneEntry};
use crate::broad_phase::PairFilter;
use crate::count::as_f64;
use crate::error::{Crowd, Error};
use crate::id::BodyId;
use glam::DVec3;

/// A body at an instant.
struct PlacedBody {
    id: BodyId,
    tag: u64,
    position: DVec3,
    /// m.
    radius: f64,
    /// The normal of a half-space.
    normal: Option<DVec3>,
}

impl PlacedBody {
    fn of((id, entry): (BodyId, &SceneEntry), time: f64) -> Option<Self> {
        Some(Self {
            id,
            tag: entry.body.tag,
            position: entry.body.trajectory.position(time)?,
            radius: radius(&entry.body),
            normal: entry.body.hitbox.normal(),
        })
    }

    /// Returns true if the bounding spheres of two bodies are within a margin (m). Half-spaces do not meet each other.
    fn is_near(&self, other: &Self, margin: f64) -> bool {
        let between = other.position - self.position;
        match (self.normal, other.normal) {
            (None, None) => between.length() <= self.radius + other.radius + margin,
            (Some(normal), None) => normal.dot(between) <= other.radius + margin,
            (None, Some(normal)) => -normal.dot(between) <= self.radius + margin,
            (Some(_), Some(_)) => false,
        }
    }
}

impl Scene {
    /// Returns the error of a search that found more spans than a limit within a time (s), at a margin (m).
    pub(crate) fn too_crowded(&self, limit: usize, window: (f64, f64), margin: f64) -> Error {
        Error::TooCrowded {
            limit,
            crowd: self.crowd(window, margin),
        }
    }

    /// Returns the body of a sample that is near most others within a margin (m), at one of a few instants of a time (s);
    /// `None` if all of the sample are alone then.
    fn crowd(&self, window: (f64, f64), margin: f64) -> Option<Crowd> {
        const INSTANTS: usize = 8;
        let lives: Vec<(f64, f64)> = self.lives_in(window).collect();
        let instants = (0..INSTANTS.min(lives.len())).map(|number| {
            let (from, to) = lives[number * lives.len() / INSTANTS.min(lives.len())];
            let share = (as_f64(number) + 0.5) / as_f64(INSTANTS);
            from + (to - from) * share
        });
        let crowds = instants.filter_map(|time| self.crowd_at(time, margin));
        crowds.reduce(larger).filter(|crowd| crowd.others > 0)
    }

    /// Returns when each body exists within a time (s), if it does.
    fn lives_in(&self, (from, to): (f64, f64)) -> impl Iterator<Item = (f64, f64)> {
        self.entries().filter_map(move |(_, entry)| {
            let domain = entry.body.trajectory.domain();
            let (from, to) = (from.max(domain.start()), to.min(domain.end()));
            (from <= to).then_some((from, to))
        })
    }

    /// Returns the body of a sample that is near most others at an instant (s).
    fn crowd_at(&self, time: f64, margin: f64) -> Option<Crowd> {
        const SAMPLE: usize = 32;
        let bodies = self.entries();
        let placed: Vec<PlacedBody> = bodies
            .filter_map(|body| PlacedBody::of(body, time))
            .collect();
        let admission = PairAdmission::of(self, margin, &|| false);
        let is_pair = |a: &PlacedBody, b: &PlacedBody| {
            let (slot, other) = (a.id.slot, b.id.slot);
            slot != other
                && a.is_near(b, margin)
                && admission.admits(slot.min(other), slot.max(other))
        };
        let sample = placed.iter().step_by(placed.len().div_ceil(SAMPLE).max(1));
        let crowds = sample.map(|one| Crowd {
            id: one.id,
            tag: one.tag,
            time,
            others: placed.iter().filter(|other| is_pair(one, other)).count(),
        });
        crowds.reduce(larger)
    }
}

/// Returns the larger of two crowds, the first of equal ones.
const fn larger(one: Crowd, other: Crowd) -> Crowd {
    if other.others > one.others {
        other
    } else {
        one
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failure fails the test")]

    use super::*;
    use crate::hitbox::Hitbox;
    use crate::layers::Layers;
    use crate::scene::Body;
    use crate::trajectory::{State, Trajectory};

    fn ball(place: DVec3, velocity: DVec3) -> Body {
        let plan = Trajectory::coasting(State::new(10.0, place, velocity)).unwrap();
        Body::new(plan).with_hitbox(Hitbox::sphere(0.5).unwrap())
    }

    /// A tenth of the bodies are near each other, of two kinds that see only each other; all others are far apart.
    #[test]
    fn a_crowd_of_few_among_many_is_found() {
        let mut scene = Scene::new();
        for number in 0..1_000_u32 {
            let layers = [Layers::new(1, 2), Layers::new(2, 1)][usize::from(number % 20 == 0)];
            let body = if number % 10 == 0 {
                ball(DVec3::X * (1e-3 * f64::from(number)), DVec3::X)
            } else {
                ball(DVec3::new(f64::from(number) * 10.0, 50.0, 0.0), DVec3::ZERO)
            };
            scene
                .insert(body.with_layers(layers).with_tag(number.into()))
                .unwrap();
        }
        let crowd = scene.crowd((0.0, 2.0), 0.5).unwrap();
        assert_eq!((crowd.tag % 10, crowd.others), (0, 50));
        assert!((0.0..=2.0).contains(&crowd.time));
        assert!(
            scene
                .body(crowd.id)
                .is_some_and(|body| body.tag == crowd.tag)
        );
        let error = scene.too_crowded(7, (0.0, 2.0), 0.5).to_string();
        let said = format!("{} (tag {}) is near 50 others at", crowd.id, crowd.tag);
        assert!(error.contains(&said), "{error}");
        assert_eq!(scene.crowd((0.0, 2.0), -2.0), None);
    }

    /// Half-spaces do not meet each other, nor do bodies that exist at different times.
    #[test]
    fn bodies_are_near_where_both_exist() {
        let mut scene = Scene::new();
        let wall = Hitbox::half_space(DVec3::Z).unwrap();
        for height in [0.0, 1.0] {
            let rest = Trajectory::at_rest(DVec3::Z * height).unwrap();
            scene
                .insert(Body::new(rest).with_hitbox(wall.clone()))
                .unwrap();
        }
        assert_eq!(scene.crowd((0.0, 1.0), 1.0), None);
        for start in [0.0, 5.0] {
            let states = [start, start + 1.0];
            let states = states.map(|time| State::new(time, DVec3::Z * 2.0, DVec3::ZERO));
            let plan = Trajectory::from_states(&states).unwrap();
            let body = Body::new(plan).with_hitbox(Hitbox::sphere(0.5).unwrap());
            scene.insert(body).unwrap();
        }
        let others = |margin| scene.crowd((0.0, 10.0), margin).map(|crowd| crowd.others);
        // The upper half-space is half a metre below the sphere, the lower one 1.5 m.
        assert_eq!([0.4, 0.6, 1.6].map(others), [None, Some(1), Some(2)]);
    }
}
