//! The cameras of every program: the same cameras in every format give the same views.

use crate::made::{Camera, FOCAL, SIZE, cameras, names, open, pictures_and_mesh, refused};
use capture::{CameraFormat, CaptureOptions, recognise};
use glam::{DMat3, DMat4, DVec2, DVec3};
use progress::Unwatched;
use std::fs::{create_dir_all, write};
use std::path::Path;

const NAMES: [&str; 3] = ["a.jpg", "sub/b.jpg", "sub/c.jpg"];

/// Opens the cameras that `write` writes into a folder with pictures and mesh; the views must be the same cameras.
fn same_cameras(kind: CameraFormat, write: impl Fn(&Path, &[Camera])) -> capture::Capture {
    let folder = tempfile::tempdir().unwrap();
    let cameras = cameras(&NAMES);
    pictures_and_mesh(folder.path(), &cameras);
    assert_eq!(recognise(folder.path()), None);
    write(folder.path(), &cameras);
    assert_eq!(recognise(folder.path()), Some(kind));
    let capture = open(folder.path()).unwrap();
    assert_eq!((capture.camera_format, names(&capture)), (kind, NAMES.to_vec()));
    for (view, camera) in capture.views.iter().zip(&cameras) {
        assert!((view.position() - camera.center).length() < 1e-9, "{}", view.name);
        for point in [DVec3::ZERO, DVec3::new(0.3, 0.2, -0.4)] {
            let at = camera.rotation * (point - camera.center);
            let expected = DVec2::new(30.0 + FOCAL * at.x / at.z, 20.0 + FOCAL * at.y / at.z);
            let pixel = view.project(point).unwrap();
            assert!((pixel - expected).length() < 1e-9, "{}: {pixel} instead of {expected}", view.name);
        }
        assert!(view.up().y > 0.9);
    }
    assert!((capture.upright * DVec3::Y).y > 0.99);
    capture
}

#[test]
fn colmap_text_and_binary() {
    same_cameras(CameraFormat::Colmap, |folder, cameras| {
        crate::made::colmap_text(&folder.join("sparse/0"), cameras)
    });
    same_cameras(CameraFormat::Colmap, |folder, cameras| colmap_binary(&folder.join("sparse"), cameras));
}

/// COLMAP's binary model; with an invalid rigs.bin, which is not read.
fn colmap_binary(folder: &Path, cameras: &[Camera]) {
    create_dir_all(folder).unwrap();
    let mut bytes = 1u64.to_le_bytes().to_vec();
    bytes.extend([&7u32.to_le_bytes()[..], &1i32.to_le_bytes()].concat());
    SIZE.map(u64::from).iter().for_each(|side| bytes.extend(side.to_le_bytes()));
    [FOCAL, FOCAL, 30.0, 20.0].iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    write(folder.join("cameras.bin"), &bytes).unwrap();
    let mut bytes = (cameras.len() as u64).to_le_bytes().to_vec();
    for (index, camera) in cameras.iter().enumerate() {
        let (q, t) = (camera.rotation, camera.rotation * -camera.center);
        bytes.extend((10 * index as u32 + 3).to_le_bytes());
        [q.w, q.x, q.y, q.z, t.x, t.y, t.z].iter().for_each(|number| bytes.extend(number.to_le_bytes()));
        bytes.extend(7u32.to_le_bytes());
        bytes.extend([camera.name.as_bytes(), b"\0"].concat());
        bytes.extend(2u64.to_le_bytes());
        bytes.extend([0x3F; 48]);
    }
    write(folder.join("images.bin"), &bytes).unwrap();
    write(folder.join("rigs.bin"), b"nonsense").unwrap();
}

#[test]
fn binary_wins_over_text() {
    let folder = crate::made::colmap(&NAMES);
    let model = folder.path().join("sparse/0");
    colmap_binary(&model, &cameras(&NAMES));
    write(model.join("cameras.txt"), "nonsense").unwrap();
    assert_eq!(open(folder.path()).unwrap().cameras, model.join("images.bin"));
}

#[test]
fn of_disconnected_models_the_one_with_the_most_pictures() {
    let folder = crate::made::colmap(&NAMES[..1]);
    let all = cameras(&NAMES);
    pictures_and_mesh(folder.path(), &all);
    crate::made::colmap_text(&folder.path().join("sparse/12"), &all);
    let capture = open(folder.path()).unwrap();
    assert_eq!((capture.views.len(), capture.cameras), (3, folder.path().join("sparse/12/images.txt")));
    assert!(
        capture.remarks.iter().any(|remark| remark.text.contains("sparse/0/images.txt")),
        "{:?}",
        capture.remarks
    );
    // Naming the other one selects it.
    assert_eq!(open(&folder.path().join("sparse/0")).unwrap().views.len(), 1);
}

/// The matrix from a camera's axes to the world, of glTF's axes (y up, looks down −z).
fn gltf_pose(camera: &Camera) -> DMat4 {
    let to_world = DMat3::from_quat(camera.rotation.inverse());
    let axes = DMat3::from_cols(to_world.x_axis, -to_world.y_axis, -to_world.z_axis);
    DMat4::from_mat3_translation(axes, camera.center)
}

fn transforms(folder: &Path, cameras: &[Camera], lens: &str, name: impl Fn(&str) -> String) {
    let frames: Vec<String> = cameras
        .iter()
        .map(|camera| {
            let rows = gltf_pose(camera).transpose().to_cols_array_2d();
            format!("{{\"file_path\": \"{}\", \"transform_matrix\": {rows:?}}}", name(&camera.name))
        })
        .collect();
    write(folder.join("transforms.json"), format!("{{{lens}, \"frames\": [{}]}}", frames.join(","))).unwrap();
}

#[test]
fn nerfstudio_with_a_lens_for_all() {
    let lens = r#""camera_model": "OPENCV", "fl_x": 50, "fl_y": 50.0, "cx": 30, "cy": 20, "w": 60.0, "h": 40, "k1": 0"#;
    same_cameras(CameraFormat::Nerfstudio, |folder, cameras| {
        transforms(folder, cameras, lens, |name| format!("./images/{name}"))
    });
}

#[test]
fn nerfstudio_by_an_angle_without_extensions() {
    // 2·atan(30/50)
    let lens = r#""camera_angle_x": 1.0808390005411683, "odd": 1"#;
    let capture = same_cameras(CameraFormat::Nerfstudio, |folder, cameras| {
        transforms(folder, cameras, lens, |name| format!("images/{}", name.trim_end_matches(".jpg")))
    });
    assert!(capture.remarks.iter().any(|remark| remark.text.contains("\"odd\"")), "{:?}", capture.remarks);
}

#[test]
fn nerfstudio_with_zeros_for_what_is_unknown() {
    let angle = "1.0808390005411683";
    let known = r#""fl_x": 50, "fl_y": 50, "cx": 30, "cy": 20, "w": 60, "h": 40"#;
    for lens in [
        format!(r#"{known}, "camera_angle_x": 0, "camera_angle_y": 0"#),
        format!(r#"{known}, "camera_angle_x": 3.5, "camera_angle_y": -1.0"#),
        r#""fl_x": 50, "fl_y": 0, "cx": 0, "cy": 0, "w": 60, "h": 40"#.into(),
        format!(r#""fl_x": 0, "fl_y": 0, "camera_angle_x": {angle}, "w": 60, "h": 40"#),
        r#""fl_x": 0.0, "fl_y": 50, "cx": 30, "cy": 20, "w": 0, "h": 0, "camera_angle_x": 0"#.into(),
        format!(r#""w": 0, "h": 0, "fl_x": "0", "camera_angle_x": {angle}"#),
    ] {
        same_cameras(CameraFormat::Nerfstudio, |folder, cameras| {
            transforms(folder, cameras, &lens, |name| format!("images/{name}"));
        });
    }
}

#[test]
fn nerfstudio_with_zeros_in_a_frame() {
    let folder = tempfile::tempdir().unwrap();
    pictures_and_mesh(folder.path(), &cameras(&["a.jpg"]));
    let pose = "[[1,0,0,0],[0,1,0,0],[0,0,1,5],[0,0,0,1]]";
    let read = |of_frame: &str, of_file: &str| {
        let frame = format!(r#"{{"file_path": "images/a.jpg", "transform_matrix": {pose}, {of_frame}}}"#);
        write(folder.path().join("transforms.json"), format!(r#"{{{of_file}, "frames": [{frame}]}}"#))
            .unwrap();
        *open(folder.path()).unwrap().views[0].lens.intrinsics()
    };
    let focal = |of_frame: &str, of_file: &str| read(of_frame, of_file).focal_px;
    let file = r#""fl_x": 50, "fl_y": 51, "w": 60, "h": 40, "camera_angle_x": 0"#;
    assert_eq!(focal(r#""fl_x": 0, "fl_y": 0, "w": 0"#, file), [50.0, 51.0]);
    assert_eq!(focal(r#""fl_x": 40, "fl_y": 41, "camera_angle_x": 0"#, file), [40.0, 41.0]);
    assert_eq!(focal(r#""fl_x": 40, "fl_y": 41"#, r#""fl_x": 0, "fl_y": 0, "w": 0, "h": 0"#), [40.0, 41.0]);
    let off_centre = read(r#""fl_x": 40, "cx": 28.5"#, r#""cx": 0, "cy": 0"#);
    assert_eq!(off_centre.principal_px, [28.5, 20.0]);
}

#[test]
fn nerfstudio_with_a_lens_and_a_mask_for_each() {
    let folder = tempfile::tempdir().unwrap();
    pictures_and_mesh(folder.path(), &cameras(&["a.jpg"]));
    crate::made::picture(&folder.path().join("m/own.png"), SIZE);
    let pose = "[[1,0,0,0],[0,1,0,0],[0,0,1,5],[0,0,0,1]]";
    let frame = format!(
        r#"{{"file_path": "images/a.jpg", "mask_path": "m/own.png", "transform_matrix": {pose}, "fl_x": 40, "k1": 0.1, "p2": 0.01}}"#
    );
    write(
        folder.path().join("transforms.json"),
        format!(r#"{{"fl_x": 50, "w": 60, "h": 40, "frames": [{frame}]}}"#),
    )
    .unwrap();
    let capture = open(folder.path()).unwrap();
    let view = &capture.views[0];
    assert_eq!(view.lens.intrinsics().focal_px, [40.0; 2]);
    assert_eq!((view.lens.distortion().radial[0], view.lens.distortion().tangential), (0.1, [0.0, 0.01]));
    assert_eq!(view.mask, Some(folder.path().join("m/own.png")));
    assert_eq!(view.position(), DVec3::new(0.0, 0.0, 5.0));
}

#[test]
fn bundler() {
    let capture = same_cameras(CameraFormat::Bundler, |folder, cameras| {
        let mut text = format!("# Bundle file v0.3\n{} 0\n", cameras.len() + 1);
        text += "0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n";
        for camera in cameras {
            let pose = gltf_pose(camera).inverse();
            let [x, y, z] = DMat3::from_mat4(pose).transpose().to_cols_array_2d();
            let t = pose.w_axis;
            text += &format!("{FOCAL} 0 0\n");
            [x, y, z, [t.x, t.y, t.z]].iter().for_each(|[a, b, c]| text += &format!("{a} {b} {c}\n"));
        }
        write(folder.join("bundle.out"), text).unwrap();
        let names: String =
            cameras.iter().map(|camera| format!("./images/{} 0 50.0\n", camera.name)).collect();
        write(folder.join("list.txt"), format!("./images/none.jpg\n{names}")).unwrap();
    });
    assert!(
        capture.remarks.iter().any(|remark| remark.names == ["./images/none.jpg"]),
        "{:?}",
        capture.remarks
    );
}

#[test]
fn visual_sfm() {
    let written = |folder: &Path, cameras: &[Camera], r: f64| {
        let mut text = format!("NVM_V3 \n\n{}\n", cameras.len());
        for Camera { name, rotation: q, center: c } in cameras {
            let name = name.replace('/', "\\");
            text +=
                &format!("{name}\t{FOCAL} {} {} {} {} {} {} {} {r} 0\n", q.w, q.x, q.y, q.z, c.x, c.y, c.z);
        }
        text += "\n1\n0 0 0 255 255 255 2 0 5 1.5 2.5 1 6 3.5 4.5\n\n0\n\n# PLY\n0\n";
        write(folder.join("model.nvm"), text).unwrap();
    };
    same_cameras(CameraFormat::Nvm, |folder, cameras| written(folder, cameras, 0.0));
    // A point measured at m is ideally at m(1 + r·m²).
    let folder = tempfile::tempdir().unwrap();
    pictures_and_mesh(folder.path(), &cameras(&NAMES));
    written(folder.path(), &cameras(&NAMES), -0.2);
    let lens = open(folder.path()).unwrap().views[0].lens;
    let direction = lens.unproject(DVec2::new(30.0 + 50.0 * 0.5, 20.0)).unwrap();
    assert!((direction.x / direction.z - 0.5 * (1.0 - 0.2 * 0.25)).abs() < 1e-12, "{direction}");
}

/// A camera of a chunk that is scaled by a half relative to the world, and rotated.
fn metashape(folder: &Path, cameras: &[Camera], calibration: &str) {
    let turn = DMat3::from_rotation_y(0.7);
    let rows = |matrix: DMat3| matrix.transpose().to_cols_array().map(|entry| entry.to_string()).join(" ");
    let mut of_cameras = String::new();
    for (id, camera) in cameras.iter().enumerate() {
        // World = 2 · turn · chunk + (1, 2, 3).
        let axes = turn.transpose() * DMat3::from_quat(camera.rotation.inverse());
        let center = turn.transpose() * (camera.center - DVec3::new(1.0, 2.0, 3.0)) * 0.5;
        let pose = DMat4::from_mat3_translation(axes, center).transpose().to_cols_array();
        let label = camera.name.trim_end_matches(".jpg").rsplit('/').next().unwrap();
        of_cameras += &format!(
            "<camera id=\"{id}\" sensor_id=\"0\" label=\"{label}\"><transform>{}</transform></camera>",
            pose.map(|entry| entry.to_string()).join(" ")
        );
    }
    let text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document version=\"1.5.0\">\n<chunk label=\"c\">\n<sensors>\n\
         <sensor id=\"0\" label=\"s\" type=\"frame\"><resolution width=\"60\" height=\"40\"/>\n\
         <calibration class=\"initial\"><f>1</f></calibration>\n\
         <calibration class=\"adjusted\"><resolution width=\"60\" height=\"40\"/>{calibration}</calibration></sensor>\n</sensors>\n\
         <cameras>\n<group>{of_cameras}</group>\n<camera id=\"99\" sensor_id=\"0\" label=\"lost\"/>\n</cameras>\n\
         <transform><rotation>{}</rotation><translation>1 2 3</translation><scale>2</scale></transform>\n</chunk>\n</document>\n",
        rows(turn)
    );
    write(folder.join("cameras.xml"), text).unwrap();
}

#[test]
fn metashape_xml() {
    let folder = tempfile::tempdir().unwrap();
    let cameras = cameras(&NAMES);
    pictures_and_mesh(folder.path(), &cameras);
    metashape(folder.path(), &cameras, "<f>50</f>");
    assert_eq!(recognise(folder.path()), Some(CameraFormat::Metashape));
    let capture = open(folder.path()).unwrap();
    assert_eq!(names(&capture), NAMES);
    for (view, camera) in capture.views.iter().zip(&cameras) {
        assert!((view.position() - camera.center).length() < 1e-9);
        let middle = view.project(DVec3::ZERO).unwrap();
        assert!((middle - DVec2::new(30.0, 20.0)).length() < 1e-9, "{middle}");
    }
    assert!(capture.remarks.iter().any(|remark| remark.names == ["lost"]), "{:?}", capture.remarks);
}

#[test]
fn metashape_lenses_are_those_of_its_manual() {
    let folder = tempfile::tempdir().unwrap();
    let cameras = cameras(&NAMES);
    pictures_and_mesh(folder.path(), &cameras);
    let [f, cx, cy, b1, b2, k1, k2, p1, p2] = [50.0, 1.25, -0.75, 0.5, 0.25, -0.1, 0.05, 0.01, -0.02];
    let terms = [
        ("f", f),
        ("cx", cx),
        ("cy", cy),
        ("b1", b1),
        ("b2", b2),
        ("k1", k1),
        ("k2", k2),
        ("p1", p1),
        ("p2", p2),
    ];
    let terms: String = terms.map(|(name, value)| format!("<{name}>{value}</{name}>")).concat();
    metashape(folder.path(), &cameras, &terms);
    let lens = open(folder.path()).unwrap().views[0].lens;
    let (x, y) = (0.3f64, -0.2f64);
    let r2 = x * x + y * y;
    let radial = 1.0 + k1 * r2 + k2 * r2 * r2;
    let x_distorted = x * radial + p1 * (r2 + 2.0 * x * x) + 2.0 * p2 * x * y;
    let y_distorted = y * radial + p2 * (r2 + 2.0 * y * y) + 2.0 * p1 * x * y;
    let expected = DVec2::new(
        30.0 + cx + x_distorted * f + x_distorted * b1 + y_distorted * b2,
        20.0 + cy + y_distorted * f,
    );
    let pixel = lens.project(DVec3::new(x, -y, 1.0)).unwrap();
    assert!((pixel - expected).length() < 1e-9, "{pixel} instead of {expected}");
}

#[test]
fn pictures_that_were_not_aligned_are_told_in_good_english() {
    let row = "1 0 0\n0 1 0\n0 0 1\n0 0 -5\n";
    for (not_aligned, told) in [
        (
            1,
            "bundle.out: sub/b.jpg has no camera: it was not aligned by the program that wrote the file (align it there",
        ),
        (
            2,
            "bundle.out: sub/b.jpg, sub/c.jpg have no camera: they were not aligned by the program that wrote the file (align them there",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        pictures_and_mesh(folder.path(), &cameras(&NAMES));
        write(folder.path().join("list.txt"), NAMES[..1 + not_aligned].join("\n")).unwrap();
        let unknown = "0 0 0\n".repeat(5 * not_aligned);
        let bundle = format!("# Bundle file v0.3\n{} 0\n50 0 0\n{row}{unknown}", 1 + not_aligned);
        write(folder.path().join("bundle.out"), bundle).unwrap();
        let remarks: Vec<String> =
            open(folder.path()).unwrap().remarks.into_iter().map(|remark| remark.text).collect();
        assert!(remarks.iter().any(|text| text.contains(told)), "{remarks:?}");
        // A picture that the file does not list is another matter.
        let unlisted = remarks.iter().find(|text| text.contains("ignored"));
        match not_aligned {
            1 => assert!(unlisted.unwrap().contains("sub/c.jpg has no camera in"), "{remarks:?}"),
            _ => assert_eq!(unlisted, None, "{remarks:?}"),
        }
    }
}

#[test]
fn a_kind_may_be_chosen() {
    let folder = crate::made::colmap(&NAMES);
    transforms(folder.path(), &cameras(&NAMES[..2]), "\"fl_x\": 50", |name| format!("images/{name}"));
    let capture = open(folder.path()).unwrap();
    assert_eq!((capture.camera_format, capture.views.len()), (CameraFormat::Colmap, 3));
    assert!(capture.remarks[0].text.contains("transforms.json"), "{:?}", capture.remarks);
    let options =
        CaptureOptions { camera_format: Some(CameraFormat::Nerfstudio), ..CaptureOptions::default() };
    let capture = capture::open(folder.path(), &options, &Unwatched).unwrap();
    assert_eq!((capture.camera_format, capture.views.len()), (CameraFormat::Nerfstudio, 2));
}

#[test]
fn malformed_files_are_reported_with_the_place() {
    let assert_refused = |file: &str, text: &str, what: &str| {
        let folder = tempfile::tempdir().unwrap();
        pictures_and_mesh(folder.path(), &cameras(&NAMES));
        write(folder.path().join("list.txt"), "a.jpg\n").unwrap();
        write(folder.path().join(file), text).unwrap();
        let sentence = refused(folder.path());
        assert!(sentence.contains(file) && sentence.contains(what), "{sentence}");
    };
    assert_refused("transforms.json", "{\"frames\": [\n{\"file_path\" 1}]}", "line 2: its JSON is invalid");
    assert_refused("transforms.json", "{\"frames\": 3}", "/frames: is not a list");
    assert_refused(
        "transforms.json",
        r#"{"frames": [{"file_path": "a.jpg"}]}"#,
        "/frames/0/transform_matrix",
    );
    let pose = "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]";
    let frame = format!(r#""frames": [{{"file_path": "a.jpg", "transform_matrix": {pose}}}]"#);
    assert_refused(
        "transforms.json",
        &format!("{{{frame}}}"),
        "picture \"a.jpg\": neither fl_x nor camera_angle_x",
    );
    assert_refused(
        "transforms.json",
        &format!("{{\"fl_x\": 0, \"camera_angle_x\": 0, \"w\": 60, \"h\": 40, {frame}}}"),
        "neither fl_x nor camera_angle_x gives its focal length (0 counts as missing)",
    );
    assert_refused(
        "transforms.json",
        &format!("{{\"camera_angle_x\": 4, {frame}}}"),
        "camera_angle_x is not an angle between 0 and π",
    );
    assert_refused(
        "transforms.json",
        &format!("{{\"fl_x\": -2, \"w\": 60, \"h\": 40, {frame}}}"),
        "focal length must be above 0",
    );
    assert_refused(
        "transforms.json",
        &format!("{{\"camera_model\": \"X\", {frame}}}"),
        "the camera_model \"X\" is not supported",
    );
    assert_refused(
        "bundle.out",
        "# Bundle file v0.3\n2 0\n",
        "line 2: declares 2 cameras, but list.txt has 1",
    );
    assert_refused(
        "bundle.out",
        "1 0\n50 0 0\n1 0 0\n0 1\n",
        "line 4: picture \"a.jpg\": does not have the 3 numbers of R",
    );
    assert_refused(
        "m.nvm",
        "NVM_V3\n2\na.jpg 50 1 0 0 0 0 0 0 0 0\n",
        "line 4: the file ends within 2 cameras",
    );
    assert_refused(
        "m.nvm",
        "NVM_V3\n1\na.jpg 50 1 0 0 0 0 0 x 0 0\n",
        "line 3: does not have the name, focal length",
    );
    assert_refused("c.xml", "<document><chunk>\n</document>", "its XML is invalid");
    let camera =
        "<cameras><camera label=\"a\" sensor_id=\"0\">\n<transform>1 2</transform></camera></cameras>";
    assert_refused(
        "c.xml",
        &format!("<document><chunk>\n{camera}</chunk></document>"),
        "line 2: camera \"a\": its sensor is not in the file",
    );
}

#[test]
fn a_folder_that_is_no_capture() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(recognise(folder.path()), None);
    assert_eq!(recognise(&folder.path().join("none")), None);
    assert!(refused(folder.path()).contains("no cameras of photographs"));
    assert!(refused(&folder.path().join("none")).contains("cannot be read"));
}
