//! Files of painted focus: maps, recipes, recorded strokes, and keys of the lens.

mod focus_map_file;
mod keys_file;
mod recipe;
mod strokes_file;

pub use focus_map_file::{FocusMapFile, write_focus_map};
pub use keys_file::{read_keys, write_keys};
pub use recipe::{FocusFile, read_focus, read_recipe};
pub use strokes_file::{
    RecordedFill, RecordedGradient, RecordedSelection, RecordedSpread, RecordedStep, RecordedStroke,
    SelectionShape, StrokeView, read_strokes, write_strokes,
};
