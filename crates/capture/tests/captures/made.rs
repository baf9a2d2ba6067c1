//! Synthetic captures: small pictures around a tetrahedron.

use capture::{Capture, CaptureError, CaptureOptions};
use glam::{DMat3, DQuat, DVec3};
use image::{Rgb, RgbImage};
use progress::Unwatched;
use std::fs::{create_dir_all, write};
use std::path::Path;

/// Width and height of the pictures, and the focal length of their lens, whose axis is in the middle.
pub const SIZE: [u32; 2] = [60, 40];
pub const FOCAL: f64 = 50.0;

/// A camera: computer vision's axes (x right, y down, z forward).
#[derive(Clone, Debug)]
pub struct Camera {
    pub name: String,
    /// From the world to the camera.
    pub rotation: DQuat,
    pub center: DVec3,
}

/// Cameras on a ring that look at the origin, upright where +y is up.
pub fn cameras(names: &[&str]) -> Vec<Camera> {
    let of = |(index, name): (usize, &&str)| {
        let angle = 0.4 * index as f64;
        let center = DVec3::new(3.0 * angle.sin(), 1.0, 3.0 * angle.cos());
        let forward = -center.normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let to_world = DMat3::from_cols(right, forward.cross(right), forward);
        Camera { name: name.to_string(), rotation: DQuat::from_mat3(&to_world).inverse(), center }
    };
    names.iter().enumerate().map(of).collect()
}

impl Camera {
    /// The line of COLMAP's images.txt.
    pub fn colmap_line(&self, id: usize, camera: u32) -> String {
        let (q, t) = (self.rotation, self.rotation * -self.center);
        format!("{id} {} {} {} {} {} {} {} {camera} {}", q.w, q.x, q.y, q.z, t.x, t.y, t.z, self.name)
    }
}

/// A grey picture.
pub fn picture(file: &Path, [width, height]: [u32; 2]) {
    create_dir_all(file.parent().unwrap()).unwrap();
    RgbImage::from_pixel(width, height, Rgb([90; 3])).save(file).unwrap();
}

/// A picture for each camera below a folder, and the tetrahedron.
pub fn pictures_and_mesh(folder: &Path, cameras: &[Camera]) {
    cameras.iter().for_each(|camera| picture(&folder.join("images").join(&camera.name), SIZE));
    write(folder.join("mesh.ply"), PLY).unwrap();
}

/// A tetrahedron around the origin.
pub const PLY: &str = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    element face 4\nproperty list uchar int vertex_indices\nend_header\n\
    -1 -0.5 -0.5\n1 -0.5 -0.5\n0 -0.5 1\n0 1 0\n3 0 1 2\n3 0 3 1\n3 1 3 2\n3 2 3 0\n";

/// COLMAP's text model of one camera, PINHOLE, as it writes it.
pub fn colmap_text(folder: &Path, cameras: &[Camera]) {
    create_dir_all(folder).unwrap();
    let [width, height] = SIZE;
    let (cx, cy) = (width / 2, height / 2);
    let lens = format!("# Camera list\n7 PINHOLE {width} {height} {FOCAL} {FOCAL} {cx} {cy}\n");
    write(folder.join("cameras.txt"), lens).unwrap();
    let lines = cameras.iter().enumerate();
    let lines = lines
        .map(|(index, camera)| format!("{}\n1.5 2.5 -1 3.5 4.5 17\n", camera.colmap_line(10 * index + 3, 7)));
    write(folder.join("images.txt"), format!("# Image list\n{}", lines.collect::<String>())).unwrap();
}

/// A capture of COLMAP's text in a new folder.
pub fn colmap(names: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let cameras = cameras(names);
    pictures_and_mesh(folder.path(), &cameras);
    colmap_text(&folder.path().join("sparse/0"), &cameras);
    folder
}

/// Opens a capture.
pub fn open(folder: &Path) -> Result<Capture, CaptureError> {
    capture::open(folder, &CaptureOptions::default(), &Unwatched)
}

/// The names of a capture's views.
pub fn names(capture: &Capture) -> Vec<&str> {
    capture.views.iter().map(|view| view.name.as_str()).collect()
}

/// The error of a capture that cannot be opened: one sentence, `FILE: what (what to do)`.
pub fn refused(folder: &Path) -> String {
    let text = open(folder).unwrap_err().to_string();
    assert!(
        text.contains(": ") && text.ends_with(')') && text.contains(" (") && !text.contains('\n'),
        "{text}"
    );
    text
}

/// Changes a text file.
pub fn change(file: &Path, how: impl Fn(&str) -> String) {
    let text = std::fs::read_to_string(file).unwrap();
    let changed = how(&text);
    assert_ne!(changed, text, "{} does not change", file.display());
    write(file, changed).unwrap();
}
