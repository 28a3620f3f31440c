//! Balls and boxes between walls, moved by rapier: no gravity, no damping, no friction, elastic.
//!
//! Gyroscopic forces are off: between contacts a box keeps its angular velocity, so that only contacts
//! deflect a body. Contacts begin where surfaces overlap in a frame. (rapier's usual ones begin at a
//! distance, and bounce bodies that do not touch.)

use glam::{Quat, Vec3};
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rapier3d::parry::query::intersection_test;
use rapier3d::prelude::{
    ActiveEvents, ColliderBuilder, ColliderSet, CollisionEvent, ContactPair, EventHandler,
    PhysicsWorld, Pose, Real, RigidBodyBuilder, RigidBodyHandle, RigidBodySet, SharedShape,
    SoftBodySet, SoftBodyTearEvent,
};
use std::f32::consts::PI;
use std::sync::{Mutex, PoisonError};

/// Time of a frame, s.
const STEP: f32 = 1.0 / 60.0;
/// Radius of a ball, m.
pub(crate) const RADIUS: f32 = 0.5;
/// Halves of a box's sides, m.
pub(crate) const HALF_SIDES: Vec3 = Vec3::new(0.5, 0.7, 1.0);
/// Side of the cube for one body, m.
const SPACING: f32 = 4.0;
/// Largest speed along an axis, m/s.
const SPEED: f32 = 6.0;
/// Largest angular velocity about an axis, rad/s.
const SPIN: f32 = 3.0;
/// Half the thickness of a wall, m: more than a body moves in a frame, by far.
const WALL: f32 = 4.0;
/// Stands for a wall where a body has its number.
const NO_BODY: u128 = u128::MAX;

/// The instant of a frame, s.
pub(crate) fn instant(frame: u32) -> f64 {
    f64::from(frame) * f64::from(STEP)
}

/// A kind of body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Ball,
    Box,
}

/// The state of a body in a frame, as rapier has it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub(crate) kind: Kind,
    /// m
    pub(crate) position: Vec3,
    /// m/s
    pub(crate) velocity: Vec3,
    /// From the body's axes to those of the world.
    pub(crate) rotation: Quat,
    /// rad/s, in the world's axes
    pub(crate) angular_velocity: Vec3,
}

impl Motion {
    fn random(kind: Kind, position: Vec3, rng: &mut ChaCha8Rng) -> Self {
        let velocity = cube(rng, SPEED);
        let (turn, angular_velocity) = match kind {
            Kind::Ball => (Vec3::ZERO, Vec3::ZERO),
            Kind::Box => (cube(rng, PI), cube(rng, SPIN)),
        };
        Self {
            kind,
            position,
            velocity,
            rotation: Quat::from_scaled_axis(turn),
            angular_velocity,
        }
    }

    /// Returns true if a contact changed the motion between this frame and the next one. rapier changes
    /// velocities, and pushes bodies that overlap out of each other.
    pub(crate) fn is_deflected(&self, next: &Self) -> bool {
        /// A push is larger than rounding, which is up to 3e-7 of the coordinates.
        const ROUNDING: f32 = 1e-6;
        let flown = self.position + self.velocity * STEP;
        let pushed = flown.distance(next.position);
        self.velocity != next.velocity
            || self.angular_velocity != next.angular_velocity
            || pushed > ROUNDING * (1.0 + flown.length())
    }

    /// Returns the pose that free flight leads to after some seconds.
    fn pose_after(&self, seconds: f32) -> Pose {
        let turn = Quat::from_scaled_axis(self.angular_velocity * seconds);
        let position = self.position + self.velocity * seconds;
        Pose::from_parts(position, turn * self.rotation)
    }

    fn shape(&self) -> SharedShape {
        match self.kind {
            Kind::Ball => SharedShape::ball(RADIUS),
            Kind::Box => SharedShape::cuboid(HALF_SIDES.x, HALF_SIDES.y, HALF_SIDES.z),
        }
    }
}

/// Contacts that begin in a frame.
#[derive(Debug, Default)]
pub(crate) struct Contacts {
    /// Of two bodies, by number.
    pub(crate) pairs: Vec<[usize; 2]>,
    /// Of a body with a wall.
    pub(crate) walls: u64,
}

/// All bodies, in the order of their numbers: balls, then boxes.
pub(crate) struct World {
    physics: PhysicsWorld,
    bodies: Vec<(Kind, RigidBodyHandle)>,
}

impl World {
    pub(crate) fn new(balls: usize, boxes: usize, seed: u64) -> Self {
        let mut physics = PhysicsWorld {
            gravity: Vec3::ZERO,
            ..PhysicsWorld::default()
        };
        let parameters = &mut physics.integration_parameters;
        parameters.dt = STEP;
        parameters.normalized_prediction_distance = 0.0;
        // Recycled contacts may end late.
        parameters.contact_recycling = false;
        let kinds = std::iter::repeat_n(Kind::Ball, balls);
        let kinds: Vec<Kind> = kinds.chain(std::iter::repeat_n(Kind::Box, boxes)).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let (places, half) = scatter(kinds.len(), &mut rng);
        build_walls(&mut physics, half);
        let bodies = kinds.iter().zip(places).enumerate();
        let bodies = bodies.map(|(number, (&kind, place))| {
            let motion = Motion::random(kind, place, &mut rng);
            let body = RigidBodyBuilder::dynamic()
                .pose(motion.pose_after(0.0))
                .linvel(motion.velocity)
                .angvel(motion.angular_velocity)
                .gyroscopic_forces_enabled(false)
                .can_sleep(false);
            let collider = elastic(ColliderBuilder::new(motion.shape()))
                .active_events(ActiveEvents::COLLISION_EVENTS)
                .user_data(number as u128);
            (kind, physics.insert(body, collider).0)
        });
        let bodies = bodies.collect();
        Self { physics, bodies }
    }

    /// Returns the states of all bodies, in the order of their numbers.
    pub(crate) fn states(&self) -> Vec<Motion> {
        let bodies = self.bodies.iter().map(|&(kind, handle)| {
            let body = &self.physics.bodies[handle];
            Motion {
                kind,
                position: body.translation(),
                velocity: body.linvel(),
                rotation: *body.rotation(),
                angular_velocity: body.angvel(),
            }
        });
        bodies.collect()
    }

    /// Moves the world to the next frame. Returns the contacts that begin in this one.
    pub(crate) fn step(&mut self) -> Contacts {
        let collector = Collector::default();
        self.physics.step_with_events(&(), &collector);
        collector
            .0
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns how long before this frame two bodies began to overlap, s. They overlap now, were apart in the
/// frame before, and flew freely since.
pub(crate) fn time_since_contact(a: &Motion, b: &Motion) -> f64 {
    /// Halvings, down to a microsecond.
    const HALVINGS: u32 = 14;
    let shapes = [a.shape(), b.shape()];
    let overlap = |seconds: f32| {
        let poses = [a, b].map(|motion| motion.pose_after(-seconds));
        intersection_test(&poses[0], &*shapes[0], &poses[1], &*shapes[1])
            .is_ok_and(|test| test.intersecting)
    };
    let (mut overlapping, mut apart) = (0.0, STEP);
    for _ in 0..HALVINGS {
        let middle = f32::midpoint(overlapping, apart);
        if overlap(middle) {
            overlapping = middle;
        } else {
            apart = middle;
        }
    }
    f64::from(overlapping)
}

/// Returns places for so many bodies, however they are turned, in a cube around the origin; and half the
/// cube's side, m.
fn scatter(bodies: usize, rng: &mut ChaCha8Rng) -> (Vec<Vec3>, f32) {
    let side = (1..).find(|side: &usize| side.pow(3) >= bodies);
    let side = side.unwrap_or(1);
    let half = length(side) * SPACING / 2.0;
    let mut cells: Vec<usize> = (0..side.pow(3)).collect();
    cells.shuffle(rng);
    cells.truncate(bodies);
    let room = SPACING / 2.0 - HALF_SIDES.length().max(RADIUS);
    let places = cells.into_iter().map(|cell| {
        let cell = [cell % side, cell / side % side, cell / side.pow(2)].map(length);
        (Vec3::from(cell) + 0.5) * SPACING - half + cube(rng, room)
    });
    (places.collect(), half)
}

fn elastic(collider: ColliderBuilder) -> ColliderBuilder {
    collider.restitution(1.0).friction(0.0)
}

/// Six walls around a cube whose side has this half, m.
fn build_walls(physics: &mut PhysicsWorld, half: f32) {
    let long = half + 2.0 * WALL;
    for axis in Vec3::AXES {
        let sides = Vec3::splat(long) + axis * (WALL - long);
        for place in [axis * (half + WALL), -axis * (half + WALL)] {
            let wall = ColliderBuilder::cuboid(sides.x, sides.y, sides.z).translation(place);
            physics.insert_collider(elastic(wall).user_data(NO_BODY), None);
        }
    }
}

/// A vector whose coordinates have at most this size.
fn cube(rng: &mut ChaCha8Rng, size: f32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| rng.random_range(-size..=size)))
}

#[allow(
    clippy::cast_precision_loss,
    reason = "some hundred cells along a side"
)]
fn length(cells: usize) -> f32 {
    cells as f32
}

/// Takes rapier's events.
#[derive(Default)]
struct Collector(Mutex<Contacts>);

impl EventHandler for Collector {
    fn handle_collision_event(
        &self,
        _: &RigidBodySet,
        colliders: &ColliderSet,
        event: CollisionEvent,
        _: Option<&ContactPair>,
    ) {
        let CollisionEvent::Started(a, b, _) = event else {
            return;
        };
        let mut contacts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let numbers = [a, b].map(|handle| usize::try_from(colliders[handle].user_data));
        match numbers {
            [Ok(a), Ok(b)] => contacts.pairs.push([a.min(b), a.max(b)]),
            _ => contacts.walls += 1,
        }
    }

    fn handle_contact_force_event(
        &self,
        _: Real,
        _: &RigidBodySet,
        _: &ColliderSet,
        _: &ContactPair,
        _: Real,
    ) {
    }

    fn handle_soft_body_tear_event(&self, _: &SoftBodySet, _: &SoftBodyTearEvent) {}
}
