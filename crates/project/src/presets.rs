//! Presets: reusable brushes, lenses and bokeh, one file each.
//!
//! * `preset`: a preset and its file.
//! * `lens_preset`: a lens in a photographer's terms. `brush_preset`: the brush settings that do not depend on the scene.
//! * `bundled`: those that come with the program. `library`: those and the user's own, in a folder.

mod brush_preset;
mod bundled;
mod lens_preset;
mod library;
mod preset;

pub use lens_preset::LensPreset;
pub use library::{LibraryEntry, PresetLibrary};
pub use preset::{Preset, PresetContent, PresetKind};
