use super::*;
use crate::test_light::*;
use progress::Unwatched;
use std::sync::Arc;
use test_scenes::{scene_of, unlit};

fn picture(scene: &Arc<scene::Scene>, focus: &ByPart, camera: &Camera, rays_a_sample: u32) -> Picture {
    let salf = light_field(scene, camera, focus);
    scatter_rays(&salf, camera, focus, &ScatterOptions { rays_a_sample, seed: 0 }, &Unwatched).unwrap()
}

/// The root mean square of the difference of radiances.
fn rmse(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.radiance.iter().flatten().zip(b.radiance.iter().flatten());
    (pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>() / (3 * a.radiance.len()) as f64).sqrt()
}

#[test]
fn a_sharp_wall_is_exact_and_a_defocused_one_uniform_up_to_noise() {
    let scene = scene_of([(wall(3.0), unlit([0.5, 0.25, 2.0]))]);
    let sharp = picture(&scene, &unpainted(&scene), &camera(40), 16);
    for (rgb, coverage) in sharp.radiance.iter().zip(&sharp.coverage) {
        assert_eq!((*rgb, *coverage), ([0.5, 0.25, 2.0], 1.0), "every ray stays in its pixel");
    }
    let focus = ByPart(scene.clone(), vec![FocusOffset::new(1.1, 1.0)]);
    let off_by = |rays| {
        let found = picture(&scene, &focus, &camera(40), rays);
        found.coverage.iter().map(|c| f64::from(c - 1.0).powi(2)).sum::<f64>().sqrt() / 40.0
    };
    let (few, many) = (off_by(16), off_by(1024));
    assert!(few < 0.25 && many < 0.03, "{few} {many}");
}

#[test]
fn a_point_becomes_its_circle_and_keeps_its_energy() {
    let camera = camera(128);
    let optics = camera.optics();
    for (z, (t, anchor)) in [(8.0, (1.0, 0.0)), (1.5, (1.0, 0.0)), (3.0, (1.1, 1.0)), (6.0, (0.9, 0.3))] {
        let offset = FocusOffset::new(t, anchor);
        let scene = scene_of([(spot(&camera, DVec2::splat(64.0), 8.0, z), unlit([1.0; 3]))]);
        let found = picture(&scene, &ByPart(scene.clone(), vec![offset]), &camera, 256);
        assert!((energy(&found) / 64.0 - 1.0).abs() < 1e-3, "at {z}: {}", energy(&found));
        let disc = optics.splat_radius_px(optics.kappa(1.0 / z, offset));
        let expected = (disc * disc + (64.0 + 1.0) / 3.0).sqrt();
        let radius = disc_radius(&found);
        assert!((radius / expected - 1.0).abs() < 0.01, "at {z}: {radius} px, expected {expected}");
    }
}

/// Occlusion, a smaller stop and a shaped aperture: more rays come ever closer to the splat.
#[test]
fn it_converges_to_the_splat() {
    let baked = Camera { aperture: lens::ApertureShape::Square.into(), ..camera(64) };
    let near = card([-0.3, -0.5], [0.02, 0.2], 1.7);
    let scene = scene_of([(near, unlit([0.9, 0.2, 0.1])), (wall(6.0), unlit([0.1, 0.3, 0.7]))]);
    let focus = ByPart(scene.clone(), vec![FocusOffset::new(0.95, 0.5), FocusOffset::STANDARD]);
    let salf = light_field(&scene, &baked, &focus);
    let polygon = lens::ApertureShape::Polygon { blades: 5, rotation: 0.2, roundness: 0.3 };
    let camera = Camera { aperture: polygon.into(), aperture_radius: 0.12, focus_distance: 2.5, ..baked };
    let mut splatter = splat::Splatter::new(salf.clone());
    splatter.render(&camera, &focus, &Unwatched).unwrap();
    let off_by = |rays_a_sample| {
        let options = ScatterOptions { rays_a_sample, seed: 3 };
        rmse(&scatter_rays(&salf, &camera, &focus, &options, &Unwatched).unwrap(), splatter.picture())
    };
    let (few, many) = (off_by(8), off_by(2048));
    assert!(many < 0.012 && few > 3.0 * many, "{few} with few rays, {many} with many");
    // Negative control: the other focus is another picture.
    splatter.render(&camera, &unpainted(&scene), &Unwatched).unwrap();
    let unlike = scatter_rays(&salf, &camera, &focus, &ScatterOptions::default(), &Unwatched).unwrap();
    assert!(rmse(&unlike, splatter.picture()) > 0.03);
}

#[test]
fn threads_leave_no_trace_and_seeds_differ() {
    let camera = camera(70);
    let near = card([-0.1, -2.0], [0.02, 2.0], 1.5);
    let scene = scene_of([(near, unlit([0.9, 0.2, 0.1])), (wall(7.0), unlit([0.1, 0.3, 0.7]))]);
    let focus = unpainted(&scene);
    let salf = light_field(&scene, &camera, &focus);
    let with = |seed| {
        let options = ScatterOptions { rays_a_sample: 32, seed };
        scatter_rays(&salf, &camera, &focus, &options, &Unwatched).unwrap()
    };
    let [one, many] = on_few_and_many_threads(|| with(0));
    assert_eq!(one, many);
    assert_ne!(with(0), with(1));
}

#[test]
fn what_cannot_be_is_refused_and_what_is_unwanted_stops() {
    let camera = camera(16);
    let scene = scene_of([(wall(5.0), unlit([1.0; 3]))]);
    let focus = unpainted(&scene);
    let salf = light_field(&scene, &camera, &focus);
    let options = ScatterOptions::default();
    let none = ScatterOptions { rays_a_sample: 0, seed: 0 };
    let found = scatter_rays(&salf, &camera, &focus, &none, &Unwatched);
    assert!(matches!(found, Err(BaselineError::Option { option: "rays a sample", .. })));
    let wider = Camera { aperture_radius: 0.2, ..camera.clone() };
    let found = scatter_rays(&salf, &wider, &focus, &options, &Unwatched);
    assert!(matches!(found, Err(BaselineError::Option { option: "aperture radius", .. })));
    let larger = Camera { width: 17, ..camera.clone() };
    let found = scatter_rays(&salf, &larger, &focus, &options, &Unwatched);
    assert!(matches!(found, Err(BaselineError::OtherCamera { .. })));
    assert_eq!(scatter_rays(&salf, &camera, &focus, &options, &Unwanted), Err(BaselineError::Cancelled));
}
