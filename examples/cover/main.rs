//! Fits spheres that provably contain a shape, and draws both:
//!
//! ```text
//! cargo run --release --example cover -- <box X Y Z | capsule R L | cylinder R H | mesh FILE>
//!     --spheres K [--seed S] [--json] [--picture FILE.svg]
//! ```
//!
//! With `--json` the last line of standard output is
//! `{"spheres":[[x,y,z,r],...],"overshoot_percent":...,"volume_ratio":...,"seconds":...}`. The volume
//! ratio is null for a mesh without interior.

mod mesh;
mod picture;
#[path = "../terminal/mod.rs"]
mod terminal;

use clap::{Args, Parser, Subcommand};
use nearmiss::parry3d::math::Vector;
use nearmiss::parry3d::shape::{Capsule, Cuboid, Cylinder, SharedShape};
use nearmiss::{CoverOptions, Extent, SphereCover};
use serde_json::json;
use std::error::Error as StdError;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;
use terminal::{Product, Progress, StandardOutput};

type Failure = Box<dyn StdError + Send + Sync>;

/// Spheres that provably contain a shape, with a bound of how far they reach out of it.
#[derive(Debug, Parser)]
#[command(name = "cover")]
struct Arguments {
    #[command(subcommand)]
    shape: Kind,
}

#[derive(Debug, Subcommand)]
enum Kind {
    /// A box around the origin, along the axes.
    Box {
        /// Length of the sides along x, m.
        #[arg(value_parser = length(), allow_hyphen_values = true)]
        x: f64,
        /// Along y, m.
        #[arg(value_parser = length(), allow_hyphen_values = true)]
        y: f64,
        /// Along z, m.
        #[arg(value_parser = length(), allow_hyphen_values = true)]
        z: f64,
        #[command(flatten)]
        task: Task,
    },
    /// A capsule around the origin, along y.
    Capsule {
        /// Radius, m.
        #[arg(value_parser = length(), allow_hyphen_values = true)]
        radius: f64,
        /// Distance of the two ends of its axis, m.
        #[arg(value_parser = terminal::within(0.0..=1e9), allow_hyphen_values = true)]
        length: f64,
        #[command(flatten)]
        task: Task,
    },
    /// A cylinder around the origin, along y.
    Cylinder {
        /// Radius, m.
        #[arg(value_parser = length(), allow_hyphen_values = true)]
        radius: f64,
        /// Full height, m.
        #[arg(value_parser = length(), allow_hyphen_values = true)]
        height: f64,
        #[command(flatten)]
        task: Task,
    },
    /// A triangle mesh: with its interior if it is closed, else its surface.
    Mesh {
        /// An OBJ or STL file.
        file: PathBuf,
        #[command(flatten)]
        task: Task,
    },
}

#[derive(Debug, Args)]
struct Task {
    /// Largest number of spheres.
    #[arg(long, value_parser = terminal::whole(1..=CoverOptions::MAX_SPHERES), allow_negative_numbers = true)]
    spheres: usize,
    /// Another seed makes the search begin elsewhere.
    #[arg(long, value_parser = terminal::whole(0..=u64::MAX), default_value = "0", allow_negative_numbers = true)]
    seed: u64,
    /// Ends with one line of JSON.
    #[arg(long)]
    json: bool,
    /// File of the picture; one that is there is replaced.
    #[arg(long, default_value = "cover.svg")]
    picture: PathBuf,
}

fn length() -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    terminal::within(1e-9..=1e9)
}

impl Kind {
    fn shape(&self) -> Result<SharedShape, Failure> {
        #[allow(clippy::cast_possible_truncation, reason = "shapes are made of f32")]
        let single = |length: f64| length as f32;
        Ok(match self {
            Self::Box { x, y, z, .. } => {
                let half = Vector::new(single(x / 2.0), single(y / 2.0), single(z / 2.0));
                SharedShape::new(Cuboid::new(half))
            }
            Self::Capsule { radius, length, .. } => {
                SharedShape::new(Capsule::new_y(single(length / 2.0), single(*radius)))
            }
            Self::Cylinder { radius, height, .. } => {
                SharedShape::new(Cylinder::new(single(height / 2.0), single(*radius)))
            }
            Self::Mesh { file, .. } => SharedShape::new(mesh::read(file)?),
        })
    }

    const fn task(&self) -> &Task {
        match self {
            Self::Box { task, .. }
            | Self::Capsule { task, .. }
            | Self::Cylinder { task, .. }
            | Self::Mesh { task, .. } => task,
        }
    }
}

fn main() -> ExitCode {
    let kind = terminal::parse::<Arguments>().shape;
    let picture = &kind.task().picture;
    if let Kind::Mesh { file, .. } = &kind
        && terminal::is_same_file(file, picture)
    {
        let name = terminal::name(picture);
        terminal::refuse::<Arguments>(format_args!(
            "--picture {name} is the file of the mesh itself"
        ));
    }
    terminal::exit_code(run(&kind))
}

fn run(kind: &Kind) -> Result<(), Failure> {
    let task = kind.task();
    let shape = kind.shape()?;
    let picture = Product::at(&task.picture)?;
    let mut out = StandardOutput::new();
    let options = CoverOptions::new(task.spheres).with_seed(task.seed);
    let progress = Progress::new();
    progress.begin(format!("fitting {} spheres", task.spheres));
    let begin = Instant::now();
    let cover = SphereCover::fit_with_progress(&*shape, &options, |share| progress.show(share))?;
    let seconds = begin.elapsed().as_secs_f64();
    progress.finish();
    if cover.extent() == Extent::Surface {
        writeln!(out, "the mesh is not closed: its surface is covered")?;
    }
    let ratio = cover.volume_ratio();
    writeln!(
        out,
        "spheres   certified overshoot             volume ratio   time\n\
         {:>7}   {:>9.4} % {:>12} m   {:>12}   {:.2} s",
        cover.spheres().len(),
        cover.overshoot_percent(),
        shown(cover.overshoot()),
        ratio.map_or("none".to_owned(), |ratio| format!("{ratio:.3}")),
        seconds,
    )?;
    let drawn = picture::draw(&*shape, &cover)?;
    picture.write(|mut file| file.write_all(drawn.as_bytes()))?;
    writeln!(out, "the picture is in {}", terminal::name(&task.picture))?;
    if task.json {
        let spheres: Vec<[f64; 4]> = cover
            .spheres()
            .iter()
            .map(|sphere| {
                let [x, y, z] = sphere.offset.to_array();
                [x, y, z, sphere.radius]
            })
            .collect();
        // In this order, which a map of JSON values would not keep.
        writeln!(
            out,
            "{{\"spheres\":{},\"overshoot_percent\":{},\"volume_ratio\":{},\"seconds\":{seconds}}}",
            json!(spheres),
            json!(cover.overshoot_percent()),
            json!(ratio),
        )?;
    }
    Ok(())
}

/// A length (m) with six decimals; as a power of ten where these would say nothing, or too much.
fn shown(metres: f64) -> String {
    if metres == 0.0 || (1e-3..1e6).contains(&metres) {
        format!("{metres:.6}")
    } else {
        format!("{metres:.4e}")
    }
}
