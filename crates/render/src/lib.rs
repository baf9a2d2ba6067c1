//! Pictures without a window: what the command line does, and what the window exports.
//!
//! ```text
//! Input (document) ─▶ LitScene (light) ─▶ bake ─▶ picture ─▶ files
//!                                                  │ with mattes, AOVs
//!                          sequence: one a frame ◀─┴─▶ tiles: one in parts
//! ```
//!
//! [`RenderOptions`] say how, [`render`] and [`render_input`] do it, [`render_frames`] and [`render_tiles`] do many.

mod bake;
mod error;
mod export;
mod mattes;
mod picture;
mod sequence;
mod tiles;
#[cfg(test)]
#[path = "../../session/tests/tiny_glb/mod.rs"]
mod tiny_glb;

pub use bake::{
    DENSE_SAMPLE_BYTES, LIGHT_PASSES, LightFieldStore, Modelled, ModelledRow, TexelStatistics, bake,
    bake_unpacked, is_compatible, write_salf,
};
pub use baselines::{LayeredOptions, ScatterOptions, ViewsOptions};
pub use error::RenderError;
pub use export::{export_glb, write_scene, write_unwrapped};
pub use picture::{
    Aov, CocConvention, Display, LeftOut, LeftOutPicture, LeftOutPrediction, MAX_CELLS_A_SIDE, OcioViews,
    RenderCost, RenderOptions, Rendered, Renderer, ScreenPixel, Stereo, StereoForm, Tone, ToneCurve,
    leave_photographs_out, light_of_photographs, photograph_picture, read_thumbnail, rectangle_to_screen,
    render, render_input, render_pair, render_photograph, render_stereo, sum_light_field, to_screen,
};
pub use sequence::{
    Baking, FrameFiles, FrameList, FrameReport, Outcome, SequenceOptions, SequenceReport, Shard, Take,
    TakeOptions, WritePicture, render_frames,
};
pub use tiles::{Merged, TileGrid, TileOptions, TileReport, TilesReport, merge_tiles, render_tiles};
