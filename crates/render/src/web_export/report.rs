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
    /// The largest difference in blur radius between two neighbours, of what is not painted, px.
    pub largest_step_px: f64,
    /// PSNR of the slices against the rendered pictures, 8-bit sRGB, dB.
    pub at_rest: PsnrSummary,
    /// The same of the cross-fades half way between neighbours; `None` for a single slice.
    pub midway: Option<PsnrSummary>,
}

impl StackReport {
    pub(super) fn new(aperture: &str, painted: bool, placed: &PlacedSlices, px_per_kappa: f64) -> Self {
        let steps = placed.slices.windows(2).map(|pair| pair[1].inverse_distance - pair[0].inverse_distance);
        Self {
            aperture: aperture.into(),
            painted,
            slices: placed.slices.len(),
            bytes: placed.bytes(),
            largest_step_px: px_per_kappa * steps.fold(0.0, f64::max),
            at_rest: placed.at_rest,
            midway: placed.midway,
        }
    }
}

impl fmt::Display for StackReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let focusing = if self.painted { "painted" } else { "ordinary focus" };
        let Self { aperture, slices, largest_step_px, at_rest, .. } = self;
        let megabytes = self.bytes as f64 / 1e6;
        write!(f, "{aperture}, {focusing}: {slices} slices, {megabytes:.2} MB, ")?;
        write!(f, "steps of at most {largest_step_px:.2} px of blur; ")?;
        write!(f, "at rest at least {:.1} dB (mean {:.1})", at_rest.lowest, at_rest.mean)?;
        match self.midway {
            Some(midway) => write!(f, ", half way {:.1} dB (mean {:.1})", midway.lowest, midway.mean),
            None => Ok(()),
        }
    }
}
