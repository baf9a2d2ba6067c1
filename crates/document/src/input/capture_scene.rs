//! Captures as scenes.

use crate::camera_path::camera_between;
use crate::error::DocumentError;
use crate::input::depth_scene::load_depth_picture;
use crate::input::disparity_error::{DisparityError, disparity_error};
use crate::input::light_field_scene::load_light_field;
use crate::input::picture_surface::PictureSurface;
use capture::{
    Capture, CaptureError, CaptureKind, CaptureOptions, DepthPictureOptions, DepthQuantity,
    LightFieldOptions, MeshFit, NearEnd,
};
use glam::{DVec2, DVec3};
use lens::{Camera, Intrinsics};
use light::{DiskCache, Steps};
use progress::{Progress, Stage};
use project::CaptureChoices;
use scene::{LoadOptions, Scene, View};
use std::path::Path;
use std::sync::Arc;

/// Names of photographs' cameras consist of this prefix and the photograph's name.
pub(crate) const PHOTOGRAPH_PREFIX: &str = "photo:";

impl From<CaptureError> for DocumentError {
    fn from(error: CaptureError) -> Self {
        match error {
            CaptureError::Cancelled(_) => Self::Cancelled,
            CaptureError::NearUnknown { ref file } => {
                Self::NearUnknown { map: file.clone(), text: error.to_string() }
            }
            other => Self::BadInput(other.to_string()),
        }
    }
}

/// An opened capture.
pub(crate) struct CaptureScene {
    pub scene: Arc<Scene>,
    /// The initial camera, if it is not the scene's first.
    pub camera: Option<Camera>,
    /// Anything missing or worth knowing, a sentence each.
    pub remarks: Vec<String>,
    /// Whether something that the capture refers to is missing.
    pub is_incomplete: bool,
    /// How well the mesh fits the photographs.
    pub mesh_fit: Option<MeshFit>,
}

/// Whether a file or folder is a capture that can be opened. A picture is one if it has depth.
pub fn is_capture(path: &Path) -> bool {
    capture::detect_capture_kind(path).is_ok()
}

/// The error of disparities estimated from the views of a light field, against those that came with it; `None` if none came with it, or the
/// capture is no light field.
pub(crate) fn capture_disparity_error(
    path: &Path,
    choices: &CaptureChoices,
    cache: &DiskCache,
    progress: &dyn Progress,
) -> Result<Option<DisparityError>, DocumentError> {
    let requested_kind = choices.kind.as_deref().and_then(CaptureKind::from_name);
    let kind = requested_kind.map_or_else(|| capture::detect_capture_kind(path), Ok)?;
    if kind != CaptureKind::LightField {
        return Ok(None);
    }
    let options = LightFieldOptions { disparity: choices.disparity.clone(), ..Default::default() };
    let field = capture::open_light_field(path, &options, &Stage::new(progress, 0.0, 0.1))?;
    disparity_error(&field, &options.load, cache, &Stage::new(progress, 0.1, 1.0))
}

/// Reads a capture: a folder of photographs, a light field, or a picture with its depth.
pub(crate) fn load_capture(
    path: &Path,
    choices: &CaptureChoices,
    cache: &DiskCache,
    steps: &dyn Steps,
) -> Result<CaptureScene, DocumentError> {
    let kind = match &choices.kind {
        Some(name) => CaptureKind::from_name(name).ok_or_else(|| {
            DocumentError::bad_file(
                path,
                format!("\"{name}\" is no kind of capture (use photographs, lightfield or depth)"),
            )
        })?,
        // A picture whose depth is specified separately needs none of its own.
        None if !path.is_dir() && (choices.depth.is_some() || choices.disparity.is_some()) => {
            CaptureKind::Depth
        }
        None => capture::detect_capture_kind(path)?,
    };
    if choices.layer.is_some() && kind != CaptureKind::Depth {
        let what = "has no layers to choose from: it is not a picture with depth (leave out --layer)";
        return Err(DocumentError::bad_file(path, what));
    }
    let near = choices.near.as_ref().map(|near| near.parse::<NearEnd>());
    let near = near.transpose().map_err(|message| DocumentError::BadInput(format!("--near {message}")))?;
    let load = LoadOptions::default();
    let surface = match kind {
        CaptureKind::Photographs => return load_photographs(path, choices, &*steps.begin("reading")),
        CaptureKind::LightField => {
            let options =
                LightFieldOptions { disparity: choices.disparity.clone(), near, load, ..Default::default() };
            load_light_field(path, &options, &choices.depth_strokes, cache, steps)?
        }
        CaptureKind::Depth => {
            let disparity = choices.disparity.clone().map(|file| (file, DepthQuantity::Disparity));
            let depth = choices.depth.clone().map(|file| (file, DepthQuantity::Depth)).or(disparity);
            let options = DepthPictureOptions { depth, layer: choices.layer.clone(), near, load };
            load_depth_picture(path, &options, &choices.depth_strokes, steps)?
        }
    };
    let PictureSurface { scene, camera, remarks, is_incomplete } = surface;
    Ok(CaptureScene { scene: Arc::new(scene), camera: Some(camera), remarks, is_incomplete, mesh_fit: None })
}

/// Reads the photographs in a folder, and the mesh of the scene that they show.
fn load_photographs(
    folder: &Path,
    choices: &CaptureChoices,
    progress: &dyn Progress,
) -> Result<CaptureScene, DocumentError> {
    let options = CaptureOptions { mesh: choices.mesh.clone(), ..CaptureOptions::default() };
    let Capture { views, mut scene, remarks, fit: mesh_fit, .. } = capture::open(folder, &options, progress)?;
    if let Some(name) = choices.leave_out.iter().find(|name| !views.iter().any(|view| view.name == **name)) {
        return Err(DocumentError::bad_file(
            folder,
            format!("no photograph is called \"{name}\" ({})", list_names(views.iter())),
        ));
    }
    let is_left_out = |view: &View| choices.leave_out.contains(&view.name);
    let (left_out, views): (Vec<View>, Vec<View>) = views.into_iter().partition(is_left_out);
    if views.is_empty() {
        return Err(DocumentError::bad_file(folder, "all photographs are left out (leave out fewer)"));
    }
    scene.path = folder.into();
    (scene.views, scene.excluded_views) = (views, left_out);
    let is_incomplete = remarks.iter().any(|remark| remark.is_incomplete);
    let remarks = remarks.into_iter().map(|remark| remark.text).collect();
    Ok(CaptureScene { scene: Arc::new(scene), camera: None, remarks, is_incomplete, mesh_fit })
}

/// The camera for a name after [`PHOTOGRAPH_PREFIX`]: that of a photograph, or for `A..B@SHARE` one between two photographs; otherwise the
/// error message.
pub(crate) fn parse_photograph_camera(
    scene: &Scene,
    name: &str,
    template_camera: &Camera,
) -> Result<Camera, String> {
    let camera = |name: &str| {
        find_photograph(scene, name).map(|view| camera_from_photograph(scene.bounds(), view, template_camera))
    };
    let interpolated = || {
        let (names, share) = name.rsplit_once('@')?;
        let (from, to) = names.split_once("..")?;
        let share = share.parse().ok().filter(|share| (0.0..=1.0).contains(share))?;
        Some((from, to, share))
    };
    match (camera(name), interpolated()) {
        (Err(_), Some((from, to, share))) => Ok(camera_between(&camera(from)?, &camera(to)?, share)),
        (camera, _) => camera,
    }
}

/// The photograph of this name, whether left out or not.
///
/// # Errors
/// There is none. The message lists the names of photographs.
pub fn find_photograph<'a>(scene: &'a Scene, name: &str) -> Result<&'a View, String> {
    let mut views = scene.all_views();
    let view = views.find(|view| view.name == name);
    view.ok_or_else(|| format!("no photograph is called \"{name}\" ({})", list_names(scene.all_views())))
}

fn list_names<'a>(views: impl Iterator<Item = &'a View>) -> String {
    const MAX_LISTED: usize = 8;
    let mut names = views.map(|view| view.name.as_str());
    let listed: Vec<&str> = names.by_ref().take(MAX_LISTED).collect();
    let more = if names.next().is_some() { ", …" } else { "" };
    match listed.is_empty() {
        true => "there are no photographs".into(),
        false => format!("there are {}{more}", listed.join(", ")),
    }
}

/// The camera of a photograph without lens distortion: a pinhole, with the sensor shifted by the offset of the principal point from the
/// picture's centre. Sensor height and background are those of `template_camera`. `bounds` are the lowest and highest corner of the scene.
pub fn camera_from_photograph(bounds: (DVec3, DVec3), view: &View, template_camera: &Camera) -> Camera {
    let [width, height] = view.lens.size_px();
    let Intrinsics { focal_px: [_, focal_px], principal_px: [x, y], .. } = *view.lens.intrinsics();
    let shift = (DVec2::new(0.5 * f64::from(width) - x, y - 0.5 * f64::from(height))) / f64::from(height);
    let depth_of = |point: DVec3| (point - view.position()).dot(view.forward());
    let center_depth = depth_of(0.5 * (bounds.0 + bounds.1));
    Camera {
        width,
        height,
        yfov: 2.0 * (0.5 * f64::from(height) / focal_px).atan(),
        focus_distance: if center_depth > 0.0 { center_depth } else { template_camera.focus_distance },
        aperture_radius: 0.0,
        shift,
        camera_to_world: view.camera_to_world,
        ..template_camera.clone()
    }
}
