//! rapier's sensors: balls that it finds overlapping at the instants of the frames.

use super::sensors::Sensors;
use super::{Contact, Frame, Stepper};
use glam::{DVec3, Vec3};

impl Stepper for Sensors {
    fn look(&mut self, frame: &Frame<'_>, found: &mut Vec<Contact>) {
        // A body that is not there is where nobody else is.
        #[allow(clippy::cast_precision_loss, reason = "far away")]
        let away = |place: usize| Vec3::new(1e9 + 1e6 * place as f32, 0.0, 0.0);
        let place = |(place, position): (usize, &DVec3)| {
            if position.is_nan() {
                away(place)
            } else {
                (position - frame.middle).as_vec3()
            }
        };
        self.step(frame.now.iter().enumerate().map(place));
        let overlaps = self.pairs().filter(|&(_, overlap)| overlap);
        found.extend(overlaps.map(|([a, b], _)| Contact {
            a,
            b,
            time: frame.time,
            separation: None,
        }));
    }
}
