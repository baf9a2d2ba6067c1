//! Presets: brushes, lenses and bokeh that are used again, a file each.
//!
//! * `preset`: what one is, and its file.
//! * `lens_preset`: a lens as a photographer names it. `brush_preset`: what of a brush is no matter of the scene.
//! * `shipped`: those that come with the program. `shelf`: those and the user's own, in a folder.

mod brush_preset;
mod lens_preset;
mod preset;
mod shelf;
mod shipped;

pub use lens_preset::LensPreset;
pub use preset::{Preset, PresetContent, PresetKind};
pub use shelf::{LibraryEntry, PresetLibrary};
