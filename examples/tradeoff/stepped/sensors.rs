//! rapier's sensors: balls on kinematic bodies, and which of them overlap.

use glam::Vec3;
use rapier3d::prelude::{
    ActiveCollisionTypes, ColliderBuilder, ColliderSet, CollisionPipeline, DefaultBroadPhase,
    IntegrationParameters, IslandManager, NarrowPhase, RigidBodyBuilder, RigidBodyHandle,
    RigidBodySet,
};

/// Kinematic bodies, each with a ball as its sensor.
pub(crate) struct Sensors {
    handles: Vec<RigidBodyHandle>,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    islands: IslandManager,
    broad_phase: DefaultBroadPhase,
    narrow_phase: NarrowPhase,
    pipeline: CollisionPipeline,
}

impl Sensors {
    /// Returns balls of these radii, m.
    pub(crate) fn new(radii: impl IntoIterator<Item = f64>) -> Self {
        let (mut bodies, mut colliders) = (RigidBodySet::new(), ColliderSet::new());
        let handles = radii.into_iter().enumerate().map(|(number, radius)| {
            let handle = bodies.insert(RigidBodyBuilder::kinematic_position_based());
            #[allow(clippy::cast_possible_truncation, reason = "rapier computes in f32")]
            let sensor = ColliderBuilder::ball(radius as f32)
                .sensor(true)
                .active_collision_types(ActiveCollisionTypes::all())
                .user_data(number as u128);
            colliders.insert_with_parent(sensor, handle, &mut bodies);
            handle
        });
        Self {
            handles: handles.collect(),
            bodies,
            colliders,
            islands: IslandManager::new(),
            broad_phase: DefaultBroadPhase::new(),
            narrow_phase: NarrowPhase::new(),
            pipeline: CollisionPipeline::new(),
        }
    }

    /// Moves all bodies, m, and looks for overlaps.
    pub(crate) fn step(&mut self, positions: impl IntoIterator<Item = Vec3>) {
        for (&handle, position) in self.handles.iter().zip(positions) {
            self.bodies[handle].set_translation(position, true);
        }
        self.pipeline.step(
            IntegrationParameters::default().prediction_distance(),
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &(),
            &(),
        );
    }

    /// Returns the numbers of two bodies whose boxes meet, and true if the balls overlap.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = ([usize; 2], bool)> {
        let pairs = self.narrow_phase.intersection_pairs();
        pairs.map(|(one, other, overlap)| {
            #[allow(
                clippy::cast_possible_truncation,
                reason = "it was a number of bodies before"
            )]
            let numbers = [one, other].map(|handle| self.colliders[handle].user_data as usize);
            (numbers, overlap)
        })
    }
}
