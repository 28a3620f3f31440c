//! nearmiss

mod bounds;
mod broad_phase;
mod conflict;
mod error;
mod hitbox;
mod id;
mod layers;
mod narrow_phase;
mod parallel;
pub mod polynomial;
mod query;
mod rounding;
mod scene;
mod screen;
mod spans;
mod stats;
mod trajectory;
mod window;

pub use broad_phase::Method;
pub use conflict::{Clip, ClosestApproach, Conflict};
pub use error::{Error, LARGEST_MAGNITUDE, Quantity};
pub use hitbox::{Hitbox, Sphere};
pub use id::BodyId;
pub use layers::Layers;
pub use query::Query;
pub use scene::{Body, Scene};
pub use screen::Screening;
pub use stats::Stats;
pub use trajectory::{Outside, Segment, State, TimeBase, Trajectory, trajectories_from_rows};
pub use window::Window;
