//! Baking and rendering without a window, for the command line and the window's exports.
//!
//! ```text
//! Input (document) ─▶ LitScene (light) ─▶ bake ─▶ picture ─▶ files
//!                                                  │ with mattes, AOVs
//!                          sequence: one a frame ◀─┼─▶ tiles: one in parts
//!                                                  └─▶ web page: one for each focus distance
//! ```
//!
//! [`RenderOptions`] configure a picture; [`render`] and [`render_input`] render one, [`render_frames`] a sequence, [`render_tiles`] a large
//! picture in tiles, and [`export_web_page`] a page that can be refocused. `examples/refocus.rs` bakes a light field once and refocuses it.

mod bake;
mod error;
mod export;
mod mattes;
mod picture;
mod sequence;
mod tiles;
#[cfg(test)]
#[allow(dead_code, reason = "shared with the tests of `session`")]
#[path = "../../session/tests/tiny_glb/mod.rs"]
mod tiny_glb;
mod web_export;

pub use bake::{
    DENSE_SAMPLE_BYTES, LightFieldStore, Modelled, ModelledRow, TexelStatistics, bake, bake_unpacked,
    is_baked_for, is_compatible, write_salf,
};
pub use baselines::{LayeredOptions, ScatterOptions, ViewsOptions};
pub use error::RenderError;
pub use export::{export_glb, write_scene, write_unwrapped};
pub use picture::{
    Aov, CocConvention, Display, LeftOut, LeftOutPicture, LeftOutPrediction, MAX_CELLS_A_SIDE, OcioViews,
    RenderCost, RenderOptions, Rendered, Renderer, ScreenPixel, Stereo, StereoForm, Tone, ToneCurve,
    leave_photographs_out, light_of_photographs, photograph_picture, read_thumbnail, render, render_input,
    render_lit_input, render_photograph, render_stereo, sharp_splats, to_screen,
};
pub use sequence::{
    Baking, FrameFiles, FrameList, FrameReport, Outcome, SequenceOptions, SequenceReport, Shard, Take,
    TakeOptions, render_frames,
};
pub use tiles::{Merged, TileGrid, TileOptions, TileReport, TilesReport, merge_tiles, render_tiles};
pub use web_export::{
    Caption, StackReport, WebPageEstimate, WebPageOptions, WebPageReport, estimate_web_page,
    export_engine_page, export_web_page, usual_engine_camera,
};
