//! The panel beside the picture: the answers of the monitor.

use crate::draw::LEVEL_COLOURS;
use crate::feed::Feed;
use crate::game::Game;
use crate::headless::percentile;
use crate::labels::{Area, Areas};
use macroquad::prelude::{Color, draw_rectangle, draw_text, screen_height, screen_width};
use nearmiss::{BodyId, Stats};
use std::collections::{BTreeSet, VecDeque};
use std::time::Duration;

/// Ticks and frames whose times are looked at.
const WINDOW: usize = 600;
/// Events shown.
const EVENTS: usize = 9;
/// Frames slower than this are drawn by the processor: ticks then wait for the drawing, s.
const SLOW_FRAME: f64 = 1.0 / 30.0;

/// The state of the panel.
#[derive(Default)]
pub(crate) struct Panel {
    /// ms.
    times: VecDeque<f64>,
    /// s.
    frames: VecDeque<f64>,
    feed: Feed,
    /// Effect of the last key.
    pub(crate) message: String,
}

impl Panel {
    /// After a tick; events of the alert levels from `lowest_level` on are shown.
    pub(crate) fn note(&mut self, game: &Game, took: Duration, lowest_level: usize) {
        keep(&mut self.times, took.as_secs_f64() * 1e3);
        let now = game.fleet.monitor.now();
        self.feed.note(now, &game.events, lowest_level);
        self.feed.settle(now, EVENTS);
    }

    /// After a frame, which took this long, s.
    pub(crate) fn note_frame(&mut self, took: f64) {
        keep(&mut self.frames, took);
    }

    /// Bodies that are named.
    pub(crate) fn named(&self) -> BTreeSet<BodyId> {
        let lines = self.feed.lines().iter().take(EVENTS);
        lines
            .flat_map(|line| [line.shown.encounter.a, line.shown.encounter.b])
            .collect()
    }

    /// Times of ticks, where they are of the ticks alone.
    fn tick_times(&self) -> Option<String> {
        let sorted = |values: &VecDeque<f64>| {
            let mut values: Vec<f64> = values.iter().copied().collect();
            values.sort_unstable_by(f64::total_cmp);
            values
        };
        let (times, frames) = (sorted(&self.times), sorted(&self.frames));
        let is_told = !frames.is_empty() && percentile(&frames, 50) <= SLOW_FRAME;
        let (p50, p99) = (percentile(&times, 50), percentile(&times, 99));
        is_told.then(|| format!("tick  p50 {p50:.2} ms   p99 {p99:.2} ms"))
    }
}

fn keep(values: &mut VecDeque<f64>, value: f64) {
    values.push_back(value);
    while values.len() > WINDOW {
        values.pop_front();
    }
}

/// A screen on which the panels take their areas.
pub(crate) fn areas() -> Areas {
    let mut areas = Areas::new((screen_width(), screen_height() - FOOT));
    areas.take(LEFT);
    areas.take(right());
    areas
}

/// Height of the line of keys, pixels.
const FOOT: f32 = 34.0;

const LEFT: Area = Area {
    x: 12.0,
    y: 12.0,
    width: 316.0,
    height: 236.0,
};

fn right() -> Area {
    Area {
        x: screen_width() - 386.0,
        y: 12.0,
        width: 374.0,
        height: 218.0,
    }
}

fn back(area: &Area) {
    draw_rectangle(area.x, area.y, area.width, area.height, BACK);
}

const BRIGHT: Color = Color::new(0.92, 0.95, 1.0, 1.0);
const DIM: Color = Color::new(0.62, 0.68, 0.78, 1.0);
const BACK: Color = Color::new(0.03, 0.04, 0.08, 0.88);

/// Draws the panel; `state` is that of the clock, and levels below `lowest_level` are off.
pub(crate) fn draw_panel(game: &Game, panel: &Panel, state: &str, lowest_level: usize) {
    let monitor = &game.fleet.monitor;
    let Stats {
        changed,
        boxes,
        candidates,
        survivors,
        ..
    } = *monitor.stats();
    back(&LEFT);
    let mut y = 38.0;
    let mut line = |text: &str, size: f32, colour: Color| {
        draw_text(text, 26.0, y, size, colour);
        y += 22.0;
    };
    line("nearmiss", 28.0, BRIGHT);
    let clock = format!(
        "{:7.2} s  {} bodies  {state}",
        monitor.now(),
        game.fleet.bodies.len()
    );
    line(&clock, 20.0, BRIGHT);
    if let Some(times) = panel.tick_times() {
        line(&times, 20.0, BRIGHT);
    }
    line(&format!("plans changed  {changed}"), 18.0, DIM);
    line(
        &format!("boxes {boxes} > pairs {candidates} > solved {survivors}"),
        18.0,
        DIM,
    );
    let avoidance = if game.avoids { "on" } else { "off" };
    line(&format!("avoidance {avoidance}"), 20.0, BRIGHT);
    let counted = format!(
        "collisions {}   lost {}",
        game.tally.collisions, game.tally.lost
    );
    line(&counted, 20.0, BRIGHT);
    for (level, alert) in monitor.levels().iter().enumerate() {
        let count = monitor
            .encounters()
            .filter(|encounter| encounter.level == level)
            .count();
        let name = if level == game.fleet.setting.contact {
            "contact".to_owned()
        } else {
            format!("{} m", alert.margin)
        };
        let (text, colour) = if level < lowest_level {
            (format!("{name}: off"), DIM)
        } else {
            (format!("{name}: {count}"), LEVEL_COLOURS[level])
        };
        #[allow(clippy::cast_precision_loss, reason = "one of three columns")]
        let x = 26.0 + 100.0 * level as f32;
        draw_text(&text, x, 214.0, 17.0, colour);
    }
    draw_text(&panel.message, 26.0, 238.0, 17.0, DIM);
    draw_events(game, panel);
    let keys = "space pause   S slow   A add 25   V avoidance   H hitboxes   F far level   R record   Q quit   \
                drag, wheel, hover";
    let foot = screen_height() - FOOT;
    draw_rectangle(0.0, foot, screen_width(), FOOT, BACK);
    draw_text(keys, 20.0, foot + 22.0, 18.0, DIM);
}

fn draw_events(game: &Game, panel: &Panel) {
    let area = right();
    back(&area);
    let mut y = 36.0;
    for line in panel.feed.lines().iter().take(EVENTS) {
        let told = &line.shown;
        let text = format!(
            "{:7.2}  {:<9}  {:<5} and {:<5}  {:5.1} m",
            told.time,
            told.word,
            game.fleet.name(told.encounter.a),
            game.fleet.name(told.encounter.b),
            told.encounter.closest.separation
        );
        let colour = LEVEL_COLOURS[told.encounter.level];
        draw_text(&text, area.x + 14.0, y, 18.0, colour);
        y += 22.0;
    }
}
