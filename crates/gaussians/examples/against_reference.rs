//! Compares our pictures with those of an independent implementation, and with wrong ones that must fail.
//!
//! ```text
//! against_reference SCENE.ply SCENE.camera.json [PAINT.json] --pictures DIR
//! ```
//!
//! DIR has `NAME.truth.npy` (64 views through the aperture), `NAME.painted.npy`, `NAME.pinhole.npy`, `NAME.ewa.npy` (as viewers project
//! splats, decoded) and `NAME.dilated*.npy` (blurred by dilation), height × width × 4 floats each: linear radiance and coverage.

#[path = "../tests/gaussians/camera_file.rs"]
mod camera_file;
#[path = "../tests/gaussians/comparison.rs"]
#[allow(dead_code, reason = "shared with the tests, which compare pictures of our own, too")]
mod comparison;

use camera_file::{number, read_camera, read_json};
use comparison::{Reference, each_splat_decoded, interleaved, scalar_last};
use gaussians::{
    GaussianCloud, GaussianPicture, GaussianView, Placement, ReadOptions, TruthOptions, open, render_pinhole,
    render_truth,
};
use glam::{DVec3, Vec3};
use lens::{Camera, FocusOffset};
use progress::Unwatched;
use serde_json::Value;
use std::path::Path;
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, camera, rest @ ..] = &arguments[..] else { panic!("SCENE CAMERA [PAINT] --pictures DIR") };
    let (paint, folder) = match rest {
        [flag, folder] if flag == "--pictures" => (None, folder),
        [paint, flag, folder] if flag == "--pictures" => (Some(paint), folder),
        _ => panic!("SCENE CAMERA [PAINT] --pictures DIR"),
    };
    let scene = Path::new(scene);
    let name = scene.file_stem().expect("a file").to_string_lossy().into_owned();
    let reference = |kind: &str| Reference::read(&Path::new(folder).join(format!("{name}.{kind}.npy")));
    let begun = Instant::now();
    let file = open(scene, &ReadOptions::default(), &Unwatched).unwrap_or_else(|e| panic!("{e}"));
    let cloud = &file.cloud;
    println!(
        "{name}: {} splats of degree {}, opened in {:.2?}",
        cloud.len(),
        cloud.degree(),
        begun.elapsed()
    );
    let camera = read_camera(Path::new(camera));
    let view = GaussianView::new(cloud, &Placement::IDENTITY, &camera);
    let truth = reference("truth");
    let compare = |what: &str, picture: &GaussianPicture, reference: &Reference, floor: Option<f64>| {
        let decibels = reference.psnr(picture);
        let verdict = floor.map_or("", |floor| if decibels >= floor { "holds" } else { "FAILS" });
        println!("  {what:<44} {decibels:6.2} dB  {verdict}");
    };

    let begun = Instant::now();
    let ours = render_truth(&view, None, &TruthOptions::default(), &Unwatched).expect("not cancelled");
    compare("aperture, unpainted, 45 dB", &ours, &truth, Some(45.0));
    println!("    in {:.2?}", begun.elapsed());
    if let Some(paint) = paint {
        let focus = read_paint(Path::new(paint), cloud, &camera);
        let begun = Instant::now();
        let ours =
            render_truth(&view, Some(&focus), &TruthOptions::default(), &Unwatched).expect("not cancelled");
        compare("aperture, painted, conserved, 42 dB", &ours, &reference("painted"), Some(42.0));
        println!("    in {:.2?}", begun.elapsed());
        println!("    normalised {:.2} dB", reference("painted").normalised_psnr(&ours));
    }
    let pinhole = render_pinhole(&view, 2, &Unwatched).expect("not cancelled");
    compare("pinhole against the same model", &pinhole, &reference("pinhole"), None);
    compare("pinhole against viewers' projection, 48 dB", &pinhole, &reference("ewa"), Some(48.0));

    println!("  controls, which must fail:");
    for kind in ["dilated_half", "dilated", "dilated_double"] {
        println!("    {kind:<42} {:6.2} dB of the aperture's truth", truth.psnr_of(&reference(kind)));
    }
    let pinhole_reference = reference("pinhole");
    let control = |what: &str, picture: &GaussianPicture| {
        println!("    {what:<42} {:6.2} dB of the pinhole's", pinhole_reference.psnr(picture));
    };
    control("each splat decoded", &each_splat_decoded(&view));
    for (what, wrong) in
        [("coefficients interleaved", interleaved(cloud)), ("quaternion x y z w", scalar_last(cloud))]
    {
        let view = GaussianView::new(&wrong, &Placement::IDENTITY, &camera);
        control(what, &render_pinhole(&view, 2, &Unwatched).expect("not cancelled"));
    }
}

/// `[{"t": x, "anchor": a, "where": {"z": [near, far]} | {"ball": [x, y, z, r]}}]`, in camera space, by the means of splats.
fn read_paint(file: &Path, cloud: &GaussianCloud, camera: &Camera) -> Vec<FocusOffset> {
    let json = read_json(file);
    let entries = json.as_array().expect("a list");
    let offset = |mean: &Vec3| {
        let point = camera.camera_from_world(mean.as_dvec3());
        let is_painted = |entry: &&Value| {
            let (z, ball) = (&entry["where"]["z"], &entry["where"]["ball"]);
            let in_z = z.is_null() || (point.z > number(&z[0]) && point.z < number(&z[1]));
            let center = || DVec3::from_array([0, 1, 2].map(|k| number(&ball[k])));
            in_z && (ball.is_null() || point.distance(center()) < number(&ball[3]))
        };
        let entry = entries.iter().rfind(is_painted);
        entry.map_or(FocusOffset::STANDARD, |e| {
            FocusOffset::new(number(&e["t"]), e["anchor"].as_f64().unwrap_or(0.0))
        })
    };
    cloud.means().iter().map(offset).collect()
}
