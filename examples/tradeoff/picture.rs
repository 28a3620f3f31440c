//! Pictures of the tables: points with names, readable on light and on dark pages.

use crate::Failure;
use crate::table::{Cell, Table};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::collections::BTreeMap;

const SIZE: (u32, u32) = (900, 560);
/// Of text and lines: it stands out from white and from black.
const INK: RGBColor = RGBColor(128, 128, 128);
const COLOURS: [RGBColor; 6] = [
    RGBColor(31, 119, 180),
    RGBColor(214, 96, 20),
    RGBColor(44, 150, 60),
    RGBColor(190, 60, 70),
    RGBColor(140, 100, 190),
    RGBColor(150, 120, 60),
];
/// In place of an error of zero.
const LEAST_ERROR: f64 = 1e-17;

/// A named point.
struct Mark {
    series: String,
    name: String,
    x: f64,
    y: f64,
}

/// The axes of a picture.
struct Axes {
    title: &'static str,
    x: &'static str,
    y: &'static str,
    y_range: (f64, f64),
    /// Points of one series are joined.
    joined: bool,
}

fn text(cell: &Cell) -> String {
    match cell {
        Cell::Text(text) => text.clone(),
        _ => String::new(),
    }
}

/// Draws a table of pairs or of steps as the text of an SVG file.
pub(crate) fn draw(table: &Table) -> Result<String, Failure> {
    let (axes, marks) = if table.key == "pair" {
        pairs(table)
    } else {
        steps(table)
    };
    let mut drawn = String::new();
    {
        let area = SVGBackend::with_string(&mut drawn, SIZE).into_drawing_area();
        page(&area, &axes, &marks)?;
        area.present()?;
    }
    // A page narrower than the picture, in which its text may stand, shows all of it.
    Ok(drawn.replacen("<svg ", "<svg style=\"max-width:100%;height:auto\" ", 1))
}

/// Time of a pair against the worst error, of random pairs.
fn pairs(table: &Table) -> (Axes, Vec<Mark>) {
    let rows = table.rows.iter().filter(|row| text(&row[0]) == "random");
    let marks = rows.filter_map(|row| {
        let name = text(&row[1]);
        let series = name.split(',').next().unwrap_or("").to_owned();
        let (x, y) = (row[2].number()?, row[4].number()?.max(LEAST_ERROR));
        Some(Mark { series, name, x, y })
    });
    let axes = Axes {
        title: "One pair: time against worst error, random cubics",
        x: "ns a pair",
        y: "worst error / size",
        y_range: (0.3 * LEAST_ERROR, 3.0),
        joined: false,
    };
    (axes, marks.collect())
}

/// Time of a scene against the share of encounters found.
fn steps(table: &Table) -> (Axes, Vec<Mark>) {
    let marks = table.rows.iter().filter_map(|row| {
        let (all, missed) = (row[2].number()?, row[3].number()?);
        let series = text(&row[0]);
        let name = row[1]
            .number()
            .map_or(series.clone(), |rate| format!("{rate} Hz"));
        let name = if series.starts_with("nearmiss") {
            series.clone()
        } else {
            name
        };
        // Of none, none is missed.
        let share = if all > 0.0 { missed / all } else { 0.0 };
        Some(Mark {
            series,
            name,
            x: row[8].number()?,
            y: 100.0 * (1.0 - share),
        })
    });
    let mut marks: Vec<Mark> = marks.collect();
    leave_out_names(&mut marks);
    let least = marks.iter().map(|mark| mark.y).fold(100.0, f64::min);
    let axes = Axes {
        title: "A scene stepped: time against encounters found",
        x: "ms in all",
        y: "encounters found, %",
        y_range: ((least - 10.0).max(0.0), 104.9),
        joined: true,
    };
    (axes, marks)
}

/// Keeps the names of the first and the last point at which a series finds all: those between would cover each other.
fn leave_out_names(marks: &mut [Mark]) {
    let is_full = |mark: &Mark| mark.y >= 100.0;
    let last_of = |series: &str| marks.iter().rposition(|mark| mark.series == series);
    let without: Vec<usize> = (0..marks.len())
        .filter(|&place| {
            let mark = &marks[place];
            let before = marks[..place]
                .iter()
                .any(|other| other.series == mark.series && is_full(other));
            is_full(mark) && before && last_of(&mark.series) != Some(place)
        })
        .collect();
    for place in without {
        marks[place].name.clear();
    }
}

fn page<'a>(
    area: &DrawingArea<SVGBackend<'a>, plotters::coord::Shift>,
    axes: &Axes,
    marks: &[Mark],
) -> Result<(), Failure> {
    let xs = || marks.iter().map(|mark| mark.x);
    let least = xs().fold(f64::INFINITY, f64::min);
    let largest = xs().fold(0.0, f64::max);
    let x_range = (0.5 * least..3.0 * largest).log_scale();
    let style = ("sans-serif", 14).into_font().color(&INK);
    let mut builder = ChartBuilder::on(area);
    builder
        .caption(axes.title, ("sans-serif", 20).into_font().color(&INK))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(72);
    macro_rules! chart {
        ($y:expr, $format:expr) => {{
            let mut chart = builder.build_cartesian_2d(x_range, $y)?;
            chart
                .configure_mesh()
                .axis_style(INK)
                .bold_line_style(INK.mix(0.25))
                .light_line_style(INK.mix(0.0))
                .label_style(style.clone())
                .axis_desc_style(style.clone())
                .x_desc(axes.x)
                .y_desc(axes.y)
                .x_label_formatter(&|x| x.to_string())
                .y_label_formatter(&$format)
                .draw()?;
            series(&mut chart, axes, marks)?;
        }};
    }
    let (low, high) = axes.y_range;
    if axes.joined {
        chart!(low..high, |y: &f64| format!("{y:.0}"));
    } else {
        chart!((low..high).log_scale(), |y: &f64| format!("{y:.0e}"));
    }
    Ok(())
}

fn series<'a, X, Y>(
    chart: &mut ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, Y>>,
    axes: &Axes,
    marks: &[Mark],
) -> Result<(), Failure>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let mut colours: BTreeMap<&str, RGBColor> = BTreeMap::new();
    for mark in marks {
        let next = COLOURS[colours.len() % COLOURS.len()];
        colours.entry(&mark.series).or_insert(next);
    }
    for (&name, &colour) in &colours {
        let own: Vec<&Mark> = marks.iter().filter(|mark| mark.series == name).collect();
        if axes.joined {
            chart
                .draw_series(LineSeries::new(
                    own.iter().map(|mark| (mark.x, mark.y)),
                    &colour,
                ))?
                .label(name.to_owned())
                .legend(move |(x, y)| Circle::new((x, y), 4, colour.filled()));
        }
        chart.draw_series(
            own.iter()
                .map(|mark| Circle::new((mark.x, mark.y), 4, colour.filled())),
        )?;
    }
    names(chart, marks, &colours)?;
    if axes.joined {
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerRight)
            .border_style(INK)
            .label_font(("sans-serif", 13).into_font().color(&INK))
            .draw()?;
    }
    Ok(())
}

/// Writes the names beside the points, where no other name is.
fn names<X, Y>(
    chart: &ChartContext<'_, SVGBackend<'_>, Cartesian2d<X, Y>>,
    marks: &[Mark],
    colours: &BTreeMap<&str, RGBColor>,
) -> Result<(), Failure>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    /// Of a letter and of a line, pixels.
    const LETTER: i32 = 6;
    const LINE: i32 = 13;
    /// Lines up and down that are tried.
    const TRIES: i32 = 12;
    let area = chart.plotting_area().strip_coord_spec();
    let (left, top) = area.get_base_pixel();
    let (width, height) = area.dim_in_pixel();
    let (width, height) = (i32::try_from(width)?, i32::try_from(height)?);
    /// Radius of a point, pixels.
    const RADIUS: i32 = 5;
    let point = |mark: &Mark| {
        let (x, y) = chart.backend_coord(&(mark.x, mark.y));
        (x - left - RADIUS, x - left + RADIUS, y - top)
    };
    let mut taken: Vec<(i32, i32, i32)> = marks.iter().map(point).collect();
    for mark in marks.iter().filter(|mark| !mark.name.is_empty()) {
        let (x, y) = chart.backend_coord(&(mark.x, mark.y));
        let (x, y) = (x - left, y - top);
        let length = LETTER * i32::try_from(mark.name.chars().count())?;
        let start = if x + 8 + length > width {
            x - 8 - length
        } else {
            x + 8
        };
        let is_free = |line: &i32| {
            (LINE / 2..height).contains(line)
                && taken.iter().all(|&(from, to, other)| {
                    start > to || start + length < from || (line - other).abs() >= LINE
                })
        };
        let lines = (0..TRIES).flat_map(|number| [y - number * LINE, y + number * LINE]);
        let line = lines.into_iter().find(is_free).unwrap_or(y);
        taken.push((start, start + length, line));
        let colour = colours.get(mark.series.as_str()).copied().unwrap_or(INK);
        if line != y {
            area.draw(&PathElement::new(
                [(x, y), (start - 2, line)],
                colour.mix(0.5),
            ))?;
        }
        let anchor = Pos::new(HPos::Left, VPos::Center);
        let font = ("sans-serif", 12).into_font().color(&colour).pos(anchor);
        area.draw(&Text::new(mark.name.clone(), (start, line), font))?;
    }
    Ok(())
}
