//! Malicious captures: nothing outside the folder is read, counts in files are not trusted, nothing takes long.

use crate::made::{PLY, SIZE, cameras, change, colmap, names, open, picture, refused};
use std::fs::{create_dir_all, remove_dir_all, remove_file, write};
use std::path::Path;
use std::time::{Duration, Instant};

#[test]
fn names_that_lead_outside_match_nothing() {
    let outside = tempfile::tempdir().unwrap();
    picture(&outside.path().join("secret.jpg"), SIZE);
    let folder = tempfile::tempdir_in(outside.path()).unwrap();
    let absolute = outside.path().join("secret.jpg").display().to_string();
    let all = ["a.jpg", "../../secret.jpg", "..\\..\\secret.jpg", &absolute];
    let all = cameras(&all);
    picture(&folder.path().join("images/a.jpg"), SIZE);
    write(folder.path().join("mesh.ply"), PLY).unwrap();
    crate::made::colmap_text(&folder.path().join("sparse/0"), &all);
    let capture = open(folder.path()).unwrap();
    assert_eq!(names(&capture), ["a.jpg"]);
    assert_eq!(capture.remarks[0].names.len(), 3, "{:?}", capture.remarks);
}

#[cfg(unix)]
#[test]
fn links_that_lead_outside_are_not_followed() {
    use std::os::unix::fs::symlink;
    let outside = colmap(&["a.jpg"]);
    // A folder of pictures.
    let folder = colmap(&["a.jpg"]);
    remove_dir_all(folder.path().join("images")).unwrap();
    symlink(outside.path().join("images"), folder.path().join("images")).unwrap();
    let text = refused(folder.path());
    assert!(
        text.contains("images: is a link that leads outside") && text.contains("name their folder"),
        "{text}"
    );
    // A picture.
    let folder = colmap(&["a.jpg", "b.jpg"]);
    remove_file(folder.path().join("images/a.jpg")).unwrap();
    symlink(outside.path().join("images/a.jpg"), folder.path().join("images/a.jpg")).unwrap();
    assert_eq!(names(&open(folder.path()).unwrap()), ["b.jpg"]);
    // The mesh.
    let folder = colmap(&["a.jpg"]);
    remove_file(folder.path().join("mesh.ply")).unwrap();
    symlink(outside.path().join("mesh.ply"), folder.path().join("mesh.ply")).unwrap();
    assert!(refused(folder.path()).contains("mesh.ply leads outside the folder"));
    // The cameras.
    let folder = colmap(&["a.jpg"]);
    remove_file(folder.path().join("sparse/0/cameras.txt")).unwrap();
    symlink(outside.path().join("sparse/0/cameras.txt"), folder.path().join("sparse/0/cameras.txt")).unwrap();
    assert!(refused(folder.path()).contains("no cameras of photographs"));
    // Links inside are fine.
    let folder = colmap(&["a.jpg"]);
    std::fs::rename(folder.path().join("images"), folder.path().join("b")).unwrap();
    symlink("b", folder.path().join("images")).unwrap();
    assert_eq!(names(&open(folder.path()).unwrap()), ["a.jpg"]);
}

/// The error of a capture with this file, within the time limit.
fn refusal(file: &str, bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    crate::made::pictures_and_mesh(folder.path(), &cameras(&["a.jpg"]));
    create_dir_all(folder.path().join("sparse")).unwrap();
    let write_to = |file: &str, bytes: &[u8]| write(folder.path().join(file), bytes).unwrap();
    write_to("sparse/cameras.bin", &[0; 8]);
    write_to("sparse/images.bin", &[0; 8]);
    write_to(file, bytes);
    let start = Instant::now();
    let text = refused(folder.path());
    assert!(start.elapsed() < Duration::from_secs(5), "{file}: {:?}", start.elapsed());
    text
}

#[test]
fn counts_are_checked_against_the_size_of_the_file() {
    let counted = |count: u64, rest: &[u8]| [&count.to_le_bytes(), rest].concat();
    for count in [u64::MAX, 1 << 60, 2] {
        let text = refusal("sparse/cameras.bin", &counted(count, &[0; 50]));
        assert!(
            text.contains(&format!(
                "cameras.bin: byte 0: declares {count} cameras, but only 50 bytes are left"
            )),
            "{text}"
        );
        let text = refusal("sparse/images.bin", &counted(count, &[0; 100]));
        assert!(text.contains(&format!("declares {count} pictures, but only 100 bytes are left")), "{text}");
    }
    // The points of a picture.
    let head =
        [&3u32.to_le_bytes()[..], &1f64.to_le_bytes(), &[0; 48], &7u32.to_le_bytes(), b"a.jpg\0"].concat();
    let text =
        refusal("sparse/images.bin", &counted(1, &[&head[..], &(u64::MAX / 24).to_le_bytes()].concat()));
    assert!(text.contains("points in a picture, but only 0 bytes are left"), "{text}");
    // A name without an end.
    let text =
        refusal("sparse/images.bin", &counted(1, &[&head[..head.len() - 1], &[b'x'; 200_000]].concat()));
    assert!(text.contains("the name of picture 3 does not end"), "{text}");
}

#[test]
fn deep_nesting_is_refused() {
    let deep = |open: &str, close: &str| open.repeat(200_000) + &close.repeat(200_000);
    let folder = |file: &str, text: String| {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path().join(file), text).unwrap();
        let start = Instant::now();
        let text = refused(folder.path());
        assert!(start.elapsed() < Duration::from_secs(5), "{file}: {:?}", start.elapsed());
        text
    };
    let json = folder("transforms.json", format!("{{\"frames\": {}}}", deep("[", "]")));
    assert!(json.contains("recursion limit"), "{json}");
    folder("cameras.xml", format!("<document><chunk>{}</chunk></document>", deep("<a>", "</a>")));
    // Content that takes a parser much more memory than its text.
    let objects = folder("transforms.json", format!("{{\"frames\": [{}0]}}", "{\"\":0},".repeat(4_000_000)));
    assert!(objects.contains("more than 200000 objects"), "{objects}");
    let attributes: String = (0..200_000).map(|k| format!(" a{k}=\">\"")).collect();
    let xml = folder("cameras.xml", format!("<document><chunk{attributes}></chunk></document>"));
    assert!(xml.contains("more than 1000 attributes"), "{xml}");
    // Entities that grow.
    let bomb = "<!DOCTYPE d [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;\">]><document><chunk>&b;</chunk></document>";
    let xml = folder("cameras.xml", bomb.into());
    assert!(xml.contains("its XML is invalid"), "{xml}");
}

#[test]
fn rows_of_nothing_and_endless_lists_take_no_time() {
    let folder = colmap(&["a.jpg"]);
    let file = folder.path().join("mesh.ply");
    let timed = |file: &Path| {
        let start = Instant::now();
        let opened = open(file.parent().unwrap())
            .map(|capture| capture.scene.triangles.len())
            .map_err(|e| e.to_string());
        assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
        opened
    };
    change(&file, |text| {
        text.replace("element vertex 4", "element nothing 18446744073709551615\nelement vertex 4")
    });
    assert_eq!(timed(&file), Ok(4));
    write(&file, PLY.replace("element vertex 4", "element vertex 18446744073709551615")).unwrap();
    assert!(timed(&file).unwrap_err().contains("do not fit"));
    write(&file, PLY.replace("3 0 1 2", "inf 0 1 2")).unwrap();
    assert!(timed(&file).unwrap_err().contains("a list of inf does not fit"));
}

#[test]
fn cancelled_is_not_opened() {
    struct Unwanted;
    impl progress::Progress for Unwanted {
        fn report(&self, _: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let folder = colmap(&["a.jpg"]);
    let opened = capture::open(folder.path(), &capture::CaptureOptions::default(), &Unwanted);
    assert!(matches!(opened, Err(capture::CaptureError::Cancelled(_))));
}
