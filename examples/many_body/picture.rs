//! A picture of a scene and its encounters: an oblique view of all paths, and how close they came.

use crate::{Failure, closest};
use nearmiss::glam::{DVec2, DVec3};
use nearmiss::{Body, Conflict, Scene, Trajectory};
use plotters::coord::Shift;
use plotters::prelude::*;

type Outcome = Result<(), Failure>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

const NIGHT: RGBColor = RGBColor(12, 16, 28);
const INK: RGBColor = RGBColor(222, 228, 240);
const FAINT: RGBColor = RGBColor(120, 132, 156);
/// Paths drawn, and points on each: more only make the file larger.
const MAX_PATHS: u32 = 320;
const POINTS_PER_PATH: u32 = 90;
const MAX_DOTS: usize = 4_000;
const SIZE: (u32, u32) = (1500, 960);
const PANEL: u32 = 380;

/// Draws the scene as the text of an SVG file.
pub(crate) fn draw(
    name: &str,
    scene: &Scene,
    conflicts: &[Conflict],
    margin: f64,
) -> Result<String, Failure> {
    let mut text = String::new();
    {
        // The last of the areas closes the drawing.
        let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        draw_page(&root, name, scene, conflicts, margin)?;
    }
    Ok(text)
}

fn draw_page(
    root: &Area<'_>,
    name: &str,
    scene: &Scene,
    conflicts: &[Conflict],
    margin: f64,
) -> Outcome {
    root.fill(&NIGHT)?;
    let (view, panel) = root.split_horizontally(SIZE.0 - PANEL);
    let camera = Camera::framing(scene, view.dim_in_pixel());
    draw_paths(&view, &camera, scene)?;
    draw_encounters(&view, &camera, conflicts, margin)?;
    let title = format!(
        "{name}: {} bodies, {} encounters within {margin} m",
        scene.len(),
        conflicts.len()
    );
    view.draw(&Text::new(title, (28, 24), font(26).color(&INK)))?;
    let note = "paths (a sample, brighter is nearer) and encounters (larger and hotter is closer)";
    view.draw(&Text::new(note, (28, 58), font(16).color(&FAINT)))?;
    draw_panel(&panel, conflicts, margin)?;
    root.present()?;
    Ok(())
}

fn font(size: i32) -> TextStyle<'static> {
    ("sans-serif", size).into_text_style(&SIZE)
}

/// Turns space into the page: a fixed oblique direction, scaled to fit.
struct Camera {
    centre: DVec3,
    scale: f64,
    middle: DVec2,
    depth: f64,
}

impl Camera {
    const RIGHT: DVec3 = DVec3::new(0.819_152, -0.573_576, 0.0);
    const UP: DVec3 = DVec3::new(0.277_486, 0.396_290, 0.875_140);
    const TOWARDS: DVec3 = DVec3::new(-0.501_956, -0.716_871, 0.483_680);

    fn framing(scene: &Scene, (width, height): (u32, u32)) -> Self {
        let axes = [Self::RIGHT, Self::UP, Self::TOWARDS];
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        for (_, body) in scene.bodies() {
            for segment in body.trajectory.segments() {
                let seen = DVec3::from_array(axes.map(|axis| segment.origin().dot(axis)));
                low = low.min(seen);
                high = high.max(seen);
            }
        }
        let middle = (low + high) / 2.0;
        let half = ((high - low) / 2.0).max(DVec3::splat(1e-9));
        let room = DVec2::new(f64::from(width) - 60.0, f64::from(height) - 140.0) / 2.0;
        Self {
            centre: axes[0] * middle.x + axes[1] * middle.y + axes[2] * middle.z,
            scale: (room.x / half.x).min(room.y / half.y),
            middle: DVec2::new(f64::from(width) / 2.0, f64::from(height) / 2.0 + 40.0),
            depth: half.z,
        }
    }

    /// Place on the page, and nearness from 0 (far) to 1 (near).
    fn project(&self, position: DVec3) -> ((i32, i32), f64) {
        let seen = position - self.centre;
        let x = self.middle.x + self.scale * seen.dot(Self::RIGHT);
        let y = self.middle.y - self.scale * seen.dot(Self::UP);
        let nearness = 0.5 + 0.5 * (seen.dot(Self::TOWARDS) / self.depth);
        ((pixel(x), pixel(y)), nearness.clamp(0.0, 1.0))
    }
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "a place on the page, in pixels"
)]
fn pixel(value: f64) -> i32 {
    value.round() as i32
}

fn draw_paths(view: &Area<'_>, camera: &Camera, scene: &Scene) -> Outcome {
    let bodies: Vec<_> = scene.bodies().map(|(_, body)| body).collect();
    for (index, body) in sample(&bodies) {
        let points = way(&body.trajectory);
        let seen: Vec<((i32, i32), f64)> = points.iter().map(|&at| camera.project(at)).collect();
        // A hue for each body, along blue and green: the warm ones are for encounters.
        let hue = 0.45 + 0.22 * (f64::from(index) * 0.618).fract();
        // Pieces share their ends; each is as bright as its middle is near.
        for piece in seen
            .chunks(8)
            .zip(1..)
            .map(|(_, k)| &seen[(k - 1) * 8..(k * 8 + 1).min(seen.len())])
        {
            let nearness = piece[piece.len() / 2].1;
            let line = piece.iter().map(|(place, _)| *place);
            let colour = HSLColor(hue, 0.65, 0.3 + 0.4 * nearness).mix(0.18 + 0.35 * nearness);
            view.draw(&PathElement::new(
                line.collect::<Vec<_>>(),
                colour.stroke_width(1),
            ))?;
        }
    }
    Ok(())
}

/// Some of the bodies, spread by the golden ratio: no pattern in their order shows.
fn sample<'a>(bodies: &[&'a Body]) -> Vec<(u32, &'a Body)> {
    let count = u32::try_from(bodies.len()).unwrap_or(u32::MAX);
    (0..count.min(MAX_PATHS))
        .map(|k| {
            let share = (f64::from(k) * 0.618_033_988_749_895).fract();
            let place = if count <= MAX_PATHS {
                k
            } else {
                place(share * f64::from(count))
            };
            (k, bodies[place as usize])
        })
        .collect()
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a place in a list, rounded down"
)]
fn place(value: f64) -> u32 {
    value as u32
}

/// Positions along the whole trajectory.
fn way(trajectory: &Trajectory) -> Vec<DVec3> {
    let (Some(&first), Some(&last)) = (trajectory.knots().first(), trajectory.knots().last())
    else {
        return Vec::new();
    };
    (0..=POINTS_PER_PATH)
        .map(|step| first + (last - first) * f64::from(step) / f64::from(POINTS_PER_PATH))
        .filter_map(|time| trajectory.position(time.min(last)))
        .collect()
}

/// Returns the closeness of an encounter: 0 at the margin, 1 at the closest of all.
struct Scale {
    least: f64,
    margin: f64,
}

impl Scale {
    fn of(conflicts: &[Conflict], margin: f64) -> Self {
        let least = conflicts
            .iter()
            .map(|conflict| conflict.closest.separation)
            .fold(margin, f64::min);
        Self { least, margin }
    }

    fn closeness(&self, conflict: &Conflict) -> f64 {
        let range = (self.margin - self.least).max(1e-12);
        ((self.margin - conflict.closest.separation) / range).clamp(0.0, 1.0)
    }
}

fn heat(closeness: f64) -> HSLColor {
    HSLColor(0.13 * (1.0 - closeness), 0.95, 0.56)
}

fn draw_encounters(
    view: &Area<'_>,
    camera: &Camera,
    conflicts: &[Conflict],
    margin: f64,
) -> Outcome {
    let scale = Scale::of(conflicts, margin);
    // The closest are drawn last, on top.
    let shown = closest(conflicts, MAX_DOTS);
    for conflict in shown.iter().rev() {
        let middle = (conflict.closest.position_a + conflict.closest.position_b) / 2.0;
        let (place, _) = camera.project(middle);
        let closeness = scale.closeness(conflict);
        let size = pixel(1.6 + 3.6 * closeness.powi(3));
        let colour = heat(closeness).mix(0.35 + 0.5 * closeness);
        view.draw(&Circle::new(place, size, colour.filled()))?;
    }
    for (rank, conflict) in shown.iter().take(10).enumerate() {
        let middle = (conflict.closest.position_a + conflict.closest.position_b) / 2.0;
        let (place, _) = camera.project(middle);
        view.draw(&Circle::new(place, 9, INK.stroke_width(1)))?;
        let label = Text::new(
            format!("{}", rank + 1),
            (place.0 + 11, place.1 - 8),
            font(16).color(&INK),
        );
        view.draw(&label)?;
    }
    Ok(())
}

fn draw_panel(panel: &Area<'_>, conflicts: &[Conflict], margin: f64) -> Outcome {
    panel.draw(&Text::new(
        "the ten closest",
        (16, 28),
        font(18).color(&INK),
    ))?;
    for (rank, conflict) in closest(conflicts, 10).into_iter().enumerate() {
        let y = 58 + 22 * i32::try_from(rank)?;
        let closest = &conflict.closest;
        let line = format!(
            "{:>2}   {:.3} m   at {:.2} s   {:.1} m/s",
            rank + 1,
            closest.separation,
            closest.time,
            closest.relative_velocity.length()
        );
        panel.draw(&Text::new(line, (16, y), font(15).color(&FAINT)))?;
    }
    let rest = panel.margin(300, 20, 8, 20);
    let (upper, lower) = rest.split_vertically(310);
    let separations: Vec<f64> = conflicts.iter().map(|c| c.closest.separation).collect();
    let times: Vec<f64> = conflicts.iter().map(|c| c.closest.time).collect();
    let least = separations.iter().copied().fold(margin, f64::min);
    histogram(&upper, "separation, m", &separations, (least, margin))?;
    let first = times.iter().copied().fold(f64::INFINITY, f64::min);
    let last = times.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    histogram(&lower, "time, s", &times, (first, last))
}

fn histogram(area: &Area<'_>, name: &str, values: &[f64], (low, high): (f64, f64)) -> Outcome {
    const BINS: u32 = 40;
    if high.is_nan() || low.is_nan() || high <= low {
        return Ok(());
    }
    let width = (high - low) / f64::from(BINS);
    let counts: Vec<(f64, u32)> = (0..BINS)
        .map(|bin| {
            let from = low + width * f64::from(bin);
            let inside =
                |value: &&f64| **value >= from && (**value < from + width || bin + 1 == BINS);
            let count = values.iter().filter(inside).count();
            (from, u32::try_from(count).unwrap_or(u32::MAX))
        })
        .collect();
    let most = counts.iter().map(|&(_, count)| count).max().unwrap_or(1);
    let mut chart = ChartBuilder::on(area)
        .caption(format!("encounters by {name}"), font(16).color(&INK))
        .margin(6)
        .x_label_area_size(28)
        .y_label_area_size(44)
        .build_cartesian_2d(low..high, 0..most + 1)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .axis_style(FAINT)
        .label_style(font(13).color(&FAINT))
        .x_labels(5)
        .y_labels(4)
        .draw()?;
    chart.draw_series(counts.iter().map(|&(from, count)| {
        let closeness = 1.0 - (from - low) / (high - low);
        let colour = if name.starts_with("time") {
            heat(0.25)
        } else {
            heat(closeness)
        };
        Rectangle::new(
            [(from, 0), (from + width * 0.86, count)],
            colour.mix(0.85).filled(),
        )
    }))?;
    Ok(())
}
