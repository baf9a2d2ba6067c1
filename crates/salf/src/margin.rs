//! How far outside the frame light must be gathered.

use crate::view::View;
use glam::{DVec2, DVec3};
use lens::FocusOffset;
use numerics::quantile;
use rayon::prelude::*;
use scene::{Scene, SurfaceField, SurfacePoint};
use trace::Tracer;

/// Beyond this many picture heights outside the frame nothing is sampled.
pub const LARGEST_MARGIN_HEIGHTS: f64 = 1.5;

/// The margin of the standard picture, px: the largest circle of confusion (its radius) of any surface that the
/// aperture sees through the frame, however far outside the frame the surface itself lies.
///
/// The rays of the picture fill the frustum |y| ≤ z·tanθ + R·|1 − z/s| (and the same in x). Its near part is
/// convex up to the focus plane; clipping every triangle to it gives the nearest visible depth. Beyond the
/// focus plane the circle grows to that of infinity.
pub fn standard_margin_px(scene: &Scene, view: &View) -> f64 {
    let inverse_s = view.optics.inverse_focus_distance;
    let nearest = scene
        .surface_triangles()
        .filter_map(|triangle| {
            let corners = scene.corners(triangle).map(|p| view.camera.camera_from_world(p));
            nearest_depth_in_frustum(corners, view)
        })
        .fold(f64::INFINITY, f64::min);
    let near = view.optics.splat_radius_px(1.0 / nearest - inverse_s);
    let far = view.optics.splat_radius_px(inverse_s);
    let splats = splat_margin_px(scene, view, |_| FocusOffset::STANDARD);
    (near.max(far).max(splats) + character_margin_px(view)).clamp(0.0, largest_margin_px(view))
}

/// The largest splat radius of Gaussian splats, px, whose light reaches the frame; their focus is that of their addresses. A few that float before the
/// lens do not count: their light is nowhere.
fn splat_margin_px(scene: &Scene, view: &View, focus: impl Fn(SurfacePoint) -> FocusOffset + Sync) -> f64 {
    /// The share of splats that do not count.
    const FLOATING: f64 = 1e-3;
    let Some(splats) = &scene.splats else { return 0.0 };
    let frame = DVec2::new(view.camera.width as f64, view.camera.height as f64);
    let radius = |splat: u32| {
        let mean = splats.placement.point(splats.cloud.means()[splat as usize].as_dvec3());
        let point = view.camera.camera_from_world(mean);
        if point.z <= view.optics.aperture_radius {
            return None;
        }
        let pixel = view.camera.pixel_from_q(view.optics.chief(point));
        let outside = (-pixel).max(pixel - frame).max_element();
        let kappa = view.optics.kappa(1.0 / point.z, focus(splats.address(splat)));
        let radius = view.optics.splat_radius_px(kappa).abs();
        (radius >= outside).then_some(radius)
    };
    let mut radii: Vec<f64> = (0..splats.cloud.len() as u32).into_par_iter().filter_map(radius).collect();
    quantile(&mut radii, 1.0 - FLOATING).unwrap_or(0.0)
}

/// The margin of a painted picture, px, measured on a grid of chief rays (like the guard band of the ground
/// truth): the largest splat radius of a surface that is no further outside the frame than that.
pub fn painted_margin_px(tracer: &Tracer, view: &View, focus: &dyn SurfaceField<FocusOffset>) -> f64 {
    const SPACING_PX: f64 = 6.0;
    let splats = splat_margin_px(tracer.scene(), view, |point| focus.at(point));
    let frame = DVec2::new(view.camera.width as f64, view.camera.height as f64);
    let character = character_margin_px(view);
    let mut margin = (splats + character).min(largest_margin_px(view));
    loop {
        let extent = frame + 2.0 * margin;
        let steps = (extent / SPACING_PX).ceil();
        let of_row = |row: i64| {
            let mut reach = margin;
            for column in 0..steps.x as i64 {
                let pixel = DVec2::new(column as f64 + 0.5, row as f64 + 0.5) / steps * extent - margin;
                let (inverse_depth, offset) = match tracer.first_hit(&view.chief_ray(pixel)) {
                    Some(hit) => (1.0 / hit.t, focus.at(hit.point)),
                    None => (0.0, focus.at_infinity()),
                };
                let outside = (-pixel).max(pixel - frame).max_element();
                // What is carried may be spread wider than what is own; where no paint moves it, it is known to have room.
                let carried = (offset.gloss > 0.0).then(|| offset.of_carried());
                for offset in [offset].into_iter().chain(carried) {
                    let radius = view.optics.splat_radius_px(view.optics.kappa(inverse_depth, offset)).abs()
                        + character;
                    if radius >= outside {
                        reach = reach.max(radius * 1.05);
                    }
                }
            }
            reach
        };
        let reach = (0..steps.y as i64).into_par_iter().map(of_row).reduce(|| margin, f64::max);
        let reach = reach.min(largest_margin_px(view));
        if reach <= margin * 1.02 + 1.0 {
            return reach;
        }
        margin = reach;
    }
}

/// What a lens's character adds to a margin, px: the curved field's and the colours' defocus in the farthest corner, and how far colours
/// are shifted there.
fn character_margin_px(view: &View) -> f64 {
    let character = view.camera.character_optics();
    let [middle, half] = view.camera.frame_q();
    let corner = (middle.abs() + half).length();
    let kappa = character.largest_curvature(corner) + character.largest_colour_defocus();
    let lateral = character.largest_lateral();
    view.optics.splat_radius_px(kappa) + lateral / (1.0 - lateral) * corner * view.optics.half_height_px
}

fn largest_margin_px(view: &View) -> f64 {
    LARGEST_MARGIN_HEIGHTS * view.camera.height as f64
}

/// The smallest depth of the part of a triangle (camera space) that lies between aperture and focus plane in the
/// frustum of the picture's rays.
fn nearest_depth_in_frustum(corners: [DVec3; 3], view: &View) -> Option<f64> {
    let optics = &view.optics;
    let (radius, inverse_s) = (optics.aperture_radius, optics.inverse_focus_distance);
    // Side planes: R + z·(slope·tanθ − R/s) − |y| ≥ 0.
    let [middle, half] = view.camera.frame_q().map(|q| (q * optics.tan_half_yfov).to_array());
    let mut polygon = corners.to_vec();
    clip(&mut polygon, |p| p.z);
    clip(&mut polygon, |p| 1.0 - p.z * inverse_s);
    for axis in [0, 1] {
        for sign in [-1.0, 1.0] {
            let slope = half[axis] + sign * middle[axis];
            clip(&mut polygon, |p| radius + p.z * (slope - radius * inverse_s) - sign * p[axis]);
        }
    }
    polygon.iter().map(|p| p.z).reduce(f64::min)
}

/// Keeps the part of a convex polygon where `inside` ≥ 0 (Sutherland and Hodgman).
fn clip(polygon: &mut Vec<DVec3>, inside: impl Fn(DVec3) -> f64) {
    let source = std::mem::take(polygon);
    for (i, &a) in source.iter().enumerate() {
        let b = source[(i + 1) % source.len()];
        let (da, db) = (inside(a), inside(b));
        if da >= 0.0 {
            polygon.push(a);
        }
        if (da >= 0.0) != (db >= 0.0) {
            polygon.push(a + (b - a) * (da / (da - db)));
        }
    }
}
