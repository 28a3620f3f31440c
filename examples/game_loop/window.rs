//! The game in a window: input, the clock, and a picture of each frame.

use crate::captions::draw_captions;
use crate::draw::{View, draw_world};
use crate::fleet::Setting;
use crate::game::Game;
use crate::hover::hovered;
use crate::panel::{Panel, areas, draw_panel};
use crate::{Arguments, Avoid, Failure, terminal};
use macroquad::conf::Conf as Settings;
use macroquad::miniquad::conf::Conf;
use macroquad::prelude::{
    KeyCode, MouseButton, get_frame_time, get_screen_data, is_key_pressed, is_mouse_button_down,
    mouse_delta_position, mouse_wheel, next_frame,
};

/// Length of a tick of simulated time, s.
const STEP: f64 = 1.0 / 60.0;

/// Bodies that a key adds.
const MORE: usize = 25;

/// Opens the window; returns when it is closed.
pub(crate) fn open(arguments: Arguments) -> Result<(), Failure> {
    let has_display = ["DISPLAY", "WAYLAND_DISPLAY"]
        .iter()
        .any(|name| std::env::var_os(name).is_some_and(|display| !display.is_empty()));
    if cfg!(target_os = "linux") && !has_display {
        return Err("there is no display for a window: run it with --headless".into());
    }
    let settings = Settings {
        miniquad_conf: Conf {
            window_title: "nearmiss".to_owned(),
            window_width: 1280,
            window_height: 720,
            sample_count: 4,
            ..Conf::default()
        },
        draw_call_vertex_capacity: 60_000,
        draw_call_index_capacity: 60_000,
        ..Settings::default()
    };
    let window = move || {
        macroquad::Window::from_config(settings, async move {
            if let Err(error) = play(arguments).await {
                terminal::complain(format_args!("error: {error}"));
                std::process::exit(1);
            }
        });
    };
    // The library has no other way to say that a display cannot be opened.
    let done = std::panic::catch_unwind(std::panic::AssertUnwindSafe(window));
    done.map_err(|_| "the window failed: without a display, run it with --headless".into())
}

async fn play(arguments: Arguments) -> Result<(), Failure> {
    let bodies = arguments.bodies.unwrap_or(crate::SHIPS);
    let mut game = Game::new(Setting::SHIPS, bodies, arguments.seed)?;
    game.replan = arguments.replan;
    game.avoids = arguments.avoid == Avoid::On;
    let mut view = View::around(game.fleet.half())?;
    let mut panel = Panel::default();
    // Simulated time that is due, s, and how fast it goes.
    let (mut due, mut pace, mut is_paused) = (0.0, 1.0, false);
    loop {
        if is_key_pressed(KeyCode::Q) || is_key_pressed(KeyCode::Escape) {
            return Ok(());
        }
        for key in [
            KeyCode::Space,
            KeyCode::S,
            KeyCode::A,
            KeyCode::V,
            KeyCode::H,
            KeyCode::F,
            KeyCode::R,
        ] {
            if !is_key_pressed(key) {
                continue;
            }
            match key {
                KeyCode::Space => is_paused = !is_paused,
                KeyCode::S => pace = if pace < 1.0 { 1.0 } else { 0.2 },
                KeyCode::A => {
                    for _ in 0..MORE {
                        if !game.fleet.add()? {
                            panel.message = "no room for more bodies".to_owned();
                            break;
                        }
                    }
                }
                KeyCode::V => game.avoids = !game.avoids,
                KeyCode::H => view.shows_hitboxes = !view.shows_hitboxes,
                KeyCode::F => view.lowest_level = 1 - view.lowest_level,
                _ => panel.message = record(&mut game),
            }
        }
        if is_mouse_button_down(MouseButton::Left) {
            let delta = mouse_delta_position();
            view.turn(delta.x, delta.y);
        }
        view.zoom(mouse_wheel().1);
        // A picture to be saved is of the same moment on every machine.
        let frame = if arguments.screenshot.is_some() {
            STEP
        } else {
            let took = f64::from(get_frame_time());
            // Nobody sees times in a picture whose frames are made as they come.
            panel.note_frame(took);
            took.min(0.1)
        };
        if !is_paused {
            due += frame * pace;
            view.drift(frame);
        }
        while due >= STEP {
            due -= STEP;
            let now = game.fleet.monitor.now() + STEP;
            let took = game.tick(now)?;
            panel.note(&game, took, view.lowest_level);
        }
        let encounters = draw_world(&game, &view);
        // A saved picture has no mouse.
        let hovered = arguments
            .screenshot
            .is_none()
            .then(|| hovered(&game, &view));
        let hovered = hovered.flatten();
        let mut areas = areas();
        if let Some(hovered) = &hovered {
            areas.take(hovered.area);
        }
        draw_captions(&game, &view, &encounters, panel.named(), areas);
        let state = match (is_paused, pace < 1.0) {
            (true, _) => "paused",
            (false, true) => "slow",
            (false, false) => "",
        };
        draw_panel(&game, &panel, state, view.lowest_level);
        if let Some(hovered) = hovered {
            hovered.draw(&game);
        }
        if let Some(path) = &arguments.screenshot
            && game.fleet.monitor.now() >= arguments.seconds
        {
            get_screen_data().export_png(&path.to_string_lossy());
            return Ok(());
        }
        next_frame().await;
    }
}

/// Begins or ends a recording of all that the monitor is told, and says so.
#[cfg(feature = "recording")]
fn record(game: &mut Game) -> String {
    const PATH: &str = "game_loop.nearmiss";
    let monitor = &mut game.fleet.monitor;
    if monitor.is_recording() {
        return match monitor.stop_recording() {
            Ok(records) => format!("{} records in {PATH}", records.unwrap_or(0)),
            Err(error) => format!("{PATH}: {error}"),
        };
    }
    let started = std::fs::File::create(PATH).and_then(|file| monitor.start_recording(file));
    match started {
        Ok(()) => format!("recording to {PATH}"),
        Err(error) => format!("{PATH}: {error}"),
    }
}

#[cfg(not(feature = "recording"))]
fn record(_: &mut Game) -> String {
    "to record, run it with --features recording".to_owned()
}
