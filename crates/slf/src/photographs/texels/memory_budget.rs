//! Resolutions of photographs and texels that fit the available memory.

use atlas::Atlas;
use glam::DVec3;
use numerics::upper_median;
use scene::{Scene, View};

/// Chosen resolutions and concurrency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MemoryBudget {
    /// Pixels of the file per stored pixel, each way.
    pub reduction: u32,
    /// Texels of the light per texel of the atlas, each way.
    pub texel_scale: f64,
    /// Number of photographs processed at once.
    pub at_once: usize,
}

/// Shares of memory for stored photographs, for observations, and for photographs being processed.
const PICTURE_SHARE: f64 = 0.3;
const OBSERVATION_SHARE: f64 = 0.4;
const WORKING_SHARE: f64 = 0.3;
/// Bytes per pixel of a photograph being processed: decoded and linear, packed, and depth.
const WORKING_BYTES: f64 = 28.0;
const PACKED_BYTES: f64 = 4.0;
const DEPTH_BYTES: f64 = 5.0;
/// Bytes per texel and photograph: its weight, and where observed the observation and residual.
const WEIGHT_BYTES: f64 = 1.0;
const OBSERVATION_BYTES: f64 = 18.0;
/// Share of the photographs that observe a texel, about.
const OBSERVED_SHARE: f64 = 0.35;
/// Bytes per texel independent of photographs.
const TEXEL_BYTES: f64 = 184.0;
/// Pixels per texel, each way, of the photographs with the finest resolution there: many photographs together resolve
/// more than one.
const PIXELS_PER_TEXEL: f64 = 0.8;
/// More photographs at once are not faster where two cores read them.
const MAX_AT_ONCE: usize = 16;
/// Limits of the texel scale.
const SCALES: [f64; 2] = [0.125, 4.0];

impl MemoryBudget {
    /// For photographs that are looked up directly: their reduction, and how many are processed at once.
    pub fn for_direct_lookup(views: &[View], memory: u64) -> (u32, usize) {
        let (total, largest) = pixel_counts(views);
        let memory = memory as f64;
        let picture_memory = memory * (1.0 - WORKING_SHARE);
        let reduction = (total * (PACKED_BYTES + DEPTH_BYTES) / picture_memory).sqrt().ceil().max(1.0);
        (reduction as u32, concurrent_photographs(largest, memory * WORKING_SHARE))
    }

    /// The budget for light stored at texels, within `memory` bytes: how far pictures and atlas are reduced, how many
    /// photographs are decoded at once.
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

/// How many photographs of up to `largest` pixels fit in `memory` bytes.
fn concurrent_photographs(largest: f64, memory: f64) -> usize {
    ((memory / (largest * WORKING_BYTES)) as usize).clamp(1, MAX_AT_ONCE)
}

/// Footprint of a pixel on the surface in the photograph with the finest resolution, world units: median over sampled
/// triangles, ignoring occlusion; `None` if no photograph shows the surface.
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
    upper_median(&mut pixels)
}
