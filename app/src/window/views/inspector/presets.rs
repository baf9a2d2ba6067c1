//! The presets of brushes, lenses and bokeh: rows to choose from, and small pictures of what each does.

mod bokeh_thumbnails;
mod preset_picture;
mod preset_row;

pub use bokeh_thumbnails::bokeh_thumbnails;
pub use preset_row::preset_row;
