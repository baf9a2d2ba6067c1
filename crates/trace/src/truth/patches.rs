//! Surfaces, cut into pieces that may send light into the picture.
//!
//! A triangle is halved along its longest edge until each piece surely sends nothing into the window (it is
//! dropped), surely sends all of it there, or is small on the picture and of about one depth. "Surely" comes
//! from bounds on κ over the piece: every ray from P through U lands right of the window's right rim q if
//!
//! ```text
//! x + κz·u > z·q·tanθ
//! ```
//!
//! and so for its other sides. Nothing is divided by z and κz is finite, so that pieces that touch the aperture
//! plane, or pass it, are judged as well; points with z ≤ 0 are behind the lens and send nothing.

use super::kappa_bounds::FocusBox;
use super::view::View;
use glam::{DVec2, DVec3};

/// A piece of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    pub triangle: u32,
    /// Its corners, in barycentrics of the triangle.
    pub barycentric: [DVec2; 3],
    /// The same, camera space.
    pub corners: [DVec3; 3],
    pub focus: FocusBox,
}

/// A piece is of about one depth if the farthest point is at most so many times as deep as the nearest.
const DEPTH_RATIO: f64 = 1.3;
/// And small if its sharp image, or that image's share of the frame's height, is at most this wide.
const SMALL_PX: f64 = 16.0;
const SMALL_SHARE: f64 = 1.0 / 16.0;
/// A piece with edges of at most this share of the aperture's radius is not cut further: what is undecided
/// then touches the aperture itself, and counts as sending.
const SMALL_AT_LENS: f64 = 1e-3;
/// How often a triangle is halved at most: its pieces' edges are then 10⁻⁹ of its own. Only what touches the
/// middle of a pinhole comes so far.
const MOST_HALVINGS: u32 = 60;

/// Calls `visit` with every piece of a triangle that may send light to `window`, the least and the greatest
/// position in px.
pub(super) fn visit_patches(view: &View, window: [DVec2; 2], triangle: u32, visit: &mut impl FnMut(&Patch)) {
    let corners = view.tracer.scene().corners(triangle).map(|corner| view.camera.camera_from_world(corner));
    let area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
    if !(area > 0.0 && area.is_finite()) {
        return;
    }
    let focus = FocusBox::of_triangle(view, triangle);
    let whole = Patch { triangle, barycentric: [DVec2::ZERO, DVec2::X, DVec2::Y], corners, focus };
    let small = SMALL_PX.max(SMALL_SHARE * 2.0 * view.optics.half_height_px);
    let mut pieces = vec![(whole, 0)];
    while let Some((patch, halvings)) = pieces.pop() {
        if !patch.may_land_in(view, window) {
            continue;
        }
        if halvings == MOST_HALVINGS || patch.is_simple(view, window, small) {
            visit(&patch);
        } else {
            pieces.extend(patch.halves().map(|half| (half, halvings + 1)));
        }
    }
}

impl Patch {
    /// The least (but not below 0) and the greatest depth of its corners, scene units.
    pub fn depths(&self) -> [f64; 2] {
        let [a, b, c] = self.corners.map(|corner| corner.z);
        [a.min(b).min(c).max(0.0), a.max(b).max(c)]
    }

    /// The reciprocals of the greatest and the least depth; `None` if it touches the aperture plane.
    pub fn inverse_depths(&self) -> Option<[f64; 2]> {
        let [nearest, farthest] = self.depths();
        (nearest > 0.0 && (1.0 / nearest).is_finite()).then(|| [1.0 / farthest, 1.0 / nearest])
    }

    /// The box around its sharp image, px; only for pieces with [`Self::inverse_depths`].
    pub fn sharp_image(&self, view: &View) -> [DVec2; 2] {
        let [a, b, c] = self.corners.map(|corner| view.camera.pixel_from_q(view.optics.chief(corner)));
        [a.min(b).min(c), a.max(b).max(c)]
    }

    /// How far its farthest point's chief place is from the axis, half-heights; infinite if it touches the aperture plane.
    pub fn farthest_chief(&self, view: &View) -> f64 {
        let chief =
            |corner: DVec3| if corner.z > 0.0 { view.optics.chief(corner).length() } else { f64::INFINITY };
        self.corners.map(chief).into_iter().fold(0.0, f64::max)
    }

    /// The patch's area, square units of length.
    pub fn area(&self) -> f64 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a).length() / 2.0
    }

    /// Whether any ray of it may land in the window.
    fn may_land_in(&self, view: &View, window: [DVec2; 2]) -> bool {
        let [_, farthest] = self.depths();
        if farthest <= 0.0 {
            return false;
        }
        let optics = &view.optics;
        let spread = optics.aperture_radius
            * self.focus.largest_kappa_times_depth(view, farthest, self.farthest_chief(view));
        let [low, high] = window.map(|px| view.camera.q_from_pixel(px) * optics.tan_half_yfov);
        // Of the window in half-heights y points up: its lower rim has the larger pixel row.
        let least =
            |side: &dyn Fn(DVec3) -> f64| self.corners.map(side).into_iter().fold(f64::INFINITY, f64::min);
        let outside = [
            least(&|p| p.x - p.z * high.x),
            least(&|p| p.z * low.x - p.x),
            least(&|p| p.y - p.z * low.y),
            least(&|p| p.z * high.y - p.y),
        ];
        // Not `all(≤)`: what is not a number is not dropped.
        !outside.into_iter().any(|distance| distance > spread)
    }

    /// Whether it need not be cut further.
    fn is_simple(&self, view: &View, window: [DVec2; 2], small: f64) -> bool {
        if self.longest_edge() <= SMALL_AT_LENS * view.optics.aperture_radius {
            return true;
        }
        let Some(inverse_depths) = self.inverse_depths() else { return false };
        if inverse_depths[1] > DEPTH_RATIO * inverse_depths[0] {
            return false;
        }
        let [low, high] = self.sharp_image(view);
        let radius =
            view.radius_px(self.focus.largest_kappa(view, inverse_depths, self.farthest_chief(view)));
        let is_inside = (low - radius).cmpge(window[0]).all() && (high + radius).cmple(window[1]).all();
        is_inside || (high - low).max_element() <= small.max(radius)
    }

    fn longest_edge(&self) -> f64 {
        let [a, b, c] = self.corners;
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    }

    /// Its two halves, cut across the longest edge.
    fn halves(&self) -> [Self; 2] {
        let edge = |k: usize| self.corners[(k + 1) % 3].distance_squared(self.corners[(k + 2) % 3]);
        let apex = (0..3).fold(0, |longest, k| if edge(k) > edge(longest) { k } else { longest });
        let (from, to) = ((apex + 1) % 3, (apex + 2) % 3);
        let (mut first, mut second) = (*self, *self);
        let middle = (self.corners[from] + self.corners[to]) / 2.0;
        let barycentric = (self.barycentric[from] + self.barycentric[to]) / 2.0;
        (first.corners[to], first.barycentric[to]) = (middle, barycentric);
        (second.corners[from], second.barycentric[from]) = (middle, barycentric);
        [first, second]
    }
}
