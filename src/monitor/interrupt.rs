//! A request to end a tick early.

#[cfg(test)]
use std::sync::atomic::AtomicU64;
use std::sync::atomic::{AtomicBool, Ordering};

/// A request from another thread to end a tick early, as if its budget were spent.
///
/// It may come between any two questions: who asks twice about one piece of work may get two answers.
#[derive(Debug, Default)]
pub(super) struct Interrupt {
    is_requested: AtomicBool,
    /// Number of questions until it requests itself; 0 for never.
    #[cfg(test)]
    questions: AtomicU64,
}

impl Interrupt {
    #[cfg(any(feature = "live", test))]
    pub(super) fn request(&self) {
        self.is_requested.store(true, Ordering::Relaxed);
    }

    pub(super) fn is_requested(&self) -> bool {
        #[cfg(test)]
        if self.questions.load(Ordering::Relaxed) > 0
            && self.questions.fetch_sub(1, Ordering::Relaxed) == 1
        {
            self.request();
        }
        self.is_requested.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::unwrap_used,
        reason = "a monitor that cannot be built fails the test"
    )]

    use super::*;
    use crate::id::BodyId;
    use crate::monitor::{AlertLevel, Monitor};
    use crate::query::Query;
    use crate::scene::{Body, Scene};
    use crate::trajectory::{State, Trajectory};
    use crate::window::Window;
    use glam::DVec3;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};
    use std::sync::Arc;

    const MARGIN: f64 = 2.0;
    const LOOKAHEAD: f64 = 4.0;

    fn plan(rng: &mut ChaCha8Rng) -> Trajectory {
        let mut vector =
            |most: f64| DVec3::from_array([0; 3].map(|_| rng.random_range(-most..most)));
        let states = [0.0, 3.0, 6.0].map(|time| State::new(time, vector(9.0), vector(3.0)));
        Trajectory::from_states(&states).unwrap()
    }

    /// A monitor that has ticked, and in which some plans have changed since.
    fn monitor(seed: u64) -> Monitor {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut scene = Scene::new();
        let ids: Vec<BodyId> = (0..50)
            .map(|_| scene.insert(Body::new(plan(&mut rng))).unwrap())
            .collect();
        let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &[AlertLevel::at(MARGIN)]).unwrap();
        monitor.advance(0.0, &mut Vec::new()).unwrap();
        for &id in ids.iter().step_by(1 + (seed % 3) as usize * 6) {
            monitor.set_trajectory(id, plan(&mut rng)).unwrap();
        }
        monitor
    }

    /// Whenever a tick is interrupted, the next one finds all.
    #[test]
    fn nothing_is_lost_wherever_a_tick_ends() {
        for seed in 0..3 {
            let window = Window::new(0.5, 0.5 + LOOKAHEAD).unwrap();
            let query = Query::new(window).with_margin(MARGIN);
            let expected = monitor(seed).scene().screen(&query).unwrap().conflicts;
            let (mut questions, mut is_interrupted) = (0, true);
            while is_interrupted {
                questions += 1;
                let mut monitor = monitor(seed);
                let interrupt = Arc::new(Interrupt::default());
                interrupt.questions.store(questions, Ordering::Relaxed);
                monitor.interrupt = Some(Arc::clone(&interrupt));
                let mut events = Vec::new();
                monitor.advance(0.5, &mut events).unwrap();
                is_interrupted = interrupt.is_requested.load(Ordering::Relaxed);
                monitor.interrupt = None;
                monitor.advance(0.5, &mut events).unwrap();
                let found = monitor.conflicts(0).unwrap();
                assert!(found == expected, "seed {seed}, question {questions}");
            }
            assert!(questions > 20, "{questions}");
        }
    }
}
