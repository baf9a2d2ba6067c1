//! How fine photographs and texels are kept, so that all of it fits the memory that there is.

use crate::photographs::numbers::median;
use atlas::Atlas;
use glam::DVec3;
use scene::{Scene, View};

/// How fine, and how much at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MemoryBudget {
    /// Pixels of a photograph that are joined to one, each way.
    pub reduction: u32,
    /// Texels of the light over those of the atlas, each way.
    pub texel_scale: f64,
    /// Photographs that are worked on at once.
    pub at_once: usize,
}

/// Of the memory, kept photographs may take this share, what they show of texels this, and those that are worked on this.
const PICTURE_SHARE: f64 = 0.3;
const OBSERVATION_SHARE: f64 = 0.4;
const WORKING_SHARE: f64 = 0.3;
/// A photograph being worked on: decoded and linear, kept, and its depth, bytes a pixel.
const WORKING_BYTES: f64 = 28.0;
const PACKED_BYTES: f64 = 4.0;
const DEPTH_BYTES: f64 = 5.0;
/// Of a texel and one photograph: its weight; where it is seen, sighting and residual.
const WEIGHT_BYTES: f64 = 1.0;
const OBSERVATION_BYTES: f64 = 18.0;
/// Of the photographs about so many see a texel.
const OBSERVED_SHARE: f64 = 0.35;
/// Of a texel by itself.
const TEXEL_BYTES: f64 = 184.0;
/// Pixels a texel, each way, as the photographs that see it best see it: many photographs know it finer than one.
const PIXELS_PER_TEXEL: f64 = 0.8;
/// More photographs at once make nothing faster where two cores read them.
const MAX_AT_ONCE: usize = 16;
/// The atlas is made finer or coarser by so much at most.
const SCALES: [f64; 2] = [0.125, 4.0];

impl MemoryBudget {
    /// For photographs that are looked up themselves: their reduction, and how many are worked on at once.
    pub fn for_direct_lookup(views: &[View], memory: u64) -> (u32, usize) {
        let (total, largest) = pixel_counts(views);
        let memory = memory as f64;
        let picture_memory = memory * (1.0 - WORKING_SHARE);
        let reduction = (total * (PACKED_BYTES + DEPTH_BYTES) / picture_memory).sqrt().ceil().max(1.0);
        (reduction as u32, concurrent_photographs(largest, memory * WORKING_SHARE))
    }

    /// For these photographs and `memory` bytes.
    pub fn for_texels(scene: &Scene, atlas: &Atlas, views: &[View], memory: u64) -> Self {
        let memory = memory as f64;
        let (total, largest) = pixel_counts(views);
        let reduction = (total * PACKED_BYTES / (memory * PICTURE_SHARE)).sqrt().ceil().max(1.0);
        let at_once = concurrent_photographs(largest, memory * WORKING_SHARE);
        let area: f64 = (0..scene.triangles.len() as u32)
            .map(|triangle| 0.5 * scene.area_normal(triangle).length())
            .filter(|area| area.is_finite())
            .sum();
        let bytes_per_texel =
            TEXEL_BYTES + views.len() as f64 * (WEIGHT_BYTES + OBSERVED_SHARE * OBSERVATION_BYTES);
        let max_texels = memory * OBSERVATION_SHARE / bytes_per_texel;
        let memory_scale = (max_texels / area).sqrt() / atlas.density;
        let target_scale = finest_pixel(scene, views)
            .map_or(1.0, |pixel| 1.0 / (PIXELS_PER_TEXEL * pixel * reduction * atlas.density));
        let scale = target_scale.min(memory_scale);
        let texel_scale = if scale.is_finite() { scale.clamp(SCALES[0], SCALES[1]) } else { 1.0 };
        Self { reduction: reduction as u32, texel_scale, at_once }
    }
}

/// Pixels of all photographs, and of the largest.
fn pixel_counts(views: &[View]) -> (f64, f64) {
    let pixels = |view: &View| view.lens.size_px().iter().map(|&side| f64::from(side)).product::<f64>();
    (views.iter().map(pixels).sum(), views.iter().map(pixels).fold(1.0, f64::max))
}

/// Photographs of up to so many pixels that so much memory has room for.
fn concurrent_photographs(largest: f64, memory: f64) -> usize {
    ((memory / (largest * WORKING_BYTES)) as usize).clamp(1, MAX_AT_ONCE)
}

/// How wide a pixel of the photographs that see a spot best is there, world units: the median over some spots; `None` if nothing is seen.
/// Whether anything stands between does not matter.
fn finest_pixel(scene: &Scene, views: &[View]) -> Option<f64> {
    const SAMPLES: usize = 500;
    let step = scene.triangles.len().div_ceil(SAMPLES).max(1);
    let pixel_at = |triangle: usize| {
        let [a, b, c] = scene.corners(triangle as u32);
        let position: DVec3 = (a + b + c) / 3.0;
        let pixel = |view: &View| {
            let at = view.project(position)?;
            let focal = view.lens.intrinsics().focal_px;
            let is_visible = view.lens.is_in_picture(at);
            is_visible.then(|| position.distance(view.position()) / focal[0].min(focal[1]))
        };
        views.iter().filter_map(pixel).min_by(f64::total_cmp)
    };
    let mut pixels: Vec<f64> = (0..scene.triangles.len()).step_by(step).filter_map(pixel_at).collect();
    median(&mut pixels, f64::total_cmp)
}
