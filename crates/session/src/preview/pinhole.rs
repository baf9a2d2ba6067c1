//! Pictures without blur: those that follow a moving camera, and what is laid over rough pictures.

use super::picture_sizes::pixel_count;
use crate::display::{Layer, SharpLayer, antialiased};
use crate::error::SessionError;
use baselines::FirstHits;
use document::Stage;
use focus::{Focus, FocusMap};
use lens::{Camera, Picture};
use light::LightQuality;
use progress::Progress;
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
        let radiance = stage.lit.solve(camera, LightQuality::Rough, progress)?;
        let start = Instant::now();
        let hits = FirstHits::trace(stage.tracer(), &*radiance, focus, camera, progress)?;
        self.pace = Some(start.elapsed().as_secs_f64() / pixel_count(camera));
        let picture = antialiased(&hits.picture());
        self.last = Some(Pinhole { hits, camera: camera.clone(), map: map.clone() });
        Ok(picture)
    }

    /// Whether the last picture shows the view of a camera with this map, in at least as many pixels.
    pub fn shows(&self, camera: &Camera, map: &FocusMap) -> bool {
        let fits = |last: &Pinhole| is_same_view(&last.camera, camera) && map.shares_tiles_with(&last.map);
        self.last.as_ref().is_some_and(|last| fits(last) && last.camera.width >= camera.width)
    }

    /// What of the last picture is laid over a rough one that is enlarged to `size`; `None` if it shows another view or focus.
    pub fn layer_over(&self, rough: &Camera, size: [u32; 2], map: &FocusMap) -> Option<Arc<dyn Layer>> {
        let Pinhole { hits, camera, map: traced_map } = self.last.as_ref()?;
        let fits = is_same_view(camera, rough) && map.shares_tiles_with(traced_map);
        // The lens may be another.
        let camera = Camera { width: camera.width, height: camera.height, ..rough.clone() };
        fits.then(|| Arc::new(SharpLayer::new(hits, &camera, [rough.width, rough.height], size)) as _)
    }
}

/// Whether the two show the same view, whatever their lens and size.
pub(crate) fn is_same_view(a: &Camera, b: &Camera) -> bool {
    (a.yfov, a.shift, a.camera_to_world) == (b.yfov, b.shift, b.camera_to_world)
        && (a.aspect() - b.aspect()).abs() < 0.1 * b.aspect()
}
