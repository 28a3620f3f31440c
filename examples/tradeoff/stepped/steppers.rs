//! Frame loops as they are commonly written: contacts at instants, and between them.

use super::{Contact, Frame, Stepper};
use glam::{DVec3, Vec3};
use parry3d::math::Pose;
use parry3d::query::{NonlinearRigidMotion, cast_shapes_nonlinear};
use parry3d::shape::Ball;

/// Boxes sorted along x, from frame to frame: those that overlap.
#[derive(Default)]
struct SortAndSweep {
    /// Least coordinates, largest coordinates, and body.
    boxes: Vec<(DVec3, DVec3, usize)>,
}

impl SortAndSweep {
    /// Calls `visit` with each two bodies whose boxes overlap.
    fn each(
        &mut self,
        of: impl Fn(usize) -> (DVec3, DVec3),
        count: usize,
        mut visit: impl FnMut(usize, usize),
    ) {
        if self.boxes.len() != count {
            self.boxes = (0..count)
                .map(|body| (DVec3::ZERO, DVec3::ZERO, body))
                .collect();
        }
        for one in &mut self.boxes {
            (one.0, one.1) = of(one.2);
        }
        // Nearly sorted since the last frame.
        self.boxes
            .sort_by(|one, other| one.0.x.total_cmp(&other.0.x));
        for (place, one) in self.boxes.iter().enumerate() {
            for other in &self.boxes[place + 1..] {
                if other.0.x > one.1.x {
                    break;
                }
                if one.0.cmple(other.1).all() && other.0.cmple(one.1).all() {
                    visit(one.2, other.2);
                }
            }
        }
    }
}

/// Balls that overlap at the instants of the frames.
pub(super) struct Overlaps {
    /// m.
    radii: Vec<f64>,
    sweep: SortAndSweep,
}

impl Overlaps {
    pub(super) fn new(radii: Vec<f64>) -> Self {
        Self {
            radii,
            sweep: SortAndSweep::default(),
        }
    }
}

impl Stepper for Overlaps {
    fn look(&mut self, frame: &Frame<'_>, found: &mut Vec<Contact>) {
        let (radii, now) = (&self.radii, frame.now);
        let around = |body: usize| (now[body] - radii[body], now[body] + radii[body]);
        self.sweep.each(around, now.len(), |a, b| {
            let separation = now[a].distance(now[b]) - (radii[a] + radii[b]);
            if separation <= 0.0 {
                found.push(Contact {
                    a,
                    b,
                    time: frame.time,
                    separation: Some(separation),
                });
            }
        });
    }
}

/// Returns the ends of a body's step: of one that was not there before, an instant.
fn way(frame: &Frame<'_>, body: usize) -> (DVec3, DVec3) {
    let (from, to) = (frame.before[body], frame.now[body]);
    if from.is_nan() { (to, to) } else { (from, to) }
}

/// Returns the box that contains a ball all through a straight step.
fn swept(frame: &Frame<'_>, radii: &[f64], body: usize) -> (DVec3, DVec3) {
    let ((from, to), radius) = (way(frame, body), radii[body]);
    (from.min(to) - radius, from.max(to) + radius)
}

/// Balls that touch on the straight ways between two frames.
pub(super) struct SweptSpheres {
    /// m.
    radii: Vec<f64>,
    sweep: SortAndSweep,
}

impl SweptSpheres {
    pub(super) fn new(radii: Vec<f64>) -> Self {
        Self {
            radii,
            sweep: SortAndSweep::default(),
        }
    }
}

impl Stepper for SweptSpheres {
    fn look(&mut self, frame: &Frame<'_>, found: &mut Vec<Contact>) {
        let (radii, now) = (&self.radii, frame.now);
        self.sweep.each(
            |body| swept(frame, radii, body),
            now.len(),
            |a, b| {
                let ((from_a, to_a), (from_b, to_b)) = (way(frame, a), way(frame, b));
                let start = from_a - from_b;
                let way = (to_a - to_b) - start;
                let square = way.length_squared();
                let nearest = if square > 0.0 {
                    (-start.dot(way) / square).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let distance = (start + nearest * way).length();
                let reach = radii[a] + radii[b];
                if distance > reach {
                    return;
                }
                // The first root of |start + s way| = reach, or the beginning of the step.
                let half = start.dot(way);
                let rest = start.length_squared() - reach * reach;
                let root = (half * half - square * rest).max(0.0).sqrt();
                let first = if rest <= 0.0 || square <= 0.0 {
                    0.0
                } else {
                    ((-half - root) / square).clamp(0.0, 1.0)
                };
                let time = frame.time - frame.step * (1.0 - first);
                found.push(Contact {
                    a,
                    b,
                    time,
                    separation: Some(distance - reach),
                });
            },
        );
    }
}

/// parry's shape casts of balls on the straight ways between two frames.
pub(super) struct ShapeCasts {
    /// m.
    radii: Vec<f64>,
    sweep: SortAndSweep,
}

impl ShapeCasts {
    pub(super) fn new(radii: Vec<f64>) -> Self {
        Self {
            radii,
            sweep: SortAndSweep::default(),
        }
    }
}

impl Stepper for ShapeCasts {
    #[allow(clippy::cast_possible_truncation, reason = "parry computes in f32")]
    fn look(&mut self, frame: &Frame<'_>, found: &mut Vec<Contact>) {
        let radii = &self.radii;
        let ball = |body: usize| Ball::new(radii[body] as f32);
        let step = frame.step as f32;
        let rate = if frame.step > 0.0 {
            1.0 / frame.step
        } else {
            0.0
        };
        // About a point near by: far from it f32 is coarse.
        let motion = |body: usize, origin: DVec3| {
            let (from, to) = way(frame, body);
            let velocity = ((to - from) * rate).as_vec3();
            NonlinearRigidMotion::new(
                Pose::from_translation((from - origin).as_vec3()),
                Vec3::ZERO,
                velocity,
                Vec3::ZERO,
            )
        };
        self.sweep.each(
            |body| swept(frame, radii, body),
            frame.now.len(),
            |a, b| {
                let origin = way(frame, b).0;
                let (one, other) = (motion(a, origin), motion(b, origin));
                let (ball_a, ball_b) = (ball(a), ball(b));
                let hit = cast_shapes_nonlinear(&one, &ball_a, &other, &ball_b, 0.0, step, true);
                if let Ok(Some(hit)) = hit {
                    let time = frame.time - frame.step + f64::from(hit.time_of_impact);
                    found.push(Contact {
                        a,
                        b,
                        time,
                        separation: None,
                    });
                }
            },
        );
    }
}
