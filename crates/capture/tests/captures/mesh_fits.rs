//! Whether a mesh fits its photographs: right meshes are not doubted, wrong ones are, and nerfstudio's are moved to their cameras.

use crate::made::{Camera, open};
use capture::{Capture, CaptureOptions, MeshFit};
use glam::{DMat3, DMat4, DQuat, DVec3};
use progress::Unwatched;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A folder of the shared data; prints a line if it is absent.
fn shared(folder: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(folder);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("SKIPPED: there is no {}", folder.display());
    None
}

/// The mesh of a capture after a motion, as a PLY file.
fn moved_mesh(capture: &Capture, motion: DMat4) -> String {
    let scene = &capture.scene;
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        scene.positions.len(),
        scene.triangles.len()
    );
    for position in &scene.positions {
        let DVec3 { x, y, z } = motion.transform_point3(*position);
        writeln!(text, "{x} {y} {z}").unwrap();
    }
    for triangle in &scene.triangles {
        let [a, b, c] = triangle.vertices;
        writeln!(text, "3 {a} {b} {c}").unwrap();
    }
    text
}

fn open_with_mesh(folder: &Path, mesh: &Path) -> Capture {
    let options = CaptureOptions { mesh: Some(mesh.into()), ..CaptureOptions::default() };
    capture::open(folder, &options, &Unwatched).unwrap()
}

/// The remark that a mesh does not fit.
fn misfit(capture: &Capture) -> Option<&str> {
    let told =
        |text: &&str| text.contains("does not fit the photographs") || text.contains("shows anything of it");
    capture.remarks.iter().map(|remark| remark.text.as_str()).find(told)
}

/// Motions that make a right mesh wrong, with their names; `symmetric` for a place that some of them leave as it is.
fn wrong_motions(capture: &Capture, symmetric: bool) -> Vec<(&'static str, DMat4)> {
    let (low, high) = capture.scene.bounds();
    let (middle, extent) = (0.5 * (low + high), (high - low).max_element());
    let about_middle =
        |motion: DMat4| DMat4::from_translation(middle) * motion * DMat4::from_translation(-middle);
    let quarter = std::f64::consts::FRAC_PI_2;
    let shift = |direction: DVec3| DMat4::from_translation(0.1 * extent * direction);
    let mut motions = vec![
        ("turned about x", about_middle(DMat4::from_rotation_x(quarter))),
        ("turned about z", about_middle(DMat4::from_rotation_z(quarter))),
        ("turned about the origin", DMat4::from_rotation_x(quarter)),
        ("smaller", about_middle(DMat4::from_scale(DVec3::splat(0.8)))),
        ("larger", about_middle(DMat4::from_scale(DVec3::splat(1.25)))),
        ("shifted along y", shift(DVec3::Y)),
        ("mirrored in y", about_middle(DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0)))),
    ];
    if !symmetric {
        motions.extend([
            ("turned about y", about_middle(DMat4::from_rotation_y(quarter))),
            ("smaller, of the origin", DMat4::from_scale(DVec3::splat(0.8))),
            ("shifted along x", shift(DVec3::X)),
            ("shifted along z", shift(DVec3::Z)),
            ("mirrored in x", about_middle(DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)))),
        ]);
    }
    motions
}

/// Checks a right capture, and its mesh after wrong motions.
fn assert_told_apart(folder: &Path, symmetric: bool) -> MeshFit {
    let start = Instant::now();
    let right = open(folder).unwrap();
    println!("{}: {:?}, {:?}", folder.display(), right.fit, start.elapsed());
    let place = tempfile::tempdir().unwrap();
    let mesh = place.path().join("wrong.ply");
    let mut failures = Vec::new();
    for (name, motion) in wrong_motions(&right, symmetric) {
        std::fs::write(&mesh, moved_mesh(&right, motion)).unwrap();
        let wrong = open_with_mesh(folder, &mesh);
        println!("  {name}: {:?}", wrong.fit);
        if misfit(&wrong).is_none() {
            failures.push(name);
        }
    }
    assert_eq!(misfit(&right), None);
    assert!(failures.is_empty(), "{}: not noticed: {failures:?}", folder.display());
    right.fit.unwrap()
}

#[test]
fn the_skull() {
    let Some(folder) = shared("data/photogrammetry/skull") else { return };
    assert!(assert_told_apart(&folder, false).agreement > 0.5);
}

#[test]
fn a_box_on_the_ground_in_five_small_pictures() {
    let Some(folder) = shared("cases/field2/06-metashape-as-it-is-exported/base") else { return };
    // A quarter turn about y, and mirrored in x, it is the same; most of it is the ground, which may be shifted along itself.
    assert!(assert_told_apart(&folder, true).agreement > 0.9);
}

#[test]
fn a_mesh_of_another_capture() {
    let Some(skull) = shared("data/photogrammetry/skull") else { return };
    let Some(base) = shared("cases/field2/06-metashape-as-it-is-exported/base") else { return };
    for (folder, mesh) in [(&skull, base.join("mesh.ply")), (&base, skull.join("mesh.ply"))] {
        let capture = open_with_mesh(folder, &mesh);
        println!("{}: {:?}", mesh.display(), capture.fit);
        assert!(misfit(&capture).is_some(), "{:?}", capture.remarks);
    }
}

#[test]
fn nerfstudios_mesh_is_moved_to_its_cameras() {
    let Some(folder) = shared("cases/field2/06-metashape-as-it-is-exported/base") else { return };
    let right = open(&folder).unwrap();
    let copy = tempfile::tempdir().unwrap();
    for inner in ["images", "sparse/0"] {
        std::fs::create_dir_all(copy.path().join(inner)).unwrap();
        for entry in std::fs::read_dir(folder.join(inner)).unwrap().flatten() {
            std::fs::copy(entry.path(), copy.path().join(inner).join(entry.file_name())).unwrap();
        }
    }
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0);
    let [scale, transform] = [0.37, 1.0].map(|scale| {
        DMat4::from_scale(DVec3::splat(scale))
            * DMat4::from_rotation_translation(turn, DVec3::new(0.2, -0.1, 0.4))
    });
    std::fs::write(copy.path().join("poisson_mesh.ply"), moved_mesh(&right, scale)).unwrap();
    let told = open(copy.path()).unwrap();
    assert!(
        misfit(&told).is_some_and(|text| text.contains("dataparser_transforms.json")),
        "{:?}",
        told.remarks
    );
    let rows = transform.transpose().to_cols_array_2d();
    let rows = &rows[..3];
    let parser = copy.path().join("dataparser_transforms.json");
    std::fs::write(&parser, format!("{{\"transform\": {rows:?}, \"scale\": 0.37}}")).unwrap();
    let moved = open(copy.path()).unwrap();
    assert_eq!(misfit(&moved), None, "{:?}", moved.remarks);
    let note =
        moved.remarks.iter().find(|remark| remark.text.contains("was moved to that of the cameras")).unwrap();
    assert!(!note.is_incomplete, "{note}");
    for (a, b) in moved.scene.positions.iter().zip(&right.scene.positions) {
        assert!(a.abs_diff_eq(*b, 1e-9), "{a} instead of {b}");
    }
    for (a, b) in moved.views.iter().zip(&right.views) {
        assert_eq!(a.camera_to_world, b.camera_to_world);
    }
    // A right mesh stays where it is, whatever the file says.
    std::fs::copy(folder.join("mesh.ply"), copy.path().join("mesh.ply")).unwrap();
    let kept = open(copy.path()).unwrap();
    assert!(kept.scene.positions == right.scene.positions && misfit(&kept).is_none(), "{:?}", kept.remarks);
    assert!(!kept.remarks.iter().any(|remark| remark.text.contains("was moved")), "{:?}", kept.remarks);
}

/// Six photographs of a smooth wall, with COLMAP's cameras; the mesh is a quadrilateral at `z` of so many units to each side.
fn wall(folder: &Path, half: f64, z: f64) {
    const SIZE: [u32; 2] = [120, 80];
    const FOCAL: f64 = 100.0;
    let radiance = |x: f64, y: f64| {
        let wave = |k: f64| 0.3 + 0.2 * (k * x).sin() * (1.3 * k * y).cos();
        [wave(3.0), wave(2.0), 0.5 * wave(1.5) + 0.1]
    };
    let mut cameras = Vec::new();
    std::fs::create_dir_all(folder.join("images")).unwrap();
    for k in 0..6 {
        let angle = f64::from(k) * 1.1;
        let center = DVec3::new(0.6 * angle.cos(), 0.4 * angle.sin(), 2.0);
        let forward = -center.normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let axes = DMat3::from_cols(right, forward.cross(right), forward);
        let name = format!("{k}.png");
        let stops = 0.2 * (f64::from(k) - 2.5);
        let picture = image::RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
            let at = |at: u32, side: u32| (f64::from(at) + 0.5 - f64::from(side) / 2.0) / FOCAL;
            let direction = axes * DVec3::new(at(x, SIZE[0]), at(y, SIZE[1]), 1.0);
            let place = center - direction * (center.z / direction.z);
            let encoded = |linear: f64| 1.055 * (linear * stops.exp2()).min(1.0).powf(1.0 / 2.4) - 0.055;
            image::Rgb(radiance(place.x, place.y).map(|linear| (encoded(linear) * 255.0).round() as u8))
        });
        picture.save(folder.join("images").join(&name)).unwrap();
        cameras.push(Camera { name, rotation: DQuat::from_mat3(&axes).inverse(), center });
    }
    let model = folder.join("sparse/0");
    std::fs::create_dir_all(&model).unwrap();
    let [width, height] = SIZE;
    std::fs::write(
        model.join("cameras.txt"),
        format!("1 PINHOLE {width} {height} {FOCAL} {FOCAL} {} {}\n", width / 2, height / 2),
    )
    .unwrap();
    let lines =
        cameras.iter().enumerate().map(|(id, camera)| format!("{}\n\n", camera.colmap_line(id + 1, 1)));
    std::fs::write(model.join("images.txt"), lines.collect::<String>()).unwrap();
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
         property list uchar int vertex_indices\nend_header\n-{half} -{half} {z}\n{half} -{half} {z}\n{half} {half} {z}\n-{half} {half} {z}\n\
         4 0 1 2 3\n"
    );
    std::fs::write(folder.join("mesh.ply"), ply).unwrap();
}

#[test]
fn a_smooth_wall_of_any_extent() {
    for half in [3.0, 3000.0, 3e6] {
        let folder = tempfile::tempdir().unwrap();
        wall(folder.path(), half, 0.0);
        let right = open(folder.path()).unwrap();
        println!("{half}: {:?}", right.fit);
        assert!(right.remarks.is_empty(), "{half}: {:?}", right.remarks);
        assert!(right.fit.unwrap().agreement > 0.6);
        wall(folder.path(), half, 0.5);
        let wrong = open(folder.path()).unwrap();
        println!("{half}, shifted: {:?}", wrong.fit);
        assert!(misfit(&wrong).is_some(), "{half}: {:?}", wrong.fit);
        wall(folder.path(), half, 4.0);
        let unseen = open(folder.path()).unwrap();
        assert!(
            misfit(&unseen).is_some_and(|text| text.contains("no picture shows")),
            "{:?} {:?}",
            unseen.fit,
            unseen.remarks
        );
    }
}
