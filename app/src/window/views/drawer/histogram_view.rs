//! A histogram of the picture's circles of confusion, near on the left, far on the right.

use crate::window::widgets::{controls, false_colour};
use egui::{Align2, Color32, FontId, Rect, Sense, Stroke, Ui, pos2, vec2};
use session::{BlurHistogram, Session};

/// Columns and rows of sampled picture positions.
const PROBES: [usize; 2] = [96, 64];
/// Bars from the nearest blur to the farthest.
const BARS: usize = 81;

/// Least space between two labels of the axis, points.
const LABEL_GAP: f32 = 6.0;

/// The histogram's state between frames.
#[derive(Default)]
pub struct HistogramView {
    histogram: Option<BlurHistogram>,
    /// The inputs from which it was made.
    histogram_key: Option<(focus::FocusMap, lens::Camera)>,
}

impl HistogramView {
    /// Draws the bars, an axis and the median.
    pub fn ui(&mut self, ui: &mut Ui, session: &Session) {
        let Some(document) = session.document() else { return };
        let fits = |(map, camera): &(focus::FocusMap, lens::Camera)| {
            map.shares_tiles_with(&document.map) && *camera == document.camera
        };
        // Not recomputed during a stroke, which needs the time.
        if !self.histogram_key.as_ref().is_some_and(fits)
            && (self.histogram.is_none() || !session.is_painting())
        {
            self.histogram = session.blur_histogram(PROBES);
            self.histogram_key = Some((document.map.clone(), document.camera.clone()));
        }
        let Some(histogram) = &self.histogram else { return };
        let in_words = |px: Option<f64>| px.map_or("–".into(), controls::circle_text);
        ui.label(format!(
            "{:.0} % of the picture is sharper than 1 px; blur from {} over {} (median) to {}.",
            histogram.sharper_than(1.0) * 100.0,
            in_words(histogram.quantile(0.0)),
            in_words(histogram.quantile(0.5)),
            in_words(histogram.quantile(1.0)),
        ));
        let (rect, response) =
            ui.allocate_exact_size(ui.available_size().max(vec2(40.0, 30.0)), Sense::hover());
        controls::set_accessible_name(&response, "Histogram of circles of confusion");
        paint(ui, rect, histogram);
        response.on_hover_text(
            "Distribution of the circles of confusion in the picture. The scale is logarithmic.",
        );
    }
}

fn paint(ui: &Ui, rect: Rect, histogram: &BlurHistogram) {
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    let axis = rect.with_min_y(rect.bottom() - 16.0);
    let bars = rect.with_max_y(axis.top()).shrink2(vec2(4.0, 4.0));
    let mut counts = [0usize; BARS];
    for &circle in &histogram.circles_px {
        let at = (false_colour::position(circle) + 1.0) / 2.0 * (BARS - 1) as f64;
        counts[(at.round() as usize).min(BARS - 1)] += 1;
    }
    let most = counts.iter().copied().max().unwrap_or(0).max(1);
    let width = bars.width() / BARS as f32;
    for (k, count) in counts.into_iter().enumerate().filter(|(_, count)| *count > 0) {
        // The square root keeps small counts visible.
        let height = bars.height() * (count as f32 / most as f32).sqrt();
        let left = bars.left() + k as f32 * width;
        let bar =
            Rect::from_min_max(pos2(left, bars.bottom() - height), pos2(left + width - 0.5, bars.bottom()));
        let circle = false_colour::circle_px(2.0 * k as f64 / (BARS - 1) as f64 - 1.0);
        painter.rect_filled(bar, 0.0, false_colour::color(circle));
    }
    let font = FontId::proportional(10.0);
    let color: Color32 = ui.visuals().text_color();
    // Where the labels so far end: in a narrow panel some are left out.
    let mut labelled_to = rect.left();
    let tick = Stroke::new(1.0, ui.visuals().weak_text_color());
    for circle in [-64.0, -16.0, -4.0, -1.0, 0.0, 1.0, 4.0, 16.0, 64.0f64] {
        let share = (false_colour::position(circle) as f32 + 1.0) / 2.0 * (BARS - 1) as f32 + 0.5;
        let x = bars.left() + share * width;
        painter.line_segment([pos2(x, axis.top()), pos2(x, axis.top() + 3.0)], tick);
        let text = match circle {
            0.0 => "sharp".to_string(),
            c if c < 0.0 => format!("near {}", -c),
            c => format!("far {c} px"),
        };
        let label = painter.layout_no_wrap(text, font.clone(), color);
        let place = Align2::CENTER_BOTTOM.anchor_size(pos2(x, axis.bottom() - 1.0), label.size());
        if place.left() >= labelled_to && place.right() <= rect.right() {
            labelled_to = place.right() + LABEL_GAP;
            painter.galley(place.min, label, color);
        }
    }
}
