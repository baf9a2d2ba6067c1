//! Files that can be opened: scenes, projects, light fields and captures, as the renderers need them.

mod capture_scene;
mod depth_polarity;
mod depth_scene;
mod disparity_error;
mod disparity_estimate;
mod light_field_scene;
mod picture_regions;
mod picture_scene;
mod picture_surface;
mod picture_views;
mod variant_choice;

pub(crate) use capture_scene::load_capture;
pub use capture_scene::{camera_from_photograph, find_photograph, is_capture};
pub use depth_polarity::DepthPolarityRequest;
pub use disparity_error::DisparityError;
pub(crate) use picture_scene::picture_atlas;
pub use variant_choice::VariantChoice;

use crate::error::DocumentError;
use crate::input::capture_scene::{
    CaptureScene, PHOTOGRAPH_PREFIX, capture_disparity_error, parse_photograph_camera,
};
use crate::paint_transfer::TransferredPaint;
use crate::scene_camera::{shot_camera_from, shot_camera_in_any_unit};
use crate::scene_file::{add_floor, atlas_error, load_variant, show_splats};
use crate::splat_focus::{is_focus_table, read_splat_focus};
use atlas::{Atlas, AtlasError, UnwrapOptions};
use focus::{Focus, FocusMap, FocusRecipe, RecipeEntry};
use lens::{Camera, Exposure, FocusOffset};
use light::{LightOptions, LitScene, Resources, Steps, load_or_unwrap_atlas};
use progress::Progress;
use project::{
    CaptureChoices, FocusFile, ProjectError, ProjectFile, SceneState, SplatsFile, read_camera, read_focus,
};
use salf::{Salf, SalfFile};
use scene::{BackFaces, Fault, Scene, SceneError, World};
use std::ffi::OsStr;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use trace::Tracer;

impl From<ProjectError> for DocumentError {
    fn from(error: ProjectError) -> Self {
        use std::io::ErrorKind::{QuotaExceeded, ResourceBusy, StorageFull, TimedOut, WouldBlock};
        match &error {
            ProjectError::Read { source, .. } | ProjectError::Write { source, .. } => match source.kind() {
                StorageFull | QuotaExceeded | ResourceBusy | TimedOut | WouldBlock => {
                    Self::TryAgain(error.to_string())
                }
                _ => Self::BadInput(error.to_string()),
            },
            ProjectError::Unverified { .. } => Self::TryAgain(error.to_string()),
            _ => Self::BadInput(error.to_string()),
        }
    }
}

/// An opened file.
#[derive(Clone)]
pub struct Input {
    /// The file.
    pub path: PathBuf,
    /// The scene: its own, the project's, or the one that the light field was baked from.
    pub scene: Arc<Scene>,
    /// The camera to show it with, unless another one is requested.
    pub camera: Camera,
    /// If the file is a project: everything else in it.
    pub project: Option<ProjectFile>,
    /// If the file is a light field: the light field.
    pub salf: Option<Arc<Salf>>,
    /// If the file is a capture: the choices it was opened with.
    pub capture: Option<CaptureChoices>,
    /// Anything unusual but harmless about the files, a sentence each.
    pub warnings: Vec<String>,
    /// Whether something that the file refers to is missing, such as photographs of a capture.
    pub is_incomplete: bool,
    /// How well the mesh of photographs fits them, if they tell.
    pub mesh_fit: Option<capture::MeshFit>,
    /// How the project's paint was transferred to this surface, if it was painted on another.
    pub paint_transfer: Option<TransferredPaint>,
    /// How light is modelled.
    pub light: LightOptions,
    /// The disk cache and threads that work on it may use.
    pub resources: Resources,
}

/// A requested camera.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraChoice {
    /// A camera file; properties that it lacks are those of the input's own camera.
    File(PathBuf),
    /// The camera of this name in the scene or project.
    Named(String),
}

impl CameraChoice {
    /// The choice that a text stands for on the command line and in scripts: a file if it ends in `.json`, else a name. A path may hold any
    /// bytes; names are UTF-8: invalid bytes give one that matches nothing.
    pub fn from_argument(text: &OsStr) -> Self {
        let is_file = text.as_encoded_bytes().to_ascii_lowercase().ends_with(b".json");
        if is_file { Self::File(text.into()) } else { Self::Named(text.to_string_lossy().into()) }
    }
}

/// The kind of a file, by its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputKind {
    /// `.glb` or `.gltf`.
    Scene,
    /// `.fbrush`.
    Project,
    /// `.salf`.
    LightField,
    /// The folder of a capture, or a picture file that is one.
    Capture,
    /// Gaussian splats: `.ply`, `.spz`, `.sog` or its folder, `.splat`, `.ksplat`.
    Splats,
}

impl InputKind {
    /// The kind of the file or folder at `path`.
    ///
    /// # Errors
    /// There is no such file, or it is of none of these kinds.
    pub fn from_path(path: &Path) -> Result<Self, DocumentError> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        if gaussians::may_be_splats(path) && path.exists() {
            return Ok(Self::Splats);
        }
        if path.is_dir() {
            return Ok(Self::Capture);
        }
        match extension.as_str() {
            "glb" | "gltf" => Ok(Self::Scene),
            ProjectFile::EXTENSION | "recovery" => Ok(Self::Project),
            "salf" => Ok(Self::LightField),
            _ if !path.exists() => Err(DocumentError::bad_file(path, "no such file (check the path)")),
            _ if capture::may_be_picture(path) => Ok(Self::Capture),
            _ => {
                let extensions = format!(".glb, .gltf, .{} or .salf", ProjectFile::EXTENSION);
                Err(DocumentError::bad_file(
                    path,
                    format!(
                        "is not a scene, project, light field or file of splats (choose a {extensions} file, or .ply, .spz, .sog, .splat or .ksplat)"
                    ),
                ))
            }
        }
    }
}

impl Input {
    /// Whether file or project say from where the scene is seen.
    pub(crate) fn has_own_camera(&self) -> bool {
        self.project.is_some() || !self.scene.has_default_camera
    }

    /// Opens the file or folder at `path`.
    ///
    /// # Errors
    /// The file, or one that it refers to, cannot be read or used, or the work was cancelled.
    pub fn open(path: &Path, resources: &Resources, steps: &dyn Steps) -> Result<Self, DocumentError> {
        Self::open_variant(path, &VariantChoice::AsSaved, resources, steps)
    }

    /// Opens the file or folder at `path`, in a variant of its scene.
    ///
    /// # Errors
    /// Those of [`Self::open`]; or the scene has no such variant.
    pub fn open_variant(
        path: &Path,
        variant: &VariantChoice,
        resources: &Resources,
        steps: &dyn Steps,
    ) -> Result<Self, DocumentError> {
        match InputKind::from_path(path)? {
            InputKind::Scene | InputKind::Splats => Self::open_scene(path, variant, resources, steps),
            InputKind::Project => {
                Self::open_project(path, ProjectFile::load(path)?, variant, resources, steps)
            }
            InputKind::LightField => Self::open_light_field(path, variant, resources, steps),
            InputKind::Capture => Self::open_capture(path, CaptureChoices::default(), resources, steps),
        }
    }

    /// Opens the capture at `path`.
    ///
    /// # Errors
    /// The capture, or a file that `choices` names, cannot be read or used, or the work was cancelled.
    pub fn open_capture(
        path: &Path,
        choices: CaptureChoices,
        resources: &Resources,
        steps: &dyn Steps,
    ) -> Result<Self, DocumentError> {
        let loaded = load_capture(path, &choices, &resources.cache, steps)?;
        let CaptureScene { scene, camera, remarks: mut warnings, is_incomplete, mesh_fit } = loaded;
        warnings.extend(prefix_with_path(path, &scene.warnings));
        let camera = camera.unwrap_or_else(|| shot_camera_in_any_unit(&scene.cameras[0]));
        let input = Self::new(path, scene, camera, warnings, resources);
        Ok(Self { capture: Some(choices), is_incomplete, mesh_fit, ..input })
    }

    /// The error of disparities estimated from the views of a light field, against those that came with it; `None` if none came with it.
    ///
    /// # Errors
    /// The views cannot be read, or `progress` was cancelled.
    pub fn disparity_error(&self, progress: &dyn Progress) -> Result<Option<DisparityError>, DocumentError> {
        let project_choices = self.project.as_ref().and_then(|project| project.capture.as_ref());
        match (self.capture.as_ref().or(project_choices), &self.scene.picture) {
            (Some(choices), Some(_)) => {
                capture_disparity_error(&self.scene.path, choices, &self.resources.cache, progress)
            }
            _ => Ok(None),
        }
    }

    /// A complete input that is no project, light field or capture.
    fn new(
        path: &Path,
        scene: Arc<Scene>,
        camera: Camera,
        warnings: Vec<String>,
        resources: &Resources,
    ) -> Self {
        Self {
            path: path.into(),
            scene,
            camera,
            project: None,
            salf: None,
            capture: None,
            warnings,
            is_incomplete: false,
            mesh_fit: None,
            paint_transfer: None,
            light: LightOptions::default(),
            resources: resources.clone(),
        }
    }

    fn open_scene(
        path: &Path,
        variant: &VariantChoice,
        resources: &Resources,
        steps: &dyn Steps,
    ) -> Result<Self, DocumentError> {
        let scene = load_variant(path, variant.name(None), None, &*steps.begin("reading"))?;
        let camera = match scene.splats {
            // The unit of a scan is unknown.
            Some(_) if scene.surface_triangles().is_empty() => shot_camera_in_any_unit(&scene.cameras[0]),
            _ => shot_camera_from(&scene.cameras[0], &Camera::default()),
        };
        let warnings = prefix_with_path(path, &scene.warnings);
        Ok(Self::new(path, scene, camera, warnings, resources))
    }

    /// Opens the scene of `project`, which was read from `path`.
    pub(crate) fn open_project(
        path: &Path,
        project: ProjectFile,
        variant: &VariantChoice,
        resources: &Resources,
        steps: &dyn Steps,
    ) -> Result<Self, DocumentError> {
        let mut warnings = Vec::new();
        match project.scene_state() {
            SceneState::Same => {}
            SceneState::Changed => warnings.push(format!(
                "{}: its scene {} has changed since it was saved (check the paint before saving again)",
                path.display(),
                project.scene.display()
            )),
            SceneState::Missing => {
                let message = format!("its scene {} is missing (restore that file)", project.scene.display());
                return Err(DocumentError::bad_file(path, message));
            }
        }
        if let Some(choices) = &project.capture {
            let loaded = load_capture(&project.scene, choices, &resources.cache, steps)?;
            warnings.extend(loaded.remarks);
            let (is_incomplete, mesh_fit) = (loaded.is_incomplete, loaded.mesh_fit);
            return Ok(Self {
                is_incomplete,
                mesh_fit,
                ..Self::from_project(path, project, loaded.scene, warnings, resources)
            });
        }
        if let Some(file) = project.splats.as_ref().and_then(|splats| splats.file.as_ref())
            && !file.exists()
        {
            let message = format!("its splats {} are missing (restore that file)", file.display());
            return Err(DocumentError::bad_file(path, message));
        }
        let splats = project.splats.as_ref();
        let load_scene_variant =
            |variant| load_variant(&project.scene, variant, splats, &*steps.begin("reading"));
        let mut scene = match load_scene_variant(variant.name(project.variant.as_deref())) {
            Err(SceneError::Bad { file, fault: fault @ Fault::NoVariant { .. } })
                if *variant == VariantChoice::AsSaved =>
            {
                let instead = "its own materials are shown instead (choose a variant before saving)";
                warnings.push(format!("{}: {fault}; {instead}", file.display()));
                load_scene_variant(None)?
            }
            loaded => loaded?,
        };
        if let Some(is_shown) = project.floor {
            add_floor(Arc::make_mut(&mut scene), is_shown, path)?;
        }
        Ok(Self::from_project(path, project, scene, warnings, resources))
    }

    /// The input of a project whose scene was read.
    fn from_project(
        path: &Path,
        project: ProjectFile,
        scene: Arc<Scene>,
        mut warnings: Vec<String>,
        resources: &Resources,
    ) -> Self {
        warnings.extend(prefix_with_path(&project.scene, &scene.warnings));
        let camera = project.cameras[project.active_camera].camera.clone();
        let (back_faces, world) = (project.back_faces, project.world.clone());
        let mut input =
            Self { project: Some(project), ..Self::new(path, scene, camera, warnings, resources) };
        input.set_back_faces(back_faces);
        match world.map(|world| world.load(&input.scene)).transpose() {
            Ok(loaded) => {
                let (world, faults) = loaded.unzip();
                input.set_world(world);
                input.warnings.extend(faults.into_iter().flatten());
            }
            Err(error) => {
                input.warnings.push(format!(
                    "{error}; the scene's own world is shown instead (choose one before saving)"
                ));
            }
        }
        input
    }

    /// Sets whether back faces are shown, overriding the project.
    pub fn set_back_faces(&mut self, back_faces: BackFaces) {
        if back_faces != self.scene.back_faces {
            Arc::make_mut(&mut self.scene).back_faces = back_faces;
        }
    }

    /// Adds Gaussian splats to the scene, or shows those that it has otherwise, overriding the project.
    ///
    /// # Errors
    /// Their file cannot be used, the scene has other splats, or none to be shown; the input is a capture or a light field; or the work was cancelled.
    pub fn set_splats(&mut self, splats: &SplatsFile, steps: &dyn Steps) -> Result<(), DocumentError> {
        let error = |what: &str| Err(DocumentError::bad_file(&self.path, what));
        if self.salf.is_some() || self.capture.is_some() {
            return error("splats cannot be added here (add them to a scene of meshes, and bake that)");
        }
        let has_splats = self.scene.splats.is_some();
        if splats.file.is_none() && !has_splats {
            return error("has no Gaussian splats to show (name their file)");
        }
        if splats.file.is_some() && !has_splats && self.project.is_some() {
            return error("its paint has no room for splats (make a project of scene and splats)");
        }
        let warnings = self.scene.warnings.len();
        show_splats(Arc::make_mut(&mut self.scene), splats, &*steps.begin("reading splats"))?;
        self.warnings.extend_from_slice(&self.scene.warnings[warnings..]);
        if self.project.is_none() && self.scene.surface_triangles().is_empty() {
            self.camera = shot_camera_in_any_unit(&self.scene.cameras[0]);
        }
        Ok(())
    }

    /// Puts a floor under the scene that catches its shadows, or hides it, overriding the project.
    ///
    /// # Errors
    /// The scene casts no shadow, or is of a light field or a project that has no room for the paint of a floor.
    pub fn set_floor(&mut self, is_shown: bool) -> Result<(), DocumentError> {
        let has_room = self.scene.floor.is_some() || self.project.is_none() && self.salf.is_none();
        if is_shown && !has_room {
            let message =
                "its paint has no room for a floor (make a project with one, or add it in the window)";
            return Err(DocumentError::bad_file(&self.path, message));
        }
        if is_shown || self.scene.floor.is_some() {
            add_floor(Arc::make_mut(&mut self.scene), is_shown, &self.path)?;
        }
        Ok(())
    }

    /// Sets the scene's world, overriding the project; `None` for the scene's own.
    pub fn set_world(&mut self, world: Option<World>) {
        if world != self.scene.world {
            let scene = Arc::make_mut(&mut self.scene);
            scene.world = world;
            scene.color_floor();
        }
    }

    fn open_light_field(
        path: &Path,
        variant: &VariantChoice,
        resources: &Resources,
        steps: &dyn Steps,
    ) -> Result<Self, DocumentError> {
        let file = File::open(path).map_err(|error| DocumentError::io(path, &error))?;
        let SalfFile { source, triangles, salf } =
            SalfFile::read(BufReader::new(file)).map_err(|error| DocumentError::bad_file(path, error))?;
        let source_path = path.parent().unwrap_or(Path::new("")).join(&source);
        if InputKind::from_path(&source_path).ok() == Some(InputKind::LightField) || !source_path.exists() {
            let message = format!(
                "the scene it was baked from, {}, is missing (restore that file)",
                source_path.display()
            );
            return Err(DocumentError::bad_file(path, message));
        }
        let baked_from = Self::open_variant(&source_path, variant, resources, steps)?;
        if baked_from.scene.triangles.len() != triangles as usize {
            let message = format!(
                "the scene it was baked from, {}, has changed since (bake again)",
                source_path.display()
            );
            return Err(DocumentError::bad_file(path, message));
        }
        Ok(Self { path: path.into(), camera: salf.camera.clone(), salf: Some(salf), ..baked_from })
    }

    /// The requested camera; by default the project's, or else the scene's first.
    ///
    /// # Errors
    /// The camera file cannot be read, or there is no camera or photograph of that name.
    pub fn camera(&self, choice: Option<&CameraChoice>) -> Result<Camera, DocumentError> {
        match choice {
            None => Ok(self.camera.clone()),
            Some(CameraChoice::File(file)) => {
                // A camera file does not refer to the default framing of a scene without cameras.
                let is_invented =
                    self.project.is_none() && self.salf.is_none() && self.scene.has_default_camera;
                let defaults = if is_invented { &Camera::default() } else { &self.camera };
                Ok(read_camera(file, defaults)?)
            }
            Some(CameraChoice::Named(name)) => {
                let saved = self.project.iter().flat_map(|project| &project.cameras);
                let mut saved = saved.filter(|named| named.name == *name).map(|named| named.camera.clone());
                if let Some(name) = name.strip_prefix(PHOTOGRAPH_PREFIX) {
                    let camera = parse_photograph_camera(&self.scene, name, &self.camera);
                    return camera.map_err(|message| DocumentError::bad_file(&self.path, message));
                }
                let in_scene = || self.scene.cameras.iter().find(|camera| camera.name == *name);
                saved.next().or_else(|| in_scene().map(|c| shot_camera_from(c, &self.camera))).ok_or_else(
                    || {
                        let names: Vec<_> =
                            self.scene.cameras.iter().map(|c| format!("\"{}\"", c.name)).collect();
                        let available =
                            format!("available: {}; a camera file ends in .json", names.join(", "));
                        DocumentError::bad_file(
                            &self.path,
                            format!("no camera is called \"{name}\" ({available})"),
                        )
                    },
                )
            }
        }
    }

    /// The project's exposure mode; by default [`Exposure::Normalise`].
    pub fn exposure(&self) -> Exposure {
        self.project.as_ref().map_or(Exposure::Normalise, |project| project.exposure)
    }

    /// The focus in `file` (a recipe, a focus map or a table of splats); without a file, the focus of the project, or the ordinary lens for a scene. The scene is
    /// unwrapped only for a map that needs its atlas.
    ///
    /// # Errors
    /// The file or the project's map cannot be read or does not fit, the scene cannot be unwrapped, or the work was cancelled.
    pub fn focus(
        &self,
        file: Option<&Path>,
        unwrap: &UnwrapOptions,
        steps: &dyn Steps,
    ) -> Result<Focus, DocumentError> {
        let evaluated = |recipe: FocusRecipe, file: &Path| {
            recipe.evaluate(&self.scene).map_err(|error| DocumentError::bad_file(file, error))
        };
        match file {
            None => self.project_focus(unwrap, steps),
            Some(file) if is_focus_table(file) => {
                let atlas = self.atlas(unwrap, steps)?;
                let map = read_splat_focus(file, &self.scene, &atlas, &*steps.begin("reading"))?;
                Ok(Focus::from_atlas_map(self.scene.clone(), atlas, Arc::new(map)))
            }
            Some(file) => match read_focus(file)? {
                FocusFile::Recipe(recipe) => evaluated(recipe, file),
                FocusFile::Map(map) if map.atlas_hash.is_none() => {
                    let background = map.background.map(RecipeEntry::Value);
                    let default = RecipeEntry::Map(Arc::new(map.image));
                    evaluated(FocusRecipe { default, background, ..FocusRecipe::default() }, file)
                }
                FocusFile::Map(map) => {
                    let atlas = self.atlas(unwrap, steps)?;
                    let map = map.into_atlas_map(file, &atlas)?;
                    Ok(Focus::from_atlas_map(self.scene.clone(), atlas, Arc::new(map)))
                }
            },
        }
    }

    fn project_focus(&self, unwrap: &UnwrapOptions, steps: &dyn Steps) -> Result<Focus, DocumentError> {
        let scene = self.scene.clone();
        let Some(project) = &self.project else { return Ok(Focus::constant(scene, FocusOffset::STANDARD)) };
        match &project.focus_map {
            None => {
                let mut focus = Focus::constant(scene, FocusOffset::STANDARD);
                focus.background = project.background_focus;
                Ok(focus)
            }
            Some(map) => {
                let atlas = self.atlas(unwrap, steps)?;
                self.check_map_size(map, &atlas)?;
                Ok(Focus::from_atlas_map(scene, atlas, Arc::new(map.clone())))
            }
        }
    }

    /// Checks that the project's focus map has the size of the atlas.
    pub(crate) fn check_map_size(&self, map: &FocusMap, atlas: &Atlas) -> Result<(), DocumentError> {
        if map.size() == [atlas.width, atlas.height] {
            return Ok(());
        }
        Err(DocumentError::bad_file(
            &self.path,
            "its focus map does not fit its atlas (restore the file from a backup)",
        ))
    }

    /// The project's atlas, or else that of the scene, which is unwrapped.
    ///
    /// # Errors
    /// The project's atlas is damaged, the scene cannot be unwrapped, or the work was cancelled.
    pub fn atlas(&self, unwrap: &UnwrapOptions, steps: &dyn Steps) -> Result<Arc<Atlas>, DocumentError> {
        let stored = self.project.as_ref().and_then(|project| project.atlas.as_ref());
        // The atlas of a picture's surface is always derived from it: its depth may have been repaired since.
        let stored = stored.filter(|_| self.scene.picture.is_none());
        let atlas = match stored {
            Some(bytes) => Atlas::from_bytes(bytes, &self.scene),
            None => self.unwrap_scene(unwrap, steps),
        };
        Ok(Arc::new(atlas.map_err(|error| atlas_error(&self.path, error))?))
    }

    /// The atlas of the current scene: that of its picture, or the scene unwrapped or read from the cache.
    pub(crate) fn unwrap_scene(
        &self,
        unwrap: &UnwrapOptions,
        steps: &dyn Steps,
    ) -> Result<Atlas, AtlasError> {
        match picture_atlas(&self.scene) {
            Some(atlas) => Ok(atlas),
            None => {
                let cache = &self.resources.cache;
                load_or_unwrap_atlas(&self.scene, unwrap, cache, &*steps.begin("unwrapping"))
            }
        }
    }

    /// The scene ready for ray tracing. Light from photographs is stored at the texels of the project's atlas, if it has one.
    ///
    /// # Errors
    /// The project's atlas is damaged.
    pub fn lit_scene(&self) -> Result<Arc<LitScene>, DocumentError> {
        let tracer = Arc::new(Tracer::new(self.scene.clone()));
        let lit = LitScene::new(tracer, self.light, &self.resources);
        let stored = self.project.as_ref().and_then(|project| project.atlas.as_ref());
        if let Some(bytes) = stored.filter(|_| lit.is_photographed()) {
            let atlas =
                Atlas::from_bytes(bytes, &self.scene).map_err(|error| atlas_error(&self.path, error))?;
            lit.set_atlas(&Arc::new(atlas));
        }
        Ok(lit)
    }
}

/// Puts the path before each warning.
pub(crate) fn prefix_with_path(path: &Path, warnings: &[String]) -> Vec<String> {
    warnings.iter().map(|warning| format!("{}: {warning}", path.display())).collect()
}
