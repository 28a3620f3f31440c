//! Notes on input that is accepted, and probably not meant.

use crate::terminal::shortest;
use nearmiss::{Hitbox, Query, Scene, Screening, Window};

/// Factor between the distance that bodies go and what their velocities say from which on units probably differ.
const OTHER_UNITS: f64 = 5.0;

/// Returns a sentence for each thing that a user should know of a screening.
pub(crate) fn of(scene: &Scene, query: &Query, screening: &Screening) -> Vec<String> {
    let mut notes = Vec::new();
    match distance_by_velocity(scene) {
        Some(factor) if factor > f64::MAX => notes.push(
            "bodies go elsewhere from their first row to the second, but all velocities in these rows are 0: bodies stop in \
             each row"
                .to_owned(),
        ),
        Some(factor) if !(1.0 / OTHER_UNITS..=OTHER_UNITS).contains(&factor) => {
            let factor = shortest(with_three_digits(factor));
            notes.push(format!(
                "from their first row to the second, bodies go {factor} times as far as their velocities say: check the \
                 units, m, s and m/s"
            ));
        }
        _ => {}
    }
    let (window, margin) = (screening.window, query.margin());
    if let Some(states) = states_elsewhere(scene, window) {
        notes.push(format!(
            "the window is {window}, and no body exists then; the states cover {states}"
        ));
    } else if scene.len() == 1 {
        notes.push("there is one body, and no other one that it could meet".to_owned());
    } else if is_of_half_spaces(scene) {
        notes.push("all bodies are half-spaces, which do not meet each other".to_owned());
    } else if screening.conflicts.is_empty() {
        let margin_shown = shortest(margin);
        let within = if window == Window::ALL {
            String::new()
        } else {
            format!(" in the window {window}")
        };
        notes.push(if margin > 0.0 {
            format!("no two bodies come within {margin_shown} m of each other{within}")
        } else if is_of_points(scene) {
            format!(
                "nothing is found{within}, since the bodies are points and the margin is {margin_shown} m: give \
                 --radius or a larger --margin"
            )
        } else {
            format!(
                "no two bodies come within {margin_shown} m of each other{within}: a larger --margin finds near misses"
            )
        });
    }
    notes
}

/// Returns a number rounded to three digits.
fn with_three_digits(number: f64) -> f64 {
    format!("{number:.2e}").parse().unwrap_or(number)
}

/// Returns how many times as far as their velocities say all bodies together go from their first state to the
/// second, infinite if all velocities are 0; `None` if they go nowhere.
fn distance_by_velocity(scene: &Scene) -> Option<f64> {
    let (mut gone, mut told) = (0.0, 0.0);
    for (_, body) in scene.bodies() {
        let [first, second, ..] = body.trajectory.knots() else {
            continue;
        };
        let states = [first, second].map(|time| body.trajectory.state(*time));
        if let [Some(first), Some(second)] = states {
            let speed = 0.5 * (first.velocity.length() + second.velocity.length());
            gone += first.position.distance(second.position);
            told += speed * (second.time - first.time);
        }
    }
    // Sums that overflow tell nothing.
    (gone > 0.0 && gone < f64::INFINITY && told < f64::INFINITY).then(|| {
        if told > 0.0 {
            (gone / told).min(f64::MAX)
        } else {
            f64::INFINITY
        }
    })
}

/// Returns the time from the first to the last state if no body exists in a window.
fn states_elsewhere(scene: &Scene, window: Window) -> Option<Window> {
    let domains = || scene.bodies().map(|(_, body)| body.trajectory.domain());
    if domains().any(|domain| domain.intersection(window).is_some()) {
        return None;
    }
    let start = domains().map(|domain| domain.start()).reduce(f64::min)?;
    let end = domains().map(|domain| domain.end()).reduce(f64::max)?;
    Window::new(start, end).ok()
}

/// Returns true if all bodies, at least one, are half-spaces.
fn is_of_half_spaces(scene: &Scene) -> bool {
    let mut bodies = scene.bodies();
    !scene.is_empty() && bodies.all(|(_, body)| body.hitbox.normal().is_some())
}

/// Returns true if all bodies are points.
fn is_of_points(scene: &Scene) -> bool {
    let mut bodies = scene.bodies();
    bodies.all(|(_, body)| body.hitbox == Hitbox::POINT)
}
