//! Strategies: arbitrary bits, and ordinary numbers that let bodies meet.

use glam::{DQuat, DVec3};
use nearmiss::{
    Body, BodyState, Hitbox, Orientation, Outside, Sphere, State, TimeBase, Trajectory, Window,
};
use proptest::collection::vec;
use proptest::prelude::{BoxedStrategy, Just, Strategy, any, prop_oneof};

/// Any bits, and numbers that are likely to do harm together.
pub(crate) fn number() -> BoxedStrategy<f64> {
    prop_oneof![
        3 => -10.0..10.0_f64,
        2 => any::<u64>().prop_map(f64::from_bits),
        1 => (-320..310_i32, -9.9..9.9_f64).prop_map(|(power, digits)| digits * 10_f64.powi(power)),
        1 => proptest::sample::select(vec![
            0.0,
            -0.0,
            1.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN_POSITIVE,
            5e-324,
            1e300,
            -1e300,
            1e-300,
            f64::EPSILON,
        ]),
    ]
    .boxed()
}

pub(crate) fn vector() -> impl Strategy<Value = DVec3> {
    [number(), number(), number()].prop_map(DVec3::from_array)
}

/// States in the order of time more often than not.
pub(crate) fn states() -> impl Strategy<Value = Vec<State>> {
    let state = (number(), vector(), vector());
    let state = state.prop_map(|(time, position, velocity)| State::new(time, position, velocity));
    (vec(state, 0..5), any::<bool>()).prop_map(|(mut states, sorts)| {
        if sorts {
            states.sort_by(|x, y| x.time.total_cmp(&y.time));
        }
        states
    })
}

pub(crate) fn outside() -> impl Strategy<Value = Outside> {
    proptest::sample::select(vec![Outside::Absent, Outside::Extrapolate, Outside::Coast])
}

pub(crate) fn trajectory() -> impl Strategy<Value = Option<Trajectory>> {
    let coefficients = vec([vector(), vector(), vector(), vector()], 0..3);
    let base = proptest::sample::select(vec![TimeBase::Absolute, TimeBase::SegmentLocal]);
    let made = prop_oneof![
        4 => states().prop_map(|states| Trajectory::from_states(&states).ok()),
        1 => vec((number(), vector()), 0..5)
            .prop_map(|positions| Trajectory::from_positions(&positions).ok()),
        1 => (vec(number(), 0..4), coefficients, base).prop_map(|(knots, coefficients, base)| {
            Trajectory::from_coefficients(&knots, &coefficients, base).ok()
        }),
        1 => vector().prop_map(|position| Trajectory::at_rest(position).ok()),
        1 => (number(), vector(), vector()).prop_map(|(time, position, velocity)| {
            Trajectory::coasting(State::new(time, position, velocity)).ok()
        }),
    ];
    (made, outside()).prop_map(|(made, outside)| Some(made?.with_outside(outside)))
}

/// Spheres, a point, or a half-space.
pub(crate) fn hitbox() -> impl Strategy<Value = Hitbox> {
    let sphere = (vector(), number()).prop_map(|(offset, radius)| Sphere { offset, radius });
    let spheres = vec(sphere, 0..3).prop_map(|spheres| match spheres[..] {
        [one] => Hitbox::sphere(one.radius).unwrap_or_default(),
        _ => Hitbox::cluster(spheres).unwrap_or_default(),
    });
    prop_oneof![7 => spheres, 1 => half_space()]
}

fn half_space() -> impl Strategy<Value = Hitbox> {
    let normal = prop_oneof![
        1 => vector(),
        3 => near().prop_map(|vector| vector.try_normalize().unwrap_or(DVec3::Z)),
    ];
    normal.prop_map(|normal| Hitbox::half_space(normal).unwrap_or_default())
}

/// Numbers up to 10.
pub(crate) fn near() -> impl Strategy<Value = DVec3> {
    [-10.0..10.0_f64, -10.0..10.0, -10.0..10.0].prop_map(DVec3::from_array)
}

/// A plan of ordinary numbers, which meets others of its kind.
pub(crate) fn ordinary() -> impl Strategy<Value = Option<Trajectory>> {
    vec((near(), near()), 2..4).prop_map(|states| {
        let state = |(time, (position, velocity))| State::new(time, position, velocity);
        let states: Vec<State> = (0..10).map(f64::from).zip(states).map(state).collect();
        Trajectory::from_states(&states).ok()
    })
}

pub(crate) fn body() -> impl Strategy<Value = Option<Body>> {
    let trajectory = prop_oneof![trajectory(), ordinary()];
    (trajectory, hitbox(), number()).prop_map(|(trajectory, hitbox, error)| {
        let body = Body::new(trajectory?).with_hitbox(hitbox);
        // A model error that is refused is none.
        Some(body.clone().with_model_error(error).unwrap_or(body))
    })
}

pub(crate) fn window() -> impl Strategy<Value = Window> {
    prop_oneof![
        1 => Just(Window::ALL),
        2 => (number(), number()).prop_map(|(x, y)| Window::new(x, y).unwrap_or(Window::ALL)),
        2 => (-10.0..10.0_f64, 0.0..10.0_f64)
            .prop_map(|(start, length)| Window::new(start, start + length).unwrap()),
        // Instants, that of a body at rest among them.
        1 => proptest::sample::select(vec![-1.0, 0.0, 1.0])
            .prop_map(|time| Window::new(time, time).unwrap()),
    ]
}

/// Components of quaternions: of rotations, of half turns, and any.
pub(crate) fn quaternion() -> impl Strategy<Value = DQuat> {
    prop_oneof![
        6 => near().prop_map(DQuat::from_scaled_axis),
        1 => [number(), number(), number(), number()].prop_map(DQuat::from_array),
        1 => proptest::sample::select(vec![
            DQuat::IDENTITY,
            -DQuat::IDENTITY,
            DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0),
            DQuat::from_xyzw(0.0, 0.0, 0.0, 1.0 + 1e-9),
        ]),
    ]
}

/// Constructors of an orientation with knots, by their kind.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Knotted {
    Slerp,
    NormalizedCubic,
}

impl Knotted {
    pub(crate) fn through(self, knots: &[(f64, DQuat)]) -> Result<Orientation, nearmiss::Error> {
        match self {
            Self::Slerp => Orientation::slerp(knots),
            Self::NormalizedCubic => Orientation::normalized_cubic(knots),
        }
    }
}

pub(crate) fn knotted() -> impl Strategy<Value = Knotted> {
    proptest::sample::select(vec![Knotted::Slerp, Knotted::NormalizedCubic])
}

/// Rotations at knots, in the order of time more often than not.
pub(crate) fn rotations() -> impl Strategy<Value = Vec<(f64, DQuat)>> {
    let time = || prop_oneof![3 => -10.0..10.0_f64, 1 => number()];
    (vec((time(), quaternion()), 0..5), 0..4_u8).prop_map(|(mut knots, unsorted)| {
        if unsorted > 0 {
            knots.sort_by(|x, y| x.0.total_cmp(&y.0));
        }
        knots
    })
}

/// Angular velocities that are refused, or at most [`FASTEST`]. A revolution costs time, however short it is.
pub(crate) fn angular_velocity() -> impl Strategy<Value = DVec3> {
    let cruel = vector().prop_map(|velocity| {
        let speed = velocity.length();
        if speed > FASTEST && speed < 1e7 {
            velocity * (FASTEST / speed)
        } else {
            velocity
        }
    });
    let slow = (near(), -4..=0_i32).prop_map(|(velocity, power)| velocity * 10_f64.powi(power));
    prop_oneof![1 => cruel, 4 => slow, 1 => near().prop_map(|velocity| 3.0 * velocity)]
}

/// rad/s: in 10 s not even 100 revolutions.
const FASTEST: f64 = 60.0;

/// Tolerances of orientations: none, one that may be refused, or any that is allowed.
pub(crate) fn tolerance() -> impl Strategy<Value = Option<f64>> {
    prop_oneof![
        3 => Just(None),
        1 => number().prop_map(Some),
        2 => (-9.0..-1.0_f64).prop_map(|power| Some(10_f64.powf(power))),
    ]
}

/// Orientations that turn at most at about [`FASTEST`] beyond their knots.
pub(crate) fn orientation() -> impl Strategy<Value = Orientation> {
    let time = || prop_oneof![3 => -10.0..10.0_f64, 1 => number()];
    let spin = (time(), quaternion(), angular_velocity());
    let spin = spin.prop_map(|(time, rotation, velocity)| {
        Orientation::spin(time, rotation, velocity).unwrap_or_default()
    });
    let knotted = (knotted(), rotations(), outside());
    let knotted = knotted.prop_map(|(kind, knots, outside)| {
        // At most half a turn from knot to knot.
        let is_slow = knots.windows(2).all(|ends| ends[1].0 - ends[0].0 > 0.1);
        let outside = if is_slow { outside } else { Outside::Absent };
        let made = kind.through(&knots).unwrap_or_default();
        made.with_outside(outside)
    });
    let made = prop_oneof![1 => Just(Orientation::FIXED), 4 => spin, 4 => knotted];
    (made, tolerance()).prop_map(|(made, tolerance)| match tolerance {
        Some(tolerance) => made.clone().with_tolerance(tolerance).unwrap_or(made),
        None => made,
    })
}

/// States as they are told, of any numbers or of ordinary ones, with a spin or without.
pub(crate) fn told() -> impl Strategy<Value = BodyState> {
    let cruel = (number(), vector(), vector());
    let state = prop_oneof![3 => (-1.0..6.0_f64, near(), near()), 1 => cruel];
    let spin = (any::<bool>(), quaternion(), angular_velocity());
    (state, spin).prop_map(|((time, position, velocity), (turns, rotation, spin))| {
        let told = BodyState::from(State::new(time, position, velocity));
        if turns {
            told.with_spin(rotation, spin)
        } else {
            told
        }
    })
}

/// Bodies of which most turn. Few of their numbers are cruel, so that they meet.
pub(crate) fn turning_body() -> impl Strategy<Value = Option<Body>> {
    let few = (near(), 0.0..3.0_f64).prop_map(|(offset, radius)| Sphere { offset, radius });
    let cluster = vec(few, 1..4).prop_map(|spheres| Hitbox::cluster(spheres).unwrap_or_default());
    let parts = (
        prop_oneof![1 => trajectory(), 4 => ordinary()],
        prop_oneof![1 => hitbox(), 4 => cluster],
        orientation(),
        prop_oneof![3 => Just(0.0), 1 => 0.0..0.1_f64, 1 => number()],
    );
    parts.prop_map(|(trajectory, hitbox, orientation, error)| {
        let body = Body::new(trajectory?).with_hitbox(hitbox);
        let body = body.with_orientation(orientation);
        Some(body.clone().with_model_error(error).unwrap_or(body))
    })
}
