//! A plot of several series over two axes, drawn as SVG.
//!
//! Series differ by colour *and* by the shape of their marks. The colours are those of Okabe and Ito (2008),
//! which are distinguishable under the common forms of colour blindness.

use super::labels::{Labels, Place};
use super::scale::{Kind, Scale};
use crate::output::markup::escaped;
use std::fmt::Write;

/// Okabe and Ito's palette without black and yellow, which print badly as thin lines.
const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555"];

const WIDTH: f64 = 560.0;
/// Height of the plot area.
const PLOT_HEIGHT: f64 = 300.0;
const LEFT: f64 = 74.0;
const RIGHT: f64 = 22.0;
const TOP: f64 = 34.0;
/// Space below the plot area for numbers and the label of the axis.
const BOTTOM: f64 = 46.0;
const LEGEND_LINE: f64 = 18.0;
/// Mean width of a letter at the legend's 12 px.
const LETTER: f64 = 6.4;

/// An axis.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Label, with the unit.
    pub label: String,
    /// Linear or logarithmic.
    pub kind: Kind,
    /// Formats its numbers.
    pub number: fn(f64) -> String,
}

/// A mark.
#[derive(Clone, Debug)]
pub struct Point {
    /// Where on the horizontal axis.
    pub x: f64,
    /// Where on the vertical axis.
    pub y: f64,
    /// Label, written beside the first and last mark of a series, and shown as the title of each.
    pub label: String,
}

/// A series of marks.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// Index into the palette; a renderer has the same one in every plot.
    pub style: usize,
    /// Whether its lines are dashed.
    pub is_dashed: bool,
    /// Its marks, joined by lines in this order.
    pub points: Vec<Point>,
}

/// A horizontal line across the plot.
#[derive(Clone, Debug)]
pub struct Rule {
    /// Where on the vertical axis.
    pub y: f64,
    /// What it is.
    pub label: String,
}

/// A plot.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Its title.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What is drawn.
    pub series: Vec<Series>,
    /// Levels.
    pub rules: Vec<Rule>,
}

/// The scales of a chart; maps values to pixels.
struct ChartFrame {
    x: Scale,
    y: Scale,
}

impl ChartFrame {
    fn px(&self, x: f64) -> Option<f64> {
        self.x.position(x).map(|place| LEFT + place * (WIDTH - LEFT - RIGHT))
    }
    fn py(&self, y: f64) -> Option<f64> {
        self.y.position(y).map(|place| TOP + (1.0 - place) * PLOT_HEIGHT)
    }
    fn at(&self, point: &Point) -> Option<(f64, f64)> {
        Some((self.px(point.x)?, self.py(point.y)?))
    }
}

impl Chart {
    /// Number of marks that cannot be shown: those at 0 on a logarithmic axis.
    pub fn left_out_count(&self) -> usize {
        let frame = self.frame();
        let points = self.series.iter().flat_map(|series| &series.points);
        points.filter(|point| frame.at(point).is_none()).count()
    }

    fn frame(&self) -> ChartFrame {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let levels = self.rules.iter().map(|rule| rule.y);
        ChartFrame {
            x: Scale::from_values(self.x.kind, points().map(|point| point.x)),
            y: Scale::from_values(self.y.kind, points().map(|point| point.y).chain(levels)),
        }
    }

    /// The plot as an SVG element.
    pub fn to_svg(&self) -> String {
        let frame = self.frame();
        let legend = self.legend();
        let legend_lines = legend.iter().map(|entry| entry.line + 1).max().unwrap_or(0);
        let height = TOP + PLOT_HEIGHT + BOTTOM + LEGEND_LINE * legend_lines as f64 + 6.0;
        let mut svg = format!(
            r#"<svg viewBox="0 0 {WIDTH} {height}" role="img" aria-label="{}" font-size="12">"#,
            escaped(&self.title)
        );
        let title = escaped(&self.title);
        append(&mut svg, format_args!(r#"<text x="{LEFT}" y="20" class="title">{title}</text>"#));
        self.grid(&mut svg, &frame);
        let mut labels = Labels::new(LEFT, WIDTH);
        for rule in &self.rules {
            let Some(y) = frame.py(rule.y) else { continue };
            let (right, label) = (WIDTH - RIGHT, escaped(&rule.label));
            labels.reserve([right - rule.label.chars().count() as f64 * LETTER, y - 16.0, right, y]);
            append(&mut svg, format_args!(r#"<path class="rule" d="M{LEFT} {y:.1}H{right}"/>"#));
            append(
                &mut svg,
                format_args!(
                    r#"<text class="note" x="{:.1}" y="{:.1}" text-anchor="end">{label}</text>"#,
                    right - 4.0,
                    y - 4.0
                ),
            );
        }
        // Labels are drawn on top of all lines.
        let mut texts = String::new();
        for series in &self.series {
            draw_series(&mut svg, &mut texts, &frame, series, &mut labels);
        }
        svg += &texts;
        for LegendEntry { series, x, line } in legend {
            let y = TOP + PLOT_HEIGHT + BOTTOM + LEGEND_LINE * line as f64 + 10.0;
            let name = escaped(&series.name);
            append(&mut svg, format_args!(r#"<path {} d="M{x:.1} {y:.1}h22"/>"#, stroke(series)));
            mark(&mut svg, series.style, x + 11.0, y);
            append(&mut svg, format_args!(r#"<text x="{:.1}" y="{:.1}">{name}</text>"#, x + 28.0, y + 4.0));
        }
        svg.push_str("</svg>");
        svg
    }

    /// Grid, numbers and names of the axes.
    fn grid(&self, svg: &mut String, frame: &ChartFrame) {
        let (right, bottom) = (WIDTH - RIGHT, TOP + PLOT_HEIGHT);
        for tick in frame.x.ticks() {
            let Some(x) = frame.px(tick.value) else { continue };
            let class = if tick.has_label { "grid" } else { "fine" };
            append(svg, format_args!(r#"<path class="{class}" d="M{x:.1} {TOP}V{bottom}"/>"#));
            if tick.has_label {
                let (y, number) = (bottom + 16.0, escaped(&(self.x.number)(tick.value)));
                append(svg, format_args!(r#"<text x="{x:.1}" y="{y}" text-anchor="middle">{number}</text>"#));
            }
        }
        for tick in frame.y.ticks() {
            let Some(y) = frame.py(tick.value) else { continue };
            let class = if tick.has_label { "grid" } else { "fine" };
            append(svg, format_args!(r#"<path class="{class}" d="M{LEFT} {y:.1}H{right}"/>"#));
            if tick.has_label {
                let (x, y, number) = (LEFT - 7.0, y + 4.0, escaped(&(self.y.number)(tick.value)));
                append(svg, format_args!(r#"<text x="{x}" y="{y:.1}" text-anchor="end">{number}</text>"#));
            }
        }
        append(svg, format_args!(r#"<path class="axis" d="M{LEFT} {TOP}V{bottom}H{right}"/>"#));
        let (x, y) = ((LEFT + right) / 2.0, bottom + 36.0);
        let label = escaped(&self.x.label);
        append(
            svg,
            format_args!(r#"<text class="label" x="{x}" y="{y}" text-anchor="middle">{label}</text>"#),
        );
        let (y, label) = (TOP + PLOT_HEIGHT / 2.0, escaped(&self.y.label));
        append(
            svg,
            format_args!(
                r#"<text class="label" x="15" y="{y}" text-anchor="middle" transform="rotate(-90 15 {y})">{label}</text>"#
            ),
        );
    }

    /// Layout of the legend, in lines below the plot.
    fn legend(&self) -> Vec<LegendEntry<'_>> {
        let (mut x, mut line) = (LEFT, 0);
        let mut entries = Vec::new();
        for series in &self.series {
            let width = 28.0 + series.name.chars().count() as f64 * LETTER + 16.0;
            if x > LEFT && x + width > WIDTH - RIGHT + 16.0 {
                (x, line) = (LEFT, line + 1);
            }
            entries.push(LegendEntry { series, x, line });
            x += width;
        }
        entries
    }
}

struct LegendEntry<'a> {
    series: &'a Series,
    x: f64,
    line: usize,
}

/// Draws lines and marks to `svg` and their labels to `texts`.
fn draw_series(
    svg: &mut String,
    texts: &mut String,
    frame: &ChartFrame,
    series: &Series,
    labels: &mut Labels,
) {
    let placed: Vec<(f64, f64, &str)> = series
        .points
        .iter()
        .filter_map(|point| frame.at(point).map(|(x, y)| (x, y, point.label.as_str())))
        .collect();
    if placed.len() > 1 {
        let mut d = String::new();
        for (k, (x, y, _)) in placed.iter().enumerate() {
            append(&mut d, format_args!("{}{x:.1} {y:.1}", if k == 0 { 'M' } else { 'L' }));
        }
        append(svg, format_args!(r#"<path {} d="{d}"/>"#, stroke(series)));
    }
    for (k, &(x, y, label)) in placed.iter().enumerate() {
        let text = escaped(label);
        append(svg, format_args!("<g><title>{}: {text}</title>", escaped(&series.name)));
        mark(svg, series.style, x, y);
        svg.push_str("</g>");
        let is_end = k == 0 || k + 1 == placed.len();
        if is_end && !label.is_empty() {
            // Without room for the label, only the mark's title shows it.
            let Some(Place { x, y, anchor }) = labels.place_label(x, y, label) else { continue };
            let colour = colour(series.style);
            append(
                texts,
                format_args!(
                    r#"<text class="mark" fill="{colour}" x="{x:.1}" y="{y:.1}" text-anchor="{anchor}">{text}</text>"#
                ),
            );
        }
    }
}

fn colour(style: usize) -> &'static str {
    COLOURS[style % COLOURS.len()]
}

fn stroke(series: &Series) -> String {
    let dashes = if series.is_dashed { r#" stroke-dasharray="5 3""# } else { "" };
    format!(r#"fill="none" stroke="{}" stroke-width="1.6"{dashes}"#, colour(series.style))
}

/// Draws a mark of a series; its shape corresponds to the colour.
fn mark(svg: &mut String, style: usize, x: f64, y: f64) {
    let colour = colour(style);
    let shape = match style % COLOURS.len() {
        0 => format!(r#"<circle cx="{x:.1}" cy="{y:.1}" r="4""#),
        1 => format!(r#"<rect x="{:.1}" y="{:.1}" width="7" height="7""#, x - 3.5, y - 3.5),
        2 => format!(r#"<path d="M{x:.1} {:.1}l4.6 8h-9.2z""#, y - 5.0),
        3 => format!(r#"<path d="M{x:.1} {:.1}l5 5l-5 5l-5-5z""#, y - 5.0),
        4 => format!(r#"<path d="M{x:.1} {:.1}l-4.6-8h9.2z""#, y + 5.0),
        5 => format!(r#"<path d="M{:.1} {:.1}h3v3h3v3h-3v3h-3v-3h-3v-3h3z""#, x - 1.5, y - 4.5),
        _ => format!(r#"<rect x="{:.1}" y="{:.1}" width="10" height="4""#, x - 5.0, y - 2.0),
    };
    append(svg, format_args!(r##"{shape} fill="{colour}" stroke="#fff" stroke-width="0.8"/>"##));
}

/// Appends formatted text; writing to a String cannot fail.
fn append(to: &mut String, text: std::fmt::Arguments<'_>) {
    let _ = to.write_fmt(text);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::plot::{plain, seconds};

    fn chart() -> Chart {
        let points = [(0.1, 0.02), (1.0, 0.01), (10.0, 0.005)].map(|(x, y)| Point {
            x,
            y,
            label: format!("{x} <px>"),
        });
        let axis = |label: &str, number| Axis { label: label.into(), kind: Kind::Log, number };
        let series = |name: &str, style| Series {
            name: name.into(),
            style,
            is_dashed: style > 0,
            points: points.to_vec(),
        };
        Chart {
            title: "Time & error".into(),
            x: axis("time, s", seconds),
            y: axis("RMSE", plain),
            series: vec![series("splat", 0), series("truth", 1)],
            rules: vec![Rule { y: 0.001, label: "reference".into() }],
        }
    }

    #[test]
    fn everything_is_drawn_within_the_picture() {
        let svg = chart().to_svg();
        assert_eq!(svg.matches("<circle").count(), 3 + 1, "a mark a point, one in the legend");
        assert_eq!(svg.matches("<g><title>").count(), 6);
        assert!(svg.contains("Time &amp; error") && svg.contains("&lt;px&gt;"), "text is escaped");
        assert!(svg.contains("100 ms") && svg.contains("10 s"), "numbers have units");
        assert!(svg.contains("reference"));
        let height: f64 =
            svg.split(r#"viewBox="0 0 560 "#).nth(1).unwrap().split('"').next().unwrap().parse().unwrap();
        for attribute in [" cx=\"", " x=\"", " y=\""] {
            for value in svg.split(attribute).skip(1) {
                let value: f64 = value.split('"').next().unwrap().parse().unwrap();
                assert!((0.0..=height.max(560.0)).contains(&value), "{attribute}{value}");
            }
        }
    }

    #[test]
    fn lower_error_is_drawn_lower_and_zero_is_left_out_and_counted() {
        let mut chart = chart();
        let frame = chart.frame();
        assert!(frame.py(0.02) < frame.py(0.005), "SVG counts from the top");
        assert!(frame.px(0.1) < frame.px(10.0));
        assert_eq!(chart.left_out_count(), 0);
        chart.series[0].points[1].y = 0.0;
        assert_eq!(chart.left_out_count(), 1);
        assert_eq!(chart.to_svg().matches("<g><title>").count(), 5);
    }

    #[test]
    fn an_empty_chart_is_still_a_chart() {
        let mut chart = chart();
        chart.series.clear();
        chart.rules.clear();
        assert!(chart.to_svg().ends_with("</svg>"));
    }
}
