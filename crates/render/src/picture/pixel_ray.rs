//! Rays through pixels.

use glam::DVec2;
use lens::Camera;
use trace::Ray;

/// The chief ray of a pixel's centre. Pixels are numbered row by row.
pub(crate) fn pixel_ray(camera: &Camera, number: u32) -> Ray {
    let pixel = DVec2::new(f64::from(number % camera.width), f64::from(number / camera.width));
    Ray::pinhole(camera, DVec2::ZERO, pixel + 0.5)
}
