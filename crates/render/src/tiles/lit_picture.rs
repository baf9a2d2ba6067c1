//! What a picture in tiles is lit and baked by.

use crate::error::RenderError;
use crate::mattes::MatteRequest;
use crate::picture::RenderOptions;
use focus::Focus;
use lens::Camera;
use light::{LitScene, Steps};
use salf::{BakeOptions, PartsBaker};
use std::sync::Arc;
use trace::{Radiance, Tracer};

/// The light of a picture that is summed: the picture itself, or what a pinhole sees.
pub(crate) struct LitPicture {
    pub tracer: Arc<Tracer>,
    /// Of the light field: as much finer as the options say.
    pub finer: Camera,
    pub focus: Focus,
    pub options: RenderOptions,
    pub mattes: Option<MatteRequest>,
    light: Arc<dyn Radiance + Send + Sync>,
    bake: BakeOptions,
}

impl LitPicture {
    /// Of what a camera shows of a scene that is focused so.
    pub fn new(
        lit: &LitScene,
        camera: &Camera,
        focus: Focus,
        options: RenderOptions,
        steps: &dyn Steps,
    ) -> Result<Self, RenderError> {
        let finer = options.finer(camera)?;
        let bake = BakeOptions {
            tolerance_px: options.tolerance_px * f64::from(options.cells_a_side),
            ..BakeOptions::for_focus(lit.tracer(), &finer, &focus)
        };
        let light = lit.solve(&finer, options.light, &*steps.begin("light"))?;
        let mattes = options.matte_request();
        Ok(Self { tracer: lit.tracer().clone(), finer, focus, options, mattes, light, bake })
    }

    /// Bakes parts of its light field.
    pub fn baker(&self) -> PartsBaker<'_> {
        PartsBaker::new(&self.tracer, &*self.light, &self.finer, &self.bake, &self.focus)
    }
}
