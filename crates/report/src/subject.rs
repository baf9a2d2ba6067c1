//! A scene to measure on: opened, with its camera, lens and focuses.

use crate::default_lens::open_aperture;
use crate::generic_focus::generic_recipe;
use crate::options::{ReportOptions, SceneRequest};
use focus::Focus;
use lens::{Camera, FocusOffset};
use scene::Scene;
use session::{FirstHits, Input, InputKind, SessionError, Steps};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;
use trace::{OutgoingRadiance, Radiance, Tracer};

/// A scene with its camera and what it is focused by.
pub struct Subject {
    /// What it is called: the file's name without its extension.
    pub name: String,
    /// The file.
    pub file: PathBuf,
    /// The scene.
    pub scene: Arc<Scene>,
    /// What answers rays.
    pub tracer: Arc<Tracer>,
    /// Seconds for the hierarchy over the triangles.
    pub prepare_seconds: f64,
    /// The camera, at the size of the pictures.
    pub camera: Camera,
    /// Where the lens comes from, a sentence.
    pub lens: String,
    /// The standard lens first, then what is painted.
    pub focuses: Vec<NamedFocus>,
    /// What is odd but does no harm.
    pub warnings: Vec<String>,
    /// The opened file, for its atlas.
    pub input: Input,
}

/// A focus with a name.
#[derive(Clone)]
pub struct NamedFocus {
    /// Its name.
    pub name: &'static str,
    /// What it does, a sentence.
    pub what: String,
    /// The focus.
    pub focus: Focus,
}

impl Subject {
    /// Opens what was asked for.
    pub fn open(
        request: &SceneRequest,
        options: &ReportOptions,
        steps: &dyn Steps,
    ) -> Result<Self, SessionError> {
        if InputKind::from_path(&request.file)? == InputKind::LightField {
            let what = "is baked for one size and tolerance, a report bakes many (give its scene or project)";
            return Err(SessionError::bad_file(&request.file, what));
        }
        let mut input = Input::open_variant(&request.file, &request.variant, steps)?;
        if let Some(back_faces) = request.back_faces {
            input.set_back_faces(back_faces);
        }
        if let Some(world) = &request.world {
            let world = world.load(&input.scene)?;
            input.set_world(Some(world));
        }
        input.set_single_scattering(request.single_scattering);
        input.set_photo_lookup(request.photo_lookup);
        let mut camera = input.camera(request.camera.as_ref())?;
        let [width, height] = options.size.unwrap_or_else(|| {
            let width = (ReportOptions::HEIGHT as f64 * camera.aspect()).round().max(1.0) as u32;
            [width, ReportOptions::HEIGHT]
        });
        (camera.width, camera.height) = (width, height);
        camera.validate().map_err(|error| SessionError::bad_file(&request.file, error))?;

        let scene = input.scene.clone();
        let start = Instant::now();
        let tracer = Arc::new(Tracer::new(scene.clone()));
        let prepare_seconds = start.elapsed().as_secs_f64();
        let standard = Focus::constant(scene.clone(), FocusOffset::STANDARD);
        let hits = trace_first_hits(&tracer, &standard, &camera, steps)?;
        // A glTF file knows where cameras stand, not what lens they have.
        let has_lens =
            input.project.is_some() || matches!(request.camera, Some(session::CameraChoice::File(_)));
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
                let (recipe, what) = generic_recipe(&scene, &tracer, &camera);
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
            tracer,
            prepare_seconds,
            camera,
            lens,
            focuses: vec![standard, painted],
            input,
        })
    }
}

/// Where the chief rays of `camera` meet the scene; without its light.
pub fn trace_first_hits(
    tracer: &Tracer,
    focus: &Focus,
    camera: &Camera,
    steps: &dyn Steps,
) -> Result<FirstHits, SessionError> {
    Ok(FirstHits::trace(tracer, &NoLight, focus, camera, &*steps.begin("first hits"))?)
}

/// No light: for first hits of which only the places count.
struct NoLight;

impl Radiance for NoLight {
    fn outgoing(&self, _point: scene::SurfacePoint, _eye: glam::DVec3) -> OutgoingRadiance {
        OutgoingRadiance::from_own(glam::Vec3::ZERO)
    }
    fn environment(&self, _direction: glam::DVec3) -> glam::Vec3 {
        glam::Vec3::ZERO
    }
}
