//! Seeded boxes of all the shapes that a slice of a scene may have.

use nearmiss::internals::broad_phase::BodyBox;
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};

/// A shape of the world that boxes can be drawn from, in any number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    pub(crate) name: &'static str,
    draw: fn(&mut ChaCha8Rng, usize) -> Vec<Aabb>,
}

impl Shape {
    /// `count` boxes; some body indices are left out, and the order is not that of the bodies.
    pub(crate) fn boxes(&self, count: usize, seed: u64) -> Vec<BodyBox> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let corners = (self.draw)(&mut rng, count);
        let mut bodies: Vec<u32> = (0..).step_by(3).take(count).collect();
        bodies.shuffle(&mut rng);
        corners
            .into_iter()
            .zip(bodies)
            .map(|(aabb, body)| BodyBox { aabb, body })
            .collect()
    }

    pub(crate) fn named(name: &str) -> Self {
        SHAPES
            .into_iter()
            .find(|shape| shape.name == name)
            .unwrap_or_else(|| panic!("no shape is called {name}"))
    }
}

/// Mean distance of neighbours in the reference swarm, and the usual side of a box: metres.
pub(crate) const SPACING: f32 = 65.6;
pub(crate) const SIDE: f32 = 0.5 * SPACING;

pub(crate) const SHAPES: [Shape; 24] = [
    shape("swarm", swarm),
    shape("clusters", |rng, n| clusters(rng, n, 10)),
    shape("many_clusters", |rng, n| clusters(rng, n, 100)),
    shape("lattice_of_clusters", lattice_of_clusters),
    shape("flat", |rng, n| flat(rng, n, 1.0)),
    shape("plane", |rng, n| flat(rng, n, 0.0)),
    shape("line", line),
    shape("points", points),
    shape("fast_few", |rng, n| few(rng, n, 15.0)),
    shape("huge_few", |rng, n| few(rng, n, 1e4)),
    shape("largest_few", |rng, n| largest(rng, n, 50)),
    shape("largest_many", |rng, n| largest(rng, n, 3)),
    shape("all_sizes", all_sizes),
    shape("nested", nested),
    shape("bridged", bridged),
    shape("one_place", one_place),
    shape("identical", identical),
    shape("touching", touching),
    shape("rods", rods),
    shape("plates", plates),
    shape("all_scales", all_scales),
    shape("outlier", outlier),
    shape("onion", onion),
    shape("folded", folded),
];

const fn shape(name: &'static str, draw: fn(&mut ChaCha8Rng, usize) -> Vec<Aabb>) -> Shape {
    Shape { name, draw }
}

#[allow(clippy::cast_precision_loss, reason = "counts far below 2^24")]
fn real(count: usize) -> f32 {
    count as f32
}

fn uniform(rng: &mut ChaCha8Rng) -> Vector {
    Vector::new(rng.random(), rng.random(), rng.random())
}

/// A box of the usual sides, each from half to one and a half times the mean.
fn usual(rng: &mut ChaCha8Rng, centre: Vector) -> Aabb {
    let half = 0.5 * SIDE * (uniform(rng) + 0.5);
    Aabb::new(centre - half, centre + half)
}

/// A cube of even density.
fn swarm(rng: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    let side = SPACING * real(n).cbrt();
    (0..n)
        .map(|_| {
            let centre = side * (uniform(rng) - 0.5);
            usual(rng, centre)
        })
        .collect()
}

/// Balls of even density, each of 1/k of the bodies, in a cube of 3,000 km.
fn clusters(rng: &mut ChaCha8Rng, n: usize, k: usize) -> Vec<Aabb> {
    let centres: Vec<Vector> = (0..k).map(|_| 3e6 * uniform(rng)).collect();
    let radius = SPACING * (0.75 / std::f32::consts::PI * real(n) / real(k)).cbrt();
    (0..n)
        .map(|i| {
            let offset = loop {
                let offset = 2.0 * uniform(rng) - 1.0;
                if offset.length_squared() <= 1.0 {
                    break offset;
                }
            };
            usual(rng, centres[i % k] + radius * offset)
        })
        .collect()
}

/// Clusters on a lattice of powers of two, which fall onto each other where coordinates wrap.
fn lattice_of_clusters(rng: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    let side = SPACING * (real(n) / 64.0).cbrt();
    (0..n)
        .map(|i| {
            let cell = Vector::new(real(i % 4), real(i / 4 % 4), real(i / 16 % 4));
            let centre = 1_048_576.0 * cell + side * uniform(rng);
            usual(rng, centre)
        })
        .collect()
}

/// A layer of boxes, as dense as the swarm seen from above; thickness as a share of the usual one.
fn flat(rng: &mut ChaCha8Rng, n: usize, thickness: f32) -> Vec<Aabb> {
    let side = SPACING * real(n).sqrt();
    let squeeze = Vector::new(1.0, 1.0, thickness);
    (0..n)
        .map(|_| {
            let centre = side * (uniform(rng) - 0.5) * Vector::new(1.0, 1.0, 1e-3 * thickness);
            let half = 0.5 * SIDE * (uniform(rng) + 0.5) * squeeze;
            Aabb::new(centre - half, centre + half)
        })
        .collect()
}

fn line(rng: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    (0..n)
        .map(|_| {
            let along = SPACING * real(n) * rng.random::<f32>();
            usual(rng, Vector::new(1.0, -2.0, 0.5) * along)
        })
        .collect()
}

/// Boxes without any thickness, drawn from few enough places that some coincide.
fn points(rng: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    let places = 2.0 * real(n).cbrt();
    (0..n)
        .map(|_| {
            let place = (places * uniform(rng)).floor();
            Aabb::new(place, place)
        })
        .collect()
}

/// The swarm with one box in twenty longer on each axis.
fn few(rng: &mut ChaCha8Rng, n: usize, factor: f32) -> Vec<Aabb> {
    let mut boxes = swarm(rng, n);
    for aabb in boxes.iter_mut().step_by(20) {
        let more = (factor - 1.0) * 0.5 * SIDE * uniform(rng);
        *aabb = Aabb::new(aabb.mins - more, aabb.maxs + more);
    }
    boxes
}

/// The swarm with one box in `stride` as large as numbers go on some axes.
fn largest(rng: &mut ChaCha8Rng, n: usize, stride: usize) -> Vec<Aabb> {
    let mut boxes = swarm(rng, n);
    for (i, aabb) in boxes.iter_mut().step_by(stride).enumerate() {
        for axis in (0..3).filter(|axis| i >> axis & 1 == 0) {
            aabb.mins[axis] = -f32::MAX;
            aabb.maxs[axis] = f32::MAX;
        }
    }
    boxes
}

/// Boxes of the usual size down to a thousand times smaller and up to thirty times larger.
fn all_sizes(rng: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    let mut boxes = swarm(rng, n);
    for aabb in &mut boxes {
        let half = 0.5 * aabb.extents() * rng.random_range(-10.0..5.0_f32).exp2();
        *aabb = Aabb::new(aabb.center() - half, aabb.center() + half);
    }
    boxes
}

/// Half of a swarm, the other half in a copy of it, ten thousand times smaller, somewhere inside.
fn nested(rng: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    let mut boxes = swarm(rng, n);
    for aabb in boxes.iter_mut().step_by(2) {
        *aabb = Aabb::new(1e-4 * aabb.mins + 10.0, 1e-4 * aabb.maxs + 10.0);
    }
    boxes
}

/// Two clusters, and one box in twelve that reaches from one into the other.
fn bridged(rng: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    let mut boxes = clusters(rng, n, 2);
    for i in (0..n.saturating_sub(1)).step_by(12) {
        let (one, other) = (boxes[i], boxes[i + 1]);
        boxes[i] = Aabb::new(one.mins.min(other.mins), one.maxs.max(other.maxs));
    }
    boxes
}

fn one_place(rng: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    (0..n)
        .map(|_| {
            let centre = Vector::splat(1e5) + 0.1 * SIDE * uniform(rng);
            usual(rng, centre)
        })
        .collect()
}

fn identical(_: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    vec![Aabb::new(Vector::splat(-0.0), Vector::splat(2.5)); n]
}

/// A full lattice of cubes that share faces, edges and corners with their neighbours.
fn touching(_: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    let edge = (1..).find(|edge| edge * edge * edge >= n).unwrap_or(1);
    (0..n)
        .map(|i| {
            let cell = Vector::new(real(i % edge), real(i / edge % edge), real(i / edge / edge));
            let low = 0.3 * (cell - 2.0);
            // The neighbour's low corner by the same expression: they touch to the bit.
            Aabb::new(low, 0.3 * (cell - 1.0))
        })
        .collect()
}

/// Long boxes side by side along the first axis.
fn rods(rng: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    let side = 2.0 * real(n).sqrt();
    (0..n)
        .map(|_| {
            let low = Vector::new(1.0, side, side) * uniform(rng);
            Aabb::new(low, low + Vector::new(1e3, 1.0, 1.0))
        })
        .collect()
}

/// Wide thin boxes upon each other along the third axis.
fn plates(rng: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    let side = 2.0 * real(n);
    (0..n)
        .map(|_| {
            let low = Vector::new(1.0, 1.0, side) * uniform(rng);
            Aabb::new(low, low + Vector::new(1e3, 1e3, 1.0))
        })
        .collect()
}

/// Places and sizes from the least to the greatest normal numbers, and some of zero.
fn all_scales(rng: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    let number = |rng: &mut ChaCha8Rng| {
        let power = rng.random_range(-140.0..126.0_f32).exp2();
        match rng.random_range(0..8) {
            0 => 0.0,
            1..=4 => power,
            _ => -power,
        }
    };
    (0..n)
        .map(|_| {
            let mut vector = || Vector::new(number(rng), number(rng), number(rng));
            let (one, other) = (vector(), vector());
            Aabb::new(one.min(other), one.max(other))
        })
        .collect()
}

/// The swarm, and one body so far away that the swarm is a point beside it.
fn outlier(rng: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    let mut boxes = swarm(rng, n);
    if let Some(last) = boxes.last_mut() {
        *last = usual(rng, Vector::new(1e30, -1e20, 1e9));
    }
    boxes
}

/// Boxes within boxes: all meet.
fn onion(_: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    (0..n)
        .map(|i| {
            let half = Vector::new(1.0, 2.0, 3.0) * real(i);
            Aabb::new(-half, half)
        })
        .collect()
}

/// The swarm's boxes moved by multiples of 65,536 m: equal where coordinates wrap.
fn folded(rng: &mut ChaCha8Rng, n: usize) -> Vec<Aabb> {
    let side = SPACING * real(n).cbrt() / 4.0;
    (0..n)
        .map(|_| {
            let fold = (16.0 * uniform(rng)).floor() - 8.0;
            let centre = 65_536.0 * fold + side * uniform(rng);
            usual(rng, centre)
        })
        .collect()
}
