//! What the monitor says, beside the picture.

use crate::draw::LEVEL_COLOURS;
use crate::game::Game;
use crate::headless::percentile;
use macroquad::prelude::{Color, draw_rectangle, draw_text, screen_height, screen_width};
use nearmiss::{Event, EventKind, Stats};
use std::collections::VecDeque;
use std::time::Duration;

/// Ticks whose times are looked at.
const WINDOW: usize = 600;
/// Events shown.
const EVENTS: usize = 9;

/// What is remembered for the panel.
#[derive(Default)]
pub(crate) struct Panel {
    /// ms.
    times: VecDeque<f64>,
    events: VecDeque<(f64, Event)>,
    /// What the last key did.
    pub(crate) message: String,
}

impl Panel {
    /// After a tick.
    pub(crate) fn note(&mut self, game: &Game, took: Duration) {
        self.times.push_back(took.as_secs_f64() * 1e3);
        while self.times.len() > WINDOW {
            self.times.pop_front();
        }
        let now = game.fleet.monitor.now();
        let told = game.events.iter().filter(|event| {
            !matches!(
                event.kind,
                EventKind::Revised(_) | EventKind::PlanEnds { .. }
            )
        });
        self.events.extend(told.map(|event| (now, *event)));
        while self.events.len() > EVENTS {
            self.events.pop_front();
        }
    }
}

const BRIGHT: Color = Color::new(0.92, 0.95, 1.0, 1.0);
const DIM: Color = Color::new(0.62, 0.68, 0.78, 1.0);
const BACK: Color = Color::new(0.03, 0.04, 0.08, 0.88);

pub(crate) fn draw_panel(game: &Game, panel: &Panel, pace: f64, is_paused: bool) {
    let mut times: Vec<f64> = panel.times.iter().copied().collect();
    times.sort_unstable_by(f64::total_cmp);
    let monitor = &game.fleet.monitor;
    let Stats {
        changed,
        boxes,
        candidates,
        survivors,
        ..
    } = *monitor.stats();
    draw_rectangle(12.0, 12.0, 316.0, 236.0, BACK);
    let mut y = 38.0;
    let mut line = |text: &str, size: f32, colour: Color| {
        draw_text(text, 26.0, y, size, colour);
        y += 22.0;
    };
    line("nearmiss", 28.0, BRIGHT);
    let state = match (is_paused, pace < 1.0) {
        (true, _) => "paused",
        (false, true) => "slow",
        (false, false) => "",
    };
    let clock = format!(
        "{:7.2} s  {} bodies  {state}",
        monitor.now(),
        game.fleet.bodies.len()
    );
    line(&clock, 20.0, BRIGHT);
    let p = |percent| percentile(&times, percent);
    let tick = format!("tick  p50 {:.2} ms   p99 {:.2} ms", p(50), p(99));
    line(&tick, 20.0, BRIGHT);
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
    for (level, name) in ["8 m:", "3 m:", "contact:"].iter().enumerate() {
        let count = monitor
            .encounters()
            .filter(|encounter| encounter.level == level)
            .count();
        #[allow(clippy::cast_precision_loss, reason = "one of three columns")]
        let x = 26.0 + 100.0 * level as f32;
        draw_text(
            format!("{name} {count}"),
            x,
            214.0,
            17.0,
            LEVEL_COLOURS[level],
        );
    }
    draw_text(&panel.message, 26.0, 238.0, 17.0, DIM);
    draw_events(panel);
    let keys =
        "space pause   S slow   A add 25   V avoidance   H hitboxes   R record   drag, wheel";
    draw_text(keys, 20.0, screen_height() - 18.0, 18.0, DIM);
}

fn draw_events(panel: &Panel) {
    let x = screen_width() - 372.0;
    draw_rectangle(x - 14.0, 12.0, 374.0, 218.0, BACK);
    let mut y = 36.0;
    for (now, event) in panel.events.iter().rev() {
        let (name, encounter) = match event.kind {
            EventKind::Predicted(encounter) => ("predicted", encounter),
            EventKind::Withdrawn(encounter) => ("withdrawn", encounter),
            EventKind::Began(encounter) => ("began", encounter),
            EventKind::Ended(encounter, _) => ("ended", encounter),
            _ => continue,
        };
        let text = format!(
            "{now:7.2}  {name:<9}  {:>3} and {:>3}  {:5.1} m",
            encounter.a.slot(),
            encounter.b.slot(),
            encounter.closest.separation
        );
        draw_text(&text, x, y, 18.0, LEVEL_COLOURS[encounter.level]);
        y += 22.0;
    }
}
