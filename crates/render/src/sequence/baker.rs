//! Baking light fields for frames: a new one only if something moved.
//!
//! A light field can show every focus distance, every smaller aperture, and any paint for which its margin is wide enough. It is
//! therefore baked for all keys of the timeline at once, with scene and camera as they are at a frame. So it does not depend on which
//! frames are rendered, and a rack focus in a static scene needs one light field.

use crate::error::RenderError;
use crate::picture::{RenderOptions, Rendered, Renderer, new_splatter, render, sum_baked};
use crate::sequence::take::{FrameState, Take};
use lens::Camera;
use light::{LightQuality, Steps};
use salf::{BakeOptions, Carried};
use scene::SurfaceField;
use splat::Splatter;
use std::sync::Arc;

/// What a light field is baked from. The `Debug` form is hashed into plans: names must not change.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Field {
    scene: [u8; 32],
    camera: Camera,
    margin_px: f64,
    carried: Carried,
}

impl Field {
    /// The inputs as text, for hashing.
    pub fn description(&self) -> String {
        format!("{self:?}")
    }
}

/// Statistics of baking for a sequence.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Baking {
    /// Number of light fields baked.
    pub baked: u32,
    /// Number of frames that reused the previous light field.
    pub reused: u32,
    /// Number of different scenes whose light was solved.
    pub scenes: u32,
    /// Time spent baking, s.
    pub seconds: f64,
    /// Time spent solving light before baking, s.
    pub light_seconds: f64,
}

/// What all keys of the timeline together need for one scene and camera.
struct KeyRequirements {
    scene: [u8; 32],
    base_camera: Camera,
    camera: Camera,
    bake_options: BakeOptions,
}

/// Bakes and sums light fields; retains the last one.
pub(crate) struct FrameBaker<'a> {
    take: &'a Take<'a>,
    options: &'a RenderOptions,
    keyed: Option<KeyRequirements>,
    last: Option<(Field, Splatter)>,
    last_scene: Option<[u8; 32]>,
    /// Statistics so far.
    pub baking: Baking,
}

impl<'a> FrameBaker<'a> {
    /// A baker for frames of `take` that has baked nothing yet.
    pub fn new(take: &'a Take<'a>, options: &'a RenderOptions) -> Self {
        Self { take, options, keyed: None, last: None, last_scene: None, baking: Baking::default() }
    }

    /// What the light field of a frame is baked from. `None` if the renderer needs none.
    ///
    /// # Errors
    /// The light of the frame's scene cannot be solved.
    pub fn field(&mut self, state: &FrameState) -> Result<Option<Field>, RenderError> {
        if self.options.renderer != Renderer::Splat {
            return Ok(None);
        }
        let lit = state.scene.lit();
        let is_current = |keyed: &KeyRequirements| {
            keyed.scene == state.scene.hash && keyed.base_camera == state.base_camera
        };
        let keyed = match self.keyed.take().filter(is_current) {
            Some(keyed) => keyed,
            None => {
                let keys = self.take.lens_and_focus_at_keys(state);
                let camera = self.take.widest_aperture_camera(state, &keys);
                let finer = |camera: &Camera| self.options.finer(camera);
                let cameras = keys.iter().map(|(camera, _)| finer(camera)).collect::<Result<Vec<_>, _>>()?;
                let shots = cameras
                    .iter()
                    .zip(&keys)
                    .map(|(camera, (_, focus))| (camera, focus as &dyn SurfaceField<_>));
                let bake_options = BakeOptions::for_all(lit.tracer(), shots);
                KeyRequirements {
                    scene: state.scene.hash,
                    base_camera: state.base_camera.clone(),
                    camera,
                    bake_options,
                }
            }
        };
        let own = self.options.finer(&state.camera)?;
        let own = BakeOptions::for_all(lit.tracer(), [(&own, &state.focus as &dyn SurfaceField<_>)]);
        let field = Field {
            scene: state.scene.hash,
            camera: keyed.camera.clone(),
            margin_px: keyed.bake_options.margin_px.max(own.margin_px),
            carried: keyed.bake_options.carried.max(own.carried),
        };
        self.keyed = Some(keyed);
        Ok(Some(field))
    }

    /// Renders a frame whose light field is `field`; `None` for renderers that need none.
    ///
    /// # Errors
    /// The light cannot be solved, the picture cannot be rendered, or the work was cancelled.
    pub fn render(
        &mut self,
        state: &FrameState,
        field: Option<&Field>,
        steps: &dyn Steps,
    ) -> Result<Rendered, RenderError> {
        let lit = state.scene.lit();
        if self.last_scene.replace(state.scene.hash) != Some(state.scene.hash) {
            self.baking.scenes += 1;
        }
        let Some(field) = field else { return render(lit, &state.camera, &state.focus, self.options, steps) };
        let mut bake_seconds = 0.0;
        if self.last.as_ref().is_some_and(|(last, _)| last == field) {
            self.baking.reused += 1;
        } else {
            // Dropped first, so that two light fields are never in memory at once.
            self.last = None;
            let start = std::time::Instant::now();
            let _ = lit.solve(&field.camera, LightQuality::Fine, &*steps.begin("light"))?;
            let light_seconds = start.elapsed().as_secs_f64();
            let need =
                BakeOptions { margin_px: field.margin_px, carried: field.carried, ..BakeOptions::default() };
            let salf = self.options.bake_as(lit, &field.camera, need, steps)?;
            self.last = Some((field.clone(), new_splatter(Arc::new(salf), self.options)));
            bake_seconds = start.elapsed().as_secs_f64();
            self.baking.baked += 1;
            self.baking.seconds += bake_seconds - light_seconds;
            self.baking.light_seconds += light_seconds;
        }
        let Some((_, splatter)) = &mut self.last else { return Err(RenderError::Cancelled) };
        let mut rendered = sum_baked(splatter, lit, &state.camera, &state.focus, self.options, steps)?;
        rendered.cost.bake_seconds = bake_seconds;
        Ok(rendered)
    }
}
