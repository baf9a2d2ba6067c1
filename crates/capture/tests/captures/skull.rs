//! The real capture of the shared reference data: 66 photographs of a skull, its cameras as text and as binary, its mesh.

use crate::made::open;
use capture::{CameraFormat, recognise};
use scene::{LoadOptions, View};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The folder of the capture; prints a line if it is absent.
fn skull() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/photogrammetry/skull");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("SKIPPED: there is no {}", folder.display());
    None
}

#[test]
fn it_opens_without_options() {
    let Some(folder) = skull() else { return };
    assert_eq!(recognise(&folder), Some(CameraFormat::Colmap));
    let start = Instant::now();
    let capture = open(&folder).unwrap();
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
    println!(
        "{:?}, {} views, {} triangles",
        start.elapsed(),
        capture.views.len(),
        capture.scene.triangles.len()
    );
    assert_eq!((capture.views.len(), capture.scene.triangles.len()), (66, 29_984));
    assert!(capture.cameras.ends_with("sparse_bin/images.bin") && capture.mesh.ends_with("mesh.ply"));
    assert!(capture.remarks.iter().all(|remark| !remark.is_incomplete), "{:?}", capture.remarks);
    assert!(capture.scene.materials[0].unlit && capture.scene.materials[0].double_sided);
    // The camera was moved around an upright skull: the up direction of its world is none of the axes.
    let up = capture.upright.inverse() * glam::DVec3::Y;
    let tilts: Vec<f64> = capture.views.iter().map(|view| view.up().dot(up)).collect();
    assert!(tilts.iter().sum::<f64>() / 66.0 > 0.7, "{tilts:?}");
}

#[test]
fn text_and_binary_are_the_same_cameras() {
    let Some(folder) = skull() else { return };
    let binary = open(&folder).unwrap();
    let copy = tempfile::tempdir().unwrap();
    for inner in ["images", "sparse_txt"] {
        std::fs::create_dir(copy.path().join(inner)).unwrap();
        for entry in std::fs::read_dir(folder.join(inner)).unwrap().flatten() {
            std::fs::copy(entry.path(), copy.path().join(inner).join(entry.file_name())).unwrap();
        }
    }
    std::fs::copy(folder.join("mesh.ply"), copy.path().join("mesh.ply")).unwrap();
    let text = open(copy.path()).unwrap();
    assert!(text.cameras.ends_with("sparse_txt/images.txt"));
    for (a, b) in text.views.iter().zip(&binary.views) {
        assert_eq!((&a.name, a.lens, a.exposure_hint), (&b.name, b.lens, b.exposure_hint));
        assert!(a.camera_to_world.abs_diff_eq(b.camera_to_world, 1e-12), "{}", a.name);
    }
}

#[test]
fn its_mesh_lies_inside_its_pictures() {
    let Some(folder) = skull() else { return };
    let capture = open(&folder).unwrap();
    let is_visible =
        |view: &View, point| view.project(point).is_some_and(|pixel| view.lens.is_in_picture(pixel));
    let vertices: Vec<_> = capture.scene.positions.iter().step_by(50).copied().collect();
    for view in &capture.views {
        let visible = vertices.iter().filter(|vertex| is_visible(view, **vertex)).count();
        let share = visible as f64 / vertices.len() as f64;
        assert!(share > 0.5, "{}: {share}", view.name);
        // There and back.
        let pixel = view.project(vertices[0]).unwrap();
        let toward = (vertices[0] - view.position()).normalize();
        assert!(view.direction(pixel).unwrap().abs_diff_eq(toward, 1e-12), "{}", view.name);
    }
}

#[test]
fn the_skull_is_where_its_mesh_is() {
    // It is bright before a dark background: the mesh and the bright pixels overlap; with mirrored or rotated poses they
    // would do so less.
    let Some(folder) = skull() else { return };
    let capture = open(&folder).unwrap();
    for view in capture.views.iter().step_by(5) {
        let picture = view.read_photograph(&LoadOptions::default()).unwrap();
        let [width, height] = [picture.width, picture.height].map(i64::from);
        let mut covered = vec![false; (width * height) as usize];
        for position in &capture.scene.positions {
            let Some(pixel) = view.project(*position).filter(|pixel| view.lens.is_in_picture(*pixel)) else {
                continue;
            };
            // A few pixels around each vertex.
            for (x, y) in (-5..=5).flat_map(|y| (-5..=5).map(move |x| (x, y))) {
                let (x, y) = (pixel.x as i64 + x, pixel.y as i64 + y);
                if (0..width).contains(&x) && (0..height).contains(&y) {
                    covered[(y * width + x) as usize] = true;
                }
            }
        }
        let overlap = |from: &dyn Fn(i64, i64) -> [i64; 2]| {
            let (mut both, mut either) = (0, 0);
            for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                let [from_x, from_y] = from(x, y);
                let is_bright = picture.pixels[(y * width + x) as usize][1] > 0.02;
                let is_covered = covered[(from_y * width + from_x) as usize];
                both += i32::from(is_bright && is_covered);
                either += i32::from(is_bright || is_covered);
            }
            f64::from(both) / f64::from(either)
        };
        let right = overlap(&|x, y| [x, y]);
        let wrong = [overlap(&|x, y| [width - 1 - x, y]), overlap(&|x, y| [x, height - 1 - y])];
        println!("{}: {right:.3}, mirrored {wrong:.3?}", view.name);
        assert!(right > 0.6 && wrong.iter().all(|wrong| right > *wrong), "{}", view.name);
    }
}
