//! The light and bake options of a tiled picture.

use crate::error::RenderError;
use crate::mattes::MatteRequest;
use crate::picture::RenderOptions;
use focus::Focus;
use lens::Camera;
use light::{LitScene, Steps};
use salf::{BakeOptions, PartsBaker};
use std::sync::Arc;
use trace::{Radiance, Tracer};

/// A picture to be summed (the main picture or the pinhole picture), with its light.
pub(crate) struct LitPicture {
    pub tracer: Arc<Tracer>,
    /// Camera of the light field, finer by the options' cells per side.
    pub finer: Camera,
    pub focus: Focus,
    pub options: RenderOptions,
    pub mattes: Option<MatteRequest>,
    light: Arc<dyn Radiance + Send + Sync>,
    bake: BakeOptions,
}

impl LitPicture {
    /// Solves the light for a picture of `camera` with `focus`.
    ///
    /// # Errors
    /// The options do not fit the camera, the light cannot be solved, or the work was cancelled.
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
            pixel_px: f64::from(options.cells_a_side),
            ..BakeOptions::for_focus(lit.tracer(), &finer, &focus)
        };
        let light = lit.solve(&finer, options.light, &*steps.begin("light"))?;
        let mattes = options.matte_request();
        Ok(Self { tracer: lit.tracer().clone(), finer, focus, options, mattes, light, bake })
    }

    /// A baker of parts of its light field.
    pub fn baker(&self) -> PartsBaker<'_> {
        PartsBaker::new(&self.tracer, &*self.light, &self.finer, &self.bake, &self.focus)
    }
}
