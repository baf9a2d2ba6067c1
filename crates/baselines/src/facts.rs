//! Three facts of a wide aperture that a blur of the pinhole picture cannot show. The light field is held against closed
//! forms; the blurs fail, as documented.

use crate::test_light::*;
use crate::{LayeredOptions, gather_blur, layered_blur};
use glam::DVec2;
use lens::{Camera, Picture};
use progress::Unwatched;
use scene::Scene;
use std::f64::consts::PI;
use std::sync::Arc;
use test_scenes::{scene_of, unlit};

/// The share of a unit disc on one side of a chord at signed distance `c` from its centre.
fn segment(c: f64) -> f64 {
    let c = c.clamp(-1.0, 1.0);
    (c.acos() - c * (1.0 - c * c).sqrt()) / PI
}

fn gathered(scene: &Arc<Scene>, camera: &Camera) -> Picture {
    gather_blur(&first_hits(scene, camera, &unpainted(scene)), camera, &Unwatched).unwrap()
}

fn cut_to_layers(scene: &Arc<Scene>, camera: &Camera) -> Picture {
    layered_blur(
        &first_hits(scene, camera, &unpainted(scene)),
        camera,
        &LayeredOptions::default(),
        &Unwatched,
    )
    .unwrap()
}

/// A spot at depth 9 in the middle of the picture, and a black card at depth 1.5 that is open to the right of x = `edge`.
fn half_hidden(camera: &Camera, edge: Option<f64>) -> Arc<Scene> {
    let spot = (spot(camera, DVec2::splat(48.0), 2.0, 9.0), unlit([1.0; 3]));
    match edge {
        None => scene_of([spot]),
        Some(edge) => scene_of([spot, (card([-3.0, -3.0], [edge, 3.0], 1.5), unlit([0.0; 3]))]),
    }
}

/// The share of the aperture that the spot sees past the edge: a ray to U passes depth 1.5 at U·(1 − 1.5/9).
fn visible_share(camera: &Camera, edge: f64) -> f64 {
    segment(edge / (1.0 - 1.5 / 9.0) / camera.aperture_radius)
}

#[test]
fn a_half_occluded_point_dims_accordingly() {
    let camera = camera(96);
    let free =
        energy(&splatted(&half_hidden(&camera, None), &camera, &unpainted(&half_hidden(&camera, None))));
    for edge in [-0.09, -0.03, 0.0, 0.05, 0.1] {
        let scene = half_hidden(&camera, Some(edge));
        let measured = energy(&splatted(&scene, &camera, &unpainted(&scene))) / free;
        let expected = visible_share(&camera, edge);
        assert!((measured - expected).abs() < 0.025, "edge at {edge}: {measured}, expected {expected}");
    }
}

#[test]
fn blurs_see_a_half_occluded_point_whole_or_not_at_all() {
    let camera = camera(96);
    let brightest = |picture: Picture| picture.radiance.iter().map(|rgb| rgb[1]).fold(0.0, f32::max);
    // The chief ray passes the edge, a third of the aperture does not.
    let (free, passing) = (half_hidden(&camera, None), half_hidden(&camera, Some(-0.04)));
    assert!(visible_share(&camera, -0.04) < 0.72);
    let ratio = brightest(gathered(&passing, &camera)) / brightest(gathered(&free, &camera));
    assert_eq!(ratio, 1.0, "the gathered point does not dim");
    // The chief ray is stopped, a third of the aperture sees the point.
    let stopped = half_hidden(&camera, Some(0.04));
    assert!(visible_share(&camera, 0.04) > 0.28);
    assert_eq!(energy(&gathered(&stopped, &camera)), 0.0);
    assert_eq!(energy(&cut_to_layers(&stopped, &camera)), 0.0);
}

#[test]
fn a_light_outside_the_frame_shows_within_its_circle_of_confusion() {
    let camera = Camera { aperture_radius: 0.4, ..camera(96) };
    let optics = camera.optics();
    let radius = optics.splat_radius_px(optics.standard_kappa(1.0 / 9.0));
    for outside in [2.5, 5.0, radius - 4.0] {
        let scene = scene_of([(spot(&camera, DVec2::new(-outside, 48.0), 2.0, 9.0), unlit([8.0; 3]))]);
        let measured = energy(&splatted(&scene, &camera, &unpainted(&scene)));
        // Of the spot's 4 px² of radiance 8, the part of the circles of its points that reaches in.
        let reaching = |k: u32| segment((outside - 1.0 + (f64::from(k) + 0.5) / 8.0) / radius);
        let expected = 32.0 * (0..16).map(reaching).sum::<f64>() / 16.0;
        assert!(
            (measured - expected).abs() < 0.015 * 32.0,
            "{outside} px outside: {measured}, expected {expected}"
        );
        assert_eq!(energy(&gathered(&scene, &camera)), 0.0);
        assert_eq!(energy(&cut_to_layers(&scene, &camera)), 0.0);
    }
    // Farther outside than its circle reaches, it does not show.
    let scene = scene_of([(spot(&camera, DVec2::new(-radius - 3.0, 48.0), 2.0, 9.0), unlit([8.0; 3]))]);
    assert_eq!(energy(&splatted(&scene, &camera, &unpainted(&scene))), 0.0);
}

/// Depth of the fence, period of its black slats and how wide they are.
const FENCE: (f64, f64, f64) = (0.6, 0.03, 0.012);

/// A white wall in focus with a green stripe, seen through a fence of upright slats.
fn fenced(camera: &Camera) -> Arc<Scene> {
    let (depth, period, slat) = FENCE;
    let (black, white, green) = (unlit([0.0; 3]), unlit([1.0; 3]), unlit([0.0, 1.0, 0.0]));
    let z = camera.focus_distance;
    let mut parts = vec![(wall(z), white), (card([0.2, -9.0], [0.3, 9.0], z * 0.9999), green)];
    parts.extend((-30..30).map(|k| {
        let left = f64::from(k) * period;
        (card([left, -2.0], [left + slat, 2.0], depth), black.clone())
    }));
    scene_of(parts)
}

/// The share of the aperture that a wall point at `x` sees between the slats: a disc less its strips.
fn visible_between_slats(camera: &Camera, x: f64) -> f64 {
    let (depth, period, slat) = FENCE;
    let z = camera.focus_distance;
    // Where the disc of rays passes the fence.
    let (center, radius) = (x * depth / z, camera.aperture_radius * (1.0 - depth / z));
    let hidden: f64 = (-30..30)
        .map(|k| f64::from(k) * period)
        .map(|left| segment((left - center) / radius) - segment((left + slat - center) / radius))
        .sum();
    1.0 - hidden
}

#[test]
fn a_fence_close_to_the_lens_becomes_see_through() {
    let camera = camera(96);
    let scene = fenced(&camera);
    let picture = splatted(&scene, &camera, &unpainted(&scene));
    let blurred = gathered(&scene, &camera);
    let pixel = pixel_at(&camera, camera.focus_distance);
    let (mut worst, mut worst_blurred) = (0.0f64, 0.0f64);
    for x in 4..92 {
        let place = (x as f64 + 0.5 - 48.0) * pixel;
        let (green, red) = (picture.radiance[48 * 96 + x][1], picture.radiance[48 * 96 + x][0]);
        let expected = visible_between_slats(&camera, place);
        worst = worst.max((f64::from(green) - expected).abs());
        worst_blurred = worst_blurred.max((f64::from(blurred.radiance[48 * 96 + x][1]) - expected).abs());
        // The stripe behind the fence is green all along, but for the pixels of its edges.
        let from_edge = (place - 0.2).abs().min((place - 0.3).abs());
        if from_edge > pixel {
            let is_stripe = (0.2..0.3).contains(&place);
            assert_eq!(f64::from(red) < 0.02, is_stripe, "{place}: {red}");
        }
    }
    assert!(worst < 0.02, "off by {worst} from the disc less its strips");
    assert!(worst_blurred > 0.3, "the blur keeps the wall between slats as it is: off by {worst_blurred}");
}
