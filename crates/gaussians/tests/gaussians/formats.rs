//! A scene in every format opens to the same splats and the same picture.

use crate::comparison::psnr_between;
use crate::encode::{
    Numbers, SpzVersion, compressed_ply, ksplat, ply, ply_in_other_order, raw_splat, sog_files, spz, zipped,
};
use crate::read_bytes;
use crate::scene::{camera, scattered};
use gaussians::{
    Axes, CloudTraits, ColorSpace, GaussianCloud, GaussianPicture, GaussianView, GltfAttributes, Placement,
    ReadOptions, Splat, SplatFile, SplatFormat, open, read_gltf_attributes, render_pinhole,
};
use progress::Unwatched;
use serde_json::json;
use std::path::Path;

fn picture(cloud: &GaussianCloud, axes: Axes) -> GaussianPicture {
    // Whatever the axes of the file, the scene stands as that of the camera.
    let to_scene = Axes::RIGHT_DOWN_FORWARD.to_gltf().transpose() * axes.to_gltf();
    let placement = Placement { rotation: to_scene, ..Placement::IDENTITY };
    let camera = camera();
    render_pinhole(&GaussianView::new(cloud, &placement, &camera), 2, &Unwatched).expect("not cancelled")
}

/// How near the file is to the original: the largest difference of a mean, and the picture's, dB.
fn differences(original: &GaussianCloud, file: &SplatFile) -> (f32, f64) {
    let cloud = &file.cloud;
    assert_eq!(cloud.len(), original.len());
    let distances = original.means().iter().zip(cloud.means()).map(|(a, b)| (*a - *b).abs().max_element());
    let reference = picture(original, original.traits().axes);
    let decibels = psnr_between(&reference, &picture(cloud, cloud.traits().axes));
    (distances.fold(0.0, f32::max), decibels)
}

/// Reads bytes and checks how near they are to the scene of a degree.
fn check(
    bytes: &[u8],
    name: &str,
    format: SplatFormat,
    original: &GaussianCloud,
    reach: f32,
    floor: f64,
) -> SplatFile {
    let file = read_bytes(bytes, name).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(file.format, format, "{name}");
    assert_eq!(file.cloud.degree(), original.degree(), "{name}");
    assert_eq!(file.warnings, [""; 0], "{name}");
    let (distance, decibels) = differences(original, &file);
    println!("{name}: {distance:.2e}, {decibels:.1} dB");
    assert!(distance <= reach && decibels >= floor, "{name}: {distance} {decibels} dB");
    file
}

#[test]
fn standard_ply() {
    for degree in 0..=4 {
        let original = scattered(150, degree);
        let file = check(&ply(&original), "scene.ply", SplatFormat::Ply, &original, 0.0, 100.0);
        assert_eq!(file.cloud.traits(), original.traits());
    }
}

#[test]
fn properties_are_taken_by_name() {
    let original = scattered(150, 2);
    for numbers in [Numbers::Ascii, Numbers::BigEndianDoubles, Numbers::LittleEndianFloats] {
        let bytes = ply_in_other_order(&original, numbers);
        check(&bytes, "scene.ply", SplatFormat::Ply, &original, 1e-6, 100.0);
    }
}

#[test]
fn compressed_plys() {
    for (degree, has_color_ranges) in [(0, false), (0, true), (1, true), (3, true)] {
        let original = scattered(300, degree);
        let bytes = compressed_ply(&original, has_color_ranges);
        check(&bytes, "scene.ply", SplatFormat::CompressedPly, &original, 2e-3, 35.0);
    }
}

#[test]
fn spz_of_all_versions() {
    for degree in 0..=4 {
        let original = scattered(150, degree);
        for version in [SpzVersion::One, SpzVersion::Two, SpzVersion::Three, SpzVersion::Four] {
            let bytes = spz(&original, version);
            let file = read_bytes(&bytes, "scene.spz").unwrap_or_else(|e| panic!("{e}"));
            assert!(file.cloud.traits().is_antialiased);
            assert_eq!(file.warnings, [""; 0]);
            // The first three have no axes but right, up, back; the fourth says that they are the scene's.
            let expected =
                if version == SpzVersion::Four { Axes::RIGHT_DOWN_FORWARD } else { Axes::RIGHT_UP_BACK };
            assert_eq!(file.cloud.traits().axes, expected);
            let cloud = file.cloud.clone().with_traits(original.traits());
            let (distance, decibels) = differences(&original, &SplatFile { cloud, ..file });
            println!("{version:?} of degree {degree}: {distance:.2e}, {decibels:.1} dB");
            assert!(distance < 2e-3 && decibels >= 35.0, "{version:?} {degree}: {distance} {decibels}");
        }
    }
}

#[test]
fn axes_of_a_file_turn_splats_and_colours_together() {
    // The same scene with y and z of all reversed: half a turn about x, which changes the sign of y and z of a rotation's axis.
    let original = scattered(150, 3);
    let mut turned = gaussians::CloudBuilder::new(3, original.len());
    for index in 0..original.len() {
        let splat = original.splat(index);
        let half_turn = glam::Quat::from_xyzw(1.0, 0.0, 0.0, 0.0);
        let values: Vec<f32> = original.coefficients(index).iter().map(|x| x.to_f32()).collect();
        // Harmonics that are odd in y and z together change their sign.
        let signs = [-1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, -1.0, 1.0, -1.0, 1.0];
        let values: Vec<f32> = values.iter().enumerate().map(|(k, x)| x * signs[k / 3]).collect();
        let mean = half_turn * splat.mean;
        turned.push(Splat { mean, rotation: half_turn * splat.rotation, ..splat }, &values);
    }
    let traits = gaussians::CloudTraits { axes: Axes::RIGHT_UP_BACK, ..original.traits() };
    let turned = turned.finish(traits);
    let reference = picture(&original, original.traits().axes);
    let decibels = psnr_between(&reference, &picture(&turned, Axes::RIGHT_UP_BACK));
    assert!(decibels > 90.0, "{decibels}");
    // Control: turned means and rotations, colours as they were.
    let mut wrong = gaussians::CloudBuilder::new(3, original.len());
    for index in 0..original.len() {
        let values: Vec<f32> = original.coefficients(index).iter().map(|x| x.to_f32()).collect();
        wrong.push(turned.splat(index), &values);
    }
    let decibels = psnr_between(&reference, &picture(&wrong.finish(traits), Axes::RIGHT_UP_BACK));
    assert!(decibels < 45.0, "{decibels}");
}

/// The cloud as one that was trained so, or not.
fn antialiased(cloud: GaussianCloud, is_antialiased: bool) -> GaussianCloud {
    let traits = CloudTraits { is_antialiased, ..cloud.traits() };
    cloud.with_traits(traits)
}

#[test]
fn sog_archives_and_folders() {
    for version in [1, 2] {
        for degree in 0..=3 {
            let original = antialiased(scattered(150, degree), version == 2);
            let files = sog_files(&original, version);
            let file = check(&zipped(&files), "scene.sog", SplatFormat::Sog, &original, 2e-3, 35.0);
            assert_eq!(file.cloud.traits().is_antialiased, version == 2);
            let folder = tempfile::tempdir().expect("a temporary folder");
            for (name, bytes) in &files {
                std::fs::write(folder.path().join(name), bytes).expect("the folder can be written");
            }
            for path in [folder.path().to_path_buf(), folder.path().join("meta.json")] {
                let in_folder =
                    open(&path, &ReadOptions::default(), &Unwatched).unwrap_or_else(|e| panic!("{e}"));
                assert_eq!((in_folder.format, &in_folder.cloud), (SplatFormat::SogFolder, &file.cloud));
            }
        }
    }
}

#[test]
fn sog_archives_with_a_folder_inside() {
    let original = antialiased(scattered(50, 1), true);
    let files: Vec<_> =
        sog_files(&original, 2).into_iter().map(|(name, bytes)| (format!("scan/{name}"), bytes)).collect();
    check(&zipped(&files), "scene.zip", SplatFormat::Sog, &original, 2e-3, 35.0);
}

#[test]
fn raw_splats() {
    let original = scattered(150, 0);
    check(&raw_splat(&original), "scene.splat", SplatFormat::Splat, &original, 0.0, 35.0);
    check(&raw_splat(&original), "scene", SplatFormat::Splat, &original, 0.0, 35.0);
}

#[test]
fn ksplats_of_all_levels() {
    for level in 0..=2 {
        for degree in 0..=3 {
            let original = scattered(150, degree);
            let bytes = ksplat(&original, level);
            check(&bytes, "scene.ksplat", SplatFormat::Ksplat, &original, 2e-4, 35.0);
            check(&bytes, "scene", SplatFormat::Ksplat, &original, 2e-4, 35.0);
        }
    }
}

#[test]
fn gltf_attributes() {
    let original = scattered(150, 3);
    let splats: Vec<Splat> = (0..original.len()).map(|index| original.splat(index)).collect();
    let positions: Vec<[f32; 3]> = splats.iter().map(|s| s.mean.to_array()).collect();
    let rotations: Vec<[f32; 4]> = splats.iter().map(|s| s.rotation.to_array()).collect();
    let scales: Vec<[f32; 3]> = splats.iter().map(|s| s.log_scale.exp().to_array()).collect();
    let opacities: Vec<f32> = splats.iter().map(|s| s.opacity).collect();
    let mut coefficients: Vec<Vec<[f32; 3]>> = vec![splats.iter().map(|s| s.base_color.to_array()).collect()];
    for k in 0..15 {
        let of = |index: usize| [0, 1, 2].map(|c| original.coefficients(index)[3 * k + c].to_f32());
        coefficients.push((0..original.len()).map(of).collect());
    }
    let coefficients: Vec<&[[f32; 3]]> = coefficients.iter().map(Vec::as_slice).collect();
    let attributes = GltfAttributes {
        positions: &positions,
        rotations: &rotations,
        scales: &scales,
        opacities: &opacities,
        coefficients: &coefficients,
    };
    let read = |attributes: &GltfAttributes<'_>, extension: serde_json::Value| {
        read_gltf_attributes(
            attributes,
            &extension,
            Path::new("scene.glb"),
            &ReadOptions::default(),
            &Unwatched,
        )
    };
    let extension = |space: &str| json!({"kernel": "ellipse", "colorSpace": space});
    let file = read(&attributes, extension("srgb_rec709_display")).unwrap();
    assert_eq!(file.cloud.traits().axes, Axes::RIGHT_UP_BACK);
    let cloud = file.cloud.clone().with_traits(original.traits());
    let (distance, decibels) = differences(&original, &SplatFile { cloud, ..file });
    assert!(distance == 0.0 && decibels > 90.0, "{distance} {decibels}");
    let linear = read(&attributes, extension("lin_rec709_display")).unwrap();
    assert_eq!(linear.cloud.traits().color_space, ColorSpace::Linear);

    assert!(read(&attributes, extension("acescg")).is_err());
    assert!(read(&attributes, json!({"kernel": "box", "colorSpace": "lin_rec709_display"})).is_err());
    assert!(read(&attributes, json!({"kernel": "ellipse"})).is_err());
    let short = GltfAttributes { opacities: &opacities[1..], ..attributes };
    assert!(read(&short, extension("srgb_rec709_display")).is_err());
    let partial = GltfAttributes { coefficients: &coefficients[..5], ..attributes };
    assert!(read(&partial, extension("srgb_rec709_display")).is_err());
}
