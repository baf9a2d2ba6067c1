//! The sizes of the quick pictures that come before the one of full size.

use lens::Camera;

/// Sides of the coarse picture are this share of the preview's: a twenty-fifth of the work.
const COARSE_SCALE: f64 = 1.0 / 5.0;

/// Where the coarse picture has more than twice as many pixels, one of so many comes before it: about a second's work.
const ROUGH_PIXELS: f64 = 20_000.0;

/// Sides of the picture between the coarse one and the fine one, as a share of the preview's: a ninth of the work.
const INTERIM_SCALE: f64 = 1.0 / 3.0;

/// Where the preview has fewer pixels, the fine one is soon there.
const MIN_INTERIM_PIXELS: f64 = 200_000.0;

/// A picture takes about so long while the camera moves, s: twenty a second.
const MOVING_SECONDS: f64 = 0.05;

/// And when it rests, s, before there is blur.
const RESTING_SECONDS: f64 = 0.4;

/// Sides of the picture while the camera moves are at least this share of the preview's.
const MIN_MOVING_SCALE: f64 = 1.0 / 12.0;

/// Below this longest side, px, a picture is quick enough to need no coarse one.
const MIN_COARSE_SIDE_PX: u32 = 48;

/// The cameras of coarse pictures, the roughest first; none where the picture is small anyway.
pub(super) fn coarse_cameras(camera: &Camera) -> Vec<Camera> {
    let coarse = scaled(camera, COARSE_SCALE);
    if coarse.width.max(coarse.height) < MIN_COARSE_SIDE_PX {
        return Vec::new();
    }
    let pixels = pixel_count(&coarse);
    let rough =
        (pixels > 2.0 * ROUGH_PIXELS).then(|| scaled(camera, COARSE_SCALE * (ROUGH_PIXELS / pixels).sqrt()));
    rough.into_iter().chain([coarse]).collect()
}

/// The camera of the picture without blur while the camera moves, if a pixel takes `pace` seconds.
pub(super) fn moving_camera(camera: &Camera, pace: Option<f64>) -> Camera {
    pinhole_camera(camera, pace, MOVING_SECONDS, MIN_MOVING_SCALE)
}

/// The camera of the picture without blur when the camera rests.
pub(super) fn resting_camera(camera: &Camera, pace: Option<f64>) -> Camera {
    pinhole_camera(camera, pace, RESTING_SECONDS, default_pinhole_scale(camera))
}

/// A camera of as many pixels as can be traced in `seconds`, its sides at least `min_scale` of the camera's.
fn pinhole_camera(camera: &Camera, pace: Option<f64>, seconds: f64, min_scale: f64) -> Camera {
    let affordable = |pace: f64| (seconds / (pace * pixel_count(camera))).sqrt();
    scaled(camera, pace.map_or(default_pinhole_scale(camera), affordable).clamp(min_scale, 1.0))
}

fn default_pinhole_scale(camera: &Camera) -> f64 {
    if pixel_count(camera) >= MIN_INTERIM_PIXELS { INTERIM_SCALE } else { 1.0 }
}

/// The camera of the picture that comes after the coarse ones, while the fine one is baked; none where that is soon there.
pub(super) fn interim_camera(camera: &Camera) -> Option<Camera> {
    (pixel_count(camera) >= MIN_INTERIM_PIXELS).then(|| scaled(camera, INTERIM_SCALE))
}

fn scaled(camera: &Camera, share: f64) -> Camera {
    let [width, height] =
        [camera.width, camera.height].map(|side| ((f64::from(side) * share).round() as u32).max(1));
    Camera { width, height, ..camera.clone() }
}

/// Pixels of a camera's picture.
pub(super) fn pixel_count(camera: &Camera) -> f64 {
    f64::from(camera.width) * f64::from(camera.height)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_pictures_are_few_and_grow() {
        let sizes = |width, height| {
            let camera = Camera { width, height, ..Camera::default() };
            let sizes: Vec<_> =
                coarse_cameras(&camera).iter().map(|small| [small.width, small.height]).collect();
            sizes
        };
        assert!(sizes(120, 90).is_empty());
        assert_eq!(sizes(640, 360), [[128, 72]]);
        assert_eq!(sizes(1920, 1080), [[189, 106], [384, 216]]);
        assert_eq!(sizes(16384, 1), [[3277, 1]]);
        let interim = |width, height| {
            interim_camera(&Camera { width, height, ..Camera::default() })
                .map(|camera| [camera.width, camera.height])
        };
        assert_eq!(interim(960, 540), Some([320, 180]));
        assert_eq!(interim(480, 270), None);
    }

    #[test]
    fn pictures_without_blur_are_as_large_as_there_is_time_for() {
        let camera = Camera { width: 960, height: 540, ..Camera::default() };
        let width =
            |pace: Option<f64>| [moving_camera(&camera, pace).width, resting_camera(&camera, pace).width];
        assert_eq!(width(None), [320, 320]);
        assert_eq!(width(Some(1e-8)), [960, 960]);
        assert_eq!(width(Some(1e-6)), [298, 843]);
        assert_eq!(width(Some(1.0)), [80, 320]);
        assert_eq!(width(Some(0.0)), [960, 960]);
    }
}
