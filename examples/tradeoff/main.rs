//! Measures what speed costs in accuracy, and the other way round:
//!
//! ```text
//! cargo run --release --example tradeoff -- [--quick] [--only pair|stepped|modelled|prices]
//!     [--json FILE] [--pictures FOLDER] [--bodies N | --states FILE --radius R --margin M]
//! ```
//!
//! Each line is compared with a certified reference: that of the splines, of the true motions that are fitted, or of the
//! boxes that spheres cover. Times are medians; what is compared runs in turns. With `--features recording` the price
//! list has a row for it.

mod existence;
mod modelled;
mod pair;
#[allow(dead_code, reason = "the benchmark `kernels` uses more of it")]
#[path = "../../benches/kernels/peers.rs"]
mod peers;
mod picture;
mod prices;
#[allow(dead_code, reason = "the example `screen` uses more of it")]
#[path = "../screen/read/mod.rs"]
mod read;
#[path = "../scenes/mod.rs"]
mod scenes;
mod stepped;
mod table;
#[path = "../terminal/mod.rs"]
mod terminal;
mod timing;
#[path = "../../benches/kernels/workloads.rs"]
mod workloads;
mod world;

use clap::{Parser, ValueEnum};
use rayon::ThreadPoolBuilder;
use serde_json::{Map, Value, json};
use std::error::Error as StdError;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use table::Table;
use terminal::{Product, Progress, StandardOutput};
use world::World;

type Failure = Box<dyn StdError + Send + Sync>;

/// Speed against accuracy, measured.
#[derive(Debug, Parser)]
#[command(name = "tradeoff")]
struct Arguments {
    /// Fewer pairs, bodies and turns: under a minute.
    #[arg(long)]
    quick: bool,
    /// One part only.
    #[arg(long, value_enum)]
    only: Option<Part>,
    /// Number of bodies of a generated scene that is stepped.
    #[arg(long, value_parser = terminal::bodies(), allow_negative_numbers = true, conflicts_with = "states")]
    bodies: Option<usize>,
    /// A file of states, as `screen` takes it, that is stepped in place of a generated scene.
    #[arg(long)]
    states: Option<PathBuf>,
    /// Radius of every body of the file, m; 0.5 if neither this is given nor the file has a column radius.
    #[arg(
        long,
        value_parser = terminal::within(0.0..=world::MAX_RADIUS),
        allow_hyphen_values = true,
        requires = "states"
    )]
    radius: Option<f64>,
    /// Separation that counts as contact in the file, m.
    #[arg(
        long,
        default_value = "0",
        value_parser = terminal::margin,
        allow_hyphen_values = true,
        requires = "states"
    )]
    margin: f64,
    /// File for all tables as JSON; replaced if it exists.
    #[arg(long)]
    json: Option<PathBuf>,
    /// A folder for the pictures tradeoff-pair.svg and tradeoff-stepped.svg; made if it does not exist.
    #[arg(long)]
    pictures: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// One pair of cubics: other solvers and ours.
    Pair,
    /// A scene stepped by a frame loop, at several rates.
    Stepped,
    /// A world modelled more or less finely.
    Modelled,
    /// A price list of capabilities.
    Prices,
}

/// The amount of measuring.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    quick: bool,
}

impl Effort {
    /// Returns one of two amounts: for all, or for a quick look.
    pub(crate) fn choose<T>(&self, all: T, quick: T) -> T {
        if self.quick { quick } else { all }
    }
}

impl Arguments {
    /// Returns the pictures' names and files.
    fn pictures(&self) -> Vec<(&'static str, PathBuf)> {
        let file = |name, folder: &PathBuf| (name, folder.join(format!("tradeoff-{name}.svg")));
        let folder = self.pictures.iter();
        let both = folder.flat_map(|folder| ["pair", "stepped"].map(|name| file(name, folder)));
        both.collect()
    }

    /// Checks options that are right one by one, but not together.
    fn check(&self) -> Result<(), String> {
        let is_stepped = self.only.is_none_or(|only| only == Part::Stepped);
        if !is_stepped && (self.states.is_some() || self.bodies.is_some()) {
            return Err(
                "--states and --bodies are of the scene that is stepped, which --only leaves out"
                    .to_owned(),
            );
        }
        let is_json = |file: &PathBuf| {
            let json = self.json.as_ref();
            json.is_some_and(|json| terminal::is_same_file(json, file))
        };
        if let Some((_, file)) = self.pictures().iter().find(|(_, file)| is_json(file)) {
            return Err(format!(
                "--json {} is a picture as well",
                terminal::name(file)
            ));
        }
        let Some(states) = &self.states else {
            return Ok(());
        };
        let json = self.json.iter().map(|file| ("--json", file.clone()));
        let pictures = self.pictures().into_iter();
        let pictures = pictures.map(|(_, file)| ("--pictures:", file));
        let mut written = json.chain(pictures);
        match written.find(|(_, file)| terminal::is_source(states, file)) {
            Some((option, file)) => Err(format!(
                "{option} {} is the file of states itself",
                terminal::name(&file)
            )),
            None => Ok(()),
        }
    }

    /// Returns the scene that is stepped, if it is.
    fn world(&self, effort: &Effort) -> Result<Option<World>, Failure> {
        if self.only.is_some_and(|only| only != Part::Stepped) {
            return Ok(None);
        }
        let world = match &self.states {
            Some(file) => World::of_file(file, self.radius, self.margin),
            None => {
                let bodies = self.bodies.unwrap_or(effort.choose(2_000, 300));
                World::swarm(bodies, 12.0, effort.choose(20.0, 4.0))
            }
        };
        world.map(Some)
    }
}

fn main() -> ExitCode {
    let arguments = terminal::parse::<Arguments>();
    match arguments.check() {
        Ok(()) => terminal::exit_code(run(&arguments)),
        Err(message) => terminal::refuse::<Arguments>(message),
    }
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let json = arguments.json.as_deref().map(Product::at).transpose()?;
    if let Some(folder) = &arguments.pictures {
        std::fs::create_dir_all(folder).map_err(|error| {
            let name = terminal::name(folder);
            if folder.exists() {
                format!("--pictures {name}: is not a folder")
            } else {
                format!("--pictures {name}: {error}")
            }
        })?;
    }
    let pictures = arguments.pictures().into_iter();
    let pictures = pictures.map(|(name, file)| Ok((name, Product::at(&file)?)));
    let pictures = pictures.collect::<Result<Vec<_>, String>>()?;
    let effort = Effort {
        quick: arguments.quick,
    };
    // One thread: what is compared has one as well.
    let pool = ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build()?;
    // A file that cannot be read is told before anything is measured.
    let world = arguments.world(&effort)?;
    let mut out = StandardOutput::new();
    let mut tables: Vec<Table> = Vec::new();
    for (part, name) in [
        (Part::Pair, "one pair"),
        (Part::Stepped, "a scene stepped"),
        (Part::Modelled, "a world modelled"),
        (Part::Prices, "a price list"),
    ] {
        if arguments.only.is_some_and(|only| only != part) {
            continue;
        }
        let progress = Progress::new();
        progress.begin(name.to_owned());
        let show = |share: f64| progress.show(share);
        let made = pool.install(|| measure(part, world.as_ref(), &effort, &show))?;
        progress.finish();
        for table in &made {
            table.print(&mut out)?;
        }
        tables.extend(made);
    }
    let found = |key: &str| tables.iter().find(|table| table.key == key);
    for (name, product) in &pictures {
        if let Some(table) = found(name) {
            let drawn = picture::draw(table)?;
            product.write(|mut file| file.write_all(drawn.as_bytes()))?;
        }
    }
    if let Some(json) = json {
        let text = document(&tables, &effort).to_string();
        json.write(|mut file| writeln!(file, "{text}"))?;
    }
    Ok(())
}

fn measure(
    part: Part,
    world: Option<&World>,
    effort: &Effort,
    progress: &dyn Fn(f64),
) -> Result<Vec<Table>, Failure> {
    Ok(match part {
        Part::Pair => vec![pair::table(effort, progress)],
        Part::Stepped => match world {
            Some(world) => vec![stepped::table(world, effort, progress)?],
            None => Vec::new(),
        },
        Part::Modelled => modelled::tables(effort, progress)?,
        Part::Prices => vec![
            prices::table(effort, &|share| progress(0.6 * share))?,
            existence::table(effort, &|share| progress(0.6 + 0.4 * share))?,
        ],
    })
}

/// All tables as one object: `{"quick": ..., "tables": {key: {"title", "rows", "notes"}}}`.
fn document(tables: &[Table], effort: &Effort) -> Value {
    let by_key: Map<String, Value> = tables
        .iter()
        .map(|table| (table.key.to_owned(), table.json()))
        .collect();
    json!({ "quick": effort.quick, "tables": by_key })
}
