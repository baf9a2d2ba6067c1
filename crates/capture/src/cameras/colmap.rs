//! COLMAP's sparse models: `cameras` and `images`, as text or binary. Rigs, frames and points are not needed: `images` has every
//! pose.

mod binary_model;
mod camera_model;
mod records;
mod text_model;

use crate::CaptureError;
use crate::cameras::pose;
use crate::cameras::shot::{Shot, ShotLens, Shots};
use crate::files::folder::Folder;
use std::path::{Path, PathBuf};

/// The two files of a model that are read.
#[derive(Clone, Debug)]
pub(crate) struct Model {
    cameras: PathBuf,
    pub images: PathBuf,
    is_binary: bool,
}

impl Model {
    /// The model in the folder `path`, if there is one; binary files take precedence, as in COLMAP.
    pub fn find(folder: &Folder, path: &Path) -> Option<Self> {
        [("bin", true), ("txt", false)].into_iter().find_map(|(extension, is_binary)| {
            let [cameras, images] =
                ["cameras", "images"].map(|name| path.join(format!("{name}.{extension}")));
            let is_there = folder.has_file(&cameras) && folder.has_file(&images);
            is_there.then_some(Self { cameras, images, is_binary })
        })
    }

    /// Reads the pictures of the model, with their lenses and poses.
    ///
    /// # Errors
    /// A file of the model cannot be read or is malformed.
    pub fn read(&self) -> Result<Shots, CaptureError> {
        let cameras = match self.is_binary {
            true => binary_model::cameras(&self.cameras)?,
            false => text_model::cameras(&self.cameras)?,
        };
        let (images, notes) = match self.is_binary {
            true => (binary_model::images(&self.images)?, Vec::new()),
            false => text_model::images(&self.images)?,
        };
        let mut shots = Shots { notes, ..Shots::default() };
        for image in images {
            let place = format!("{}: picture {:?}", image.place, image.name);
            let Some(lens) = cameras.get(&image.camera) else {
                let cameras_file = self.cameras.file_name().unwrap_or_default().to_string_lossy();
                let what = format!("its camera {} is not in {cameras_file}", image.camera);
                return Err(CaptureError::malformed(&self.images, place, what));
            };
            let Some(camera_to_world) = pose::from_world_to_camera(image.quaternion, image.translation)
            else {
                return Err(CaptureError::malformed(
                    &self.images,
                    place,
                    "its rotation is not a unit quaternion",
                ));
            };
            let lens = ShotLens::Calibrated(*lens);
            shots.shots.push(Shot {
                name: image.name,
                place: image.place,
                lens,
                camera_to_world,
                mask: None,
            });
        }
        Ok(shots)
    }
}
