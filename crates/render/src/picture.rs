//! Full-size pictures and what belongs to them: AOVs, stereo pairs, photographs for comparison, thumbnails and tone mapping.

mod aov;
mod coc_convention;
mod cross_validation;
mod input_picture;
mod ocio_views;
mod photograph_picture;
mod photographed;
mod pixel_ray;
mod render;
mod renderer;
mod splat_truth;
mod stereo;
mod thumbnail;
mod tone;
mod tone_curve;

pub use aov::Aov;
pub(crate) use aov::LayerInputs;
pub use coc_convention::CocConvention;
pub use cross_validation::{LeftOut, LeftOutPicture, LeftOutPrediction, leave_photographs_out};
pub(crate) use input_picture::lit_scene_of;
pub use input_picture::{render_input, render_lit_input};
pub use ocio_views::OcioViews;
pub use photograph_picture::{photograph_picture, render_photograph};
pub use photographed::light_of_photographs;
pub(crate) use photographed::photographed_shares_of_pixels;
pub use render::{MAX_CELLS_A_SIDE, RenderCost, RenderOptions, Rendered, render, sharp_splats};
pub(crate) use render::{cut_off_warning, new_splatter, sum_baked};
pub use renderer::Renderer;
pub use stereo::{Stereo, StereoForm, render_stereo};
pub use thumbnail::read_thumbnail;
pub use tone::{Display, ScreenPixel, Tone, to_screen};
pub use tone_curve::ToneCurve;
