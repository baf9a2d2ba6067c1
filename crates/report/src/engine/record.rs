//! A measurement of the engine, as written to `report.json`.

use super::frame_copy::Timing;
use super::ray_tracer::AgainstTruth;
use salf::Salf;
use serde::Serialize;
use splat::Splatter;

/// A time with its error. Splatted pictures are compared with the converged splat of the same light field,
/// those of the ray tracer with the ground truth, on linear values clipped to [0, 1].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EngineRecord {
    /// The scene, or the synthetic field.
    pub scene: String,
    /// What was timed.
    pub what: String,
    /// The renderer.
    pub renderer: String,
    /// Where it ran: "cpu" or "gpu".
    pub backend: String,
    /// Name of the graphics card, if one was used.
    pub adapter: Option<String>,
    /// Number of threads.
    pub threads: u32,
    /// Width and height, px.
    pub size: [u32; 2],
    /// Samples of the light field.
    pub samples: u64,
    /// The largest circle of confusion of a synthetic field, or the 99th percentile of a scene's, px.
    pub coc_px: f64,
    /// Side of a node that may be drawn as one, as a share of a circle of confusion of 16 px; 0: every sample
    /// is drawn.
    pub tolerance: Option<f64>,
    /// What the time of a bake is measured against: samples, triangles, or layers of leaves.
    pub against: Option<f64>,
    /// Rays per pixel of the ray tracer.
    pub spp: Option<u32>,
    /// Median time, ms.
    pub ms_median: f64,
    /// The last of these times by the graphics card's own clock, from the first sum to the last pixel, if
    /// available, ms.
    pub card_ms: Option<f64>,
    /// Median time to copy one frame meanwhile, ms.
    pub frame_copy_ms: f64,
    /// Median time in frame copies.
    pub frame_copies: f64,
    /// PSNR against the converged picture, or of the ray tracer against the ground truth, dB.
    pub psnr: Option<f64>,
    /// PSNR within 6 px of outlines, dB; `None` without outlines.
    pub band_psnr: Option<f64>,
    /// Root mean square difference of the coverage within 6 px of outlines.
    pub band_coverage_rms: Option<f64>,
    /// Comparison of a scene's splat with the ground truth.
    pub truth: Option<AgainstTruth>,
    /// Memory of the samples, or of the hierarchy and the sums, bytes.
    pub bytes: u64,
}

impl EngineRecord {
    /// A record without a comparison.
    pub(super) fn new(scene: &str, what: &str, salf: &Salf, timing: Timing) -> Self {
        Self {
            scene: scene.into(),
            what: what.into(),
            renderer: "splat".into(),
            backend: "cpu".into(),
            adapter: None,
            threads: rayon::current_num_threads() as u32,
            size: [salf.camera.width, salf.camera.height],
            samples: salf.samples.len() as u64,
            coc_px: 0.0,
            tolerance: None,
            against: None,
            spp: None,
            ms_median: 0.0,
            card_ms: None,
            frame_copy_ms: 0.0,
            frame_copies: 0.0,
            psnr: None,
            band_psnr: None,
            band_coverage_rms: None,
            truth: None,
            bytes: 0,
        }
        .with_timing(timing)
    }

    /// Replaces the time.
    pub(super) fn with_timing(self, timing: Timing) -> Self {
        let Timing { seconds, frame_copy } = timing;
        Self {
            ms_median: seconds * 1e3,
            frame_copy_ms: frame_copy * 1e3,
            frame_copies: timing.frame_copies(),
            ..self
        }
    }

    /// Sets the device and the memory of a splatter.
    pub(super) fn summed_by(self, splatter: &Splatter) -> Self {
        let bytes = splatter.bytes().iter().sum::<usize>() as u64;
        match splatter.gpu() {
            Some(gpu) => Self { backend: "gpu".into(), adapter: Some(gpu.name().into()), bytes, ..self },
            None => Self { bytes, ..self },
        }
    }

    /// Speedup over the ray tracer at equal error; a lower bound if the ray tracer takes longer than measured.
    pub(super) fn speedup_over_ray_tracer(&self) -> Option<f64> {
        self.truth.as_ref().map(|truth| truth.ray_tracer_ms / self.ms_median)
    }

    /// A one-line summary.
    pub(super) fn summary_line(&self) -> String {
        let decibels =
            |name: &str, value: Option<f64>| value.map_or(String::new(), |v| format!(", {name}{v:.1} dB"));
        format!(
            "{} {}{}{}{}: {:.1} ms = {:.1} F{}{}{}{}",
            self.scene,
            self.what,
            self.adapter.as_ref().map_or(String::new(), |name| format!(" on {name}")),
            self.tolerance.map_or(String::new(), |t| format!(" at {t}")),
            self.spp.map_or(String::new(), |spp| format!(" of {spp} rays")),
            self.ms_median,
            self.frame_copies,
            self.card_ms.map_or(String::new(), |ms| format!(", {ms:.1} ms by its clock")),
            decibels("", self.psnr),
            decibels("outlines ", self.band_psnr),
            self.truth_sentence(),
        )
    }

    fn truth_sentence(&self) -> String {
        let (Some(truth), Some(times)) = (&self.truth, self.speedup_over_ray_tracer()) else {
            return String::new();
        };
        let least = if truth.ray_tracer_takes_longer { "at least " } else { "" };
        let AgainstTruth { psnr, flip, .. } = truth;
        format!("; truth {psnr:.1} dB, FLIP {flip:.4}, {least}{times:.2} times as fast as the ray tracer")
    }
}
