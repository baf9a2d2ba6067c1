//! The sizes of the quick pictures that come before the one of full size.

use lens::Camera;

/// Sides of the coarse picture are at most this share of the preview's: a twenty-fifth of the work.
const COARSE_SCALE: f64 = 1.0 / 5.0;

/// The coarse picture takes at most about so long, s.
const COARSE_SECONDS: f64 = 3.0;

/// One that takes so long, s, needs none before it.
const QUICK_COARSE_SECONDS: f64 = 0.7;

/// The first picture of a light field has so many pixels: less than a second's work even where each takes half a millisecond, as with glossy
/// surfaces under a sky.
const GLANCE_PIXELS: f64 = 1500.0;

/// Sides of the picture between the coarse one and the fine one, as a share of the preview's: a ninth of the work.
const INTERIM_SCALE: f64 = 1.0 / 3.0;

/// Where the preview has fewer pixels, the fine one is soon there.
const MIN_INTERIM_PIXELS: f64 = 200_000.0;

/// A picture takes about so long while the camera moves, s: with what the window takes, some twenty a second.
const MOVING_SECONDS: f64 = 0.035;

/// And when it rests, s, before it is blurred.
const RESTING_SECONDS: f64 = 0.8;

/// Sides of the picture while the camera moves are at least this share of the preview's.
const MIN_MOVING_SCALE: f64 = 1.0 / 12.0;

/// Below this longest side, px, a picture is quick enough to need no coarse one.
const MIN_COARSE_SIDE_PX: u32 = 48;

/// Whether pictures of few pixels come before the fine one; not where it is small anyway.
pub(super) fn has_coarse_pictures(camera: &Camera) -> bool {
    let coarse = scaled(camera, COARSE_SCALE);
    coarse.width.max(coarse.height) >= MIN_COARSE_SIDE_PX
}

/// The camera of the next picture of few pixels, after one of `shown_pixels` (0: after none), if a pixel takes `pace` seconds to bake (none: not
/// known yet); none after the last.
pub(super) fn next_coarse_camera(camera: &Camera, shown_pixels: f64, pace: Option<f64>) -> Option<Camera> {
    if !has_coarse_pictures(camera) {
        return None;
    }
    let of_pixels = |pixels: f64| scaled(camera, (pixels / pixel_count(camera)).sqrt().min(COARSE_SCALE));
    let coarse = pace.map(|pace| of_pixels(COARSE_SECONDS / pace));
    if shown_pixels > 0.0 {
        return coarse.filter(|coarse| pixel_count(coarse) >= 2.0 * shown_pixels);
    }
    let is_quick =
        |coarse: &Camera| pace.is_some_and(|pace| pixel_count(coarse) * pace < QUICK_COARSE_SECONDS);
    Some(coarse.filter(is_quick).unwrap_or_else(|| of_pixels(GLANCE_PIXELS)))
}

/// The camera of the one picture of few pixels of a scene with Gaussian splats: whatever its size, most of the time is for what each cell of the aperture
/// sees of all splats.
pub(super) fn coarse_camera_of_splats(camera: &Camera) -> Option<Camera> {
    has_coarse_pictures(camera).then(|| scaled(camera, COARSE_SCALE))
}

/// The camera with a picture of this size.
pub(super) fn resized(camera: &Camera, [width, height]: [u32; 2]) -> Camera {
    Camera { width, height, ..camera.clone() }
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
    resized(
        camera,
        [camera.width, camera.height].map(|side| ((f64::from(side) * share).round() as u32).max(1)),
    )
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
        let sizes = |width, height, pace: f64| {
            let camera = Camera { width, height, ..Camera::default() };
            let (mut sizes, mut known_pace) = (Vec::new(), None);
            let mut shown = 0.0;
            while let Some(small) = next_coarse_camera(&camera, shown, known_pace) {
                sizes.push([small.width, small.height]);
                (shown, known_pace) = (pixel_count(&small), Some(pace));
            }
            sizes
        };
        assert!(sizes(120, 90, 1e-5).is_empty());
        assert_eq!(sizes(240, 135, 1e-5), [[48, 27]]);
        assert_eq!(sizes(960, 540, 1e-5), [[52, 29], [192, 108]]);
        assert_eq!(sizes(960, 540, 5e-4), [[52, 29], [103, 58]]);
        assert_eq!(sizes(960, 540, 1.0), [[52, 29]]);
        assert_eq!(sizes(16384, 1, 0.0), [[3277, 1]]);
        let camera = Camera { width: 960, height: 540, ..Camera::default() };
        let first = |pace| next_coarse_camera(&camera, 0.0, Some(pace)).unwrap().width;
        assert_eq!([first(1e-5), first(5e-4)], [192, 52], "what is quick needs nothing before it");
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
        assert_eq!(width(Some(1e-6)), [249, 960]);
        assert_eq!(width(Some(1.0)), [80, 320]);
        assert_eq!(width(Some(0.0)), [960, 960]);
    }
}
