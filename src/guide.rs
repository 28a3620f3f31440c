//! The guide: how to use nearmiss, page by page. Every example runs as a test.
//!
//! | page | subject |
//! |---|---|
//! | [`start_here`] | two bodies, one answer |
//! | [`choosing_accuracy`] | what trades speed for accuracy, and what does not |
//! | [`time_frames_units`] | seconds, metres, epochs, reference frames |
//! | [`from_your_motion_to_splines`] | states, waypoints, curves, functions |
//! | [`games`] | bodies whose state is given every frame |
//! | [`fleets_and_traffic`] | plans that are known ahead, and asked about first |
//! | [`satellites`] | long, fast, far: what a cubic is worth in orbit |
//! | [`when_plans_change`] | replan, extend, late news |
//! | [`overload_and_deadlines`] | budgets, crowds, a thread of its own |
//! | [`errors`] | what can go wrong, and what to do |
//! | [`how_the_proof_goes`] | why no conflict is lost |
//! | [`cookbook`] | recipes |

#[doc = include_str!("guide/start_here.md")]
pub mod start_here {}

#[doc = include_str!("guide/choosing_accuracy.md")]
#[doc = include_str!("../examples/images/tradeoff-pair.svg")]
#[doc = ""]
#[doc = include_str!("../examples/images/tradeoff-stepped.svg")]
pub mod choosing_accuracy {}

#[doc = include_str!("guide/time_frames_units.md")]
pub mod time_frames_units {}

#[doc = include_str!("guide/from_your_motion_to_splines.md")]
pub mod from_your_motion_to_splines {}

#[doc = include_str!("guide/games.md")]
pub mod games {}

#[doc = include_str!("guide/fleets_and_traffic.md")]
pub mod fleets_and_traffic {}

#[doc = include_str!("guide/satellites.md")]
pub mod satellites {}

#[doc = include_str!("guide/when_plans_change.md")]
pub mod when_plans_change {}

#[doc = include_str!("guide/overload_and_deadlines.md")]
pub mod overload_and_deadlines {}

#[doc = include_str!("guide/errors.md")]
pub mod errors {}

#[doc = include_str!("guide/how_the_proof_goes.md")]
pub mod how_the_proof_goes {}

#[doc = include_str!("guide/cookbook.md")]
pub mod cookbook {}
