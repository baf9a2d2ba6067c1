//! What people trip over, and what is refused with a sentence.

use crate::encode::{SpzVersion, compressed_ply, ply, raw_splat, sog_files, spz, zipped};
use crate::read_bytes;
use crate::scene::scattered;
use gaussians::{GaussianError, ReadOptions, open, read};
use progress::{Progress, Unwatched};
use std::path::Path;

fn error(bytes: &[u8], name: &str) -> String {
    let error = read_bytes(bytes, name).map(|file| file.cloud.len()).unwrap_err().to_string();
    assert!(error.starts_with(name) && error.ends_with(')') && !error.contains('\n'), "{error}");
    error
}

/// A file in ASCII with these properties and rows.
fn ascii(properties: &[&str], rows: &[&str], more: &str) -> Vec<u8> {
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {}\n", rows.len());
    properties.iter().for_each(|name| text += &format!("property float {name}\n"));
    text += &format!("{more}end_header\n");
    rows.iter().for_each(|row| text += &format!("{row}\n"));
    text.into_bytes()
}

const SHAPE: [&str; 11] =
    ["x", "y", "z", "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"];

#[test]
fn point_clouds_and_meshes_say_so() {
    let points = ascii(&["x", "y", "z"], &["1 2 3"], "");
    assert!(error(&points, "a.ply").contains("is a point cloud without splats"));
    let mesh =
        ascii(&["x", "y", "z"], &["1 2 3"], "element face 1\nproperty list uchar int vertex_indices\n");
    assert!(error(&mesh, "a.ply").contains("is a mesh without splats"));
    assert!(error(b"ply\nformat ascii 1.0\nend_header\n", "a.ply").contains("without vertices"));
    assert!(error(b"glTF....", "a.glb").contains("is a glTF scene"));
    assert!(error(b"hello", "a.txt").contains("is no file of Gaussian splats"));
    assert!(error(b"", "a").contains("is no file of Gaussian splats"));
}

#[test]
fn colours_as_red_green_blue_are_read() {
    let names: Vec<&str> = SHAPE.into_iter().chain(["red", "green", "blue"]).collect();
    let bytes = ascii(&names, &["0 0 1 2 -3 -3 -3 1 0 0 0 1 0.5 0"], "");
    let file = read_bytes(&bytes, "a.ply").unwrap();
    let color = file.cloud.color(0, glam::Vec3::Z);
    assert!((color - glam::Vec3::new(1.0, 0.5, 0.0)).abs().max_element() < 1e-6);
    let text = String::from_utf8(bytes).unwrap();
    let bytes = text
        .replace("float red", "uchar red")
        .replace("float green", "uchar green")
        .replace("float blue", "uchar blue");
    let file = read_bytes(bytes.replace("1 0.5 0\n", "255 0 51\n").as_bytes(), "a.ply").unwrap();
    let color = file.cloud.color(0, glam::Vec3::Z);
    assert!((color - glam::Vec3::new(1.0, 0.0, 0.2)).abs().max_element() < 1e-6);
    assert!(error(&ascii(&SHAPE, &["0 0 1 2 -3 -3 -3 1 0 0 0"], ""), "a.ply").contains("neither f_dc_0"));
}

#[test]
fn plain_values_and_flat_splats_are_read_with_a_warning() {
    let names: Vec<&str> = SHAPE.into_iter().chain(["f_dc_0", "f_dc_1", "f_dc_2"]).collect();
    let rows = ["0 0 1 0.8 0.05 0.02 0.01 1 0 0 0 0 0 0"; 20];
    let file = read_bytes(&ascii(&names, &rows, ""), "a.ply").unwrap();
    let splat = file.cloud.splat(0);
    assert!((splat.opacity - 0.8).abs() < 1e-6 && (splat.log_scale.x - 0.05f32.ln()).abs() < 1e-6);
    assert!(file.warnings[0].contains("not as logarithms and logits"), "{:?}", file.warnings);
    let names: Vec<&str> = names.into_iter().filter(|name| *name != "scale_2").collect();
    let file = read_bytes(&ascii(&names, &["0 0 1 2 -3 -3 1 0 0 0 0 0 0"], ""), "a.ply").unwrap();
    assert_eq!(file.cloud.splat(0).log_scale.z, f32::NEG_INFINITY);
    assert!(file.warnings[0].contains("2D Gaussians"), "{:?}", file.warnings);
}

#[test]
fn incomplete_columns_are_named() {
    let names: Vec<&str> = SHAPE.into_iter().filter(|name| *name != "rot_2").collect();
    assert!(
        error(&ascii(&names, &["0 0 1 2 -3 -3 -3 1 0 0"], ""), "a.ply").contains("has no property rot_2")
    );
    let names: Vec<&str> =
        SHAPE.into_iter().chain(["f_dc_0", "f_dc_1", "f_dc_2", "f_rest_0", "f_rest_1"]).collect();
    assert!(
        error(&ascii(&names, &["0 0 1 2 -3 -3 -3 1 0 0 0 0 0 0 0 0"], ""), "a.ply")
            .contains("has 2 properties f_rest")
    );
}

#[test]
fn cut_files_are_refused() {
    let cloud = scattered(60, 1);
    for (name, bytes) in [
        ("a.ply", ply(&cloud)),
        ("a.compressed.ply", compressed_ply(&cloud, true)),
        ("a.spz", spz(&cloud, SpzVersion::Three)),
        ("a.spz", spz(&cloud, SpzVersion::Four)),
        ("a.sog", zipped(&sog_files(&cloud, 2))),
        ("a.splat", raw_splat(&cloud)),
        ("a.ksplat", crate::encode::ksplat(&cloud, 1)),
    ] {
        assert!(read_bytes(&bytes, name).is_ok(), "{name}");
        for length in [0, 1, 20, bytes.len() / 2 + 1, bytes.len() - 1] {
            error(&bytes[..length], name);
        }
    }
}

#[test]
fn counts_beyond_the_bytes_are_refused() {
    let cloud = scattered(60, 0);
    let text = String::from_utf8_lossy(&ply(&cloud)).replace("vertex 60", "vertex 4000000000");
    assert!(error(text.as_bytes(), "a.ply").contains("do not fit"));
    let mut bytes = spz(&cloud, SpzVersion::Four);
    bytes[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(error(&bytes, "a.spz").contains("more than its"));
    let payload = &mut crate::encode::spz_payload(&cloud, SpzVersion::Three);
    payload[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(error(&crate::encode::gzipped(payload), "a.spz").contains("more than its"));
    let mut files = sog_files(&cloud, 2);
    files[0].1 =
        String::from_utf8_lossy(&files[0].1).replace("\"count\":60", "\"count\":4000000000").into_bytes();
    error(&zipped(&files), "a.sog");
}

#[test]
fn other_versions_say_what_to_do() {
    let cloud = scattered(10, 0);
    let mut bytes = spz(&cloud, SpzVersion::Four);
    bytes[4] = 9;
    assert!(error(&bytes, "a.spz").contains("version 9, 1 to 4 are read (convert"));
    let mut files = sog_files(&cloud, 2);
    files[0].1 = String::from_utf8_lossy(&files[0].1).replace("\"version\":2", "\"version\":3").into_bytes();
    assert!(error(&zipped(&files), "a.sog").contains("version 3"));
}

#[test]
fn a_scene_stays_in_its_folder() {
    let cloud = scattered(10, 0);
    for name in ["../means_l.webp", "/etc/passwd", "a/../../b.webp", "..\\\\b.webp"] {
        let mut files = sog_files(&cloud, 2);
        files[0].1 = String::from_utf8_lossy(&files[0].1).replace("means_l.webp", name).into_bytes();
        assert!(error(&zipped(&files), "a.sog").contains("outside its folder"), "{name}");
    }
}

#[cfg(unix)]
#[test]
fn links_out_of_the_folder_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("scene");
    std::fs::create_dir(&inside).unwrap();
    for (name, bytes) in sog_files(&scattered(10, 0), 2) {
        let target = if name == "quats.webp" { folder.path().join(&name) } else { inside.join(&name) };
        std::fs::write(target, bytes).unwrap();
    }
    std::os::unix::fs::symlink(folder.path().join("quats.webp"), inside.join("quats.webp")).unwrap();
    let error = open(&inside, &ReadOptions::default(), &Unwatched).map(|file| file.cloud.len()).unwrap_err();
    assert!(matches!(error, GaussianError::Outside { .. }), "{error}");
}

#[test]
fn limits_and_cancelling_hold() {
    let cloud = scattered(200, 3);
    let options = ReadOptions { max_memory: 20_000 };
    for (name, bytes) in [
        ("a.ply", ply(&cloud)),
        ("a.spz", spz(&cloud, SpzVersion::Four)),
        ("a.sog", zipped(&sog_files(&cloud, 2))),
    ] {
        let error =
            read(&bytes, Path::new(name), &options, &Unwatched).map(|file| file.cloud.len()).unwrap_err();
        assert!(matches!(error, GaussianError::TooBig { .. }), "{error}");
    }
    struct Cancelling;
    impl Progress for Cancelling {
        fn report(&self, _fraction: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let error = read(&spz(&cloud, SpzVersion::Two), Path::new("a.spz"), &ReadOptions::default(), &Cancelling);
    assert!(matches!(error, Err(GaussianError::Cancelled(_))));
}
