//! Common pitfalls of captures of photographs, each with files that have it: they open correctly, or give the right error.

use crate::made::{SIZE, cameras, change, colmap, names, open, picture, refused};
use scene::LoadOptions;
use std::path::Path;

const NAMES: [&str; 3] = ["a.jpg", "b.jpg", "c.jpg"];

/// The cameras of the views are those of `NAMES`.
fn assert_poses(folder: &Path) {
    let capture = open(folder).unwrap();
    assert_eq!(names(&capture), NAMES);
    for (view, camera) in capture.views.iter().zip(cameras(&NAMES)) {
        assert!((view.position() - camera.center).length() < 1e-9, "{}", view.name);
        assert!((view.forward() + camera.center.normalize()).length() < 1e-9, "{}", view.name);
    }
}

#[test]
fn trap_1_the_second_line_of_a_picture_is_empty() {
    let folder = colmap(&NAMES);
    change(&folder.path().join("sparse/0/images.txt"), |text| text.replace("1.5 2.5 -1 3.5 4.5 17", ""));
    assert_poses(folder.path());
    assert_eq!(open(folder.path()).unwrap().remarks, []);
}

#[test]
fn trap_1_the_second_line_of_a_picture_is_left_out() {
    let folder = colmap(&NAMES);
    change(&folder.path().join("sparse/0/images.txt"), |text| text.replace("1.5 2.5 -1 3.5 4.5 17\n", ""));
    assert_poses(folder.path());
    let remarks = open(folder.path()).unwrap().remarks;
    assert!(
        remarks[0].text.contains("is missing after 2 of 3 pictures") && !remarks[0].is_incomplete,
        "{remarks:?}"
    );
}

#[test]
fn trap_1_double_spaces_tabs_and_windows_line_ends() {
    let folder = colmap(&NAMES);
    change(&folder.path().join("sparse/0/images.txt"), |text| {
        text.replace(' ', "  ").replace('\n', "\t\r\n")
    });
    change(&folder.path().join("sparse/0/cameras.txt"), |text| text.replace(' ', "\t \t"));
    assert_poses(folder.path());
}

#[test]
fn trap_1_decimal_commas() {
    let folder = colmap(&NAMES);
    // Names keep their dots.
    change(&folder.path().join("sparse/0/images.txt"), |text| text.replace('.', ",").replace(",jpg", ".jpg"));
    change(&folder.path().join("sparse/0/cameras.txt"), |text| text.replace("50 50", "50,0 50,0"));
    assert_poses(folder.path());
}

#[test]
fn trap_1_a_line_that_is_cut_names_its_place() {
    let folder = colmap(&NAMES);
    let file = folder.path().join("sparse/0/images.txt");
    change(&file, |text| text[..text.len() - 60].into());
    let text = refused(folder.path());
    assert!(text.starts_with(&format!("{}: line 6: ", file.display())), "{text}");
}

#[test]
fn trap_2_pictures_in_subfolders_with_backslashes_in_another_case() {
    let folder = colmap(&["left/a.jpg", "right/a.jpg", "right/b.JPG"]);
    change(&folder.path().join("sparse/0/images.txt"), |text| {
        text.replace("left/a.jpg", "left\\a.jpg")
            .replace("right/a.jpg", "Right\\A.JPG")
            .replace("b.JPG", "b.jpg")
    });
    let capture = open(folder.path()).unwrap();
    let mut pictures: Vec<_> =
        capture.views.iter().map(|view| view.picture.strip_prefix(folder.path()).unwrap()).collect();
    pictures.sort();
    assert_eq!(pictures, ["images/left/a.jpg", "images/right/a.jpg", "images/right/b.JPG"].map(Path::new));
    assert!(names(&capture).contains(&"left/a.jpg"), "{:?}", names(&capture));
}

#[test]
fn trap_2_pictures_beside_the_cameras_or_above_them() {
    for (place, model) in [
        ("images", "sparse/0"),
        ("images", "sparse"),
        ("images", "dense/sparse"),
        ("dense/images", "dense/sparse"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let cameras = cameras(&NAMES);
        cameras.iter().for_each(|camera| picture(&folder.path().join(place).join(&camera.name), SIZE));
        std::fs::write(folder.path().join("mesh.ply"), crate::made::PLY).unwrap();
        crate::made::colmap_text(&folder.path().join(model), &cameras);
        assert_poses(folder.path());
        if model != "dense/sparse" {
            // The folder of the model itself is enough, and so is that of all models.
            assert_poses(&folder.path().join(model));
            assert_poses(&folder.path().join("sparse"));
        }
    }
}

#[test]
fn trap_3_the_default_model_and_a_principal_point_aside() {
    let folder = colmap(&NAMES);
    std::fs::write(folder.path().join("sparse/0/cameras.txt"), "7 SIMPLE_RADIAL 60 40 50 33.25 18.5 -0.1\n")
        .unwrap();
    let capture = open(folder.path()).unwrap();
    let lens = capture.views[0].lens;
    assert_eq!(lens.intrinsics().principal_px, [33.25, 18.5]);
    assert_eq!(lens.project(glam::DVec3::Z).unwrap().to_array(), [33.25, 18.5]);
    // r = 0.2 to 0.2 − 0.1 · 0.008.
    let at = lens.project(glam::DVec3::new(0.2, 0.0, 1.0)).unwrap();
    assert!((at.x - (33.25 + 50.0 * 0.1992)).abs() < 1e-9, "{at}");
}

#[test]
fn trap_3_an_unsupported_camera_model() {
    let folder = colmap(&NAMES);
    change(&folder.path().join("sparse/0/cameras.txt"), |text| text.replace("PINHOLE", "PINHOLE_2"));
    let text = refused(folder.path());
    assert!(
        text.contains("cameras.txt: line 2: camera 7: the camera model \"PINHOLE_2\" is not supported"),
        "{text}"
    );
}

/// Writes a JPEG of 60 × 40 px whose EXIF orientation is a rotation by 90°.
fn turned_picture(file: &Path, [width, height]: [u32; 2]) {
    let exif = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0";
    let mut encoder = image::codecs::jpeg::JpegEncoder::new(std::fs::File::create(file).unwrap());
    image::ImageEncoder::set_exif_metadata(&mut encoder, exif.to_vec()).unwrap();
    encoder.encode_image(&image::RgbImage::new(width, height)).unwrap();
}

#[test]
fn trap_4_exif_rotation_is_followed_only_where_the_camera_was_turned_too() {
    let folder = colmap(&NAMES);
    // As in COLMAP since 3.7: the camera is that of the picture as it is stored.
    turned_picture(&folder.path().join("images/a.jpg"), SIZE);
    // As in programs that rotate pictures first.
    turned_picture(&folder.path().join("images/b.jpg"), [SIZE[1], SIZE[0]]);
    let capture = open(folder.path()).unwrap();
    let orientations: Vec<_> =
        capture.views.iter().map(|view| [view.orientation, view.exif_orientation]).collect();
    assert_eq!(orientations, [[1, 6], [6, 6], [1, 1]]);
    for view in &capture.views {
        let pixels = view.read_photograph(&LoadOptions::default()).unwrap();
        assert_eq!([pixels.width, pixels.height], SIZE);
    }
    assert_eq!(capture.remarks.len(), 1);
    assert!(capture.remarks[0].names == ["b.jpg"] && !capture.remarks[0].is_incomplete);
}

#[test]
fn trap_4_a_picture_that_lies_on_its_side_without_saying_so_is_left_out() {
    let folder = colmap(&NAMES);
    picture(&folder.path().join("images/b.jpg"), [SIZE[1], SIZE[0]]);
    let capture = open(folder.path()).unwrap();
    assert_eq!(names(&capture), ["a.jpg", "c.jpg"]);
    let remark = &capture.remarks[0];
    assert!(
        remark.is_incomplete
            && remark.text.contains("b.jpg (line 4): it is 40 × 60 px, its camera is for 60 × 40 px"),
        "{remark}"
    );
}

#[test]
fn trap_5_missing_pictures_are_named_and_the_others_used() {
    let folder = colmap(&NAMES);
    std::fs::remove_file(folder.path().join("images/b.jpg")).unwrap();
    picture(&folder.path().join("images/z.jpg"), SIZE);
    let capture = open(folder.path()).unwrap();
    assert_eq!(names(&capture), ["a.jpg", "c.jpg"]);
    let [missing, unused] = &capture.remarks[..] else { panic!("{:?}", capture.remarks) };
    assert!(
        missing.is_incomplete
            && missing.names == ["b.jpg"]
            && missing.text.contains("1 of 3 pictures is missing: b.jpg (put it into"),
        "{missing}"
    );
    assert!(!unused.is_incomplete && unused.names == ["z.jpg"], "{unused}");
}

#[test]
fn trap_5_no_picture_at_all() {
    let folder = colmap(&NAMES);
    std::fs::rename(folder.path().join("images"), folder.path().join("masks")).unwrap();
    let text = refused(folder.path());
    assert!(
        text.contains("none of the pictures of its 3 cameras can be used: \"a.jpg\" is not in"),
        "{text}"
    );
}

#[test]
fn trap_5_points_that_are_none() {
    let folder = colmap(&NAMES);
    change(&folder.path().join("mesh.ply"), |text| text.replace("0 1 0\n", "nan inf 0\n"));
    let capture = open(folder.path()).unwrap();
    assert_eq!(capture.scene.triangles.len(), 1);
    assert!(capture.scene.warnings[0].contains("3 of 4 triangles"), "{:?}", capture.scene.warnings);
    assert!(capture.scene.positions.iter().all(|position| position.is_finite()));
}

#[test]
fn trap_5_a_pose_that_is_none_names_its_picture() {
    let folder = colmap(&NAMES);
    let file = folder.path().join("sparse/0/images.txt");
    change(&file, |text| {
        let (before, pose) = text.split_once("\n13 ").unwrap();
        format!("{before}\n13 nan {}", pose.split_once(' ').unwrap().1)
    });
    let text = refused(folder.path());
    assert!(text.contains("line 4: picture \"b.jpg\": its rotation is not 4 numbers"), "{text}");
}

#[test]
fn trap_5_a_mesh_that_no_picture_shows() {
    let folder = colmap(&NAMES);
    change(&folder.path().join("mesh.ply"), |text| text.replace("-0.5", "900"));
    change(&folder.path().join("mesh.ply"), |text| text.replace("0 1 0\n", "0 901 0\n"));
    let remarks = open(folder.path()).unwrap().remarks;
    assert!(
        remarks.last().unwrap().is_incomplete
            && remarks.last().unwrap().text.contains("no picture shows anything of it")
    );
}

#[test]
fn trap_6_ten_views_of_which_a_fifth_has_a_person_masked_out_and_exposures_differ() {
    let all: Vec<String> = (0..10).map(|index| format!("{index}.jpg")).collect();
    let folder = colmap(&all.iter().map(String::as_str).collect::<Vec<_>>());
    // The masks as COLMAP has them, and as others have them.
    let masks = folder.path().join("masks");
    std::fs::create_dir(&masks).unwrap();
    let half =
        image::GrayImage::from_fn(SIZE[0], SIZE[1], |x, _| image::Luma([if x < 30 { 0 } else { 255 }]));
    half.save(masks.join("3.jpg.png")).unwrap();
    half.save(masks.join("8.png")).unwrap();
    let capture = open(folder.path()).unwrap();
    assert_eq!(capture.views.len(), 10);
    for (index, view) in capture.views.iter().enumerate() {
        let mask = view.read_mask(&LoadOptions::default()).unwrap();
        assert_eq!(mask.is_some(), index == 3 || index == 8, "{}", view.name);
        if let Some(mask) = mask {
            assert_eq!(mask.is_valid.iter().filter(|counts| **counts).count() as u32, SIZE[0] * SIZE[1] / 2);
        }
        assert_eq!(view.exposure_hint, None);
    }
}
