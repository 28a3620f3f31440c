//! rapier's sensors: balls that it finds overlapping at the instants of the frames.

use super::{Contact, Frame, Stepper};
use glam::Vec3;
use rapier3d::prelude::{
    ActiveCollisionTypes, ColliderBuilder, ColliderHandle, ColliderSet, CollisionPipeline,
    DefaultBroadPhase, IntegrationParameters, IslandManager, NarrowPhase, RigidBodyBuilder,
    RigidBodyHandle, RigidBodySet,
};
use std::collections::HashMap;

/// Kinematic bodies, each with a ball as its sensor.
pub(super) struct Sensors {
    handles: Vec<RigidBodyHandle>,
    places: HashMap<ColliderHandle, usize>,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    islands: IslandManager,
    broad_phase: DefaultBroadPhase,
    narrow_phase: NarrowPhase,
    pipeline: CollisionPipeline,
}

impl Sensors {
    #[allow(clippy::cast_possible_truncation, reason = "rapier computes in f32")]
    pub(super) fn new(radius: f64, count: usize) -> Self {
        let (mut bodies, mut colliders) = (RigidBodySet::new(), ColliderSet::new());
        let mut places = HashMap::new();
        let handles = (0..count).map(|place| {
            let handle = bodies.insert(RigidBodyBuilder::kinematic_position_based());
            let sensor = ColliderBuilder::ball(radius as f32)
                .sensor(true)
                .active_collision_types(ActiveCollisionTypes::KINEMATIC_KINEMATIC);
            let collider = colliders.insert_with_parent(sensor, handle, &mut bodies);
            places.insert(collider, place);
            handle
        });
        let handles = handles.collect();
        Self {
            handles,
            places,
            bodies,
            colliders,
            islands: IslandManager::new(),
            broad_phase: DefaultBroadPhase::new(),
            narrow_phase: NarrowPhase::new(),
            pipeline: CollisionPipeline::new(),
        }
    }
}

impl Stepper for Sensors {
    fn look(&mut self, frame: &Frame<'_>, found: &mut Vec<Contact>) {
        for (place, (&handle, position)) in self.handles.iter().zip(frame.now).enumerate() {
            // A body that is not there is where nobody else is.
            #[allow(clippy::cast_precision_loss, reason = "far away")]
            let away = Vec3::new(1e9 + 1e6 * place as f32, 0.0, 0.0);
            let position = if position.is_nan() {
                away
            } else {
                position.as_vec3()
            };
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
        for (one, other, overlap) in self.narrow_phase.intersection_pairs() {
            if overlap {
                let [a, b] = [one, other].map(|collider| self.places[&collider]);
                found.push(Contact {
                    a,
                    b,
                    time: frame.time,
                    separation: None,
                });
            }
        }
    }
}
