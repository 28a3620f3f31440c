//! Text in the picture: countdowns at the places of encounters, and the numbers of the bodies that are named.

use crate::draw::{LEVEL_COLOURS, View, on_screen, vector};
use crate::game::Game;
use crate::labels::{Area, Areas};
use macroquad::prelude::{Color, Vec2, draw_line, draw_rectangle, draw_text, measure_text, vec2};
use nearmiss::{BodyId, Encounter};
use std::collections::BTreeSet;

/// Countdowns at most.
const MAX_COUNTDOWNS: usize = 16;
const BACK: Color = Color::new(0.02, 0.03, 0.06, 0.72);
const NUMBER: Color = Color::new(0.92, 0.95, 1.0, 0.9);

/// Draws what has room beside the areas taken. `named` are the bodies that the panel names.
pub(crate) fn draw_captions(
    game: &Game,
    view: &View,
    encounters: &[Encounter],
    mut named: BTreeSet<BodyId>,
    mut areas: Areas,
) {
    let camera = view.camera();
    let now = game.fleet.monitor.now();
    // What can still be avoided, and matters most, before what goes on.
    let mut urgent: Vec<&Encounter> = encounters.iter().collect();
    urgent.sort_by_key(|encounter| (encounter.enter <= now, std::cmp::Reverse(encounter.level)));
    for encounter in urgent.into_iter().take(MAX_COUNTDOWNS) {
        let closest = &encounter.closest;
        let [a, b] = game.fleet.closest_places(encounter);
        let middle = (a + b) * 0.5;
        let Some(at) = on_screen(&camera, vector(middle)) else {
            continue;
        };
        let ahead = closest.time - now;
        let text = if encounter.enter <= now {
            format!("now  {:.1} m", closest.separation)
        } else {
            format!("{ahead:.1} s  {:.1} m", closest.separation)
        };
        caption(&text, 18, at, LEVEL_COLOURS[encounter.level], &mut areas);
        named.extend([encounter.a, encounter.b]);
    }
    for id in named {
        if game.fleet.is_floor(id) {
            continue;
        }
        let place = game.fleet.state(id);
        let place = place.and_then(|state| on_screen(&camera, vector(state.position)));
        if let Some(at) = place {
            caption(&game.fleet.name(id), 15, at, NUMBER, &mut areas);
        }
    }
}

/// Writes a text beside a point, with a line to the point if it is not next to it. Without room there is none.
fn caption(text: &str, size: u16, at: Vec2, colour: Color, areas: &mut Areas) {
    const EDGE: f32 = 4.0;
    let extent = measure_text(text, None, size, 1.0);
    // Digits change with each frame: all are as high as this.
    let height = f32::from(size) * 0.75;
    let room = (extent.width + 2.0 * EDGE, height + 2.0 * EDGE);
    let Some(area) = areas.place((at.x, at.y), room) else {
        return;
    };
    let near = vec2(
        at.x.clamp(area.x, area.x + area.width),
        at.y.clamp(area.y, area.y + area.height),
    );
    if near.distance(at) > 15.0 {
        draw_line(at.x, at.y, near.x, near.y, 1.0, colour);
    }
    let Area {
        x,
        y,
        width,
        height: high,
    } = area;
    draw_rectangle(x, y, width, high, BACK);
    draw_text(text, x + EDGE, y + EDGE + height, f32::from(size), colour);
}
