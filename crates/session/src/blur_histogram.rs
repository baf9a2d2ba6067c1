//! A histogram of the picture's circles of confusion.

use document::{Document, chief_ray, pick};
use glam::DVec2;
use numerics::quantile_of_sorted;

/// Signed diameters of circles of confusion at positions spread evenly over the picture, in pixels of the full-size picture (negative
/// near, positive far).
#[derive(Clone, Debug, PartialEq)]
pub struct BlurHistogram {
    /// Diameters at positions that show a surface, ascending.
    pub circles_px: Vec<f64>,
    /// Number of positions without a surface.
    pub background: usize,
}

impl BlurHistogram {
    /// The quantile at `share`, in [0, 1], of the positions that show a surface.
    pub fn quantile(&self, share: f64) -> Option<f64> {
        quantile_of_sorted(&self.circles_px, share)
    }

    /// The share of all positions whose diameter is less than `px`.
    pub fn sharper_than(&self, px: f64) -> f64 {
        let sharper = self.circles_px.iter().filter(|circle| circle.abs() < px).count();
        sharper as f64 / (self.circles_px.len() + self.background).max(1) as f64
    }
}

impl BlurHistogram {
    /// Measures `columns` × `rows` positions of a document's picture, by chief rays.
    pub(crate) fn measure(document: &Document, [columns, rows]: [usize; 2]) -> Self {
        let optics = document.camera.optics();
        let mut histogram = Self { circles_px: Vec::new(), background: 0 };
        for k in 0..columns * rows {
            let at = DVec2::new((k % columns) as f64 + 0.5, (k / columns) as f64 + 0.5);
            let ray = chief_ray(&document.camera, at / DVec2::new(columns as f64, rows as f64));
            match pick(document.stage.tracer(), &ray) {
                None => histogram.background += 1,
                Some(hit) => {
                    let depth = document.camera.camera_from_world(hit.position).z;
                    let kappa = optics.kappa(1.0 / depth, document.focus_at(&hit));
                    histogram.circles_px.push(2.0 * optics.splat_radius_px(kappa));
                }
            }
        }
        histogram.circles_px.sort_by(f64::total_cmp);
        histogram
    }
}
