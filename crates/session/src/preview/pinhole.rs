//! Pictures without blur: those that follow a moving camera, and those that are blurred by themselves.

use super::picture_sizes::{pixel_count, resized, resting_camera};
use crate::display::{Defocused, antialiased};
use crate::error::SessionError;
use baselines::FirstHits;
use document::Stage;
use focus::{Focus, FocusMap};
use lens::{Camera, Picture};
use light::LightQuality;
use progress::Progress;
use render::sharp_splats;
use std::sync::Arc;
use std::time::Instant;

/// Traces pictures without blur, and keeps the last one.
#[derive(Default)]
pub(crate) struct PinholeTracer {
    last: Option<Pinhole>,
    /// Seconds that a pixel takes; `None` before the first picture.
    pace: Option<f64>,
}

/// A picture without blur, and what it shows.
struct Pinhole {
    hits: FirstHits,
    camera: Camera,
    map: Arc<FocusMap>,
    /// Whether it has as many pixels as there is time for when the camera rests.
    is_resting: bool,
    /// The same, blurred by the lens of a camera.
    defocused: Option<(Camera, Arc<Defocused>)>,
}

impl PinholeTracer {
    /// Forgets the scene.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Seconds that a pixel takes; `None` before the first picture.
    pub fn pace(&self) -> Option<f64> {
        self.pace
    }

    /// Traces the picture of a camera in rough light.
    ///
    /// # Errors
    /// The light cannot be solved, or the work was cancelled.
    pub fn trace(
        &mut self,
        stage: &Stage,
        camera: &Camera,
        (focus, map): (&Focus, &Arc<FocusMap>),
        progress: &dyn Progress,
    ) -> Result<Picture, SessionError> {
        let hits = self.trace_hits(stage, camera, (focus, map), progress)?;
        Ok(antialiased(&hits.picture()))
    }

    /// Traces the picture of a camera that rests, unless the last one is that, or has as many pixels. Gaussian splats are blended; while the
    /// camera moves each pixel shows one of them.
    ///
    /// # Errors
    /// The light cannot be solved, or the work was cancelled.
    pub fn trace_resting(
        &mut self,
        stage: &Stage,
        camera: &Camera,
        (focus, map): (&Focus, &Arc<FocusMap>),
        progress: &dyn Progress,
    ) -> Result<(), SessionError> {
        let resting = resting_camera(camera, self.pace);
        let is_enough =
            |last: &Pinhole| last.shows(camera, map) && (last.is_resting || last.hits.width >= resting.width);
        if !self.last.as_ref().is_some_and(is_enough) {
            self.trace_hits(stage, &resting, (focus, map), progress)?;
            let light = stage.lit.solve(&resting, LightQuality::Rough, progress)?;
            let blended = sharp_splats(stage.tracer(), &*light, focus, &resting, progress)?;
            if let (Some(last), Some(radiance)) = (&mut self.last, blended) {
                last.hits.radiance = radiance;
            }
        }
        self.last.iter_mut().for_each(|last| last.is_resting = true);
        Ok(())
    }

    /// Traces a picture and keeps it.
    fn trace_hits(
        &mut self,
        stage: &Stage,
        camera: &Camera,
        (focus, map): (&Focus, &Arc<FocusMap>),
        progress: &dyn Progress,
    ) -> Result<&FirstHits, SessionError> {
        let radiance = stage.lit.solve(camera, LightQuality::Rough, progress)?;
        let start = Instant::now();
        let hits = FirstHits::trace(stage.tracer(), &*radiance, focus, camera, progress)?;
        self.pace = Some(start.elapsed().as_secs_f64() / pixel_count(camera));
        let (camera, map) = (camera.clone(), map.clone());
        let traced = Pinhole { hits, camera, map, is_resting: false, defocused: None };
        Ok(&self.last.insert(traced).hits)
    }

    /// The last picture, blurred by the lens of a camera, and whether it was not asked for before; `None` if it shows another view or focus.
    pub fn defocused(&mut self, camera: &Camera, map: &FocusMap) -> Option<(Arc<Defocused>, bool)> {
        let Pinhole { hits, defocused, .. } = self.last.as_mut().filter(|last| last.shows(camera, map))?;
        let camera = resized(camera, [hits.width, hits.height]);
        if let Some((of, kept)) = defocused
            && *of == camera
        {
            return Some((kept.clone(), false));
        }
        let made = Arc::new(Defocused::new(hits, &camera));
        *defocused = Some((camera, made.clone()));
        Some((made, true))
    }
}

impl Pinhole {
    /// Whether it is the view of a camera, with this map.
    fn shows(&self, camera: &Camera, map: &FocusMap) -> bool {
        is_same_view(&self.camera, camera) && map.shares_tiles_with(&self.map)
    }
}

/// Whether the two show the same view, whatever their lens and size.
pub(crate) fn is_same_view(a: &Camera, b: &Camera) -> bool {
    (a.yfov, a.shift, a.camera_to_world) == (b.yfov, b.shift, b.camera_to_world)
        && (a.aspect() - b.aspect()).abs() < 0.1 * b.aspect()
}
