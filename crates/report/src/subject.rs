//! A scene to measure on: opened, with its camera, lens and focuses.

pub mod default_lens;
mod generic_focus;
pub mod subdivision;

use crate::options::{ReportOptions, SceneRequest};
use baselines::FirstHits;
use default_lens::open_aperture;
use document::{Input, InputKind};
use focus::Focus;
use generic_focus::generic_recipe;
use lens::{Camera, FocusOffset};
use light::LitScene;
use light::Steps;
use scene::Scene;
use session::SessionError;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;
use trace::{OutgoingRadiance, Radiance, Tracer};

/// A scene with its camera and focuses.
pub struct Subject {
    /// The file name without extension.
    pub name: String,
    /// The file.
    pub file: PathBuf,
    /// The scene.
    pub scene: Arc<Scene>,
    /// The scene ready for rays, with its light.
    pub lit: Arc<LitScene>,
    /// Seconds to build the hierarchy over the triangles.
    pub prepare_seconds: f64,
    /// The camera, at the size of the pictures.
    pub camera: Camera,
    /// The source of the lens, a sentence.
    pub lens: String,
    /// The standard focus first, then the painted one.
    pub focuses: Vec<NamedFocus>,
    /// Oddities that do no harm.
    pub warnings: Vec<String>,
    /// The opened file, for its atlas.
    pub input: Input,
}

/// A focus with a name.
#[derive(Clone)]
pub struct NamedFocus {
    /// Its name.
    pub name: &'static str,
    /// A sentence that describes it.
    pub what: String,
    /// The focus.
    pub focus: Focus,
}

impl Subject {
    /// Opens the requested scene.
    ///
    /// # Errors
    /// The file, camera or focus cannot be read, or the work is cancelled.
    pub fn open(
        request: &SceneRequest,
        options: &ReportOptions,
        steps: &dyn Steps,
    ) -> Result<Self, SessionError> {
        if InputKind::from_path(&request.file)? == InputKind::LightField {
            let what =
                "baked for one size and tolerance, but a report bakes many (give its scene or project)";
            return Err(SessionError::bad_file(&request.file, what));
        }
        let mut input = Input::open_variant(&request.file, &request.variant, &options.resources, steps)?;
        if let Some(back_faces) = request.back_faces {
            input.set_back_faces(back_faces);
        }
        if let Some(world) = &request.world {
            let (world, faults) = world.load(&input.scene)?;
            input.set_world(Some(world));
            input.warnings.extend(faults);
        }
        input.light = request.light;
        let mut camera = input.camera(request.camera.as_ref())?;
        let [width, height] = options.size.unwrap_or_else(|| {
            let width = (ReportOptions::HEIGHT as f64 * camera.aspect()).round().max(1.0) as u32;
            [width, ReportOptions::HEIGHT]
        });
        (camera.width, camera.height) = (width, height);
        camera.validate().map_err(|error| SessionError::bad_file(&request.file, error))?;

        let scene = input.scene.clone();
        let start = Instant::now();
        let lit = LitScene::new(Arc::new(Tracer::new(scene.clone())), input.light, &input.resources);
        let prepare_seconds = start.elapsed().as_secs_f64();
        let standard = Focus::constant(scene.clone(), FocusOffset::STANDARD);
        let hits = trace_first_hits(lit.tracer(), &standard, &camera, steps)?;
        // A glTF file contains poses of cameras, but not their lenses.
        let has_lens =
            input.project.is_some() || matches!(request.camera, Some(document::CameraChoice::File(_)));
        let lens =
            if has_lens { "as the camera says".to_string() } else { open_aperture(&mut camera, &hits) };

        let painted = match (&request.focus, &input.project) {
            (Some(file), _) => Some(NamedFocus {
                name: "painted",
                what: format!("as {} says", file.file_name().unwrap_or_default().to_string_lossy()),
                focus: input.focus(Some(file), &options.unwrap, steps)?,
            }),
            (None, Some(project)) if project.focus_map.is_some() => Some(NamedFocus {
                name: "painted",
                what: "as the project is painted".into(),
                focus: input.focus(None, &options.unwrap, steps)?,
            }),
            _ => None,
        };
        let painted = match painted {
            Some(painted) => painted,
            None => {
                let (recipe, what) = generic_recipe(&scene, lit.tracer(), &camera);
                let focus =
                    recipe.evaluate(&scene).map_err(|error| SessionError::bad_file(&request.file, error))?;
                NamedFocus { name: "painted", what, focus }
            }
        };
        let standard = NamedFocus {
            name: "standard",
            what: "the ordinary lens, nothing painted".into(),
            focus: standard,
        };
        let name = request.file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self {
            name,
            file: request.file.clone(),
            warnings: input.warnings.clone(),
            scene,
            lit,
            prepare_seconds,
            camera,
            lens,
            focuses: vec![standard, painted],
            input,
        })
    }
}

/// The first hits of the chief rays of `camera`, without light.
///
/// # Errors
/// Tracing is cancelled.
pub fn trace_first_hits(
    tracer: &Tracer,
    focus: &Focus,
    camera: &Camera,
    steps: &dyn Steps,
) -> Result<FirstHits, SessionError> {
    Ok(FirstHits::trace(tracer, &NoLight, focus, camera, &*steps.begin("first hits"))?)
}

/// Zero radiance, for first hits of which only the positions matter.
struct NoLight;

impl Radiance for NoLight {
    fn outgoing(&self, _point: scene::SurfacePoint, _eye: glam::DVec3) -> OutgoingRadiance {
        OutgoingRadiance::from_own(glam::Vec3::ZERO)
    }
    fn environment(&self, _direction: glam::DVec3) -> glam::Vec3 {
        glam::Vec3::ZERO
    }
}
