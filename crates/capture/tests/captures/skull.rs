//! The real capture of the shared reference data: 66 photographs of a skull, its cameras as text and as binary, its mesh.

use crate::made::open;
use capture::{Kind, recognise};
use scene::{LoadOptions, View};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The folder of the capture; says so loudly if it is absent.
fn skull() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/photogrammetry/skull");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("SKIPPED: there is no {}", folder.display());
    None
}

#[test]
fn it_opens_without_a_word_of_help() {
    let Some(folder) = skull() else { return };
    assert_eq!(recognise(&folder), Some(Kind::Colmap));
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
    // The camera was moved about a skull that stood upright: its world's up is none of the axes.
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
    let is_seen =
        |view: &View, point| view.project(point).is_some_and(|pixel| view.lens.is_in_picture(pixel));
    let vertices: Vec<_> = capture.scene.positions.iter().step_by(50).copied().collect();
    for view in &capture.views {
        let seen = vertices.iter().filter(|vertex| is_seen(view, **vertex)).count();
        let share = seen as f64 / vertices.len() as f64;
        assert!(share > 0.5, "{}: {share}", view.name);
        // There and back.
        let pixel = view.project(vertices[0]).unwrap();
        let toward = (vertices[0] - view.position()).normalize();
        assert!(view.direction(pixel).unwrap().abs_diff_eq(toward, 1e-12), "{}", view.name);
    }
}

#[test]
fn the_skull_is_where_its_mesh_is() {
    // The background is dark: pixels that the mesh covers are brighter than those about it; mirrored or turned poses would not have it so.
    let Some(folder) = skull() else { return };
    let capture = open(&folder).unwrap();
    for view in capture.views.iter().step_by(11) {
        let picture = view.photograph(&LoadOptions::default()).unwrap();
        let [width, height] = [picture.width, picture.height];
        let mut covered = vec![false; (width * height) as usize];
        for position in &capture.scene.positions {
            let Some(pixel) = view.project(*position).filter(|pixel| view.lens.is_in_picture(*pixel)) else {
                continue;
            };
            // A few pixels about each vertex.
            for (x, y) in (-6..=6).flat_map(|y| (-6..=6).map(move |x| (x, y))) {
                let (x, y) = (pixel.x as i64 + x, pixel.y as i64 + y);
                if (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y) {
                    covered[(y * i64::from(width) + x) as usize] = true;
                }
            }
        }
        let mean = |inside: bool, flip: bool| {
            let index = |pixel: usize| if flip { covered.len() - 1 - pixel } else { pixel };
            let values =
                picture.pixels.iter().enumerate().filter(|(pixel, _)| covered[index(*pixel)] == inside);
            let (sum, count) =
                values.fold((0.0, 0), |(sum, count), (_, rgb)| (sum + f64::from(rgb[1]), count + 1));
            sum / f64::from(count)
        };
        let contrast = |flip| mean(true, flip) / mean(false, flip);
        println!("{}: {:.2}, turned over {:.2}", view.name, contrast(false), contrast(true));
        assert!(contrast(false) > 1.5 * contrast(true), "{}", view.name);
    }
}
