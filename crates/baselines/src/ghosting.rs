//! Where a sparse light field ghosts: the bounds of refocusing from pinhole views.
//!
//! Views at a spacing m show a point of depth z as one pixel each, of size p on an image plane at the distance d. Refocused
//! to the depth z + f, that pixel is p' = (z + f)·p/d wide, and the copies of neighbouring views are |f|·m/z apart
//! ("Computational Image Formation Based on Surface Light Fields", section 3.3.1, equations 5 and 6). They leave no gap as long
//! as |f|·m/z ≤ p' (equation 7), that is for f_min ≤ f ≤ f_max:
//!
//! ```text
//! f_max = z²p/(md − zp)  (without bound where md ≤ zp),      f_min = −z²p/(md + zp)
//! ```
//!
//! Both are one condition on the focus distance s = z + f, and so on the defocus κ = 1/s − 1/z:
//!
//! ```text
//! |κ|·m·d ≤ p
//! ```
//!
//! that is, on the sensor copies are at most a pixel apart. In this form it also holds for painted points.

use crate::error::{check_hits, check_option};
use crate::views::VIEWS_A_SIDE;
use crate::{BaselineError, FirstHits};
use lens::Camera;

/// The focal offsets [f_min, f_max] from a point within which its refocused copies leave no gap.
///
/// ```text
/// f_max = z²p/(md − zp),    f_min = −z²p/(md + zp)
/// ```
///
/// | symbol | argument | meaning | unit |
/// | --- | --- | --- | --- |
/// | z | `depth` | distance of the point from the views, along their axis, ≥ 0; may be infinite | length |
/// | p | `pixel_size` | side of a pixel on the views' image plane, finite and ≥ 0 | length |
/// | m | `view_spacing` | distance between neighbouring views, finite and ≥ 0 | length |
/// | d | `image_distance` | distance of the image plane from its view's pinhole, finite and > 0 | length |
///
/// f is the offset of the refocused plane from the point, > 0 behind it.
///
/// Limits: where md ≤ zp a pixel is wider than the views' spacing as the point sees it, and f_max is ∞. At z = 0 the
/// views lie on the point itself (a surface light field): no f ghosts, [−∞, ∞]. At z = ∞ every finite focus distance is an
/// f of −∞, and the bounds are [−∞, ∞] (use [`copies_apart_px`] there). At m = 0 all views are one: [−z, ∞]. At p = 0 only f = 0 is left. Arguments
/// outside of the ranges above, and NaN, give NaN.
pub fn ghosting_bounds(depth: f64, pixel_size: f64, view_spacing: f64, image_distance: f64) -> [f64; 2] {
    let (z, p, m, d) = (depth, pixel_size, view_spacing, image_distance);
    let is_valid = z >= 0.0 && p >= 0.0 && m >= 0.0 && d > 0.0 && (p + m + d).is_finite();
    if !is_valid {
        return [f64::NAN; 2];
    }
    if z == 0.0 || z == f64::INFINITY {
        return [f64::NEG_INFINITY, f64::INFINITY];
    }
    // The views' spacing in pixels, as the point sees it: md/(zp).
    let spacing_px = match (m == 0.0, p == 0.0) {
        (true, _) => 0.0,
        (false, true) => f64::INFINITY,
        (false, false) => (m / z) * (d / p),
    };
    let f_min = -z / (spacing_px + 1.0);
    let f_max = if spacing_px > 1.0 { z / (spacing_px - 1.0) } else { f64::INFINITY };
    [f_min, f_max]
}

/// How far apart neighbouring views' copies of a point of defocus `kappa` lie on the picture, px, for
/// `views_a_side` × `views_a_side` views over the aperture's square: |κ|·(m/tanθ)·(H/2) with m = 2R/`views_a_side`. 0 for a
/// single view, which has no neighbour.
pub fn copies_apart_px(camera: &Camera, kappa: f64, views_a_side: u32) -> f64 {
    if views_a_side < 2 {
        return 0.0;
    }
    camera.optics().circle_of_confusion_px(kappa) / f64::from(views_a_side)
}

/// The pixels that [`crate::shift_and_add`] ghosts at: those whose point's copies are more than a pixel apart, a value
/// a pixel. Painted points are judged by their painted defocus.
///
/// # Errors
/// [`BaselineError`] if `hits` belong to another camera or an option is out of range.
pub fn beyond_ghosting_bound(
    hits: &FirstHits,
    camera: &Camera,
    views_a_side: u32,
) -> Result<Vec<bool>, BaselineError> {
    check_hits(hits, camera)?;
    check_option("views a side", views_a_side, VIEWS_A_SIDE, "1 to 64")?;
    Ok(hits.kappa.iter().map(|&kappa| copies_apart_px(camera, kappa, views_a_side) > 1.0).collect())
}

/// The depths [nearest, farthest] that the unpainted `camera` shows without ghosts from `views_a_side` ×
/// `views_a_side` views: those of |1/s − 1/z| ≤ p/(md). The farthest may be infinite; a single view, or a pinhole,
/// shows all.
pub fn ghost_free_depths(camera: &Camera, views_a_side: u32) -> [f64; 2] {
    let inverse_focus_distance = 1.0 / camera.focus_distance;
    let apart_px = copies_apart_px(camera, 1.0, views_a_side);
    let largest_kappa = 1.0 / apart_px;
    let nearest = 1.0 / (inverse_focus_distance + largest_kappa);
    let farthest = inverse_focus_distance - largest_kappa;
    [nearest, if farthest > 0.0 { 1.0 / farthest } else { f64::INFINITY }]
}

#[cfg(test)]
mod tests;
