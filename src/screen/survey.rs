//! Scene-wide statistics, gathered in one pass over the bodies.

use crate::bounds::{DAabb, Frame, MovingFrame, Padding};
use crate::count::short;
use crate::knots::Knots;
use crate::scene::{Scene, SceneEntry};
use crate::search::SceneStatistics;
use crate::trajectory::{Extension, Segment, StraightMotion};
use crate::window::Window;
use glam::DVec3;

/// Scene-wide statistics for one query.
#[derive(Debug)]
pub(super) struct SceneSurvey {
    window: Window,
    margin: f64,
    /// Velocity of the frame of all boxes, m/s: paths are relative to it.
    velocity: DVec3,
    /// Length of a plan's path relative to the frame, in lengths of its path: that of some plans together.
    share_of_path: f64,
    /// Existence of each body, by place, and of all (first and last instant, s). A body that is part of no
    /// pair never exists.
    pub(super) lives: Vec<(f64, f64)>,
    pub(super) all_lifetimes: (f64, f64),
    /// Approximate extremes of the plans of bodies that exist in the window, m.
    plans: DAabb,
    /// Approximate extremes of their motion beyond the plans, m.
    beyond: DAabb,
    /// Statistics of motion in the window.
    pub(super) statistics: SceneStatistics,
    /// Largest relevant distance from a body's position, m.
    pub(super) size: f64,
    /// True if some bodies turn and have long arms.
    pub(super) have_long_arms: bool,
    /// Number of cubics, pieces beyond the knots in the window included.
    pub(super) cubics: usize,
    /// Number of bodies that follow a plan, not straight motions.
    pub(super) not_straight: usize,
}

impl SceneSurvey {
    /// Returns a survey before any body of the scene is included.
    pub(super) fn of(scene: &Scene, window: Window, margin: f64) -> Self {
        let velocity = scene.common_velocity(window.ends());
        Self {
            window,
            margin,
            velocity,
            share_of_path: share_of_path(scene, window, velocity),
            lives: vec![(0.0, 0.0); scene.len()],
            all_lifetimes: (f64::INFINITY, f64::NEG_INFINITY),
            plans: DAabb::NOTHING,
            beyond: DAabb::NOTHING,
            statistics: SceneStatistics {
                margin: margin.max(0.0),
                ..SceneStatistics::default()
            },
            size: 0.0,
            have_long_arms: false,
            cubics: 0,
            not_straight: 0,
        }
    }

    /// Counts the body's cubics; includes the body and its pieces beyond the knots in the window if it has a partner.
    #[inline]
    pub(super) fn include(
        &mut self,
        place: usize,
        (entry, extension): (&SceneEntry, Option<&Extension>),
        has_partner: bool,
    ) {
        let body = &entry.body;
        let motions = body.trajectory.straight_motions();
        let own = if motions.is_empty() {
            entry.summary().compact.ends()
        } else {
            Knots::of(body.trajectory.piece_knots()).ends()
        };
        let (first, last) = extension.map_or(own, |extension| extension.domain);
        let beyond = extension.map_or(0, |extension| extension.before + extension.after);
        self.cubics += body.trajectory.piece_knots().len().saturating_sub(1) + beyond as usize;
        self.not_straight += usize::from(motions.is_empty());
        if !has_partner {
            self.lives[place] = (f64::INFINITY, f64::NEG_INFINITY);
            return;
        }
        self.lives[place] = (first, last);
        self.all_lifetimes = (
            self.all_lifetimes.0.min(first),
            self.all_lifetimes.1.max(last),
        );
        if first > self.window.end() || last < self.window.start() {
            return;
        }
        let size = Padding::size(body.shape(), self.margin);
        self.size = self.size.max(size);
        self.have_long_arms |= body.shape().has_long_arms();
        let pieces = motions.iter().zip(body.trajectory.piece_knots().windows(2));
        for (motion, ends) in pieces {
            self.count_straight(motion, (ends[0], ends[1]));
        }
        if motions.is_empty() {
            let plan = entry.summary();
            self.plans.include(plan.extremes);
            let cubics = short(body.trajectory.cubics().len());
            let path = self.share_of_path * plan.path;
            self.statistics.add(own, self.window.ends(), (path, cubics));
        }
        if let Some(extension) = extension {
            let plan = &body.trajectory;
            if extension.before > 0 {
                let ends = (first.max(self.window.start()), own.0);
                self.count_beyond(&plan.segment_before(), ends, extension.before);
            }
            if extension.after > 0 {
                let ends = (own.1, last.min(self.window.end()));
                if let Some(motion) = motions.last() {
                    self.count_straight(motion, ends);
                } else {
                    self.count_beyond(&plan.segment_after(), ends, extension.after);
                }
            }
        }
    }

    /// Includes the part of a straight motion that lies within the window and between two instants (s).
    fn count_straight(&mut self, motion: &StraightMotion, (first, last): (f64, f64)) {
        let (from, to) = (first.max(self.window.start()), last.min(self.window.end()));
        let at = |time: f64| motion.origin() + motion.displacement_to(time);
        let mut extremes = DAabb::of_point(motion.origin());
        self.plans.include(extremes);
        if from <= to {
            for position in [at(from), at(to)] {
                extremes.include(DAabb::of_point(position));
            }
            let path = (motion.velocity() - self.velocity).length() * (to - from);
            self.statistics
                .add((from, to), self.window.ends(), (path, 1));
        }
        self.beyond.include(extremes);
    }

    /// Adds the motion beyond the knots between two instants (s), in `pieces` pieces.
    fn count_beyond(&mut self, segment: &Segment, (from, to): (f64, f64), pieces: u32) {
        let [begin, end] = [from, to].map(|time| segment.motion_at(time).0);
        for position in [begin, end] {
            self.beyond.include(DAabb::of_point(position));
        }
        let path = (end - begin - self.velocity * (to - from)).length();
        self.statistics
            .add((from, to), self.window.ends(), (path, pieces));
    }

    /// Returns a frame for all bodies that exist in the window, centred on most of them. Completes the statistics.
    pub(super) fn complete(&mut self, scene: &Scene) -> MovingFrame {
        let window = self.window.ends();
        let some = scene.sample(window);
        let mut positions: Vec<DVec3> = some.map(|one| one.extremes().middle()).collect();
        let most = DAabb::of_middle_half(&mut positions);
        let mut extremes = self.plans;
        extremes.include(self.beyond);
        let world = self.world(scene);
        self.statistics.world = (world.high - world.low).to_array();
        Frame::amid(extremes, most, self.size).moving(self.velocity)
    }

    /// Returns a box around most bodies at a time, m. In a moving frame, plans reach farther than that.
    fn world(&self, scene: &Scene) -> DAabb {
        if self.velocity == DVec3::ZERO {
            return self.plans;
        }
        let mut world = DAabb::NOTHING;
        for entry in scene.sample(self.window.ends()) {
            let plan = &entry.body.trajectory;
            let time = self.window.start().max(plan.domain().start());
            if let Some(position) = plan.position(time) {
                world.include(DAabb::of_point(position - self.velocity * time));
            }
        }
        world
    }
}

/// Returns the length of the paths of some plans relative to a velocity (m/s), in lengths of their paths.
fn share_of_path(scene: &Scene, window: Window, velocity: DVec3) -> f64 {
    /// Pieces of a plan that tell enough.
    const SOME: usize = 32;
    let (mut relative, mut all) = (0.0, 0.0);
    if velocity != DVec3::ZERO {
        for entry in scene.sample(window.ends()) {
            for segment in entry.body.trajectory.cubics().iter().take(SOME) {
                let [begin, end] = [segment.start(), segment.end()];
                let way = segment.motion_at(end).0 - segment.motion_at(begin).0;
                relative += (way - velocity * (end - begin)).length();
                all += segment.extent();
            }
        }
    }
    if all > 0.0 { relative / all } else { 1.0 }
}
