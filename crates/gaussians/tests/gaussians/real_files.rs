//! Files of other programs.

use crate::comparison::psnr_between;
use gaussians::{Axes, GaussianView, Placement, ReadOptions, SplatFile, SplatFormat, open, render_pinhole};
use glam::{DMat4, DVec3, EulerRot};
use lens::Camera;
use progress::Unwatched;
use std::path::{Path, PathBuf};

fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/splats").join(name);
    if path.exists() {
        return Some(path);
    }
    println!("SKIPPED: there is no {}", path.display());
    None
}

fn opened(path: &Path) -> SplatFile {
    open(path, &ReadOptions::default(), &Unwatched).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn small_files_have_their_splats() {
    for (name, format, count, degree) in [
        ("minimal-v2.spz", SplatFormat::Spz, 4, 0),
        ("minimal-v3.spz", SplatFormat::Spz, 4, 0),
        ("minimal-v4.spz", SplatFormat::Spz, 4, 0),
        ("minimal.splat", SplatFormat::Splat, 4, 0),
        ("minimal.ksplat", SplatFormat::Ksplat, 4, 0),
        ("model.ply", SplatFormat::Ply, 9, 3),
        ("model.spz", SplatFormat::Spz, 9, 3),
        ("playbot_3_0", SplatFormat::SogFolder, 31_000, 2),
        ("guitar.compressed.ply", SplatFormat::CompressedPly, 90_854, 0),
    ] {
        let Some(path) = shared(name) else { continue };
        let file = opened(&path);
        assert_eq!(
            (file.format, file.cloud.file_rows(), file.cloud.degree()),
            (format, count, degree),
            "{name}"
        );
    }
}

#[test]
fn two_versions_of_spz_agree() {
    let (Some(third), Some(fourth)) = (shared("minimal-v3.spz"), shared("minimal-v4.spz")) else { return };
    assert_eq!(opened(&third).cloud, opened(&fourth).cloud);
}

#[test]
fn a_standard_file_and_its_spz_agree() {
    let (Some(ply), Some(spz)) = (shared("model.ply"), shared("model.spz")) else { return };
    let [ply, spz] = [opened(&ply), opened(&spz)].map(|file| file.cloud);
    let turn = Axes::RIGHT_DOWN_FORWARD.to_gltf();
    let same = |k: usize| {
        let upright = (turn * ply.splat(k).mean.as_dvec3()).as_vec3();
        let as_it_is = ply.splat(k).mean;
        let distance = |mean: glam::Vec3| (mean - spz.splat(k).mean).abs().max_element();
        (distance(upright) < 1e-2, distance(as_it_is) < 1e-2)
    };
    // The writer may have left the axes as they were: either all are turned, or none.
    let pairs: Vec<_> = (0..ply.len()).map(same).collect();
    assert!(pairs.iter().all(|p| p.0) || pairs.iter().all(|p| p.1), "{pairs:?}");
}

/// A scan as a compressed PLY, y down, and as SPZ, y up: each by its own axes, the pictures are the same.
#[test]
fn a_scan_in_two_formats_is_one_picture() {
    let (Some(ply), Some(spz)) = (shared("biker.compressed.ply"), shared("biker.spz")) else { return };
    let [ply, spz] = [opened(&ply), opened(&spz)].map(|file| file.cloud);
    assert_eq!((ply.file_rows(), spz.file_rows()), (152_746, 152_746));
    let pose = DMat4::from_euler(EulerRot::YXZ, 0.4, -0.2, 0.0);
    let center = DVec3::new(0.0, 0.9, 0.0);
    let position = center + pose.transform_vector3(DVec3::new(0.0, 0.0, 4.0));
    let camera = Camera {
        width: 80,
        height: 60,
        yfov: 0.7,
        camera_to_world: DMat4::from_translation(position) * pose,
        ..Camera::default()
    };
    let picture = |cloud: &gaussians::GaussianCloud, axes: Axes| {
        let view = GaussianView::new(cloud, &Placement::upright(axes), &camera);
        render_pinhole(&view, 2, &Unwatched).expect("not cancelled")
    };
    let reference = picture(&ply, ply.traits().axes);
    let alpha = reference.alpha.iter().sum::<f32>() / reference.alpha.len() as f32;
    assert!(alpha > 0.05, "the scan is in the picture: {alpha}");
    let decibels = psnr_between(&reference, &picture(&spz, spz.traits().axes));
    println!("biker, compressed PLY against SPZ: {decibels:.1} dB");
    assert!(decibels >= 35.0, "{decibels}");
    // Control: upside down.
    let decibels = psnr_between(&reference, &picture(&spz, Axes::RIGHT_DOWN_FORWARD));
    assert!(decibels < 30.0, "{decibels}");
}
