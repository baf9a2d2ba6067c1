//! What a document looks like at a time: scene, camera and focus.

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

/// How a document is put in time.
#[derive(Clone, Debug, PartialEq)]
pub struct TakeOptions {
    /// Frames a second: frame 1 is at 0 s.
    pub frames_per_second: f64,
    /// The animation of the scene's file, by name; the first where there is none.
    pub animation: Option<String>,
    /// The keys of the lens; those of the project, unless others are given.
    pub lens: LensMotion,
    /// Whether the layers of the project make the focus, and move; not where another focus was given.
    pub has_layers: bool,
    /// Pixels of the same picture around the frame, on each side ([`Camera::overscanned`]).
    pub overscan: u32,
}

/// A document in time.
pub struct Take<'a> {
    input: &'a Input,
    camera: Camera,
    focus: &'a Focus,
    options: TakeOptions,
    layers: Option<&'a LayerStack>,
    moving: Option<AnimatedScene>,
    /// The camera of the scene that the camera goes with.
    follows: Option<usize>,
    still: Arc<SceneInTime>,
    /// The scene that was asked for last: most often the next is the same.
    last: Mutex<Arc<SceneInTime>>,
}

/// A document at a time.
pub(crate) struct FrameState {
    pub scene: Arc<SceneInTime>,
    /// The camera, its lens included.
    pub camera: Camera,
    pub focus: Focus,
    /// The camera before its lens moved.
    pub placed: Camera,
}

impl<'a> Take<'a> {
    /// Puts a document in time: `camera` and `focus` are those of the scene at rest.
    ///
    /// # Errors
    /// A light field is of one moment; the scene has no such animation, or has changed.
    pub fn new(
        input: &'a Input,
        camera: Camera,
        focus: &'a Focus,
        options: TakeOptions,
        steps: &dyn Steps,
    ) -> Result<Self, RenderError> {
        if input.salf.is_some() {
            let what = "is the light field of one moment (give the scene or project it was baked from)";
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

    /// The file that was opened.
    pub(crate) fn path(&self) -> &std::path::Path {
        &self.input.path
    }

    /// When a frame is, s.
    pub fn seconds(&self, frame: u32) -> f64 {
        (f64::from(frame) - 1.0) / self.options.frames_per_second
    }

    /// All times at which something is keyed, ascending.
    fn key_times(&self) -> Vec<f64> {
        let layers = self.layers.iter().flat_map(|layers| layers.layers());
        let mut times: Vec<f64> =
            self.options.lens.times().chain(layers.flat_map(|layer| layer.motion.times())).collect();
        times.sort_unstable_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// The document at a time.
    pub(crate) fn at(&self, seconds: f64, progress: &dyn Progress) -> Result<FrameState, RenderError> {
        let (scene, cameras) = self.scene(seconds, progress)?;
        let placed = self.placed(&cameras, seconds)?.overscanned(self.options.overscan);
        Ok(self.state_at(scene, placed, seconds))
    }

    /// The same place with the lens and the focus of every key: what has to be known there for any of them.
    pub(crate) fn at_keys(&self, at: &FrameState) -> Vec<(Camera, Focus)> {
        let keyed_lens = |seconds| {
            let state = self.state_at(at.scene.clone(), at.placed.clone(), seconds);
            (state.camera, state.focus)
        };
        self.key_times().into_iter().map(keyed_lens).collect()
    }

    /// The camera at a place before its lens moves, with the aperture of the widest of these lenses.
    pub(crate) fn widest_aperture_camera(&self, at: &FrameState, keyed: &[(Camera, Focus)]) -> Camera {
        if self.options.lens.f_number.is_empty() {
            return at.placed.clone();
        }
        // The focal length grows with the distance that is focused on: the longest of all with the widest stop bounds all of them.
        let cameras = || keyed.iter().map(|(camera, _)| camera).chain([&at.camera]);
        let focal = cameras().map(|camera| camera.optics().focal_length()).fold(0.0, f64::max);
        let numbers = self.options.lens.f_number.keys().iter().map(|key| key.value);
        Camera { aperture_radius: focal / (2.0 * numbers.fold(f64::INFINITY, f64::min)), ..at.placed.clone() }
    }

    fn state_at(&self, scene: Arc<SceneInTime>, placed: Camera, seconds: f64) -> FrameState {
        let camera = self.options.lens.camera_at(seconds, &placed, &|point| scene.position(point));
        let map = self.layers.map(|layers| self.painted(layers, &scene, &placed, seconds));
        let focus = scene.focus(self.focus, map.as_ref());
        FrameState { scene, camera, focus, placed }
    }

    /// The scene at a time, and its cameras then. One that is lit and stands as one before is the same.
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

    /// Where the camera stands at a time.
    fn placed(&self, now: &[SceneCamera], seconds: f64) -> Result<Camera, RenderError> {
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

    /// What the layers make at a time.
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

    /// The atlas of the paint.
    fn rest_atlas(&self) -> Option<&Arc<atlas::Atlas>> {
        self.focus.parts.iter().find_map(|source| match source {
            FocusSource::Atlas { atlas, .. } => Some(atlas),
            _ => None,
        })
    }
}

/// The first of the scene's cameras that stands where `camera` does: a pose that was saved and read again is the same to the last bit.
fn camera_at_same_pose(cameras: &[SceneCamera], camera: &Camera) -> Option<usize> {
    cameras.iter().position(|other| other.camera_to_world == camera.camera_to_world)
}
