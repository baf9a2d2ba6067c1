//! Metashape's rigs: slaves whose poses follow from their master's and from their sensors.

use crate::made::{Camera, cameras, change, names, open, pictures_and_mesh, refused};
use glam::{DMat3, DMat4, DQuat, DVec2, DVec3};
use std::fs::write;
use std::path::Path;

const NAMES: [&str; 4] = ["a.jpg", "b.jpg", "c.jpg", "d.jpg"];

/// Numbers separated by spaces.
fn spaced(numbers: &[f64]) -> String {
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

/// From a camera's axes (computer vision's) to the world.
fn to_world(camera: &Camera) -> DMat4 {
    DMat4::from_mat3_translation(DMat3::from_quat(camera.rotation.inverse()), camera.center)
}

/// A sensor with its offset, as exported.
fn sensor(id: usize, focal: f64, to_rig: Option<DMat4>) -> String {
    let offset = match to_rig {
        None => "<rotation locked=\"true\"/><location locked=\"true\"/>".into(),
        Some(to_rig) => format!(
            "<rotation locked=\"false\">{}</rotation><location locked=\"true\">{}</location>\n\
             <rotation_covariance>{covariance}</rotation_covariance><location_covariance>{covariance}</location_covariance>",
            spaced(&DMat3::from_mat4(to_rig).transpose().to_cols_array()),
            spaced(&to_rig.w_axis.truncate().to_array()),
            covariance = spaced(&[1e-9; 9]),
        ),
    };
    format!(
        "<sensor id=\"{id}\" label=\"s{id}\" type=\"frame\" master_id=\"1\"><resolution width=\"60\" height=\"40\"/>\n\
         <calibration class=\"adjusted\"><resolution width=\"60\" height=\"40\"/><f>{focal}</f></calibration>\n{offset}</sensor>\n"
    )
}

/// A rig of four cameras, of which the second is the master, in a chunk that a component turns, moves and scales; the offsets are stated for
/// a master that is at `master_to_rig`, or not at all.
fn rig(folder: &Path, cameras: &[Camera], master_to_rig: Option<DMat4>) {
    let turn = DMat3::from_rotation_z(0.7);
    let chunk_to_world = DMat4::from_mat3_translation(turn * 2.0, DVec3::new(1.0, 2.0, 3.0));
    // Without the scale, which does not change what a camera shows.
    let to_chunk =
        |camera: &Camera| chunk_to_world.inverse() * to_world(camera) * DMat4::from_scale(DVec3::splat(2.0));
    let (mut sensors, mut list) = (String::new(), String::new());
    for (id, camera) in cameras.iter().enumerate() {
        let to_rig = master_to_rig.map(|master| master * to_chunk(&cameras[1]).inverse() * to_chunk(camera));
        sensors += &sensor(id, 50.0 + id as f64, to_rig);
        let label = camera.name.trim_end_matches(".jpg");
        let pose = spaced(&to_chunk(camera).transpose().to_cols_array());
        list += &match id {
            1 => format!(
                "<camera id=\"11\" sensor_id=\"1\" component_id=\"0\" label=\"{label}\"><transform>{pose}</transform></camera>\n"
            ),
            _ => format!(
                "<camera id=\"1{id}\" sensor_id=\"{id}\" master_id=\"11\" label=\"{label}\"><orientation>1</orientation></camera>\n"
            ),
        };
    }
    let text = format!(
        "<document version=\"2.0.0\"><chunk label=\"c\">\n<sensors>{sensors}</sensors>\n\
         <components><component id=\"0\"><transform><rotation locked=\"true\">{}</rotation><translation locked=\"true\">1 2 3</translation>\
         <scale locked=\"true\">2</scale></transform></component></components>\n<cameras>{list}</cameras>\n</chunk></document>\n",
        spaced(&turn.transpose().to_cols_array())
    );
    write(folder.join("cameras.xml"), text).unwrap();
}

fn assert_placed(folder: &Path, cameras: &[Camera]) {
    let capture = open(folder).unwrap();
    assert_eq!(names(&capture), NAMES, "{:?}", capture.remarks);
    for (id, (view, camera)) in capture.views.iter().zip(cameras).enumerate() {
        assert!((view.position() - camera.center).length() < 1e-9, "{}: {}", view.name, view.position());
        // A point off the axis: the view's rotation, and its own focal length.
        let point = DVec3::new(0.2, 0.3, -0.1);
        let seen = camera.rotation * (point - camera.center);
        let expected = DVec2::new(30.0, 20.0) + seen.truncate() / seen.z * (50.0 + id as f64);
        let pixel = view.project(point).unwrap();
        assert!((pixel - expected).length() < 1e-9, "{}: {pixel} instead of {expected}", view.name);
    }
}

#[test]
fn slaves_follow_their_master() {
    let folder = tempfile::tempdir().unwrap();
    let cameras = cameras(&NAMES);
    pictures_and_mesh(folder.path(), &cameras);
    rig(folder.path(), &cameras, Some(DMat4::IDENTITY));
    assert_placed(folder.path(), &cameras);
    // The master is listed after its slaves, and in a group.
    change(&folder.path().join("cameras.xml"), |text| {
        let start = text.find("<camera id=\"11\"").unwrap();
        let end = start + text[start..].find("</camera>").unwrap() + "</camera>".len();
        let (master, rest) = (&text[start..end], [&text[..start], &text[end..]].concat());
        rest.replace("</cameras>", &format!("<group>{master}</group></cameras>"))
    });
    assert_placed(folder.path(), &cameras);
}

#[test]
fn a_master_may_have_an_offset_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let cameras = cameras(&NAMES);
    pictures_and_mesh(folder.path(), &cameras);
    let offset = DMat4::from_rotation_translation(DQuat::from_rotation_x(0.4), DVec3::new(0.5, -0.2, 0.1));
    rig(folder.path(), &cameras, Some(offset));
    assert_placed(folder.path(), &cameras);
}

#[test]
fn an_offset_that_is_not_stated_is_none() {
    let folder = tempfile::tempdir().unwrap();
    // All cameras of the rig are in one place.
    let mut cameras = cameras(&NAMES);
    let master = cameras[1].clone();
    cameras.iter_mut().for_each(|camera| {
        (camera.rotation, camera.center) = (master.rotation, master.center);
    });
    pictures_and_mesh(folder.path(), &cameras);
    rig(folder.path(), &cameras, None);
    assert_placed(folder.path(), &cameras);
}

#[test]
fn slaves_of_a_master_that_is_not_aligned_are_left_out_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let cameras = cameras(&NAMES);
    pictures_and_mesh(folder.path(), &cameras);
    rig(folder.path(), &cameras, Some(DMat4::IDENTITY));
    // c is aligned on its own, d is its slave, and a the slave of one that is not in the file.
    change(&folder.path().join("cameras.xml"), |text| {
        let start = text.rfind("<transform>").unwrap();
        let end = start + text[start..].find("</transform>").unwrap() + "</transform>".len();
        let pose = text[start..end].to_string();
        let text = [&text[..start], &text[end..]].concat();
        let text = text.replace(
            "id=\"10\" sensor_id=\"0\" master_id=\"11\"",
            "id=\"10\" sensor_id=\"0\" master_id=\"77\"",
        );
        let text = text.replace(
            "id=\"13\" sensor_id=\"3\" master_id=\"11\"",
            "id=\"13\" sensor_id=\"3\" master_id=\"12\"",
        );
        text.replace("master_id=\"11\" label=\"c\">", &format!("label=\"c\">{pose}"))
    });
    let capture = open(folder.path()).unwrap();
    assert_eq!(names(&capture), ["c.jpg", "d.jpg"], "{:?}", capture.remarks);
    let told = capture.remarks.iter().find(|remark| remark.text.contains("slave")).unwrap();
    assert!(
        told.text.contains("1 slave of a rig has no pose") && told.text.contains("not aligned"),
        "{told}"
    );
    assert!(capture.remarks.iter().any(|remark| remark.names == ["a", "b"]), "{:?}", capture.remarks);
}

#[test]
fn circles_and_bad_offsets_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let cameras = cameras(&NAMES);
    pictures_and_mesh(folder.path(), &cameras);
    let file = folder.path().join("cameras.xml");
    rig(folder.path(), &cameras, Some(DMat4::IDENTITY));
    let good = std::fs::read_to_string(&file).unwrap();
    let circle = good.replace("<transform>", "<t>").replace("</transform>", "</t>");
    let circle = circle.replace("component_id=\"0\" label=\"b\"", "master_id=\"10\" label=\"b\"");
    write(&file, circle).unwrap();
    assert!(refused(folder.path()).contains("no chunk has an aligned camera"));
    let sensor = |text: &str| good.replacen("<rotation locked=\"false\">", &format!("<rotation>{text}"), 1);
    for (rotation, what) in [
        ("nonsense ", "sensor \"s0\": its rotation is not 9 numbers"),
        ("2 0 0 0 1 0 0 0 1</rotation><x>", "without stretching or mirroring"),
        ("-1 0 0 0 1 0 0 0 1</rotation><x>", "without stretching or mirroring"),
    ] {
        let text = sensor(rotation);
        let text = if rotation.contains("<x>") {
            text.replacen("</rotation><location", "</x><location", 1)
        } else {
            text
        };
        write(&file, text).unwrap();
        let sentence = refused(folder.path());
        assert!(sentence.contains(what), "{sentence}");
    }
}

#[test]
fn the_rig_of_the_shared_cases_has_the_poses_of_colmap() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/cases/field2/06-metashape-as-it-is-exported");
    if !folder.is_dir() {
        println!("SKIPPED: there is no {}", folder.display());
        return;
    }
    let (rig, base) = (open(&folder.join("rig")).unwrap(), open(&folder.join("base")).unwrap());
    assert_eq!((rig.views.len(), base.views.len()), (5, 5), "{:?}", rig.remarks);
    for (a, b) in rig.views.iter().zip(&base.views) {
        assert_eq!((&a.name, a.lens), (&b.name, b.lens));
        assert!(a.camera_to_world.abs_diff_eq(b.camera_to_world, 1e-9), "{}", a.name);
    }
}
