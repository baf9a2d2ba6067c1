//! A dot plot as SVG: a line for each row of a table, a dot for each of its figures.
//!
//! Dots instead of bars, for times at equal error reach over three powers of ten, and bars have no meaning on a logarithmic axis.

use super::quantity::Quantity;
use std::fmt::Write;

const INK: &str = "#222";
const PALE: &str = "#ccc";
/// Colours that are told apart with any eyesight (Okabe and Ito 2008).
const COLORS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
const WIDTH: f64 = 720.0;
const ROW_HEIGHT: f64 = 26.0;
const TOP: f64 = 62.0;
const BOTTOM: f64 = 40.0;
const RIGHT: f64 = 24.0;
/// Width of a character of 14 px, about.
const CHARACTER: f64 = 7.6;

/// How values are placed.
#[derive(Clone, Copy, PartialEq)]
pub enum Axis {
    /// In proportion to their logarithms.
    Logarithmic,
    /// In proportion.
    Linear,
}

/// A figure of a row.
pub struct Mark {
    /// Which series it belongs to.
    pub series: usize,
    pub quantity: Quantity,
}

/// Figures that are drawn on one line.
pub struct Row {
    pub title: String,
    pub marks: Vec<Mark>,
}

/// What is plotted.
pub struct Plot {
    pub title: String,
    pub series: Vec<String>,
    pub rows: Vec<Row>,
    pub axis: Axis,
    pub unit: String,
}

/// A range of values on a range of pixels.
struct Scale {
    axis: Axis,
    from: f64,
    to: f64,
    left: f64,
    right: f64,
}

impl Scale {
    fn x(&self, value: f64) -> f64 {
        let share = match self.axis {
            Axis::Linear => (value - self.from) / (self.to - self.from),
            Axis::Logarithmic => (value / self.from).ln() / (self.to / self.from).ln(),
        };
        self.left + share * (self.right - self.left)
    }

    /// A scale that holds all values, and where its ticks are.
    fn with_ticks(axis: Axis, values: &[f64], left: f64, right: f64) -> (Self, Vec<f64>) {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let ticks: Vec<f64> = match axis {
            Axis::Logarithmic => {
                let all = (-6..9).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * 10f64.powi(power)));
                let all: Vec<f64> = all.collect();
                let first = all.iter().rposition(|tick| *tick <= least * 1.0001).unwrap_or(0);
                let last = all.iter().position(|tick| *tick >= most * 0.9999).unwrap_or(all.len() - 1);
                all[first..=last.max(first + 1)].to_vec()
            }
            Axis::Linear => {
                let step = round_step((most - least).max(most.abs() * 1e-3).max(1e-9) / 6.0);
                let (first, last) = (
                    (least / step - 1e-6).floor(),
                    (most / step + 1e-6).ceil().max((least / step).floor() + 1.0),
                );
                (0..=(last - first) as usize).map(|k| (first + k as f64) * step).collect()
            }
        };
        let scale = Self { axis, from: ticks[0], to: ticks[ticks.len() - 1], left, right };
        (scale, ticks)
    }
}

/// 1, 2 or 5 times a power of ten, at least as large.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .map(|digit| digit * power)
        .into_iter()
        .find(|step| *step >= least * 0.999)
        .unwrap_or(10.0 * power)
}

/// A tick's number, without digits that say nothing.
fn tick_text(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    format!("{rounded}").replace('-', "−")
}

/// Text as XML has it.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

impl Plot {
    /// The picture.
    pub fn svg(&self) -> String {
        let longest = self.rows.iter().map(|row| row.title.chars().count()).max().unwrap_or(0);
        let left = (longest as f64 * CHARACTER + 24.0).min(WIDTH * 0.6);
        let values: Vec<f64> = self
            .rows
            .iter()
            .flat_map(|row| &row.marks)
            .flat_map(|mark| [mark.quantity.low, mark.quantity.high])
            .collect();
        let (scale, ticks) = Scale::with_ticks(self.axis, &values, left, WIDTH - RIGHT);
        let height = TOP + ROW_HEIGHT * self.rows.len() as f64 + BOTTOM;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" height=\"{height}\" \
             font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"14\">\n\
             <title>{}</title>\n<rect width=\"{WIDTH}\" height=\"{height}\" rx=\"6\" fill=\"#fff\"/>\n",
            escaped(&self.title)
        );
        let mut text = |x: f64, y: f64, anchor: &str, color: &str, words: &str| {
            let words = escaped(words);
            writeln!(
                svg,
                "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"{color}\">{words}</text>"
            )
            .unwrap();
        };
        text(WIDTH / 2.0, 22.0, "middle", INK, &self.title);
        let mut x = left;
        for (k, series) in self.series.iter().enumerate() {
            text(x, 46.0, "start", color(k), &format!("● {series}"));
            x += (series.chars().count() as f64 + 4.0) * CHARACTER;
        }
        let bottom = height - BOTTOM;
        let mut last_label = f64::NEG_INFINITY;
        for tick in &ticks {
            let words = tick_text(*tick);
            let half = words.chars().count() as f64 * CHARACTER / 2.0;
            if scale.x(*tick) - half > last_label + 6.0 {
                last_label = scale.x(*tick) + half;
                text(scale.x(*tick), bottom + 18.0, "middle", INK, &words);
            }
        }
        text(left - 34.0, bottom + 18.0, "end", INK, &self.unit);
        for (k, row) in self.rows.iter().enumerate() {
            text(left - 12.0, TOP + (k as f64 + 0.5) * ROW_HEIGHT + 5.0, "end", INK, &row.title);
        }
        for tick in &ticks {
            let x = scale.x(*tick);
            writeln!(svg, "<path d=\"M{x:.1} {TOP}V{bottom}\" stroke=\"{PALE}\"/>").unwrap();
        }
        for (k, row) in self.rows.iter().enumerate() {
            let y = TOP + (k as f64 + 0.5) * ROW_HEIGHT;
            writeln!(
                svg,
                "<path d=\"M{left:.1} {y:.1}H{:.1}\" stroke=\"{PALE}\" stroke-dasharray=\"1 4\"/>",
                WIDTH - RIGHT
            )
            .unwrap();
            for mark in &row.marks {
                svg += &drawn(mark, &scale, y);
            }
        }
        svg + "</svg>\n"
    }
}

fn color(series: usize) -> &'static str {
    COLORS[series % COLORS.len()]
}

/// A dot, with a line where it is a range; a triangle toward where the value lies where it is a bound.
fn drawn(mark: &Mark, scale: &Scale, y: f64) -> String {
    let color = color(mark.series);
    let [low, high] = [mark.quantity.low, mark.quantity.high].map(|value| scale.x(value));
    let side = match mark.quantity.bound {
        Some('>') => 6.0,
        Some(_) => -6.0,
        None => 0.0,
    };
    if side != 0.0 {
        let tip = high + side * 1.6;
        let (above, below) = (y - 6.0, y + 6.0);
        return format!(
            "<path d=\"M{high:.1} {above:.1}L{tip:.1} {y:.1}L{high:.1} {below:.1}Z\" fill=\"{color}\"/>\n"
        );
    }
    let range = if high - low > 0.5 {
        format!("<path d=\"M{low:.1} {y:.1}H{high:.1}\" stroke=\"{color}\" stroke-width=\"3\"/>\n")
    } else {
        String::new()
    };
    format!("{range}<circle cx=\"{:.1}\" cy=\"{y:.1}\" r=\"5\" fill=\"{color}\"/>\n", (low + high) / 2.0)
}
