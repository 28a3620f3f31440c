//! The world: bodies, hitboxes, predicted encounters.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "pictures are drawn in f32"
)]

use crate::Failure;
use crate::fleet::Kind;
use crate::game::Game;
use crate::shapes::Shape;
use glam::{DQuat, DVec3};
use macroquad::prelude::{
    Camera, Camera3D, Color, Mat3, Mesh, Vec2, Vec3, clear_background, draw_circle,
    draw_cube_wires, draw_line_3d, draw_mesh, draw_plane, screen_height, screen_width, set_camera,
    set_default_camera, vec2, vec3,
};
use nearmiss::{BodyId, Encounter};
use std::collections::BTreeMap;

/// Of the alert levels, the widest first.
pub(crate) const LEVEL_COLOURS: [Color; 3] = [
    Color::new(0.35, 0.75, 1.0, 1.0),
    Color::new(1.0, 0.76, 0.25, 1.0),
    Color::new(1.0, 0.33, 0.36, 1.0),
];

/// Triangles in one draw call.
const BATCH: usize = 15_000;

/// The place from which the world is seen.
pub(crate) struct View {
    angle: f32,
    height: f32,
    distance: f32,
    half: f32,
    stars: Vec<Vec3>,
    shapes: [(Kind, Shape); 3],
    pub(crate) shows_hitboxes: bool,
    /// The alert levels from this one on are shown.
    pub(crate) lowest_level: usize,
}

impl View {
    /// Returns the view of a cube with this half side, m. The far level is not shown at first.
    pub(crate) fn around(half: f64) -> Result<Self, Failure> {
        // Evenly over the sphere: the golden angle from pole to pole.
        let stars = (0..900).map(|k| {
            let y = 1.0 - 2.0 * (k as f32 + 0.5) / 900.0;
            let (sin, cos) = (k as f32 * 2.399_963 + (k as f32 * 12.9).sin()).sin_cos();
            let across = (1.0 - y * y).sqrt();
            vec3(cos * across, y, sin * across)
        });
        let shape = |kind| Ok::<_, Failure>((kind, Shape::of(kind)?));
        Ok(Self {
            angle: 0.7,
            height: 0.38,
            distance: 2.1 * half as f32,
            half: half as f32,
            stars: stars.collect(),
            shapes: [
                shape(Kind::Ship)?,
                shape(Kind::Drone)?,
                shape(Kind::Asteroid)?,
            ],
            shows_hitboxes: true,
            lowest_level: 1,
        })
    }

    pub(crate) fn turn(&mut self, across: f32, along: f32) {
        self.angle -= 2.0 * across;
        self.height = (self.height - 2.0 * along).clamp(-1.4, 1.4);
    }

    pub(crate) fn zoom(&mut self, steps: f32) {
        let factor = 0.9_f32.powf(steps.clamp(-3.0, 3.0));
        self.distance = (self.distance * factor).clamp(10.0, 8.0 * self.half);
    }

    /// Goes slowly round.
    pub(crate) fn drift(&mut self, seconds: f64) {
        self.angle += 0.03 * seconds as f32;
    }

    pub(crate) fn camera(&self) -> Camera3D {
        let (sin, cos) = self.angle.sin_cos();
        let (up, flat) = self.height.sin_cos();
        Camera3D {
            position: vec3(cos * flat, up, sin * flat) * self.distance,
            up: Vec3::Y,
            target: vec3(0.0, -0.06 * self.half, 0.0),
            fovy: 0.75,
            ..Camera3D::default()
        }
    }
}

/// Returns a place on the screen, if it is before the camera.
pub(crate) fn on_screen(camera: &Camera3D, place: Vec3) -> Option<Vec2> {
    let clip = camera.matrix() * place.extend(1.0);
    (clip.w > 0.0).then(|| {
        vec2(
            (0.5 + 0.5 * clip.x / clip.w) * screen_width(),
            (0.5 - 0.5 * clip.y / clip.w) * screen_height(),
        )
    })
}

pub(crate) fn vector(v: DVec3) -> Vec3 {
    vec3(v.x as f32, v.y as f32, v.z as f32)
}

fn faint(colour: Color, alpha: f32) -> Color {
    Color { a: alpha, ..colour }
}

pub(crate) fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Sphere => "sphere",
        Kind::Ship => "ship",
        Kind::Drone => "drone",
        Kind::Asteroid => "asteroid",
    }
}

/// Draws the world; returns the encounters that are shown, the soonest first.
pub(crate) fn draw_world(game: &Game, view: &View) -> Vec<Encounter> {
    clear_background(Color::new(0.025, 0.03, 0.055, 1.0));
    let camera = view.camera();
    draw_stars(&camera, view);
    let encounters = worst_first(game, view.lowest_level);
    set_camera(&camera);
    let side = Vec3::splat(2.0 * view.half);
    draw_cube_wires(Vec3::ZERO, side, Color::new(0.3, 0.4, 0.6, 0.35));
    draw_floor(view.half, camera.position);
    draw_bodies(game, view);
    // The worst alert of each body.
    let mut alerts: BTreeMap<BodyId, usize> = BTreeMap::new();
    for encounter in &encounters {
        for id in [encounter.a, encounter.b] {
            let alert = alerts.entry(id).or_default();
            *alert = encounter.level.max(*alert);
        }
    }
    if view.shows_hitboxes {
        draw_hitboxes(game, &camera, &alerts);
    }
    for encounter in &encounters {
        draw_encounter(game, encounter);
    }
    set_default_camera();
    encounters
}

/// One encounter a pair, that of the worst level, the soonest first.
fn worst_first(game: &Game, lowest_level: usize) -> Vec<Encounter> {
    let mut worst: BTreeMap<(BodyId, BodyId), Encounter> = BTreeMap::new();
    let encounters = game.fleet.monitor.encounters();
    for encounter in encounters.filter(|encounter| encounter.level >= lowest_level) {
        let kept = worst
            .entry((encounter.a, encounter.b))
            .or_insert(*encounter);
        if encounter.level > kept.level {
            *kept = *encounter;
        }
    }
    let mut all: Vec<Encounter> = worst.into_values().collect();
    all.sort_by(|x, y| x.closest.time.total_cmp(&y.closest.time));
    all
}

fn draw_stars(camera: &Camera3D, view: &View) {
    for (k, star) in view.stars.iter().enumerate() {
        if let Some(at) = on_screen(camera, camera.position + *star * 1e4) {
            let brightness = 0.25 + 0.5 * ((k as f32 * 7.31).sin().abs());
            let colour = Color::new(0.8, 0.87, 1.0, brightness);
            draw_circle(at.x, at.y, 0.6 + 0.7 * brightness, colour);
        }
    }
}

/// The floor: a grid on a surface, which hides nothing from below.
fn draw_floor(half: f32, from: Vec3) {
    const LINES: i32 = 8;
    if from.y > -half {
        // A little below the lines, which it would hide.
        let middle = vec3(0.0, -half - 0.1, 0.0);
        let surface = Color::new(0.16, 0.24, 0.40, 0.35);
        draw_plane(middle, vec2(half, half), None, surface);
    }
    let colour = Color::new(0.35, 0.5, 0.75, 0.32);
    for k in -LINES..=LINES {
        let x = half * k as f32 / LINES as f32;
        draw_line_3d(vec3(x, -half, -half), vec3(x, -half, half), colour);
        draw_line_3d(vec3(-half, -half, x), vec3(half, -half, x), colour);
    }
}

fn draw_bodies(game: &Game, view: &View) {
    let mut vertices = Vec::new();
    for (index, &id) in game.fleet.bodies.iter().enumerate() {
        let Some(state) = game.fleet.state(id) else {
            continue;
        };
        let kind = game.fleet.setting.kind(index);
        let Some((_, shape)) = view.shapes.iter().find(|(of, _)| *of == kind) else {
            continue;
        };
        let Some(body) = game.fleet.monitor.scene().body(id) else {
            continue;
        };
        let rotation = body.orientation.rotation(state.time);
        shape.place(axes(rotation), vector(state.position), &mut vertices);
    }
    for batch in vertices.chunks(3 * BATCH) {
        draw_mesh(&Mesh {
            indices: (0..batch.len()).map(|index| index as u16).collect(),
            vertices: batch.to_vec(),
            texture: None,
        });
    }
}

/// A body's axes in the world.
fn axes(rotation: DQuat) -> Mat3 {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| vector(rotation * axis));
    Mat3::from_cols(x, y, z)
}

/// A ring that faces the camera around each sphere.
fn draw_hitboxes(game: &Game, camera: &Camera3D, alerts: &BTreeMap<BodyId, usize>) {
    const CORNERS: usize = 20;
    let scene = game.fleet.monitor.scene();
    for &id in &game.fleet.bodies {
        let Some(body) = scene.body(id) else { continue };
        let colour = match alerts.get(&id) {
            Some(&level) => faint(LEVEL_COLOURS[level], 0.9),
            None => Color::new(0.6, 0.7, 0.85, 0.16),
        };
        let now = game.fleet.monitor.now();
        for sphere in body.spheres_at(now).unwrap_or_default() {
            let centre = vector(sphere.offset);
            let forward = (camera.target - camera.position).normalize();
            let right = forward.cross(Vec3::Y).normalize() * sphere.radius as f32;
            let up = right.cross(forward).normalize() * sphere.radius as f32;
            let corner = |k: usize| {
                let (sin, cos) = (k as f32 * std::f32::consts::TAU / CORNERS as f32).sin_cos();
                centre + right * cos + up * sin
            };
            for k in 0..CORNERS {
                draw_line_3d(corner(k), corner(k + 1), colour);
            }
        }
    }
}

/// Both ways to the closest approach, and the gap there.
fn draw_encounter(game: &Game, encounter: &Encounter) {
    const STEPS: u32 = 14;
    let colour = LEVEL_COLOURS[encounter.level];
    let now = game.fleet.monitor.now();
    let ahead = encounter.closest.time - now;
    let scene = game.fleet.monitor.scene();
    let fly = [encounter.a, encounter.b].into_iter();
    for id in fly.filter(|&id| !game.fleet.is_floor(id)) {
        let Some(body) = scene.body(id) else { continue };
        let way: Vec<Vec3> = (0..=STEPS)
            .filter_map(|k| {
                let time = now + ahead.max(0.0) * f64::from(k) / f64::from(STEPS);
                body.trajectory.position(time).map(vector)
            })
            .collect();
        for (pair, k) in way.windows(2).zip(0_u8..) {
            let alpha = 0.15 + 0.6 * f32::from(k) / STEPS as f32;
            draw_line_3d(pair[0], pair[1], faint(colour, alpha));
        }
    }
    let [a, b] = game.fleet.closest_places(encounter).map(vector);
    draw_line_3d(a, b, colour);
    let middle = (a + b) * 0.5;
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        draw_line_3d(middle - axis * 1.2, middle + axis * 1.2, colour);
    }
}
