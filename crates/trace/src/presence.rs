//! Whether a surface point is there: masks and blending.

use crate::Ray;
use crate::random::{mix, unit};
use scene::{Scene, SurfacePoint};

/// Whether `point` is there for `ray`: if a number drawn for the ray and the triangle falls below the point's
/// opacity. Under a mask the opacity is 0 or 1 and the draw decides nothing.
pub(crate) fn is_there(scene: &Scene, point: SurfacePoint, ray: &Ray) -> bool {
    draw(ray, point.triangle) < f64::from(scene.opacity(point))
}

/// A number in [0, 1), uniform over rays and triangles, the same every time.
fn draw(ray: &Ray, triangle: u32) -> f64 {
    let words = [ray.origin, ray.direction].into_iter().flat_map(|v| v.to_array().map(f64::to_bits));
    unit(words.fold(u64::from(triangle), |hash, word| mix(hash ^ word)))
}
