//! The error of all invalid inputs.

mod change_time;
mod context;
mod crowd;
mod quantity;

use crate::id::{BodyId, NamedBody};

pub(crate) use change_time::check_change_time;
pub use crowd::Crowd;
pub use quantity::{MAX_MAGNITUDE, Quantity};

/// The reason for which an input was refused. The call that returned it changed nothing, except
/// that after [`TooCrowded`](Self::TooCrowded) a monitor rebuilds its search state.
///
/// `Display` and `Debug` write the same sentence: what is wrong, with its values, and what to do if that is not plain.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Too few states or waypoints. A trajectory needs at least two (or one segment); one that
    /// [coasts](crate::Trajectory::coasting) needs one.
    #[error(
        "a trajectory needs at least two states or waypoints, not {count} (Trajectory::coasting takes one)"
    )]
    TooFewStates {
        /// Number of states.
        count: usize,
    },
    /// The numbers of knots and segments do not match.
    #[error("{knots} knots need {} segments, not {segments}", knots.saturating_sub(1))]
    SegmentCount {
        /// Number of knots.
        knots: usize,
        /// Number of segments.
        segments: usize,
    },
    /// A cubic B-spline has fewer than four control points.
    #[error("a cubic B-spline needs at least four control points, not {count}")]
    TooFewControlPoints {
        /// Number of control points.
        count: usize,
    },
    /// The numbers of knots and control points of a cubic B-spline do not match.
    #[error("a cubic B-spline of {control_points} control points needs {} knots, not {knots}", control_points + 4)]
    KnotCount {
        /// Number of knots.
        knots: usize,
        /// Number of control points.
        control_points: usize,
    },
    /// A curve is broken: one piece of it ends elsewhere than the next one begins.
    #[error(
        "knot {knot}: the curve before it ends {distance:?} m from where the curve after it begins: give both \
         the same point"
    )]
    Discontinuous {
        /// The knot, counted from 0.
        knot: usize,
        /// The distance, m.
        distance: f64,
    },
    /// The time of a knot is not later than that of the knot before it.
    #[error(
        "knot {knot}: time {time:?} s is not later than the knot before it, {previous:?} s: sort by time, and keep \
         one knot for each instant (of a B-spline at most four)"
    )]
    TimeNotIncreasing {
        /// The later knot, counted from 0.
        knot: usize,
        /// The time of the knot before, s.
        previous: f64,
        /// The time of this knot, s.
        time: f64,
    },
    /// A number is NaN or infinite.
    #[error("knot {knot}: {quantity} is {value}, not a finite number")]
    NotFinite {
        /// The knot, counted from 0.
        knot: usize,
        /// The number's meaning.
        quantity: Quantity,
        /// Its value.
        value: f64,
    },
    /// A number, or one that follows from it, is larger than [`MAX_MAGNITUDE`].
    #[error("knot {knot}: {quantity} reaches {value:e}, beyond ±1e300: check the units")]
    OutOfRange {
        /// The knot, counted from 0.
        knot: usize,
        /// The number's meaning.
        quantity: Quantity,
        /// Its value, or a bound of the quantity that follows from it.
        value: f64,
    },
    /// Numbers of a cubic that were read from a file contradict each other.
    #[error("knot {knot}: the numbers of the cubic before it contradict each other")]
    Contradiction {
        /// The knot, counted from 0.
        knot: usize,
    },
    /// A body cannot be followed so far beyond its knots: more than 1e100 times the duration of the
    /// cubic that carries it there, or to times far beyond [`MAX_MAGNITUDE`].
    #[error(
        "knot {knot}: the body cannot be followed from it as far as {time:?} s: check the window, the clock, and \
         knots that are almost at one time"
    )]
    TooFar {
        /// The knot from which the body is followed, counted from 0.
        knot: usize,
        /// The time, s.
        time: f64,
    },
    /// Too few rotations. An [orientation](crate::Orientation) between knots needs at least two.
    #[error("an orientation between knots needs at least two rotations, not {count}")]
    TooFewRotations {
        /// Number of rotations.
        count: usize,
    },
    /// The length of a rotation's quaternion differs from 1 by more than 1e-9.
    #[error(
        "knot {knot}: the quaternion of the rotation has the length {length:?}, not 1: normalise it in f64"
    )]
    RotationLength {
        /// The knot, counted from 0.
        knot: usize,
        /// The length.
        length: f64,
    },
    /// Two neighbouring rotations are half a turn apart: both ways from one to the other are
    /// equally long.
    #[error("knot {knot}: half a turn from the knot before, either way: give a knot in between")]
    AntipodalRotations {
        /// The later knot, counted from 0.
        knot: usize,
    },
    /// A cubic of quaternions comes so close to zero that its direction is not known well enough.
    #[error(
        "knot {knot}: the cubic of quaternions before it comes too close to zero: give a knot in between, or \
         a larger tolerance"
    )]
    RotationVanishes {
        /// The later knot, counted from 0.
        knot: usize,
    },
    /// An angular speed is above 1e6 rad/s.
    #[error("angular speed {speed:e} rad/s is above 1e6 rad/s")]
    AngularSpeed {
        /// The speed, rad/s.
        speed: f64,
    },
    /// The tolerance of an orientation is not within 1e-9..=0.1.
    #[error("tolerance {value:?} is not a number within 1e-9..=0.1")]
    Tolerance {
        /// The tolerance, relative to a sphere's distance from the body's position.
        value: f64,
    },
    /// The tolerance of a [fit](crate::Trajectory::fit), or of a
    /// [simplification](crate::Trajectory::simplified), is not a positive number up to 1e300.
    #[error("tolerance {metres:?} m is not a positive number up to 1e300")]
    FitTolerance {
        /// The tolerance, m.
        metres: f64,
    },
    /// The window of a [fit](crate::Trajectory::fit) is a single instant, is open, or exceeds ±1e300 s.
    #[error(
        "a motion cannot be fitted over {start:?}..{end:?} s: give a window with two different, finite ends"
    )]
    FitWindow {
        /// Start, s.
        start: f64,
        /// End, s.
        end: f64,
    },
    /// An [option](crate::FitOptions) of a fit is negative, NaN or infinite.
    #[error("fit: the {option} is {value:?}, not a finite number of at least 0")]
    FitOption {
        /// The option.
        option: &'static str,
        /// Its value.
        value: f64,
    },
    /// The motion to be [fitted](crate::Trajectory::fit) has a value that is no number within ±1e300.
    #[error("the motion at {time:?} s: {quantity} is {value:?}, not a number within ±1e300")]
    Motion {
        /// The time asked for, s.
        time: f64,
        /// The number's meaning.
        quantity: Quantity,
        /// Its value.
        value: f64,
    },
    /// No cubic from this time on stays within the tolerance of the motion, however short: the tolerance is too near the
    /// rounding, or the position jumps.
    #[error(
        "from {time:?} s on no cubic follows the motion within {tolerance:?} m, only within {reached:?} m: the \
         tolerance is below the rounding, or the position jumps"
    )]
    FitUnreachable {
        /// The time from which on no cubic follows the motion, s.
        time: f64,
        /// The tolerance, m.
        tolerance: f64,
        /// The least error that was found, m.
        reached: f64,
    },
    /// The velocity of the motion to be [fitted](crate::Trajectory::fit) is not the derivative of its position: it has
    /// other units, another frame or another sign, or it is too imprecise for the tolerance.
    #[error(
        "the motion at {time:?} s: {quantity} is {told:?} m/s, but the position changes by {found:?} m/s: give the \
         derivative of the position, or a larger tolerance"
    )]
    FitVelocity {
        /// The time, s.
        time: f64,
        /// The component of the velocity that is off most.
        quantity: Quantity,
        /// Its value, m/s.
        told: f64,
        /// Its value by the positions, m/s.
        found: f64,
    },
    /// The fit of a motion needs more knots than allowed.
    #[error(
        "{limit} knots reach {time:?} s only: allow a larger tolerance, or more knots (max_knots) if the motion is given by \
         a function, and check that its velocity is the derivative of its position"
    )]
    FitKnots {
        /// Largest number of knots allowed; of polynomials, the largest number of knots between those given.
        limit: usize,
        /// The time up to which the motion was fitted, s.
        time: f64,
    },
    /// A motion contradicts the [bound](crate::FitOptions::with_fourth_derivative) of its fourth derivative, or its
    /// velocity is not the derivative of its position.
    #[error(
        "the motion at {time:?} s is {deviation:e} m from its cubic, beyond the {bound:e} m that its fourth \
         derivative allows: check the bound, and the velocity"
    )]
    FitBound {
        /// The time, s.
        time: f64,
        /// Its distance from the cubic, m.
        deviation: f64,
        /// The largest distance by the bound, m.
        bound: f64,
    },
    /// The rows of one body are not together.
    #[error(
        "row {row}: the body appeared before, and others since: sort the rows by body, then by time"
    )]
    RowsApart {
        /// The row, counted from 0 over all rows.
        row: usize,
    },
    /// An error of one body, which is named by its id where it has one, and by its tag.
    #[error("{}: {error}", NamedBody(*id, *body))]
    InBody {
        /// The body's tag: 0 without [`Body::with_tag`](crate::Body::with_tag).
        body: u64,
        /// The body's id; `None` for a body that is not in a scene yet.
        id: Option<BodyId>,
        /// The error of this body.
        #[source]
        error: Box<Error>,
    },
    /// An error of one command of a batch: see [`Monitor::apply`](crate::Monitor::apply).
    #[error("command {command}: {error}")]
    InCommand {
        /// The command, counted from 0.
        command: usize,
        /// The error of this command.
        #[source]
        error: Box<Error>,
    },
    /// A radius is negative, NaN, infinite or too large.
    #[error("sphere {sphere}: radius {radius:?} m is not a number from 0 to 1e300")]
    Radius {
        /// The sphere within its hitbox, counted from 0.
        sphere: usize,
        /// The radius, m.
        radius: f64,
    },
    /// A [model error](crate::Body::with_model_error) is negative, NaN, infinite or too large.
    #[error("model error {metres:?} m is not a number from 0 to 1e300")]
    ModelError {
        /// The model error, m.
        metres: f64,
    },
    /// A sphere's offset is NaN, infinite or too large.
    #[error("sphere {sphere}: offset component {value:?} m is not a number within ±1e300")]
    Offset {
        /// The sphere within its hitbox, counted from 0.
        sphere: usize,
        /// The component, m.
        value: f64,
    },
    /// The length of a half-space's normal differs from 1 by more than 1e-9.
    #[error(
        "the normal of the half-space has the length {length:?}, not 1: give a unit vector, normalised in f64"
    )]
    NormalLength {
        /// The length; NaN if a component is.
        length: f64,
    },
    /// A half-space has an orientation that is not [fixed](crate::Orientation::FIXED).
    #[error("a half-space cannot turn: leave its orientation fixed, or give the body spheres")]
    TurningHalfSpace,
    /// A cluster needs at least one sphere.
    #[error("a cluster needs at least one sphere")]
    EmptyCluster,
    /// A margin is NaN or infinite, or too large.
    #[error("margin {margin:?} m is not a number within ±1e300")]
    Margin {
        /// The margin, m.
        margin: f64,
    },
    /// A window without any instant: its start is later than its end, either is NaN, or both are
    /// the same infinity.
    #[error(
        "window {start:?}..{end:?} s: no instant lies between them; name the earlier time first"
    )]
    Window {
        /// Start, s.
        start: f64,
        /// End, s.
        end: f64,
    },
    /// A query names no window, and the scene has no plan that implies one: all its bodies are at
    /// rest or coast from single states.
    #[error("no body has a plan that says which time to look at: name a window, with Query::new")]
    NoPlan,
    /// A body that exists at all times cannot be screened over an open-ended window: see
    /// [`Scene::planned`](crate::Scene::planned).
    #[error(
        "{} exists beyond its knots: close the window on both sides, with Window::new",
        NamedBody(*id, *body)
    )]
    WindowNotClosed {
        /// The body's tag: 0 without [`Body::with_tag`](crate::Body::with_tag).
        body: u64,
        /// The body's id; `None` for a body that is not in a scene yet.
        id: Option<BodyId>,
    },
    /// More pairs may be in contact than the limit: a crowd, or a margin as large as the world.
    #[error(
        "too many pairs may be in conflict (with room for {limit} of their spans{}): narrow the window \
         (the lookahead) or the margin, leave pairs out (layers, ignored pairs), or raise the limit (max_spans); \
         in a monitor, each two spheres and each turn of clusters have spans of their own, and skip_to goes on",
        crowd.map_or(String::new(), |crowd| format!("; {crowd}"))
    )]
    TooCrowded {
        /// The limit; see [`Query::with_max_spans`](crate::Query::with_max_spans) and
        /// [`Monitor::set_max_spans`](crate::Monitor::set_max_spans).
        limit: usize,
        /// A body that comes near many others. `None` if no body of a sample comes near another one.
        crowd: Option<Crowd>,
    },
    /// The id names no body of this scene (it may have been removed). An id of another scene is not always noticed: it may
    /// name a body of this one.
    #[error("{id} is not in the scene: it was removed, or the id is of another scene")]
    UnknownBody {
        /// The id.
        id: BodyId,
    },
    /// A pair needs two different bodies.
    #[error("{id} cannot be paired with itself: name two bodies")]
    SameBody {
        /// The id.
        id: BodyId,
    },
    /// A plan is to change at a time at which the plan so far does not exist: it is over, or has not begun.
    ///
    /// Replace it as a whole with [`Monitor::set_trajectory`](crate::Monitor::set_trajectory), or let plans go on
    /// with [`Outside::Coast`](crate::Outside::Coast).
    #[error(
        "the plan so far does not exist at {time:?} s: it is from {start:?} s to {end:?} s; set the trajectory as a \
         whole instead (set_trajectory)"
    )]
    NoOldPlan {
        /// Time of the change, s; of a late plan, the instant from which it would be followed.
        time: f64,
        /// First instant of the plan so far, s.
        start: f64,
        /// Last instant of the plan so far, s.
        end: f64,
    },
    /// A plan is to change at a time at which the new plan does not exist, or ends. A late plan must go on from the
    /// monitor's clock.
    ///
    /// Give one that exists by then and goes on, perhaps with [`Outside::Coast`](crate::Outside::Coast).
    #[error(
        "the new plan does not go on from {time:?} s: it is from {start:?} s to {end:?} s; give one that begins by \
         then and ends later"
    )]
    NoNewPlan {
        /// Time of the change, s; the monitor's clock if a late plan does not go on from it.
        time: f64,
        /// First instant of the new plan, s.
        start: f64,
        /// Last instant of the new plan, s.
        end: f64,
    },
    /// A monitor is asked about the time ahead, and knows nothing of it: before its first tick, before the first one after
    /// it was [restored](crate::Monitor::restore) with changes that no tick had seen, or while a
    /// [budget](crate::Monitor::advance_within) leaves it behind its clock.
    #[error(
        "the monitor knows nothing of the time ahead: its clock shows {now:?} s, and all is known up to \
         {complete_until:?} s; advance it first, until complete_until is after the clock"
    )]
    NothingKnown {
        /// Time of the clock, s.
        now: f64,
        /// Instant up to which all is known, s.
        complete_until: f64,
    },
    /// A plan or an orientation is to change at a time that is not within ±1e300.
    #[error("a plan or an orientation cannot change at {time:?} s: give a time within ±1e300")]
    ChangeTime {
        /// The time, s.
        time: f64,
    },
    /// The monitor's clock never goes back.
    #[error(
        "the clock cannot go back from {now:?} s to {time:?} s: give a later time, or restore a snapshot"
    )]
    ClockWentBack {
        /// Time of the clock, s.
        now: f64,
        /// Time asked for, s.
        time: f64,
    },
    /// A time that a monitor's clock cannot show: not a number within ±1e300, or so far from 0 that
    /// the lookahead vanishes in its rounding.
    #[error(
        "the clock cannot show {time:?} s: not within ±1e300, or too far from 0 for the lookahead"
    )]
    Clock {
        /// The time, s.
        time: f64,
    },
    /// A monitor's lookahead is not a positive duration up to 1e300, or vanishes by rounding.
    #[error(
        "{value:?} s is not a usable lookahead: give a positive number up to 1e300; if it is lost in the rounding \
         of the clock, count time from an epoch near your data"
    )]
    Lookahead {
        /// The value, s.
        value: f64,
    },
    /// A monitor needs at least one alert level.
    #[error("a monitor needs at least one alert level: give it AlertLevel::at(margin)")]
    NoAlertLevel,
    /// There is no alert level with this number.
    #[error(
        "there is no alert level {level}: levels count from 0, in the order given to Monitor::new"
    )]
    UnknownAlertLevel {
        /// The number, counted from 0.
        level: usize,
    },
    /// A duration or length among a monitor's settings is negative or NaN.
    #[error("{setting}: {value:?} is not a number of at least 0")]
    Setting {
        /// The setting.
        setting: &'static str,
        /// The value, s or m.
        value: f64,
    },
    /// An alert level's margin is not a number within ±1e300, or exceeds its release margin.
    #[error(
        "alert level {level}: margin {margin:?} m, release {release:?} m: an encounter begins at the margin and ends \
         beyond the release, so give a release of at least the margin, both within ±1e300"
    )]
    AlertLevel {
        /// The level, counted from 0.
        level: usize,
        /// Its margin, m.
        margin: f64,
        /// Its release margin, m.
        release: f64,
    },
    /// A monitor's snapshot, read from a file, contradicts itself.
    #[error("the snapshot of a monitor cannot be right: {problem}")]
    Snapshot {
        /// The contradiction.
        problem: &'static str,
    },
    /// The caller's progress function ended the screening: see
    /// [`Scene::screen_with_progress`](crate::Scene::screen_with_progress).
    #[error("the screening was ended before it was complete")]
    Cancelled,
    /// The scene holds as many bodies as ids can distinguish (2^32 - 1).
    #[error("the scene is full")]
    SceneFull,
}
