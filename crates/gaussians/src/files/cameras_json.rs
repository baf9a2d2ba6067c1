//! `cameras.json` of 3DGS: the views that a scene was trained from.

use crate::cloud::Axes;
use crate::error::GaussianError;
use crate::placement::Placement;
use glam::{DMat3, DMat4, DVec3};
use lens::Camera;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The views beside a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraList {
    /// The file.
    pub file: PathBuf,
    /// The usable views, in the order of the file.
    pub views: Vec<CapturedView>,
    /// How many have no usable pose, size or focal length.
    pub left_out: usize,
}

/// A view that a scene was trained from.
#[derive(Clone, Debug, PartialEq)]
pub struct CapturedView {
    /// The name of its photograph.
    pub name: String,
    /// Width of the photograph, px.
    pub width: u32,
    /// Height of the photograph, px.
    pub height: u32,
    /// Full vertical angle of view, in (0, π).
    pub yfov: f64,
    /// Pose in the axes of the cloud's file; the camera has glTF's axes: it looks down −Z, +Y up.
    pub camera_to_file: DMat4,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Entry {
    View(RawView),
    Other(IgnoredAny),
}

#[derive(Deserialize)]
struct RawView {
    #[serde(default)]
    img_name: String,
    width: f64,
    height: f64,
    position: [f64; 3],
    rotation: [[f64; 3]; 3],
    fy: f64,
}

impl CameraList {
    /// The list that belongs to a scene's file: `cameras.json` beside it, or two folders up, where the trainer leaves it for
    /// `point_cloud/iteration_30000/point_cloud.ply`. `None` if there is none.
    pub fn path_beside(scene: &Path) -> Option<PathBuf> {
        let folder = scene.parent()?;
        let is_iteration = folder.file_name()?.to_string_lossy().starts_with("iteration_");
        let model = folder.parent().and_then(Path::parent).filter(|_| is_iteration);
        [Some(folder), model]
            .into_iter()
            .flatten()
            .map(|folder| folder.join("cameras.json"))
            .find(|file| file.is_file())
    }

    /// Reads a list.
    ///
    /// # Errors
    /// The file cannot be read, is longer than a list of 100,000 views, or is no such list.
    pub fn read(file: &Path) -> Result<Self, GaussianError> {
        /// A view takes about 500 bytes.
        const MAX_BYTES: u64 = 50_000_000;
        let unreadable = |source| GaussianError::unreadable(file, source);
        let mut text = Vec::new();
        File::open(file)
            .map_err(unreadable)?
            .take(MAX_BYTES + 1)
            .read_to_end(&mut text)
            .map_err(unreadable)?;
        if text.len() as u64 > MAX_BYTES {
            return Err(GaussianError::malformed(file, "size", "is longer than any list of cameras"));
        }
        Self::parse(file, &text)
    }

    fn parse(file: &Path, text: &[u8]) -> Result<Self, GaussianError> {
        let malformed =
            |e: serde_json::Error| GaussianError::malformed(file, format!("line {}", e.line()), e);
        let entries: Vec<Entry> = serde_json::from_slice(text).map_err(malformed)?;
        let count = entries.len();
        let view = |entry| match entry {
            Entry::View(raw) => CapturedView::new(raw),
            Entry::Other(_) => None,
        };
        let views: Vec<CapturedView> = entries.into_iter().filter_map(view).collect();
        Ok(Self { file: file.into(), left_out: count - views.len(), views })
    }

    /// Where up is on average, in the axes of the cloud's file; `None` if the views do not agree on one.
    pub fn up(&self) -> Option<DVec3> {
        let sum: DVec3 = self.views.iter().map(|view| view.camera_to_file.y_axis.truncate()).sum();
        // Photographs from all around have their ups about one direction: a mean of at least half the length.
        (sum.length() > 0.5 * self.views.len() as f64).then(|| sum.normalize())
    }
}

impl CapturedView {
    /// `None` if a number is not usable.
    fn new(raw: RawView) -> Option<Self> {
        let RawView { img_name: name, width, height, position, rotation, fy } = raw;
        let side = |pixels: f64| {
            let is_valid =
                pixels >= 1.0 && pixels <= f64::from(Camera::LARGEST_SIDE_PX) && pixels.fract() == 0.0;
            is_valid.then_some(pixels as u32)
        };
        let (width, height) = (side(width)?, side(height)?);
        let yfov = 2.0 * (f64::from(height) / (2.0 * fy)).atan();
        let position = DVec3::from_array(position);
        // Rows of the file; the camera looks along its third column, with the second down.
        let axes = DMat3::from_cols_array_2d(&rotation).transpose() * Axes::RIGHT_DOWN_FORWARD.to_gltf();
        let deviation = axes.transpose() * axes - DMat3::IDENTITY;
        let is_rigid = deviation.to_cols_array().iter().all(|e| e.abs() < 1e-3) && axes.determinant() > 0.0;
        let is_valid = fy > 0.0 && yfov > 0.0 && position.is_finite() && is_rigid;
        is_valid.then(|| Self {
            name,
            width,
            height,
            yfov,
            camera_to_file: DMat4::from_translation(position) * DMat4::from_mat3(axes),
        })
    }

    /// The camera of the view in the world in which the cloud is placed: its size, angle and pose, all else as `like` has it.
    pub fn camera(&self, placement: &Placement, like: &Camera) -> Camera {
        let position = placement.point(self.camera_to_file.w_axis.truncate());
        // A reflected cloud is seen by a camera whose right is left.
        let turned = placement.rotation * DMat3::from_mat4(self.camera_to_file);
        let turned = if turned.determinant() < 0.0 {
            turned * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0))
        } else {
            turned
        };
        Camera {
            width: self.width,
            height: self.height,
            yfov: self.yfov,
            camera_to_world: DMat4::from_translation(position) * DMat4::from_mat3(turned),
            ..like.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"[
        {"id": 0, "img_name": "a", "width": 100, "height": 80, "position": [1, 2, 3],
         "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "fx": 90.0, "fy": 40.0},
        {"id": 1, "img_name": "b", "width": 100, "height": 80, "position": [1, 2, 3],
         "rotation": [[1, 0, 0], [0, 2, 0], [0, 0, 1]], "fx": 90.0, "fy": 40.0},
        {"img_name": "c"},
        {"img_name": "d", "width": 10, "height": 20, "position": [0, 0, 0],
         "rotation": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], "fx": 20.0, "fy": 20.0}]"#;

    #[test]
    fn poses_are_those_of_the_trainer() {
        let list = CameraList::parse(Path::new("cameras.json"), TEXT.as_bytes()).unwrap();
        assert_eq!((list.views.len(), list.left_out), (2, 2));
        let view = &list.views[0];
        assert_eq!((view.width, view.height), (100, 80));
        assert!((view.yfov - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        // The camera of the trainer looks along +z of the file, with y down.
        let camera = view.camera(&Placement::IDENTITY, &Camera::default());
        camera.validate().unwrap();
        assert!(
            camera.camera_from_world(DVec3::new(1.0, 2.0, 7.0)).distance(DVec3::new(0.0, 0.0, 4.0)) < 1e-6
        );
        assert!(camera.camera_from_world(DVec3::new(1.0, 3.0, 7.0)).y < 0.0);
        // Upright, the same point is ahead all the same.
        let placement = Placement::upright(Axes::RIGHT_DOWN_FORWARD);
        let camera = view.camera(&placement, &Camera::default());
        let ahead = placement.point(DVec3::new(1.0, 2.0, 7.0));
        assert!(camera.camera_from_world(ahead).distance(DVec3::new(0.0, 0.0, 4.0)) < 1e-6);
        // The last one looks along +x: its forward column is (1, 0, 0).
        let sideways = list.views[1].camera(&Placement::IDENTITY, &Camera::default());
        assert!(
            sideways.camera_from_world(DVec3::new(5.0, 0.0, 0.0)).distance(DVec3::new(0.0, 0.0, 5.0)) < 1e-6
        );
        assert!(list.up().unwrap().distance(DVec3::NEG_Y) < 1e-12);
    }

    #[test]
    fn other_json_is_refused() {
        for text in ["{}", "[1", "null"] {
            assert!(CameraList::parse(Path::new("cameras.json"), text.as_bytes()).is_err(), "{text}");
        }
        assert_eq!(CameraList::parse(Path::new("c"), b"[1, {}]").unwrap().left_out, 2);
    }

    #[test]
    fn the_list_is_beside_the_scene_or_where_the_trainer_leaves_it() {
        let folder = tempfile::tempdir().unwrap();
        let nested = folder.path().join("point_cloud/iteration_30000");
        std::fs::create_dir_all(&nested).unwrap();
        let scene = nested.join("point_cloud.ply");
        assert_eq!(CameraList::path_beside(&scene), None);
        std::fs::write(folder.path().join("cameras.json"), TEXT).unwrap();
        assert_eq!(CameraList::path_beside(&scene), Some(folder.path().join("cameras.json")));
        assert_eq!(CameraList::read(&folder.path().join("cameras.json")).unwrap().views.len(), 2);
    }
}
