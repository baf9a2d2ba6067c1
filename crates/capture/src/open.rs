//! Opening a capture: the story from top to bottom.

use crate::cameras::layout::Cameras;
use crate::cameras::upright::estimate_upright;
use crate::files::folder::Folder;
use crate::mesh_fit::MeshFit;
use crate::mesh_place::MeshPlace;
use crate::pictures::picture_folder::PictureSearch;
use crate::{CameraFormat, CaptureError, Remark, mesh, pictures};
use glam::DQuat;
use progress::{Progress, Stage};
use scene::{LoadOptions, Scene, View};
use std::path::{Path, PathBuf};

/// Options for reading a capture.
#[derive(Clone, Debug, Default)]
pub struct CaptureOptions {
    /// Which cameras to read if there are several; `None`: the first in the order of [`CameraFormat`] whose pictures
    /// exist.
    pub camera_format: Option<CameraFormat>,
    /// The folder of the pictures; `None`: looked for in the capture's folder.
    pub pictures: Option<PathBuf>,
    /// The mesh; `None`: looked for in the capture's folder.
    pub mesh: Option<PathBuf>,
    /// Limits on memory and size of the mesh.
    pub load: LoadOptions,
}

/// A place: photographs with their cameras, and its surface, in one world.
///
/// That world is the capture's own, neither rotated nor scaled: measurements and exports match other files of the capture.
#[derive(Clone, Debug)]
pub struct Capture {
    /// The format of the cameras.
    pub camera_format: CameraFormat,
    /// The file that the cameras were read from.
    pub cameras: PathBuf,
    /// The file that the surface was read from.
    pub mesh: PathBuf,
    /// The photographs, by name; at least one.
    pub views: Vec<View>,
    /// The surface; irregularities of it are in [`Scene::warnings`].
    pub scene: Scene,
    /// The rotation that would make +y up, estimated from how the cameras were held: the worlds of most programs have no up direction, or
    /// another one. It is for viewing the scene; neither surface nor cameras are rotated by it.
    pub upright: DQuat,
    /// How well the surface fits the photographs; `None` if they do not tell, as those of blank walls do not.
    pub fit: Option<MeshFit>,
    /// What was incomplete, or is good to know.
    pub remarks: Vec<Remark>,
}

/// Opens the capture in a folder: its cameras, the headers of its pictures, its mesh.
///
/// # Errors
/// It is no capture, a file of it is malformed or exceeds the limits, none of its pictures exists, or there is no mesh.
/// [`CaptureError::Cancelled`] if `progress` cancels.
pub fn open(path: &Path, options: &CaptureOptions, progress: &dyn Progress) -> Result<Capture, CaptureError> {
    let (folder, within) = capture_folder(path)?;
    let mut candidates = Cameras::find(&folder);
    candidates.retain(|cameras| options.camera_format.is_none_or(|kind| kind == cameras.format()));
    // A caller that names a model's folder wants that model.
    candidates.sort_by_key(|cameras| !cameras.file().starts_with(&within));
    let mut remarks = Vec::new();
    let (cameras, views) = first_usable_views(
        &folder,
        &candidates,
        options,
        &Stage::named(progress, "pictures", 0.0, 0.5),
        &mut remarks,
    )?;
    let used = cameras.file();
    let others = candidates.iter().map(Cameras::file).filter(|file| *file != used);
    remarks.extend(Remark::about(others.map(|file| file.display().to_string()).collect(), false, |names| {
        let used = used.display();
        format!("{used}: is used for the cameras; there are also {names} (specify a kind to use those)")
    }));
    let mesh = match &options.mesh {
        Some(mesh) => mesh.clone(),
        None => mesh::find_mesh(&folder, &mut remarks)?,
    };
    let reading = Stage::named(progress, "surface", 0.5, 0.8);
    let mut scene = mesh::read_mesh(&mesh, &options.load, &reading, &mut remarks)?;
    let upright = estimate_upright(&views);
    let search = MeshPlace { folder: &folder, mesh: &mesh, options: &options.load };
    let fit = search.fit_mesh(&mut scene, &views, &Stage::named(progress, "fit", 0.8, 1.0), &mut remarks)?;
    scene.set_upright(upright);
    progress.report(1.0);
    Ok(Capture {
        camera_format: cameras.format(),
        cameras: cameras.file().into(),
        mesh,
        views,
        scene,
        upright,
        fit,
        remarks,
    })
}

/// The folder of the whole capture, where `path` may be that of a model within it (`sparse/0`), and the folder that
/// was requested.
fn capture_folder(path: &Path) -> Result<(Folder, PathBuf), CaptureError> {
    let is_model = |path: &Path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("sparse") || name.parse::<u32>().is_ok()
    };
    if !is_model(path) {
        return Ok((Folder::open(path)?, path.into()));
    }
    let within = dunce::canonicalize(path).map_err(|source| CaptureError::unreadable(path, source))?;
    // The nearest folder above that is no model's; a folder of photographs may be called 2024, too, and has no model
    // of its own.
    let above = within.ancestors().skip(1).find(|above| !is_model(above)).map(Folder::open).transpose()?;
    let has_it =
        |folder: &Folder| Cameras::find(folder).iter().any(|cameras| cameras.file().starts_with(&within));
    match above.filter(has_it) {
        Some(above) => Ok((above, within)),
        None => Ok((Folder::open(path)?, path.into())),
    }
}

/// The views of the first cameras whose pictures exist.
fn first_usable_views<'a>(
    folder: &Folder,
    candidates: &'a [Cameras],
    options: &CaptureOptions,
    progress: &dyn Progress,
    remarks: &mut Vec<Remark>,
) -> Result<(&'a Cameras, Vec<View>), CaptureError> {
    let mut failed = None;
    for cameras in candidates {
        let shots = cameras.read()?;
        let mut own_remarks = Vec::new();
        let source = PictureSearch { folder, cameras: cameras.file(), pictures: options.pictures.as_deref() };
        match pictures::views(&source, shots, progress, &mut own_remarks) {
            Ok(views) => {
                remarks.extend(own_remarks);
                return Ok((cameras, views));
            }
            Err(error @ CaptureError::NoPictures { .. }) => drop(failed.get_or_insert(error)),
            Err(error) => return Err(error),
        }
    }
    Err(failed.unwrap_or_else(|| CaptureError::NoCameras { folder: folder.shown.clone() }))
}
