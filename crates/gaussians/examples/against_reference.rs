//! Compares our pictures with those of an independent implementation, and with wrong ones that must fail.
//!
//! ```text
//! against_reference SCENE.ply SCENE.camera.json [PAINT.json] --pictures DIR
//! ```
//!
//! DIR has `NAME.truth.npy` (64 views through the aperture), `NAME.painted.npy`, `NAME.pinhole.npy`, `NAME.ewa.npy` (as viewers project
//! splats, decoded) and `NAME.dilated*.npy` (blurred by dilation), height × width × 4 floats each: linear radiance and coverage.

use gaussians::{
    Eye, GaussianCloud, GaussianPicture, GaussianView, Placement, ReadOptions, TruthOptions, cloud::CloudBuilder, open,
    render_pinhole, render_truth,
};
use glam::{DMat4, DVec2, DVec3, Quat, Vec3};
use half::f16;
use lens::{Camera, FocusOffset};
use progress::Unwatched;
use serde_json::Value;
use std::path::{Path, PathBuf};
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
    println!("{name}: {} splats of degree {}, opened in {:.2?}", cloud.len(), cloud.degree(), begun.elapsed());
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
        let ours = render_truth(&view, Some(&focus), &TruthOptions::default(), &Unwatched).expect("not cancelled");
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
    for (what, wrong) in [("coefficients interleaved", interleaved(cloud)), ("quaternion x y z w", rotated(cloud))] {
        let view = GaussianView::new(&wrong, &Placement::IDENTITY, &camera);
        control(what, &render_pinhole(&view, 2, &Unwatched).expect("not cancelled"));
    }
}

/// A picture of the other implementation.
struct Reference {
    rgbc: Vec<[f32; 4]>,
}

impl Reference {
    /// Reads an array of little-endian floats as numpy writes it.
    fn read(file: &PathBuf) -> Self {
        let bytes = std::fs::read(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let header = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        let text = String::from_utf8_lossy(&bytes[10..10 + header]);
        assert!(text.contains("'<f4'") && text.contains("'fortran_order': False"), "{text}");
        let floats = bytes[10 + header..].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        let floats: Vec<f32> = floats.collect();
        Self { rgbc: floats.chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect() }
    }

    fn psnr(&self, picture: &GaussianPicture) -> f64 {
        let rgb = |k: usize| picture.picture.radiance[k];
        psnr((0..self.rgbc.len()).map(|k| (rgb(k), [self.rgbc[k][0], self.rgbc[k][1], self.rgbc[k][2]])))
    }

    fn normalised_psnr(&self, picture: &GaussianPicture) -> f64 {
        let normal = |rgb: [f32; 3], coverage: f32| rgb.map(|c| c / coverage.max(1e-3));
        psnr((0..self.rgbc.len()).map(|k| {
            let [r, g, b, coverage] = self.rgbc[k];
            (normal(picture.picture.radiance[k], picture.picture.coverage[k]), normal([r, g, b], coverage))
        }))
    }

    fn psnr_of(&self, other: &Self) -> f64 {
        let rgb = |p: [f32; 4]| [p[0], p[1], p[2]];
        psnr(self.rgbc.iter().zip(&other.rgbc).map(|(a, b)| (rgb(*a), rgb(*b))))
    }
}

/// Of linear values in [0, 1], dB.
fn psnr(pairs: impl ExactSizeIterator<Item = ([f32; 3], [f32; 3])>) -> f64 {
    let count = 3.0 * pairs.len() as f64;
    let square = |(a, b): (f32, f32)| f64::from(a.clamp(0.0, 1.0) - b.clamp(0.0, 1.0)).powi(2);
    let error: f64 = pairs.map(|(a, b)| a.into_iter().zip(b).map(square).sum::<f64>()).sum();
    -10.0 * (error / count).max(1e-12).log10()
}

fn read_json(file: &Path) -> Value {
    let text = std::fs::read(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    serde_json::from_slice(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn read_camera(file: &Path) -> Camera {
    let json = read_json(file);
    let pose = &json["camera_to_world"];
    let rows: Vec<f64> = (0..16).map(|k| number(&pose[k / 4][k % 4])).collect();
    Camera {
        width: number(&json["width"]) as u32,
        height: number(&json["height"]) as u32,
        yfov: number(&json["yfov"]),
        focus_distance: json["focus_distance"].as_f64().unwrap_or(f64::INFINITY),
        aperture_radius: number(&json["aperture_radius"]),
        sensor_height: number(&json["sensor_height"]),
        camera_to_world: DMat4::from_cols_slice(&rows).transpose(),
        background: Some([0, 1, 2].map(|k| number(&json["background"][k]))),
        ..Camera::default()
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
        entry.map_or(FocusOffset::STANDARD, |e| FocusOffset::new(number(&e["t"]), e["anchor"].as_f64().unwrap_or(0.0)))
    };
    cloud.means().iter().map(offset).collect()
}

/// The pinhole's picture if the colour of each splat were decoded, instead of the sum of a ray.
fn each_splat_decoded(view: &GaussianView<'_>) -> GaussianPicture {
    let mut picture = render_pinhole(view, 1, &Unwatched).expect("not cancelled");
    let eye = Eye::new(view, DVec2::ZERO);
    let colors: Vec<Vec3> = (0..view.len() as u32).map(|splat| eye.decoded(eye.color(splat))).collect();
    let width = view.camera().width as usize;
    for (index, radiance) in picture.picture.radiance.iter_mut().enumerate() {
        let pixel = DVec2::new((index % width) as f64 + 0.5, (index / width) as f64 + 0.5);
        let hits = eye.hits(view.direction(DVec2::ZERO, pixel));
        let sum: Vec3 = hits.iter().map(|hit| hit.weight as f32 * colors[hit.splat as usize]).sum();
        *radiance = sum.to_array();
    }
    picture
}

/// The cloud, its splats changed.
fn changed(cloud: &GaussianCloud, change: impl Fn(usize, Vec<f32>) -> (Quat, Vec<f32>)) -> GaussianCloud {
    let mut builder = CloudBuilder::new(cloud.degree(), cloud.len());
    for index in 0..cloud.len() {
        let coefficients = cloud.coefficients(index).iter().copied().map(f16::to_f32).collect();
        let (rotation, coefficients) = change(index, coefficients);
        builder.push(gaussians::Splat { rotation, ..cloud.splat(index) }, &coefficients);
    }
    builder.finish(cloud.traits())
}

/// As if the coefficients of a colour were beside each other in the file.
fn interleaved(cloud: &GaussianCloud) -> GaussianCloud {
    changed(cloud, |index, values| {
        let count = values.len() / 3;
        let in_file = |k: usize| values[k % count * 3 + k / count];
        (cloud.splat(index).rotation, (0..values.len()).map(in_file).collect())
    })
}

/// As if the file's four numbers of a rotation were x y z w.
fn rotated(cloud: &GaussianCloud) -> GaussianCloud {
    changed(cloud, |index, values| {
        let q = cloud.splat(index).rotation;
        (Quat::from_xyzw(q.w, q.x, q.y, q.z), values)
    })
}
