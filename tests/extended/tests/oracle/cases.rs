//! Seeded families of questions that are hard in one way each.

use glam::DVec3;
use nearmiss::{Accuracy, Body, Outside, Query, Scene, State, Trajectory, Window};
use rand::{Rng, RngExt};

/// What is hard about a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    Random,
    /// The margin is the least distance, but for 1e-9, 1e-12, a rounding, or nothing.
    Grazing,
    /// The margin is a largest distance between two minima, but for as little.
    Gap,
    /// The bodies come to rest at one place: distance and speed vanish together.
    Docking,
    /// As docking, with no acceleration left, or all the way at one distance from it.
    Multiple,
    /// One velocity, or one plan, for both.
    Parallel,
    /// The closest approach is at a knot.
    AtKnot,
    /// The window ends at the closest approach, or at a crossing.
    AtWindowEnd,
    /// Spans of 1e-6 s or 1e6 s.
    Durations,
    /// A million kilometres out, 1e9 s after the epoch.
    Far,
    /// The bodies go on beyond their knots, along their cubics or straight.
    Beyond,
    /// One body moves a thousand or a million times more than the other.
    MixedScales,
}

pub(crate) const FAMILIES: [Family; 12] = [
    Family::Random,
    Family::Grazing,
    Family::Gap,
    Family::Docking,
    Family::Multiple,
    Family::Parallel,
    Family::AtKnot,
    Family::AtWindowEnd,
    Family::Durations,
    Family::Far,
    Family::MixedScales,
    Family::Beyond,
];

/// Two bodies, a margin and a window.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) states: [Vec<State>; 2],
    pub(crate) margin: f64,
    pub(crate) window: Option<(f64, f64)>,
    pub(crate) outside: Outside,
}

fn vector(rng: &mut impl Rng, half: f64) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| rng.random_range(-half..=half)))
}

/// A few states at irregular times.
fn path(rng: &mut impl Rng, start: f64, duration: f64, centre: DVec3, size: f64) -> Vec<State> {
    let count = rng.random_range(1..=3);
    let mut time = start;
    (0..=count)
        .map(|_| {
            let now = time;
            time += duration * rng.random_range(0.3..1.0);
            let position = centre + vector(rng, size);
            State::new(now, position, vector(rng, 2.0 * size / duration))
        })
        .collect()
}

impl Case {
    pub(crate) fn draw(rng: &mut impl Rng, family: Family) -> Self {
        Self::draw_around(rng, family, DVec3::ZERO)
    }

    /// The same somewhere else (m), and as hard there: the margin is chosen after the move.
    pub(crate) fn draw_around(rng: &mut impl Rng, family: Family, place: DVec3) -> Self {
        let (mut duration, mut start, mut centre) = (1.0, 0.0, DVec3::ZERO);
        let mut sizes = [1.0, 1.0];
        match family {
            Family::Durations => duration = [1e-6, 1e-3, 1e3, 1e6][rng.random_range(0..4)],
            Family::Far => (start, centre) = (1.7e9, vector(rng, 1e9)),
            Family::MixedScales => sizes[1] = [1e-6, 1e-3, 1e3, 1e6][rng.random_range(0..4)],
            _ => {}
        }
        let mut states = sizes.map(|size| path(rng, start, duration, centre, size));
        shape(rng, family, &mut states);
        for state in states.iter_mut().flatten() {
            state.position += place;
        }
        let mut case = Self {
            states,
            margin: 0.0,
            window: None,
            outside: Outside::Absent,
        };
        if family == Family::Beyond {
            case.outside = [Outside::Extrapolate, Outside::Coast][rng.random_range(0..2)];
            let [before, after] = [(); 2].map(|()| rng.random_range(0.0..4.0));
            case.window = Some((start - before, start + after));
        } else if rng.random_bool(0.25) {
            let [from, to] = [(); 2].map(|()| start + duration * rng.random_range(0.0..1.5));
            case.window = Some((from.min(to), from.max(to)));
        }
        case.choose_margin(rng, family);
        case
    }

    pub(crate) fn scene(&self) -> Scene {
        let mut scene = Scene::new();
        self.join(&mut scene);
        scene
    }

    /// Puts both bodies into a scene.
    pub(crate) fn join(&self, scene: &mut Scene) {
        for states in &self.states {
            let plan = Trajectory::from_states(states).unwrap();
            let plan = plan.with_outside(self.outside);
            scene.insert(Body::new(plan)).unwrap();
        }
    }

    /// Margin and window, asked for certificates.
    pub(crate) fn query(&self) -> Query {
        Query::new(self.window())
            .with_margin(self.margin)
            .with_accuracy(Accuracy::Certified)
    }

    pub(crate) fn window(&self) -> Window {
        self.window
            .map_or(Window::ALL, |(from, to)| Window::new(from, to).unwrap())
    }

    /// Origin difference and extents of all segments: the local scale, summed up.
    pub(crate) fn scale(&self) -> f64 {
        // Neither over- nor underflows.
        let norm = |v: DVec3| v.x.hypot(v.y).hypot(v.z);
        let origin = self.states[0][0].position;
        let reach = |states: &[State]| {
            let extents = states.windows(2).map(|pair| {
                let duration = pair[1].time - pair[0].time;
                norm(pair[0].position - pair[1].position)
                    + duration * norm(pair[0].velocity).max(norm(pair[1].velocity))
            });
            let origins = states.iter().map(|state| norm(state.position - origin));
            origins.zip(extents).map(|(o, e)| o + e).fold(0.0, f64::max)
        };
        reach(&self.states[0]) + reach(&self.states[1])
    }

    fn choose_margin(&mut self, rng: &mut impl Rng, family: Family) {
        let scene = self.scene();
        let ids: Vec<_> = scene.bodies().map(|(id, _)| id).collect();
        let least = scene
            .closest_approach(ids[0], ids[1], self.window())
            .unwrap();
        let Some(least) = least else {
            self.margin = 1.0;
            return;
        };
        if family == Family::AtWindowEnd {
            let end = self.window.map_or(least.time + 1.0, |window| window.1);
            self.window = Some((least.time, end.max(least.time)));
        }
        let near = match family {
            Family::Gap => self.largest_between(&scene, least.time),
            _ => least.separation,
        };
        let is_near = matches!(family, Family::Grazing | Family::Gap) || rng.random_bool(0.5);
        let little = [0.0, 1e-12, 1e-9, f64::EPSILON, 1e-6][rng.random_range(0..5)];
        let sign = [-1.0, 1.0][rng.random_range(0..2)];
        self.margin = if is_near {
            near * (1.0 + sign * little)
        } else {
            near + rng.random_range(-0.1..1.0) * near.max(0.1)
        };
    }

    /// The largest distance found between the closest approach and the next minimum, if any.
    fn largest_between(&self, scene: &Scene, time: f64) -> f64 {
        let plans: Vec<&Trajectory> = scene.bodies().map(|(_, body)| &body.trajectory).collect();
        let at = |t: f64| Some(plans[0].position(t)?.distance(plans[1].position(t)?));
        let last = self.window().end();
        let end = plans[0]
            .domain()
            .end()
            .min(plans[1].domain().end())
            .min(last);
        let step = (end - time) / 64.0;
        let value = |k: u32| at(time + step * f64::from(k)).unwrap_or(0.0);
        let top = (1..64).find(|&k| value(k) >= value(k - 1) && value(k) > value(k + 1));
        let Some(top) = top else {
            return value(0);
        };
        // Golden section search.
        let (mut low, mut high) = (
            time + step * f64::from(top - 1),
            time + step * f64::from(top + 1),
        );
        for _ in 0..80 {
            let (x, y) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
            if at(x).unwrap_or(0.0) < at(y).unwrap_or(0.0) {
                low = x;
            } else {
                high = y;
            }
        }
        at(0.5 * (low + high)).unwrap_or(0.0)
    }
}

/// What makes a family what it is, where that is the motion.
fn shape(rng: &mut impl Rng, family: Family, states: &mut [Vec<State>; 2]) {
    let [first, second] = states;
    match family {
        Family::Docking | Family::Multiple => {
            let goal = *first.last().unwrap();
            let mut last = *second.last().unwrap();
            (last.position, last.velocity) = (goal.position, goal.velocity);
            last.time = goal.time;
            second.truncate(1);
            second[0].time = last.time - 0.75;
            if family == Family::Multiple {
                // The first control point is the last: constant but for the start, or cubic to it.
                first.truncate(1);
                let mut end = first[0];
                end.time = last.time;
                end.velocity = DVec3::ZERO;
                first[0] = State::new(last.time - 1.5, end.position, DVec3::ZERO);
                first.push(end);
                let offset = vector(rng, 1.0) * f64::from(rng.random_range(0..2_u8));
                (last.position, last.velocity) = (end.position + offset, DVec3::ZERO);
                second[0].velocity = (last.position - second[0].position) * 4.0;
            }
            second.push(last);
        }
        Family::Parallel => {
            let offset = vector(rng, 1.0) * f64::from(rng.random_range(0..2_u8));
            *second = first
                .iter()
                .map(|state| State {
                    position: state.position + offset,
                    ..*state
                })
                .collect();
        }
        Family::AtKnot => {
            // At a knot of both the relative velocity is at right angles to the way between.
            let meeting = State::new(0.5, vector(rng, 1.0), vector(rng, 2.0));
            let away = vector(rng, 0.5);
            let across = away.cross(vector(rng, 2.0));
            for (states, sign) in [(first, 0.0), (second, 1.0)] {
                let velocity = meeting.velocity + sign * across;
                let knot = State::new(0.5, meeting.position + sign * away, velocity);
                let rest = path(rng, 1.2, 1.0, DVec3::ZERO, 1.0);
                *states = [State::new(0.0, vector(rng, 1.0), vector(rng, 2.0)), knot]
                    .into_iter()
                    .chain(rest)
                    .collect();
            }
        }
        _ => {}
    }
}
