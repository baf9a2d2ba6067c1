//! Pictures at full size and what is told beside them.
//!
//! Rendering by any renderer, extra channels, pictures to compare with, checks by rays, counts, and scenes as files.

mod aov;
mod blur_histogram;
mod coc_convention;
mod left_out;
mod mattes;
mod photograph_picture;
mod reference;
mod render;
mod renderer;
mod shot_extras;
mod stereo;
mod thumbnail;
mod unwrapped;
mod verification;

pub use aov::Aov;
pub use blur_histogram::BlurHistogram;
pub use coc_convention::CocConvention;
pub use left_out::{LeftOut, LeftOutPicture, LeftOutPrediction};
pub use reference::{Reference, ReferenceKind};
pub use render::{MAX_CELLS_A_SIDE, RenderCost, RenderOptions, Rendered, render, render_input};
pub use renderer::Renderer;
pub(crate) use stereo::render_pair;
pub use stereo::{Stereo, StereoForm, render_stereo};
pub use thumbnail::read_thumbnail;
pub(crate) use unwrapped::write_scene;
pub use unwrapped::write_unwrapped;
pub use verification::{Verification, VerifiedError};

pub(crate) use aov::LayerInputs;
pub(crate) use mattes::{
    Entry, Footprints, MatteRequest, Packing, Ranking, SampleParts, Tally, Things, left_out_warning,
    ranks_of, shares,
};
pub(crate) use photograph_picture::photograph_picture;
pub(crate) use render::{
    light_of_photographs, new_splatter, photographed_shares_of_pixels, sum_baked, sum_light_field, tracer_of,
};
