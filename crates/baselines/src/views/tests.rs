use super::*;
use crate::test_light::*;
use progress::Unwatched;
use std::sync::Arc;
use test_scenes::{scene_of, unlit};

fn picture(scene: &Arc<scene::Scene>, focus: &ByPart, camera: &Camera, views_a_side: u32) -> Picture {
    let tracer = Tracer::new(scene.clone());
    let options = ViewsOptions { views_a_side, rays_a_pixel: 4 };
    shift_and_add(&tracer, &BaseColor(scene.clone()), focus, camera, &options, &Unwatched).unwrap()
}

#[test]
fn a_wall_stays_uniform_at_every_focus() {
    let scene = scene_of([(wall(5.0), unlit([0.5, 0.25, 2.0]))]);
    for focus_distance in [0.7, 5.0, f64::INFINITY] {
        let camera = Camera { focus_distance, ..camera(30) };
        let found = picture(&scene, &unpainted(&scene), &camera, 3);
        for (rgb, coverage) in found.radiance.iter().zip(&found.coverage) {
            let expected = [0.5, 0.25, 2.0];
            (0..3).for_each(|c| assert!((rgb[c] - expected[c]).abs() < 1e-5, "{rgb:?}"));
            assert!((coverage - 1.0).abs() < 1e-5);
        }
    }
}

#[test]
fn a_point_becomes_its_circle_and_keeps_its_energy() {
    let camera = camera(128);
    let optics = camera.optics();
    for (z, (t, anchor)) in [(8.0, (1.0, 0.0)), (1.5, (1.0, 0.0)), (3.0, (1.1, 1.0)), (6.0, (0.9, 0.3))] {
        let offset = FocusOffset::new(t, anchor);
        let scene = scene_of([(spot(&camera, DVec2::splat(64.0), 8.0, z), unlit([1.0; 3]))]);
        let focus = ByPart(scene.clone(), vec![offset]);
        let found = picture(&scene, &focus, &camera, 16);
        assert!((energy(&found) / 64.0 - 1.0).abs() < 0.02, "at {z}: {}", energy(&found));
        let disc = optics.splat_radius_px(optics.kappa(1.0 / z, offset));
        // The second moments of the spot and of a pixel add to the disc's.
        let expected = (disc * disc + (64.0 + 1.0) / 3.0).sqrt();
        let radius = disc_radius(&found);
        assert!((radius / expected - 1.0).abs() < 0.02, "at {z}: {radius} px, expected {expected}");
    }
}

#[test]
fn a_single_view_is_the_pinhole_picture() {
    let camera = camera(48);
    let scene = scene_of([(spot(&camera, DVec2::splat(20.0), 8.0, 9.0), unlit([1.0; 3]))]);
    let found = picture(&scene, &unpainted(&scene), &camera, 1);
    assert_eq!(found, first_hits(&scene, &camera, &unpainted(&scene)).picture());
}

#[test]
fn partial_occlusion_is_seen() {
    // A spot far away, hidden from half of the aperture by a black card whose edge is on its chief ray.
    let camera = camera(64);
    let spot = spot(&camera, DVec2::splat(32.0), 4.0, 9.0);
    let free = scene_of([(spot.clone(), unlit([1.0; 3]))]);
    let card = card([-2.0, -2.0], [0.0, 2.0], 1.5);
    let hidden = scene_of([(spot, unlit([1.0; 3])), (card, unlit([0.0; 3]))]);
    let [all, half] = [free, hidden].map(|scene| energy(&picture(&scene, &unpainted(&scene), &camera, 8)));
    assert!((half / all - 0.5).abs() < 0.02, "{half} of {all}");
}

#[test]
fn threads_leave_no_trace() {
    let camera = camera(70);
    let near = card([-0.1, -2.0], [0.02, 2.0], 1.5);
    let scene = scene_of([(near, unlit([0.9, 0.2, 0.1])), (wall(7.0), unlit([0.1, 0.3, 0.7]))]);
    let focus = ByPart(scene.clone(), vec![FocusOffset::new(1.05, 0.6), FocusOffset::STANDARD]);
    let [one, many] = on_few_and_many_threads(|| picture(&scene, &focus, &camera, 3));
    assert_eq!(one, many);
}

#[test]
fn what_cannot_be_is_refused_and_what_is_unwanted_stops() {
    let camera = camera(16);
    let scene = scene_of([(wall(5.0), unlit([1.0; 3]))]);
    let (tracer, light, focus) = (Tracer::new(scene.clone()), BaseColor(scene.clone()), unpainted(&scene));
    let with = |views_a_side, rays_a_pixel| {
        let options = ViewsOptions { views_a_side, rays_a_pixel };
        shift_and_add(&tracer, &light, &focus, &camera, &options, &Unwatched)
    };
    assert!(matches!(with(0, 2), Err(BaselineError::Option { option: "views a side", .. })));
    assert!(matches!(with(2, 257), Err(BaselineError::Option { option: "rays a pixel", .. })));
    let options = ViewsOptions::default();
    let found = shift_and_add(&tracer, &light, &focus, &camera, &options, &Unwanted);
    assert_eq!(found, Err(BaselineError::Cancelled));
}
