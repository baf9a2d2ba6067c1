//! What was measured of a web page.

use crate::web_export::options::WebPageOptions;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;
use web_page::{PlacedSlices, PsnrSummary};

/// A web page that was written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WebPageReport {
    /// The page, and its poster if there is one.
    pub files: Vec<PathBuf>,
    /// Bytes of the page.
    pub bytes: u64,
    /// Its stacks.
    pub stacks: Vec<StackReport>,
}

impl WebPageReport {
    /// What is not as good as it should be, one sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let wanted = WebPageOptions::MIDWAY_PSNR;
        let poor = |stack: &StackReport| {
            let midway = stack.midway.filter(|midway| midway.lowest < wanted)?;
            Some(format!(
                "{}: while the focus moves at {}, cross-fades are as far as {:.1} dB from the picture, not {wanted} dB (at rest it is right)",
                self.files.first()?.display(),
                stack.aperture,
                midway.lowest
            ))
        };
        self.stacks.iter().filter_map(poor).collect()
    }
}

/// The slices of one aperture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StackReport {
    /// The aperture's name, such as `f/2.8`.
    pub aperture: String,
    /// Whether it is focused as painted, or by the ordinary lens.
    pub painted: bool,
    /// The number of slices.
    pub slices: usize,
    /// Bytes of their pictures, before they are encoded as text.
    pub bytes: u64,
    /// The radius of the blur that remains at the slice that shows a surface best, px: the largest of all surfaces that some distance makes
    /// sharp.
    pub largest_blur_px: f64,
    /// PSNR of the slices against the rendered pictures, dB, as `compare` measures it.
    pub at_rest: PsnrSummary,
    /// The same of the cross-fades half way between neighbours; `None` for a single slice.
    pub midway: Option<PsnrSummary>,
}

impl StackReport {
    /// `sharp` are the reciprocal distances that make some surface sharp, at which the blur grows by `px_per_kappa`.
    pub(super) fn new(
        aperture: &str,
        painted: bool,
        placed: &PlacedSlices,
        sharp: &[f64],
        px_per_kappa: f64,
    ) -> Self {
        let slices: Vec<f64> = placed.slices.iter().map(|slice| slice.inverse_distance).collect();
        let blur_px = |&distance: &f64| {
            let next = slices.partition_point(|&slice| slice < distance);
            let neighbours = &slices[next.saturating_sub(1)..slices.len().min(next + 1)];
            let apart = neighbours.iter().map(|slice| (slice - distance).abs());
            px_per_kappa * apart.fold(f64::INFINITY, f64::min)
        };
        Self {
            aperture: aperture.into(),
            painted,
            slices: placed.slices.len(),
            bytes: placed.bytes(),
            largest_blur_px: sharp.iter().map(blur_px).fold(0.0, f64::max),
            at_rest: placed.at_rest,
            midway: placed.midway,
        }
    }
}

impl fmt::Display for StackReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let focusing = if self.painted { "painted" } else { "ordinary focus" };
        let Self { aperture, slices, largest_blur_px, at_rest, .. } = self;
        let megabytes = self.bytes as f64 / 1e6;
        write!(f, "{aperture}, {focusing}: {slices} slices, {megabytes:.2} MB, ")?;
        write!(f, "surfaces at most {largest_blur_px:.2} px from sharp; ")?;
        write!(f, "at rest at least {:.1} dB (mean {:.1})", at_rest.lowest, at_rest.mean)?;
        match self.midway {
            Some(midway) => write!(f, ", half way {:.1} dB (mean {:.1})", midway.lowest, midway.mean),
            None => Ok(()),
        }
    }
}
