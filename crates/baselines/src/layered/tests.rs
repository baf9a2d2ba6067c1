use super::*;
use crate::test_light::*;
use glam::DVec2;
use lens::FocusOffset;
use progress::Unwatched;
use test_scenes::{scene_of, unlit};

fn picture(scene: &std::sync::Arc<scene::Scene>, camera: &Camera, layers: u32) -> Picture {
    let hits = first_hits(scene, camera, &unpainted(scene));
    layered_blur(&hits, camera, &LayeredOptions { layers }, &Unwatched).unwrap()
}

#[test]
fn a_defocused_wall_stays_uniform() {
    let scene = scene_of([(wall(8.0), unlit([0.5, 0.25, 2.0]))]);
    let found = picture(&scene, &camera(40), 8);
    for (rgb, coverage) in found.radiance.iter().zip(&found.coverage) {
        let expected = [0.5, 0.25, 2.0];
        (0..3).for_each(|c| assert!((rgb[c] - expected[c]).abs() < 1e-5, "{rgb:?}"));
        assert!((coverage - 1.0).abs() < 1e-5);
    }
}

#[test]
fn a_point_becomes_its_circle_and_keeps_its_energy() {
    let camera = camera(96);
    let optics = camera.optics();
    for (z, focus) in [(8.0, (1.0, 0.0)), (1.6, (1.0, 0.0)), (3.0, (1.1, 1.0))] {
        let focus = FocusOffset::new(focus.0, focus.1);
        // Before a black wall of the same focus.
        let spot = spot(&camera, DVec2::splat(48.5), 3.0, z);
        let scene = scene_of([(spot, unlit([1.0; 3])), (wall(z * 1.0001), unlit([0.0; 3]))]);
        let hits = first_hits(&scene, &camera, &ByPart(scene.clone(), vec![focus]));
        let found = layered_blur(&hits, &camera, &LayeredOptions { layers: 1 }, &Unwatched).unwrap();
        assert!((energy(&found) / energy(&hits.picture()) - 1.0).abs() < 1e-4);
        let disc = optics.splat_radius_px(optics.kappa(1.0 / z, focus));
        let expected = (disc * disc + (9.0 + 1.0) / 3.0).sqrt();
        let radius = disc_radius(&found);
        assert!((radius - expected).abs() < 0.15, "at {z}: {radius} px, expected {expected}");
    }
}

/// What layers are for: the wall behind does not bleed into what is sharp before it, as it does when gathered.
#[test]
fn a_sharp_card_keeps_its_edge() {
    let camera = camera(64);
    let card = card([-2.0, -2.0], [0.0, 2.0], 3.0);
    let scene = scene_of([(card, unlit([0.0; 3])), (wall(30.0), unlit([1.0; 3]))]);
    let found = picture(&scene, &camera, 16);
    let row = |x: usize| found.radiance[32 * 64 + x][0] / found.coverage[32 * 64 + x];
    assert!(row(31) == 0.0 && row(32) > 0.9, "{} beside {}", row(31), row(32));
}

#[test]
fn layers_of_paint_are_cut_apart() {
    let camera = camera(128);
    // Two cards of one depth, the left one painted sharp although the lens focuses elsewhere.
    let [left, right] = [48.5, 80.5].map(|x| spot(&camera, DVec2::new(x, 64.5), 3.0, 8.0));
    let black = unlit([0.0; 3]);
    let scene = scene_of([(left, unlit([1.0; 3])), (right, unlit([1.0; 3])), (wall(8.01), black)]);
    let focus = ByPart(scene.clone(), vec![FocusOffset::SHARP, FocusOffset::STANDARD]);
    let hits = first_hits(&scene, &camera, &focus);
    let found = layered_blur(&hits, &camera, &LayeredOptions { layers: 4 }, &Unwatched).unwrap();
    let at = |x: usize| found.radiance[64 * 128 + x][0];
    assert!(at(48) > 0.9, "painted sharp: {}", at(48));
    assert!(at(80) < 0.1 && at(80) > 0.05, "unpainted: {}", at(80));
}

#[test]
fn what_cannot_be_is_refused_and_what_is_unwanted_stops() {
    let camera = camera(16);
    let hits = FirstHits::background(16, 16);
    let with = |layers| layered_blur(&hits, &camera, &LayeredOptions { layers }, &Unwatched);
    assert!(matches!(with(0), Err(BaselineError::Option { option: "layers", .. })));
    assert!(matches!(with(257), Err(BaselineError::Option { .. })));
    let options = LayeredOptions::default();
    let other = FirstHits::background(16, 17);
    let found = layered_blur(&other, &camera, &options, &Unwatched);
    assert_eq!(found, Err(BaselineError::OtherCamera { actual: [16, 17], camera: [16, 16] }));
    let broken = Camera { yfov: f64::NAN, ..camera.clone() };
    assert!(matches!(layered_blur(&hits, &broken, &options, &Unwatched), Err(BaselineError::Camera(_))));
    assert_eq!(layered_blur(&hits, &camera, &options, &Unwanted), Err(BaselineError::Cancelled));
}
