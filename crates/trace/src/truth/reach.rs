//! From which standard picture positions rays may land in the window: the frame and its guard band.
//!
//! Paint displaces light by (κ − κ_standard)·U/tanθ. The reach is the box around every place from which a
//! point's rays can be displaced into the window, with bounds on κ for every piece of surface that may send
//! light there ([`super::patches`]): a bound, not a guess, though a box of pieces and so often wider than need
//! be. Hidden surfaces count as well. It ends at [`WIDEST`], which only light from next to the aperture plane
//! passes.

use super::kappa_bounds::FocusBox;
use super::patches::visit_patches;
use super::view::View;
use glam::DVec2;
use rayon::prelude::*;

/// How far the reach goes beyond the window at most, half-heights of the frame.
const WIDEST: f64 = 16.0;

/// Positions of the frame, px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reach {
    pub low: DVec2,
    pub high: DVec2,
}

impl Reach {
    /// The positions of the pinhole picture from which light can be displaced into `window` (least and greatest
    /// corner, px).
    pub fn new(view: &View, window: [DVec2; 2]) -> Self {
        let window = Self { low: window[0], high: window[1] }.widened(view.lateral_px(window));
        let widest = window.widened(WIDEST * view.optics.half_height_px);
        let background =
            FocusBox::of_background(view).background_displacement_px(view, [window.low, window.high]);
        let triangles = 0..view.tracer.scene().triangles.len() as u32;
        let reach = triangles
            .into_par_iter()
            .map(|triangle| Self::of_triangle(view, window, triangle))
            .reduce(|| window, Self::union)
            .union(window.widened(background));
        Self { low: reach.low.max(widest.low).floor(), high: reach.high.min(widest.high).ceil() }
    }

    fn of_triangle(view: &View, window: Self, triangle: u32) -> Self {
        let mut reach = window;
        visit_patches(view, [window.low, window.high], triangle, &mut |patch| {
            let Some(inverse_depths) = patch.inverse_depths() else {
                reach = Self { low: DVec2::NEG_INFINITY, high: DVec2::INFINITY };
                return;
            };
            let chief = patch.farthest_chief(view);
            let displacement = patch.focus.largest_displacement(view, inverse_depths, chief);
            if displacement > 0.0 {
                let standard =
                    inverse_depths.map(|inverse| view.radius_px(view.optics.standard_kappa(inverse)));
                let [low, high] = patch.sharp_image(view);
                let image = Self { low, high }.widened(standard[0].max(standard[1]));
                reach = reach.union(image.intersection(window.widened(view.radius_px(displacement))));
            }
        });
        reach
    }

    fn widened(self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    /// The box around both; an empty one adds nothing.
    fn union(self, other: Self) -> Self {
        if other.low.cmpgt(other.high).any() {
            return self;
        }
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn intersection(self, other: Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.min(other.high) }
    }

    /// Whether a position of the pinhole picture, px, is in it.
    pub fn contains(&self, position: DVec2) -> bool {
        position.cmpge(self.low).all() && position.cmplt(self.high).all()
    }
}
