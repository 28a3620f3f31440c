//! The body under the mouse, and what it will meet.

use crate::draw::{LEVEL_COLOURS, View, kind_name, on_screen, vector};
use crate::fleet::LOOKAHEAD;
use crate::game::Game;
use crate::labels::Area;
use macroquad::prelude::{
    Color, Vec2, draw_circle_lines, draw_rectangle, draw_text, mouse_position, screen_height,
    screen_width, vec2,
};
use nearmiss::{BodyId, Encounter};

/// Largest distance of the mouse from a body that it points at, pixels.
const REACH: f32 = 22.0;
/// Encounters named.
const MAX_NAMED: usize = 6;
const WIDTH: f32 = 250.0;
const BRIGHT: Color = Color::new(0.92, 0.95, 1.0, 1.0);

/// The body under the mouse.
pub(crate) struct Hovered {
    id: BodyId,
    /// Its place on the screen.
    at: Vec2,
    /// Its encounters of the levels that are shown.
    met: Vec<Encounter>,
    /// The area of the text that names it, beside the body.
    pub(crate) area: Area,
}

/// Finds the body that is nearest to the mouse, and its encounters of the levels that are shown.
pub(crate) fn hovered(game: &Game, view: &View) -> Option<Hovered> {
    let camera = view.camera();
    let mouse = vec2(mouse_position().0, mouse_position().1);
    let places = game.fleet.bodies.iter().filter_map(|&id| {
        let state = game.fleet.state(id)?;
        Some((id, on_screen(&camera, vector(state.position))?))
    });
    let nearest = places
        .map(|(id, at)| (id, at, at.distance(mouse)))
        .filter(|&(.., distance)| distance < REACH)
        .min_by(|(.., a), (.., b)| a.total_cmp(b));
    let (id, at, _) = nearest?;
    let met = encounters_of(game, id, view.lowest_level);
    let lines = 1 + met.len().max(1);
    #[allow(clippy::cast_precision_loss, reason = "a few lines")]
    let height = 14.0 + 21.0 * lines as f32;
    let area = Area {
        x: (at.x + REACH + 8.0).min(screen_width() - WIDTH - 8.0),
        y: (at.y - height / 2.0).clamp(8.0, (screen_height() - height - 8.0).max(8.0)),
        width: WIDTH,
        height,
    };
    Some(Hovered { id, at, met, area })
}

impl Hovered {
    /// Names the body, and whom it meets.
    pub(crate) fn draw(self, game: &Game) {
        let Self { id, at, met, area } = self;
        draw_circle_lines(at.x, at.y, REACH, 1.5, BRIGHT);
        let Area {
            x,
            y,
            width,
            height,
        } = area;
        draw_rectangle(x, y, width, height, Color::new(0.03, 0.04, 0.08, 0.94));
        let mut baseline = y + 20.0;
        let mut line = |text: &str, colour: Color| {
            draw_text(text, x + 10.0, baseline, 18.0, colour);
            baseline += 21.0;
        };
        let speed = game
            .fleet
            .state(id)
            .map_or(0.0, |state| state.velocity.length());
        let kind = kind_name(game.fleet.kind(id));
        let name = game.fleet.name(id);
        line(&format!("{name} {kind}  {speed:.1} m/s"), BRIGHT);
        if met.is_empty() {
            line(&format!("meets nobody within {LOOKAHEAD} s"), BRIGHT);
        }
        let now = game.fleet.monitor.now();
        for encounter in met {
            let other = if encounter.a == id {
                encounter.b
            } else {
                encounter.a
            };
            let when = if encounter.enter <= now {
                "now     ".to_owned()
            } else {
                format!("in {:.1} s", encounter.enter - now)
            };
            let so_far = if encounter.open { " so far" } else { "" };
            let text = format!(
                "{when}  {}  {:.1} m{so_far}",
                game.fleet.name(other),
                encounter.closest.separation
            );
            line(&text, LEVEL_COLOURS[encounter.level]);
        }
    }
}

/// The first encounters of a body, one for each other body: that of the worst level.
fn encounters_of(game: &Game, id: BodyId, lowest_level: usize) -> Vec<Encounter> {
    let mut met: Vec<Encounter> = Vec::new();
    for encounter in game.fleet.monitor.encounters() {
        let is_own = encounter.a == id || encounter.b == id;
        if !is_own || encounter.level < lowest_level {
            continue;
        }
        let pair = (encounter.a, encounter.b);
        match met.iter_mut().find(|kept| (kept.a, kept.b) == pair) {
            Some(kept) if kept.level < encounter.level => *kept = *encounter,
            Some(_) => {}
            None => met.push(*encounter),
        }
    }
    met.sort_by(|a, b| a.enter.total_cmp(&b.enter));
    met.truncate(MAX_NAMED);
    met
}
