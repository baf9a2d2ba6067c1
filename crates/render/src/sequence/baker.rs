//! Light fields for frames: baked where something moved, kept where nothing did.
//!
//! A light field serves every focus distance and every smaller stop, and any paint that its margin has room for. So it is baked for
//! all keys of the timeline at once, as the scene and the camera stand at a frame: which frames are rendered makes no difference to it, and
//! a rack focus in a scene that stands still is one light field.

use crate::error::RenderError;
use crate::picture::{RenderOptions, Rendered, Renderer, new_splatter, render, sum_baked};
use crate::sequence::take::{FrameState, Take};
use lens::Camera;
use light::{LightQuality, Steps};
use salf::{BakeOptions, Carried};
use scene::SurfaceField;
use splat::Splatter;
use std::sync::Arc;

/// What a light field is baked from beside its scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Field {
    scene: [u8; 32],
    camera: Camera,
    margin_px: f64,
    carried: Carried,
}

impl Field {
    /// All of it in words.
    pub fn description(&self) -> String {
        format!("{self:?}")
    }
}

/// What baking took, and what was not baked again.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Baking {
    /// Light fields that were baked.
    pub baked: u32,
    /// Frames whose light field was there already.
    pub reused: u32,
    /// Scenes whose light was solved for.
    pub scenes: u32,
    /// Seconds that baking took.
    pub seconds: f64,
    /// Seconds that light was waited for before.
    pub light_seconds: f64,
}

/// What the keys need of a place: scene and camera.
struct KeyedNeed {
    scene: [u8; 32],
    placed: Camera,
    camera: Camera,
    need: BakeOptions,
}

/// Bakes and sums light fields, and keeps the last one.
pub(crate) struct FrameBaker<'a> {
    take: &'a Take<'a>,
    options: &'a RenderOptions,
    keyed: Option<KeyedNeed>,
    last: Option<(Field, Splatter)>,
    last_scene: Option<[u8; 32]>,
    pub baking: Baking,
}

impl<'a> FrameBaker<'a> {
    pub fn new(take: &'a Take<'a>, options: &'a RenderOptions) -> Self {
        Self { take, options, keyed: None, last: None, last_scene: None, baking: Baking::default() }
    }

    /// What the light field of an instant is baked from.
    pub fn field(&mut self, at: &FrameState) -> Result<Option<Field>, RenderError> {
        if self.options.renderer != Renderer::Splat {
            return Ok(None);
        }
        let lit = at.scene.lit();
        let is_current = |keyed: &KeyedNeed| keyed.scene == at.scene.hash && keyed.placed == at.placed;
        let keyed = match self.keyed.take().filter(is_current) {
            Some(keyed) => keyed,
            None => {
                let keys = self.take.at_keys(at);
                let camera = self.take.widest_aperture_camera(at, &keys);
                let finer = |camera: &Camera| self.options.finer(camera);
                let cameras = keys.iter().map(|(camera, _)| finer(camera)).collect::<Result<Vec<_>, _>>()?;
                let shots = cameras
                    .iter()
                    .zip(&keys)
                    .map(|(camera, (_, focus))| (camera, focus as &dyn SurfaceField<_>));
                let need = BakeOptions::for_all(lit.tracer(), shots);
                KeyedNeed { scene: at.scene.hash, placed: at.placed.clone(), camera, need }
            }
        };
        let own = self.options.finer(&at.camera)?;
        let own = BakeOptions::for_all(lit.tracer(), [(&own, &at.focus as &dyn SurfaceField<_>)]);
        let field = Field {
            scene: at.scene.hash,
            camera: keyed.camera.clone(),
            margin_px: keyed.need.margin_px.max(own.margin_px),
            carried: keyed.need.carried.max(own.carried),
        };
        self.keyed = Some(keyed);
        Ok(Some(field))
    }

    /// The picture of an instant, whose light field is `field`.
    pub fn render(
        &mut self,
        at: &FrameState,
        field: Option<&Field>,
        steps: &dyn Steps,
    ) -> Result<Rendered, RenderError> {
        let lit = at.scene.lit();
        if self.last_scene.replace(at.scene.hash) != Some(at.scene.hash) {
            self.baking.scenes += 1;
        }
        let Some(field) = field else { return render(lit, &at.camera, &at.focus, self.options, steps) };
        let mut bake_seconds = 0.0;
        if self.last.as_ref().is_some_and(|(last, _)| last == field) {
            self.baking.reused += 1;
        } else {
            // Two light fields at once would need the memory of both.
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
        let mut rendered = sum_baked(splatter, lit, &at.camera, &at.focus, self.options, steps)?;
        rendered.cost.bake_seconds = bake_seconds;
        Ok(rendered)
    }
}
