//! The search for spans that may hold a contact, for screenings and monitors.
//!
//! Time is cut into slices. In each slice every body has a box, and a *fat line*, a closer bound: a line with a
//! radius. (A body that is told another place within the slice *teleports*: it has some of each for every place.) Overlapping
//! boxes give candidates, and cheap tests leave spans of these. A slice with many candidates is searched island by island
//! or in parts. Bodies are known by numbers alone ([`Bodies`]): dense ones
//! in a screening, slots in a monitor. [`WindowSearch`] searches a whole window. [`CandidateRefiner`] is its last
//! part, which a monitor's slices use directly.
//!
//! Words: [`internals`](crate::internals).

mod bodies;
mod body_walk;
mod box_sizes;
mod by_place;
mod crowded;
mod form;
mod form_slices;
mod islands;
mod lifetimes;
mod limits;
mod pace;
mod refine;
mod scratch;
mod slice_length;
mod slices;
mod sort;
mod window;

pub(crate) use bodies::{Bodies, BoxedBodies};
pub(crate) use body_walk::SLICES_AT_A_TIME;
pub(crate) use form::SliceBlock;
#[cfg(test)]
pub(crate) use form::SliceBounds;
pub(crate) use form_slices::{FormInPlace, SlicesToForm, SourcesInPlace};
pub(crate) use lifetimes::list_present;
pub(crate) use limits::{LimitExceeded, Limits, are_coarse};
pub(crate) use pace::Pace;
pub(crate) use refine::{CandidateRefiner, RefineContext};
pub(crate) use scratch::{SearchScratch, recycled};
pub(crate) use slice_length::SliceTrials;
pub(crate) use slices::{SceneStatistics, TimeSlices};
pub(crate) use sort::SpanSorter;
pub(crate) use window::{FEW_BOXES, WindowSearch};
