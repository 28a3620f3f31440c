//! A collision monitor for many bodies that move along cubic splines: which of them will come too
//! close, when, and how close.
//!
//! The goals of nearmiss, in this order: correct, fast, pleasant to use.
//!
//! ```
//! use nearmiss::glam::DVec3;
//! use nearmiss::{Body, Hitbox, Query, Scene, State, Trajectory};
//!
//! let mut scene = Scene::new();
//! for (from, to) in [(DVec3::ZERO, 100.0 * DVec3::X), (100.0 * DVec3::X, DVec3::Y)] {
//!     let velocity = (to - from) / 10.0;
//!     let plan = [State::new(0.0, from, velocity), State::new(10.0, to, velocity)];
//!     let body = Body::new(Trajectory::from_states(&plan)?).with_hitbox(Hitbox::sphere(0.5)?);
//!     scene.insert(body)?;
//! }
//! for conflict in scene.screen(&Query::default().with_margin(2.0))?.conflicts {
//!     println!(
//!         "within 2 m from {:.3} s to {:.3} s, closest {:.3} m at {:.3} s",
//!         conflict.enter, conflict.exit, conflict.closest.separation, conflict.closest.time
//!     );
//! }
//! # Ok::<(), nearmiss::Error>(())
//! ```
//!
//! The [`guide`] leads on from here: [games](guide::games), [fleets and traffic](guide::fleets_and_traffic),
//! [satellites](guide::satellites), [your motion as splines](guide::from_your_motion_to_splines), and a
//! [cookbook](guide::cookbook).
//!
//! | you want | call |
//! |---|---|
//! | all conflicts in a time | [`Scene::screen`] |
//! | those of a body that is not in the scene | [`Scene::conflicts_with`] |
//! | those of a body if it had another plan | [`Scene::what_if`] |
//! | those of two bodies, without a scene | the functions of [`pair`] |
//! | events while bodies move and plans change | [`Monitor`] |
//! | plans tried before they are flown | [`Monitor::what_if`], [`Monitor::what_if_plans`] |
//! | closest approaches of cubics in batches | the module [`kernels`] |
//!
//! # The way the data flows
//!
//! ```text
//! states (t, p, v)   your input, f64, irregular times
//!   -> Trajectory    cubic Hermite segments; all validation happens here
//!   -> bounds        hull of a part of a segment, rounded outward to a parry3d Aabb (f32)
//!   -> broad phase   time slices x boxes -> candidate pairs
//!   -> spans         merged intervals: both bodies on one segment each
//!   -> narrow phase  relative cubic -> squared distance of degree 6 -> closest approach, contact intervals
//!   -> conflicts     maximal intervals per pair, sorted, the same bits on any number of threads
//!   -> monitor       clock + plans that change -> events
//! ```
//!
//! Cheap stages may only reject what is certainly clear, their own rounding accounted for; one
//! plain f64 solver has the last word, on whole spans. So speed never costs an answer.
//!
//! # Words
//!
//! | word | meaning |
//! |---|---|
//! | [`State`] | time, position, velocity (s, m, m/s) |
//! | [`Segment`] | one cubic between consecutive states' times (knots) |
//! | [`Trajectory`] | the segments of one body; [`Outside`] says what it does before and after |
//! | plan | the trajectory that a body follows until it is given another one |
//! | span | a common interval of one cubic of each of two bodies |
//! | [`Hitbox`] | a sphere, a cluster of spheres fixed in the body's frame, or a half-space |
//! | [`Orientation`] | the rotation of a body's frame over time, in which its hitbox is fixed |
//! | [`BodyPlan`] | a trajectory with an orientation |
//! | [`Body`] | trajectory, hitbox, orientation, [`Layers`], and your tag |
//! | separation | distance between hitbox surfaces, m; negative where they overlap |
//! | model error | how far the world may be from a body's plan, m: [`Body::with_model_error`] |
//! | margin | a conflict is a maximal interval with separation <= margin |
//! | [`Window`] | the closed time interval asked about |
//! | [`Conflict`] | pair, enter, exit, and the [`ClosestApproach`] in between |
//! | [`Monitor`] | a scene with a clock and a lookahead, whose plans change |
//! | tick | one call of [`Monitor::advance`] or [`Monitor::advance_within`]: the clock moves, and events are reported |
//! | [`Encounter`] | a conflict of a pair as the monitor follows it, at one [`AlertLevel`] |
//! | [`Event`] | `Predicted`, `Revised`, `Withdrawn`, `Began`, `Ended`, `PlanEnds` |
//!
//! Readers of the code find the words of the inside in `src/internals.rs`, along the way from a state to an
//! event.
//!
//! # Accuracy
//!
//! Answers are f64, good to a few roundings of the local scale (the distance of the places
//! where the two bodies' segments begin, plus the extents of these); neither the absolute position nor the absolute time
//! enters. Exception: polynomials in absolute time are good to a few roundings of their largest term. Distances within
//! that rounding of the margin are reported, so a touch is never lost but at an end of the [window](Window).
//!
//! All answers are about the splines. A body's model error says how far the world may be from its
//! spline: answers then cover all that may be in the world, and a certified one is about the world
//! ([`Certificate`]).
//!
//! The spheres' centres of a body that turns follow cubics in place of their true paths. These are off by at most the
//! tolerance of the [`Orientation`], times the distance of the sphere's centre from the body's position. The radii are enlarged by
//! that, so no contact is lost; with [`Accuracy::Certified`] it is part of the proven error instead.
//!
//! # Features
//!
//! - `parallel` (default): screenings and a monitor's ticks run on the threads of the current rayon
//!   pool, and `kernels::parallel` exists. Without it they run on the caller's thread,
//!   with the same answers.
//! - `live` (default): `Monitor::spawn` runs a monitor on a thread of its own, behind the bounded
//!   channels of `live`.
//! - `serde`: scenes, states, queries, screenings, options of covers and live monitors, commands, events, snapshots, conflicts
//!   and their parts implement `Serialize` and `Deserialize`. Before version 1.0 a minor version may change their form;
//!   a recording names its own. Turn on `float_roundtrip` of `serde_json`: without it the last bits of numbers change when
//!   they are read. A scene then has other conflicts in their last bits, and a restored snapshot reports events at other
//!   times, by some roundings of the clock: 1e-14 s near 0, 1e-6 s at Unix times, where their number may differ, too. Knots
//!   that are a rounding apart are refused then. (`recording` turns it on.) JSON has no NaN and no infinity: in a query, an
//!   alert level or a state they are written as `null`, which is refused when it is read.
//! - `recording`: `Monitor::start_recording` records a monitor's inputs, and
//!   `recording::Replay` replays them, bit for bit. Turns `serde` on.
//! - `mint`: [`State::new`] takes `mint::Vector3<f64>`, to which vectors of other libraries, and of other versions of
//!   glam, can be converted.
//!
//! On `wasm32-unknown-unknown` everything runs on the caller's thread without `parallel` and
//! `live`; the clock that times work and keeps a [`Budget::Time`] is the browser's.

// On docs.rs each item names the features that it needs.
#![cfg_attr(docsrs, feature(doc_cfg))]

mod accuracy;
mod blossom;
mod bounds;
mod broad_phase;
mod conflict;
mod conflict_index;
mod count;
mod cover;
mod enclosure;
mod error;
mod guess;
pub mod guide;
mod hitbox;
mod id;
#[doc(hidden)]
pub mod internals;
#[cfg(feature = "serde")]
mod json_number;
mod knots;
mod layers;
mod monitor;
mod narrow_phase;
mod orientation;
mod parallel;
mod polynomial;
mod pool;
mod query;
mod readable;
mod real;
mod rounding;
#[cfg(feature = "serde")]
mod saved_limit;
mod scene;
mod screen;
mod search;
mod shape;
mod simd;
mod spans;
mod stats;
mod trajectory;
mod turning_box;
mod wall_clock;
mod window;

pub use accuracy::{Accuracy, Certificate, TimeEnclosure};
pub use conflict::{CertifiedApproach, Clip, ClosestApproach, Conflict};
pub use conflict_index::ConflictIndex;
pub use cover::{CoverError, CoverOptions, Coverage, Extent, SphereCover, verify_cover};
pub use error::{Crowd, Error, MAX_MAGNITUDE, Quantity};
pub use glam;
pub use hitbox::{Hitbox, Sphere};
pub use id::BodyId;
pub use layers::Layers;
pub use monitor::{
    AlertLevel, Budget, Command, Encounter, EncounterId, EndReason, Event, EventKind, Monitor,
    RevisionThreshold, Snapshot,
};
pub use narrow_phase::kernels;
pub use orientation::Orientation;
pub use parry3d;
pub use query::Query;
pub use scene::{Body, BodyPlan, BodyPlanRef, BodyState, Scene, Spin};
pub use screen::{Screening, pair};
pub use stats::Stats;
pub use trajectory::{
    Fit, FitOptions, Keyframe, Outside, PositionOptions, Segment, State, TimeBase, Trajectory,
};
pub use window::Window;

/// A monitor on a thread of its own, behind bounded channels.
#[cfg(feature = "live")]
pub mod live {
    pub use crate::monitor::live::{
        Counts, Handle, Live, LiveOptions, Panicked, Report, ReportKind, Request, Stopped, Ticket,
        Unsent,
    };
    pub use crossbeam_channel;
}

/// Recordings of a monitor's inputs, and their replay.
#[cfg(feature = "recording")]
pub mod recording {
    pub use crate::monitor::recording::{RecordingError, Replay};
}

/// The README's examples, compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
