//! Pictures against those of an independent implementation (`reference/make.py`), with wrong ones that must fail.
//!
//! The two differ in one thing: where splats let something of a ray through, we decode their un-premultiplied sum, so that rims do not darken
//! before a black background. The still life is closed.

use crate::comparison::{Reference, each_splat_decoded, interleaved, psnr_between, scalar_last};
use crate::encode::ply;
use crate::scene::{camera, focus, scattered, still_life};
use gaussians::{
    CloudBuilder, CloudTraits, ColorSpace, Eye, GaussianPicture, GaussianView, Placement, Splat,
    TruthOptions, median_depth, render_pinhole, render_truth,
};
use glam::{DVec2, DVec3, Quat, Vec3};
use lens::{Camera, FocusOffset};
use progress::Unwatched;
use serde_json::json;
use std::path::Path;

fn reference(name: &str) -> Reference {
    Reference::read(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/gaussians/reference").join(format!("{name}.npy")),
    )
}

fn truth(view: &GaussianView<'_>, focus: Option<&[FocusOffset]>) -> GaussianPicture {
    render_truth(view, focus, &TruthOptions::default(), &Unwatched).expect("not cancelled")
}

fn pinhole(view: &GaussianView<'_>) -> GaussianPicture {
    render_pinhole(view, 2, &Unwatched).expect("not cancelled")
}

#[test]
fn the_aperture_picture_is_that_of_the_reference() {
    let (cloud, camera) = (still_life(), camera());
    let view = GaussianView::new(&cloud, &Placement::IDENTITY, &camera);
    let [unpainted, painted] = [reference("truth"), reference("painted")];
    let ours = truth(&view, None);
    let offsets = focus(&cloud);
    let with_paint = truth(&view, Some(&offsets));
    let figures = [unpainted.psnr(&ours), painted.psnr(&with_paint), painted.normalised_psnr(&with_paint)];
    println!("unpainted {:.1} dB, painted {:.1} dB, normalised {:.1} dB", figures[0], figures[1], figures[2]);
    assert!(figures[0] >= 45.0 && figures[1] >= 42.0 && figures[2] >= 42.0, "{figures:?}");
    // Controls: the other one's picture, no aperture, blur by dilation.
    assert!(painted.psnr(&ours) < 42.0, "{}", painted.psnr(&ours));
    let no_aperture = unpainted.psnr(&pinhole(&view));
    let dilated = unpainted.psnr_of(&reference("dilated"));
    println!("controls: no aperture {no_aperture:.1} dB, dilated {dilated:.1} dB");
    assert!(no_aperture < 42.0 && dilated < 42.0, "{no_aperture} {dilated}");
}

#[test]
fn the_pinhole_picture_is_that_of_viewers() {
    let (cloud, camera) = (still_life(), camera());
    let view = GaussianView::new(&cloud, &Placement::IDENTITY, &camera);
    let ours = pinhole(&view);
    let [same, projected] =
        [reference("pinhole"), reference("projected")].map(|reference| reference.psnr(&ours));
    println!("same model {same:.1} dB, viewers' projection {projected:.1} dB");
    assert!(same >= 60.0 && projected >= 48.0, "{same} {projected}");
    let wrong = [
        ("each splat decoded", each_splat_decoded(&view)),
        (
            "coefficients interleaved",
            pinhole(&GaussianView::new(&interleaved(&cloud), &Placement::IDENTITY, &camera)),
        ),
        (
            "quaternion x y z w",
            pinhole(&GaussianView::new(&scalar_last(&cloud), &Placement::IDENTITY, &camera)),
        ),
    ];
    for (what, picture) in wrong {
        let decibels = reference("pinhole").psnr(&picture);
        println!("control, {what}: {decibels:.1} dB");
        assert!(decibels < 40.0, "{what}: {decibels}");
    }
}

/// Writes the scene for `reference/make.py` into the folder `$GAUSSIANS_SCENE`.
#[test]
#[ignore = "writes the scene that the reference pictures are made of"]
fn write_the_scene() {
    let folder = std::env::var("GAUSSIANS_SCENE").expect("set GAUSSIANS_SCENE to a folder");
    let write =
        |name: &str, bytes: &[u8]| std::fs::write(Path::new(&folder).join(name), bytes).expect("written");
    let camera = camera();
    let json = json!({
        "width": camera.width, "height": camera.height, "yfov": camera.yfov, "focus_distance": camera.focus_distance,
        "aperture_radius": camera.aperture_radius, "sensor_height": camera.sensor_height, "background": [0.0, 0.0, 0.0],
        "camera_to_world": [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]],
    });
    // As `focus` paints, by balls and depths in camera space.
    let paint = json!([
        {"t": 1, "anchor": 1, "where": {"z": [3.9, 99]}},
        {"t": 1.025, "anchor": 1, "where": {"z": [2.0, 3.2], "ball": [-1000.25, 0, 2.6, 1000.0]}},
    ]);
    write("scene.ply", &ply(&still_life()));
    write("camera.json", json.to_string().as_bytes());
    write("paint.json", paint.to_string().as_bytes());
}

/// A splat at `mean` in camera space, as a cloud of one.
fn one(mean: Vec3, size: f32, opacity: f32) -> gaussians::GaussianCloud {
    let mut builder = CloudBuilder::new(0, 1);
    let log_scale = Vec3::splat(size.ln());
    builder.push(
        Splat { mean, rotation: Quat::IDENTITY, log_scale, opacity, base_color: Vec3::splat(1.0) },
        &[],
    );
    builder.finish(CloudTraits::default())
}

#[test]
fn a_ball_responds_as_its_distance_from_the_ray() {
    let camera = Camera { height: 1_000_000, width: 1, ..camera() };
    let cloud = one(Vec3::new(0.3, 0.2, 3.0), 0.1, 0.8);
    let view = GaussianView::new(&cloud, &Placement::IDENTITY, &camera);
    let mean = DVec3::new(0.3, -0.2, 3.0);
    for u in [DVec2::ZERO, DVec2::new(0.1, -0.05)] {
        let eye = Eye::new(&view, u);
        for direction in [DVec3::new(0.1, -0.06, 1.0), DVec3::new(0.05, -0.02, 1.0)] {
            let from_eye = mean - u.extend(0.0);
            let along = from_eye.dot(direction) / direction.length_squared();
            let distance = (from_eye - along * direction).length();
            let alpha = 0.8 * (-0.5 * (distance / 0.1f64).powi(2)).exp();
            let hits = eye.hits(direction);
            assert_eq!(hits.len(), usize::from(alpha >= 1.0 / 255.0));
            let Some(hit) = hits.first() else { continue };
            assert!(
                (hit.alpha - alpha).abs() < 1e-5 && (hit.depth - along).abs() < 1e-6,
                "{hit:?} {alpha} {along}"
            );
            let step = 1e-6;
            let nudged = |axis: DVec3| 1.0 / eye.hits(direction + step * axis)[0].depth;
            let expected = DVec2::new(nudged(DVec3::X), nudged(DVec3::Y)) - 1.0 / hit.depth;
            let gradient = eye.inverse_depth_gradient(hit.splat, direction);
            assert!((gradient - expected / step).length() < 1e-4, "{gradient} {}", expected / step);
        }
    }
}

#[test]
fn responses_have_their_least_and_most() {
    let camera = camera();
    let at = |opacity: f32| {
        let cloud = one(Vec3::new(0.0, 0.0, 3.0), 0.1, opacity);
        let view = GaussianView::new(&cloud, &Placement::IDENTITY, &camera);
        Eye::new(&view, DVec2::ZERO).hits(DVec3::Z).first().map(|hit| hit.alpha)
    };
    assert_eq!(at(1.0), Some(0.99));
    assert!((at(0.5).unwrap() - 0.5).abs() < 1e-6);
    assert!(at(0.0041).is_some());
    // Behind the camera there is nothing.
    let cloud = one(Vec3::new(0.0, 0.0, -3.0), 0.1, 0.9);
    assert!(GaussianView::new(&cloud, &Placement::IDENTITY, &camera).is_empty());
}

#[test]
fn tiles_lose_no_splat() {
    let (cloud, camera) = (scattered(300, 1), Camera { width: 40, height: 30, ..camera() });
    let view = GaussianView::new(&cloud, &Placement::IDENTITY, &camera);
    let picture = render_pinhole(&view, 1, &Unwatched).expect("not cancelled");
    let eye = Eye::new(&view, DVec2::ZERO);
    for (index, alpha) in picture.alpha.iter().enumerate() {
        let pixel = DVec2::new((index % 40) as f64 + 0.5, (index / 40) as f64 + 0.5);
        let all: f64 = eye.hits(view.direction(DVec2::ZERO, pixel)).iter().map(|hit| hit.weight).sum();
        assert!((f64::from(*alpha) - all).abs() < 1e-5, "{pixel}: {alpha} {all}");
    }
}

#[test]
fn coverage_is_one_and_light_is_conserved() {
    let (cloud, camera) = (still_life(), Camera { background: Some([0.3, 0.2, 0.1]), ..camera() });
    let view = GaussianView::new(&cloud, &Placement::IDENTITY, &camera);
    let options = TruthOptions { aperture_points: 8, ..TruthOptions::default() };
    let render = |focus: Option<&[FocusOffset]>| {
        render_truth(&view, focus, &options, &Unwatched).expect("not cancelled")
    };
    let unpainted = render(None);
    assert!(unpainted.picture.coverage.iter().all(|coverage| (coverage - 1.0).abs() < 1e-5));
    // A focus that is everywhere standard is no paint, to the bit.
    assert!(render(Some(&vec![FocusOffset::STANDARD; cloud.len()])) == unpainted);
    // A blur that stays within the picture moves light and coverage, but makes none.
    let mut offsets = vec![FocusOffset::STANDARD; cloud.len()];
    for (offset, mean) in offsets.iter_mut().zip(cloud.means()) {
        if (mean - Vec3::new(-0.25, 0.1, 2.6)).length() < 0.5 {
            *offset = FocusOffset::new(1.012, 1.0);
        }
    }
    let painted = render(Some(&offsets));
    let sums = |picture: &GaussianPicture| {
        let light: f32 = picture.picture.radiance.iter().map(|rgb| rgb[1]).sum();
        (light, picture.picture.coverage.iter().sum::<f32>())
    };
    let (before, after) = (sums(&unpainted), sums(&painted));
    assert!(
        psnr_between(&unpainted, &painted) < 50.0,
        "the paint shows: {}",
        psnr_between(&unpainted, &painted)
    );
    assert!(
        (after.0 / before.0 - 1.0).abs() < 1e-3 && (after.1 / before.1 - 1.0).abs() < 1e-3,
        "{before:?} {after:?}"
    );
}

#[test]
fn threads_do_not_show() {
    let (cloud, camera) = (still_life(), camera());
    let view = GaussianView::new(&cloud, &Placement::IDENTITY, &camera);
    let offsets = focus(&cloud);
    let options = TruthOptions { aperture_points: 3, ..TruthOptions::default() };
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| render_truth(&view, Some(&offsets), &options, &Unwatched).expect("not cancelled"))
    };
    assert!(with(1) == with(3));
}

#[test]
fn linear_clouds_are_not_decoded() {
    let (cloud, camera) = (still_life(), camera());
    let linear = cloud.clone().with_traits(CloudTraits { color_space: ColorSpace::Linear, ..cloud.traits() });
    let view = GaussianView::new(&linear, &Placement::IDENTITY, &camera);
    let eye = Eye::new(&view, DVec2::ZERO);
    let pixel = DVec2::new(24.5, 18.5);
    let mut hits = eye.hits(view.direction(DVec2::ZERO, pixel));
    let sum: Vec3 = hits.iter().map(|hit| hit.weight as f32 * eye.color(hit.splat)).sum();
    let picture = render_pinhole(&view, 1, &Unwatched).expect("not cancelled");
    let radiance = Vec3::from_array(picture.picture.radiance[18 * 48 + 24]);
    assert!((radiance - sum).abs().max_element() < 1e-6, "{radiance} {sum}");
    assert!(median_depth(&mut hits).is_some_and(|depth| depth > 1.0 && depth < 4.5));
}

#[test]
fn clouds_are_placed_with_scale() {
    // Twice as large and twice as far away from the camera's centre: the same pinhole picture.
    let (cloud, camera) = (scattered(200, 2), camera());
    let here = pinhole(&GaussianView::new(&cloud, &Placement::IDENTITY, &camera));
    let placement = Placement { scale: DVec3::splat(2.0), ..Placement::IDENTITY };
    let larger = pinhole(&GaussianView::new(&cloud, &placement, &camera));
    assert!(psnr_between(&here, &larger) > 100.0);
}
