use super::*;
use crate::test_light::*;
use crate::{ViewsOptions, shift_and_add};
use glam::DVec2;
use lens::Picture;
use progress::Unwatched;
use test_scenes::{scene_of, unlit};
use trace::{Ray, Tracer};

/// Views a side of the aperture.
const VIEWS: u32 = 4;

/// m, p and d of `camera`.
fn view_geometry(camera: &Camera) -> [f64; 3] {
    let spacing = 2.0 * camera.aperture_radius / f64::from(VIEWS);
    [spacing, camera.sensor_height / f64::from(camera.height), camera.optics().image_distance]
}

/// Whether a point of depth z, seen by two neighbouring views and thrown back by each of them as the pixel that it saw,
/// leaves a gap on the plane of depth z + f: by nothing but rays.
fn leaves_a_gap(camera: &Camera, z: f64, f: f64) -> bool {
    let spacing = view_geometry(camera)[0];
    let point = DVec2::new(0.137, 0.04).extend(z);
    let on_plane = |view: f64| {
        let eye = DVec2::new(view, 0.0);
        // The same camera, moved: where it sees the point.
        let seen = camera.pixel_from_q(camera.optics().chief(point - eye.extend(0.0)));
        [-0.5, 0.5].map(|half_pixel| {
            let ray = Ray::pinhole(camera, eye, seen + DVec2::new(half_pixel, 0.0));
            let origin = camera.camera_from_world(ray.origin);
            let direction = camera.camera_direction(ray.direction);
            origin.x + direction.x * ((z + f) - origin.z) / direction.z
        })
    };
    let [a, b] = [-spacing / 2.0, spacing / 2.0].map(on_plane);
    a[1] < b[0] || b[1] < a[0]
}

/// The f between `without` and `with` a gap at which it opens, by bisection.
fn gap_opens_at(camera: &Camera, z: f64, mut without: f64, mut with: f64) -> f64 {
    assert!(!leaves_a_gap(camera, z, without) && leaves_a_gap(camera, z, with), "{z}: {without} {with}");
    for _ in 0..80 {
        let middle = (without + with) / 2.0;
        *(if leaves_a_gap(camera, z, middle) { &mut with } else { &mut without }) = middle;
    }
    (without + with) / 2.0
}

#[test]
fn the_bounds_are_where_rays_of_neighbouring_views_part() {
    let camera = camera(128);
    let [m, p, d] = view_geometry(&camera);
    for z in [0.4, 1.0, 2.5, 3.0, 7.0, 12.0] {
        let [f_min, f_max] = ghosting_bounds(z, p, m, d);
        assert!(m * d > z * p, "there is a far bound");
        let found = [gap_opens_at(&camera, z, 0.0, -0.9999 * z), gap_opens_at(&camera, z, 0.0, 1e9)];
        for (found, expected) in found.into_iter().zip([f_min, f_max]) {
            assert!((found / expected - 1.0).abs() < 1e-3, "{z}: {found}, expected {expected}");
        }
        // Negative control: neither bound is the other's negative.
        assert!((f_min / -f_max - 1.0).abs() > 1e-3);
    }
    // Far away a pixel is wider than the views' spacing: no focus behind the point leaves a gap.
    let z = 1.01 * m * d / p;
    assert_eq!(ghosting_bounds(z, p, m, d)[1], f64::INFINITY);
    assert!(!leaves_a_gap(&camera, z, 1e9 * z));
}

#[test]
fn the_bounds_are_total() {
    let bounds = ghosting_bounds;
    let all = [f64::NEG_INFINITY, f64::INFINITY];
    assert_eq!(bounds(0.0, 1e-5, 0.1, 0.05), all, "a view on the point itself");
    assert_eq!(bounds(f64::INFINITY, 1e-5, 0.1, 0.05), all);
    assert_eq!(bounds(2.0, 1e-5, 0.0, 0.05), [-2.0, f64::INFINITY], "one view");
    assert_eq!(bounds(2.0, 0.0, 0.1, 0.05), [0.0, 0.0], "points for pixels");
    let formula =
        |z: f64, p: f64, m: f64, d: f64| [-z * z * p / (m * d + z * p), z * z * p / (m * d - z * p)];
    for (z, p, m, d) in [(1.0, 1e-4, 0.05, 0.04), (3.0, 2e-4, 0.01, 0.1), (1e-9, 1e-5, 0.3, 0.05)] {
        let (found, expected) = (bounds(z, p, m, d), formula(z, p, m, d));
        (0..2).for_each(|k| assert!((found[k] / expected[k] - 1.0).abs() < 1e-12, "{found:?}"));
    }
    let extreme = bounds(1e-300, 1e-300, 1e300, 1e300);
    assert!(extreme.iter().all(|f| !f.is_nan()), "{extreme:?}");
    for (z, p, m, d) in [
        (-1.0, 1e-5, 0.1, 0.05),
        (1.0, -1e-5, 0.1, 0.05),
        (1.0, 1e-5, f64::NAN, 0.05),
        (1.0, 1e-5, 0.1, 0.0),
        (f64::NAN, 1e-5, 0.1, 0.05),
        (1.0, f64::INFINITY, 0.1, 0.05),
    ] {
        assert!(bounds(z, p, m, d).iter().all(|f| f.is_nan()), "{z} {p} {m} {d}");
    }
}

#[test]
fn a_camera_s_depths_and_pixels_agree_with_the_bounds() {
    for focus_distance in [3.0, 0.4, f64::INFINITY] {
        let camera = Camera { focus_distance, ..camera(128) };
        let [m, p, d] = view_geometry(&camera);
        let [nearest, farthest] = ghost_free_depths(&camera, VIEWS);
        assert!(nearest < focus_distance && focus_distance <= farthest);
        for z in (1..4000).map(|k| 0.01 * f64::from(k)) {
            let [f_min, f_max] = ghosting_bounds(z, p, m, d);
            let f = focus_distance - z;
            // Not on the bound itself, where rounding decides.
            if (f / f_min - 1.0).abs() < 1e-9 || (f / f_max - 1.0).abs() < 1e-9 {
                continue;
            }
            let is_ghost_free = f_min <= f && f <= f_max;
            let kappa = camera.optics().standard_kappa(1.0 / z);
            assert_eq!(copies_apart_px(&camera, kappa, VIEWS) <= 1.0, is_ghost_free, "{focus_distance} {z}");
            assert_eq!((nearest..=farthest).contains(&z), is_ghost_free, "{focus_distance} {z}");
        }
    }
    let camera = camera(128);
    assert_eq!(ghost_free_depths(&camera, 1), [0.0, f64::INFINITY], "one view has no neighbour");
    let pinhole = Camera { aperture_radius: 0.0, ..camera };
    assert_eq!(ghost_free_depths(&pinhole, VIEWS), [0.0, f64::INFINITY]);
}

/// A bright line, upright and as wide as a pixel, in the middle of the picture, at a depth where copies of it are `apart_px` apart.
fn line(camera: &Camera, apart_px: f64) -> std::sync::Arc<scene::Scene> {
    let kappa = apart_px / copies_apart_px(camera, 1.0, VIEWS);
    let z = 1.0 / (1.0 / camera.focus_distance - kappa);
    let pixel = pixel_at(camera, z);
    scene_of([(card([0.0, -2.0 * z], [pixel, 2.0 * z], z), unlit([1.0; 3]))])
}

/// Local maxima along the middle row that stand out from what lies between them by a tenth of the brightest.
fn maxima(picture: &Picture) -> usize {
    let width = picture.width as usize;
    let row = &picture.radiance[picture.height as usize / 2 * width..][..width];
    let row: Vec<f32> = row.iter().map(|rgb| rgb[1]).collect();
    let brightest = row.iter().copied().fold(0.0, f32::max);
    let (mut count, mut is_rising) = (0, true);
    let (mut high, mut low) = (0.0f32, 0.0f32);
    for value in row {
        if is_rising {
            high = high.max(value);
            if value < high - 0.1 * brightest {
                (count, is_rising, low) = (count + 1, false, value);
            }
        } else {
            low = low.min(value);
            if value > low + 0.1 * brightest {
                (is_rising, high) = (true, value);
            }
        }
    }
    count
}

#[test]
fn views_ghost_beyond_the_bound_and_the_light_field_does_not() {
    let aperture = lens::ApertureShape::Square.into();
    let camera = Camera { aperture, aperture_radius: 0.3, ..camera(96) };
    for (apart_px, ghosts) in [(0.5, false), (0.9, false), (4.0, true), (-4.0, true), (6.5, true)] {
        let scene = line(&camera, apart_px);
        let focus = unpainted(&scene);
        let tracer = Tracer::new(scene.clone());
        let options = ViewsOptions { views_a_side: VIEWS, rays_a_pixel: 16 };
        let light = BaseColor(scene.clone());
        let views = shift_and_add(&tracer, &light, &focus, &camera, &options, &Unwatched).unwrap();
        let hits = first_hits(&scene, &camera, &focus);
        let marked = beyond_ghosting_bound(&hits, &camera, VIEWS).unwrap();
        let on_line = (0..marked.len()).filter(|&k| hits.depth[k].is_finite());
        assert!(on_line.clone().count() > 50 && on_line.clone().all(|k| marked[k] == ghosts), "{apart_px}");
        // A copy for each of the views in a row.
        assert_eq!(maxima(&views), if ghosts { VIEWS as usize } else { 1 }, "{apart_px} px apart");
        assert_eq!(maxima(&splatted(&scene, &camera, &focus)), 1, "{apart_px} px apart, splatted");
    }
}

/// Where the copies of a line lie across the picture, px: the centroids of what black columns part.
fn copies(picture: &Picture) -> Vec<f64> {
    let width = picture.width as usize;
    let of_column =
        |x: usize| picture.radiance.iter().skip(x).step_by(width).map(|rgb| f64::from(rgb[1])).sum::<f64>();
    let columns: Vec<f64> = (0..width).map(of_column).collect();
    let mut places = Vec::new();
    let mut x = 0;
    for copy in columns.chunk_by(|a, b| (*a > 0.0) == (*b > 0.0)) {
        let light: f64 = copy.iter().sum();
        if light > 0.0 {
            let moment: f64 = copy.iter().zip(x..).map(|(light, x)| light * (x as f64 + 0.5)).sum();
            places.push(moment / light);
        }
        x += copy.len();
    }
    places
}

/// A picture from views of a line as wide as a pixel at depth z, focused at `focus_distance` by a long lens.
fn views_of_line(z: f64, focus_distance: f64) -> (Camera, Picture) {
    let aperture = lens::ApertureShape::Square.into();
    let camera = Camera {
        width: 320,
        height: 32,
        yfov: 0.007,
        sensor_height: 0.01,
        focus_distance,
        aperture,
        ..camera(320)
    };
    let pixel = pixel_at(&camera, z);
    let scene =
        scene_of([(card([0.137 * pixel, -40.0 * pixel], [1.137 * pixel, 40.0 * pixel], z), unlit([1.0; 3]))]);
    let options = ViewsOptions { views_a_side: VIEWS, rays_a_pixel: 64 };
    let tracer = Tracer::new(scene.clone());
    let focus = unpainted(&scene);
    let picture = shift_and_add(&tracer, &BaseColor(scene), &focus, &camera, &options, &Unwatched).unwrap();
    (camera, picture)
}

#[test]
fn copies_in_pictures_part_at_the_bounds() {
    for z in [1.2, 2.5, 6.0] {
        let (camera, picture) = views_of_line(z, z);
        assert_eq!(copies(&picture).len(), 1, "in focus all views show one line");
        let [m, p, d] = view_geometry(&camera);
        let expected = ghosting_bounds(z, p, m, d);
        for (bound, side) in expected.into_iter().zip([1.0, -1.0]) {
            // Copies 40 px apart, in front of the line and behind it.
            let kappa = side * 40.0 * p / (m * d);
            let focus_distance = 1.0 / (1.0 / z + kappa);
            assert!(focus_distance > 0.0, "{z}: the lens is long enough");
            let places = copies(&views_of_line(z, focus_distance).1);
            assert_eq!(places.len(), VIEWS as usize, "{z}: {places:?}");
            let apart_px = (places[3] - places[0]) / 3.0;
            // Where they would be a pixel apart: their distance grows with 1/s − 1/z from 0.
            let found = 1.0 / (1.0 / z + kappa / apart_px) - z;
            assert!(
                (found / bound - 1.0).abs() < 1e-3,
                "{z}: {found}, expected {bound}, {apart_px} px apart"
            );
            println!(
                "{z}: {found:.6}, expected {bound:.6}, {:+.4} %, {apart_px:.4} px apart",
                100.0 * (found / bound - 1.0)
            );
        }
        // Negative control: the bounds of a point a hundredth farther away.
        let other = ghosting_bounds(1.01 * z, p, m, d);
        assert!((0..2).all(|k| (other[k] / expected[k] - 1.0).abs() > 1e-3), "{other:?}");
    }
}
