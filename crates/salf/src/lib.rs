//! The surface-aperture light field (SALF): for a fixed camera, the image of the aperture as each surface point
//! sees it.
//!
//! [`bake()`] samples every surface that some point of the aperture sees. Samples come from the pinhole picture
//! where surfaces face the aperture (their footprints are the squares of the pixel grid or quadrants of them, so that they
//! tile the picture exactly), and from the surface itself where it is edge-on, or small and bright. A [`Sample`] knows its
//! surface address, its weight toward every aperture point, its radiance, and what of the aperture it sees ([`Visibility`]);
//! they are kept packed ([`Samples`]).

mod baker;
mod carried;
mod domain;
mod file;
mod jitter;
mod margin;
mod options;
mod salf;
mod sample;
mod samples;
pub mod tree;
mod view;

pub use baker::outliers::Outliers;
pub use baker::parts::{PartsBaker, Surroundings};
pub use baker::{bake, bake_with_outliers};
pub use carried::Carried;
pub use domain::{Cell, Domain};
pub use file::{SalfFile, SalfFileError};
pub use margin::LARGEST_MARGIN_HEIGHTS;
pub use options::BakeOptions;
pub use salf::{Salf, SalfStatistics};
pub use sample::{Address, Sample, SampleFocus, Visibility};
pub use samples::{Addresses, Run, SampleLocation, Samples};
