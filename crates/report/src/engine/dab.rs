//! The cost of a single dab while the picture is live.

use lens::FocusOffset;
use salf::{Salf, SampleLocation};
use scene::{SurfaceField, SurfacePoint};
use std::collections::HashSet;
use std::sync::Arc;

/// Samples covered by a dab.
const SAMPLES: usize = 5000;

/// Circle of confusion of the dab, px: a fixed t would blur beyond the picture in a large scene.
const CIRCLE_PX: f64 = 48.0;

/// A focus with a dab: the samples at some points are blurred.
pub struct DabbedFocus {
    focus: Arc<dyn SurfaceField<FocusOffset> + Send>,
    points: HashSet<[u64; 3]>,
    offset: FocusOffset,
    /// Indices of the covered samples.
    pub samples: Vec<u32>,
}

impl DabbedFocus {
    /// A dab on the surface samples nearest to the picture's centre.
    pub fn new(salf: &Salf, focus: Arc<dyn SurfaceField<FocusOffset> + Send>) -> Self {
        let middle = glam::Vec2::new(salf.camera.width as f32, salf.camera.height as f32) / 2.0;
        let spots = salf.samples.runs().flat_map(|run| run.indices.clone().zip(run.locations()));
        let mut nearest: Vec<(u32, SampleLocation)> =
            spots.filter(|(_, spot)| spot.address.surface.is_some()).collect();
        let distance = |spot: &SampleLocation| spot.center.distance_squared(middle);
        nearest.sort_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)));
        nearest.truncate(SAMPLES);
        let points = nearest.iter().filter_map(|(_, spot)| spot.address.surface.map(point_key)).collect();
        let optics = salf.camera.optics();
        // With anchor 1 the blur is the same at any depth; without an aperture there is none.
        let kappa = optics.kappa_for_circle_px(CIRCLE_PX).unwrap_or(0.0);
        let offset = FocusOffset::new(1.0 + kappa * optics.image_distance, 1.0);
        Self { focus, points, offset, samples: nearest.into_iter().map(|(index, _)| index).collect() }
    }
}

fn point_key(point: SurfacePoint) -> [u64; 3] {
    [point.triangle.into(), point.barycentric.x.to_bits(), point.barycentric.y.to_bits()]
}

impl SurfaceField<FocusOffset> for DabbedFocus {
    fn at(&self, point: SurfacePoint) -> FocusOffset {
        if self.points.contains(&point_key(point)) { self.offset } else { self.focus.at(point) }
    }
    fn at_infinity(&self) -> FocusOffset {
        self.focus.at_infinity()
    }
}
