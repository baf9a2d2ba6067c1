//! Evaluating a document at a time: scene, camera and focus.

use crate::error::RenderError;
use crate::picture::lit_scene_of;
use crate::sequence::scene_in_time::SceneInTime;
use document::{Input, InputKind};
use focus::{Focus, FocusMap, FocusSource, LayerStack, LensMotion};
use lens::Camera;
use light::Steps;
use progress::Progress;
use scene::{AnimatedScene, AnimationTime, LoadOptions, SceneCamera};
use std::sync::{Arc, Mutex, PoisonError};

/// How a document is animated.
#[derive(Clone, Debug, PartialEq)]
pub struct TakeOptions {
    /// Frames per second. Frame 1 is at 0 s.
    pub frames_per_second: f64,
    /// Name of the animation in the scene's file; the first one if `None`.
    pub animation: Option<String>,
    /// The keys of the lens.
    pub lens: LensMotion,
    /// Whether the project's layers determine the focus and may be animated. False if the focus was given explicitly.
    pub has_layers: bool,
    /// Extra pixels around the frame, on each side ([`Camera::overscanned`]).
    pub overscan: u32,
}

/// An animated document.
pub struct Take<'a> {
    input: &'a Input,
    camera: Camera,
    focus: &'a Focus,
    options: TakeOptions,
    layers: Option<&'a LayerStack>,
    moving: Option<AnimatedScene>,
    /// Index of the scene camera whose animation the camera follows.
    follows: Option<usize>,
    still: Arc<SceneInTime>,
    /// The scene of the last request: the next is often the same.
    last: Mutex<Arc<SceneInTime>>,
}

/// A document evaluated at a time.
pub(crate) struct FrameState {
    pub scene: Arc<SceneInTime>,
    /// The camera, with its lens at that time.
    pub camera: Camera,
    pub focus: Focus,
    /// The camera before lens keys are applied.
    pub base_camera: Camera,
}

impl<'a> Take<'a> {
    /// Animates a document. `camera` and `focus` are those of the scene at rest.
    ///
    /// # Errors
    /// The input is a light field (it cannot be animated), the scene has no such animation, or its file has changed.
    pub fn new(
        input: &'a Input,
        camera: Camera,
        focus: &'a Focus,
        options: TakeOptions,
        steps: &dyn Steps,
    ) -> Result<Self, RenderError> {
        if input.salf.is_some() {
            let what =
                "is a light field, which cannot be animated (give the scene or project it was baked from)";
            return Err(RenderError::bad_file(&input.path, what));
        }
        let moving = match InputKind::from_path(&input.scene.path) {
            Ok(InputKind::Scene) => {
                let (rest, load) = (input.scene.clone(), LoadOptions::default());
                let moving = AnimatedScene::open(rest, &load, &*steps.begin("reading"))?;
                Some(moving).filter(|moving| options.animation.is_some() || !moving.animations().is_empty())
            }
            _ if options.animation.is_some() => {
                return Err(RenderError::bad_file(&input.path, "has no animations (leave out --animation)"));
            }
            _ => None,
        };
        let follows = moving.as_ref().and_then(|_| camera_at_same_pose(&input.scene.cameras, &camera));
        let layers = input.project.as_ref().and_then(|project| project.layers.as_ref());
        let layers =
            layers.filter(|layers| options.has_layers && (layers.is_animated() || layers.follows_camera()));
        let still = Arc::new(SceneInTime::at_rest(lit_scene_of(input, &camera)?));
        let last = Mutex::new(still.clone());
        Ok(Self { input, camera, focus, options, layers, moving, follows, still, last })
    }

    /// The input file.
    pub(crate) fn path(&self) -> &std::path::Path {
        &self.input.path
    }

    /// The time of a frame in the animation, s.
    pub fn seconds(&self, frame: i32) -> f64 {
        (f64::from(frame) - 1.0) / self.options.frames_per_second
    }

    /// All key times, ascending and unique, s.
    fn key_times(&self) -> Vec<f64> {
        let layers = self.layers.iter().flat_map(|layers| layers.layers());
        let mut times: Vec<f64> =
            self.options.lens.times().chain(layers.flat_map(|layer| layer.motion.times())).collect();
        times.sort_unstable_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// Evaluates the document at a time.
    pub(crate) fn evaluate(&self, seconds: f64, progress: &dyn Progress) -> Result<FrameState, RenderError> {
        let (scene, cameras) = self.scene(seconds, progress)?;
        let base_camera = self.base_camera_at(&cameras, seconds)?.overscanned(self.options.overscan);
        Ok(self.state_at(scene, base_camera, seconds))
    }

    /// Camera and focus at the time of every key, with scene and base camera of `state`.
    pub(crate) fn lens_and_focus_at_keys(&self, state: &FrameState) -> Vec<(Camera, Focus)> {
        let keyed_lens = |seconds| {
            let keyed = self.state_at(state.scene.clone(), state.base_camera.clone(), seconds);
            (keyed.camera, keyed.focus)
        };
        self.key_times().into_iter().map(keyed_lens).collect()
    }

    /// The base camera of `state`, with the widest aperture of all `keyed` lenses.
    pub(crate) fn widest_aperture_camera(&self, state: &FrameState, keyed: &[(Camera, Focus)]) -> Camera {
        if self.options.lens.f_number.is_empty() {
            return state.base_camera.clone();
        }
        // The longest focal length with the smallest f-number bounds all apertures: focal length grows with focus distance.
        let cameras = || keyed.iter().map(|(camera, _)| camera).chain([&state.camera]);
        let focal = cameras().map(|camera| camera.optics().focal_length()).fold(0.0, f64::max);
        let numbers = self.options.lens.f_number.keys().iter().map(|key| key.value);
        Camera {
            aperture_radius: focal / (2.0 * numbers.fold(f64::INFINITY, f64::min)),
            ..state.base_camera.clone()
        }
    }

    fn state_at(&self, scene: Arc<SceneInTime>, base_camera: Camera, seconds: f64) -> FrameState {
        let camera = self.options.lens.camera_at(seconds, &base_camera, &|point| scene.position(point));
        let map = self.layers.map(|layers| self.painted(layers, &scene, &base_camera, seconds));
        let focus = scene.focus(self.focus, map.as_ref());
        FrameState { scene, camera, focus, base_camera }
    }

    /// The scene and its cameras at a time. Reuses the previous scene if its content is the same.
    fn scene(
        &self,
        seconds: f64,
        progress: &dyn Progress,
    ) -> Result<(Arc<SceneInTime>, Vec<SceneCamera>), RenderError> {
        let Some(moving) = &self.moving else { return Ok((self.still.clone(), Vec::new())) };
        let moment = AnimationTime { animation: self.options.animation.clone(), seconds };
        let moved = SceneInTime::moved(moving, &moment, self.still.lit(), progress)?;
        let cameras = moved.scene.cameras.clone();
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if self.still.hash == moved.hash {
            return Ok((self.still.clone(), cameras));
        }
        if last.hash != moved.hash {
            *last = Arc::new(moved);
        }
        Ok((last.clone(), cameras))
    }

    /// The camera at a time before lens keys are applied.
    fn base_camera_at(&self, now: &[SceneCamera], seconds: f64) -> Result<Camera, RenderError> {
        let Some(index) = self.follows else { return Ok(self.camera.clone()) };
        let rest = &self.input.scene.cameras;
        let (Some(before), Some(after), true) = (rest.get(index), now.get(index), rest.len() == now.len())
        else {
            let what = format!("at {seconds} s one of its cameras has no pose (choose other frames)");
            return Err(RenderError::bad_file(&self.input.scene.path, what));
        };
        let zooms = self.camera.yfov == before.yfov;
        Ok(Camera {
            camera_to_world: after.camera_to_world,
            yfov: if zooms { after.yfov } else { self.camera.yfov },
            ..self.camera.clone()
        })
    }

    /// The composite of the layers at a time.
    fn painted(
        &self,
        layers: &LayerStack,
        scene: &SceneInTime,
        camera: &Camera,
        seconds: f64,
    ) -> Arc<FocusMap> {
        let atlas = self.rest_atlas().filter(|_| layers.depends_on_depth());
        Arc::new(layers.at_time(seconds, atlas.map(|atlas| scene.canvas(atlas)), camera).composite())
    }

    /// The atlas of the focus map.
    fn rest_atlas(&self) -> Option<&Arc<atlas::Atlas>> {
        self.focus.parts.iter().find_map(|source| match source {
            FocusSource::Atlas { atlas, .. } => Some(atlas),
            _ => None,
        })
    }
}

/// Index of the first scene camera with exactly the pose of `camera`. Poses survive saving and loading bit for bit.
fn camera_at_same_pose(cameras: &[SceneCamera], camera: &Camera) -> Option<usize> {
    cameras.iter().position(|other| other.camera_to_world == camera.camera_to_world)
}
