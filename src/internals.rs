//! Parts of the crate for its own tests and benchmarks. They may change or go with any version.
//!
//! # From a state to an event
//!
//! The path of the data through `src`, for readers of the code. The words of the public interface are
//! defined at the [crate](crate); those of the inside are set in italics where they are defined here.
//!
//! 1. `trajectory`: states become [`Segment`](crate::Segment)s. Beyond its knots a body follows an *end
//!    motion*, the cubic before its first knot and the one after its last. A *piece* is a segment, or a part
//!    of an end motion between two *cuts*. End motions and legs of constant velocity are in *power form*,
//!    other cubics in Bézier form. Pieces beyond
//!    the knots are twice as long each time (`DoublingCuts`). A *straight motion* is a trajectory from one state. A *plan* is any
//!    trajectory, or one that is no straight motion where both are named. A body that *turns* has a rotation.
//!    - A state that the caller gives is *told*. Where states are told each frame, a straight motion is
//!      *replaced* by another one in place: the trajectory keeps its few *recent motions*, or many. The facts that a new
//!      motion is checked against are its `LastMotion`.
//!    - A change holds `from` an instant on. Pieces and spins that end before `since` (`forget_before`) are
//!      dropped. A *late* plan is to be followed from before the clock: see `Monitor::replan`.
//! 2. `orientation`: the *parts* of an orientation, as given, become *pieces*, each an arc or a cubic. These
//!    become cubics of matrices between cuts of their own; the rotation is *baked*. A `TurningSection` lies
//!    between neighbouring cuts of one body, a *section* between those of both. The *way* of a point is its path
//!    about the body's position; how far its cubic is off, in metres, is the `path_error`. A *spin* is a
//!    rotation at an instant with a constant angular velocity.
//! 3. `scene`: a body lies in a *slot*, the number in its id. A *place* is an index in a list, above all its
//!    dense number in one search. An *entry* is a body with the *summary* of its motion. Its *compact
//!    trajectory*, a copy in f32, lies on cache *lines* of an *arena*. The *reach* of a hitbox is the largest
//!    distance of its bounding sphere's points from the body's position, its *arm* that of the centres. A *partner* is another
//!    body with which a body may be a pair; bodies with the same layers are of one *kind*.
//! 4. `bounds`: f32 coordinates are relative to a *reference frame* (`frame`): an origin that may move, and a unit. That of
//!    one body's cubics is its *anchor*; a *source* is the cubics with their *placement* in the frame. A box
//!    exceeds the hull of a motion by its *padding*, hitbox and half the margin, and by rounding. A *fat line*
//!    is a closer bound, a line with a radius. Rounding is relative to coordinates and to the *spread*, which is
//!    at least half the distance between any two points of a cubic; each *split* of a cubic adds rounding. A *run*
//!    is four consecutive cubics, or four smaller runs, bounded at once.
//! 5. `broad_phase`: two bodies whose boxes meet in a time slice are a *candidate*. A *filter* of pairs
//!    admits or refuses by layers and ignored pairs. Bodies are in *groups* by their layers: only groups that may form
//!    pairs are compared. It *gives up* to end a search early, incomplete. (The field
//!    `filter` of `Layers` is a bit mask.)
//! 6. `search`: a window or a lookahead is cut into *slices*, formed in *blocks* of a few. Bodies are *present*
//!    where their *lifetimes* overlap a block. A body that is told another place *teleports*: it has a box at each.
//!    Boxes of a crowded slice make *islands*, which empty space separates: each is searched in a frame of its own, amid its
//!    bodies and with their common velocity. Boxes are *coarse* where f32 rounding makes up most of them. Candidates whose fat lines come near each other are *near pairs*.
//!    The spans of these that cheap tests leave are the *survivors*. The first of these tests compares the hulls
//!    of two cubics in f32 (`HullTest`). The tests reject only what exceeds the threshold by the *clearance*,
//!    512 roundings. The *pace* of slices tells when which share of the bodies' time has passed.
//!    Searches begin at the earliest and end at the latest exact instant that may be reported as
//!    an end of the window (`earliest_exact`, `latest_exact`).
//! 7. `narrow_phase`: a *view* is all that it reads of a body. A margin is *widened* by the model errors of both.
//!    Over a span, the difference of two motions is a *relative cubic*. Between *stationary points* the distance is monotonic: its *profile*
//!    has these and the ends of the span as *nodes*. A *dip* is a minimum that the rounding of the squared
//!    distance hides; a *plateau* is a distance that is constant to rounding. A *contact* unites
//!    the intervals of spans and spheres that are within a threshold. Where a body turns, a span is cut into
//!    *sections*. A *question* about clusters says how near two spheres must come in each *step* of an interval to
//!    matter. Which spheres are nearer is certain beyond the *slack*, an allowance for
//!    rounding.
//! 8. `enclosure`: branch and bound over the parts of a span. A *minorant* is a quadratic below a squared
//!    distance; its *leading* coefficient is that of x². *Stretches* divide a span into what is certainly inside a
//!    threshold, certainly outside, or undecided.
//! 9. `screen`: contacts become conflicts. This is the end of a screening.
//! 10. `monitor`: changes are prepared in a `ChangeContext`. The *lookahead search* keeps *solved spans*
//!     (`solved`), and knows everything up to an instant, the end of the *known time*. It holds bodies as
//!     *monitored bodies* and notes the *changed* ones, whose bounds are `moved`. A *meter* counts work against a
//!     budget.
//!     - The *grid* is the frame and the length of slices. A slice is *needed* if it overlaps the lookahead. Work on
//!       the next slice is *due* in shares; it is *put off* where there is too little room. A slice is *fresh* when
//!       all work on it that is due is done: then changed bodies are compared with all bodies. Each body has its box at a place in the leaves of a tree.
//!       The number of slices follows from *statistics* of motion.
//!     - A search *from nothing* forms boxes of all bodies for itself alone, and keeps none. A *jump* of the clock
//!       is searched so, in *chunks* of time.
//!     - A body is *due* at the instant up to which it was compared with half-spaces.
//! 11. `monitor/reading`: contacts of a pair become *solved conflicts* and *planned encounters*, whatever the window.
//!     Those *at an edge* of the window are clipped to it in each tick.
//! 12. `monitor/encounters`: a planned encounter that is reported becomes a *tracked encounter*, until it
//!     ends or is withdrawn. Their differences are the events. Pairs *wait* that have tracked encounters
//!     beyond the known time. An instant up to which events were reported is *reported*.

use crate::query::Query;
use std::num::NonZeroU32;

pub use crate::broad_phase::Method;
pub use crate::simd::InstructionSet;

pub mod broad_phase {
    //! Boxes in, candidate pairs out.
    pub use crate::broad_phase::{
        BodyBox, BroadPhase, BruteForce, Candidate, Everyone, Groups, InstructionSet, Method,
        PairFilter, Sweep, Tree,
    };
}

pub mod enclosure {
    //! Certified enclosures of one cubic.
    pub use crate::enclosure::{
        DistanceEnclosure, Effort, LeastDistance, OutOfRange, ParameterEnclosure, Stretch,
        Stretches, Threshold, UncertainCubic, Verdict,
    };
}

pub mod polynomial {
    //! Roots of polynomials.
    pub use crate::polynomial::{RootList, roots};
}

/// Query settings that change the time of an answer, never the answer.
pub trait QueryInternals: Sized {
    /// Returns the query with another broad-phase method.
    #[must_use]
    fn with_method(self, method: Method) -> Self;

    /// Returns the query with this number of slices of the window, at most a million, instead of
    /// the cheapest number. The answer does not depend on it if there is room for the candidates of
    /// a slice (2^22, or [`max_spans`](Query::max_spans) if that is more).
    #[must_use]
    fn with_slices(self, slices: NonZeroU32) -> Self;

    /// Returns the query with another instruction set, instead of the best of this processor.
    #[must_use]
    fn with_instruction_set(self, instructions: InstructionSet) -> Self;
}

impl QueryInternals for Query {
    fn with_method(mut self, method: Method) -> Self {
        self.method = method;
        self
    }

    fn with_slices(mut self, slices: NonZeroU32) -> Self {
        self.slices = Some(slices);
        self
    }

    fn with_instruction_set(mut self, instructions: InstructionSet) -> Self {
        self.instructions = instructions;
        self
    }
}
