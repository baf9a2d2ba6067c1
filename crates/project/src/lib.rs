//! Files: projects, focus maps, pictures, cameras and recipes.
//!
//! * [`read_camera`], [`write_camera`]: the camera as JSON.
//! * [`read_recipe`]: focus by name, as JSON; [`read_focus`]: a recipe or a map, whichever the file is.
//! * [`FocusMapFile`]: focus maps as EXR or 16-bit PNG.
//! * [`write_picture`], [`read_picture`]: pictures as EXR, PNG and (reading only) HDR, with layers beside the colour.
//! * [`PartFile`]: a part of a picture that is yet to be merged.
//! * [`Cryptomatte`]: which things each pixel shows, as layers.
//! * [`seal_picture`], [`is_finished`]: whether a picture is whole, and which plan it was made by.
//! * [`compare`]: how far two pictures are apart; [`write_error_map`]: where; [`z_test`]: whether
//!   chance explains it.
//! * [`Preset`]: a brush, lens or bokeh to be used again; [`PresetShelf`]: all that there are.
//! * [`ProjectFile`]: the saved document; [`Thumbnail`]: the small picture in it.
//!
//! Everything is written atomically: the old file stays until the new one is complete.

mod aperture_mask_file;
mod camera;
mod capture_choices;
mod color_space;
mod compare;
mod container;
mod cryptomatte;
mod disk;
mod error;
mod error_map_file;
mod exr_bands;
mod exr_file;
mod exr_form;
mod exr_header;
mod exr_window;
mod focus_map_file;
mod json;
mod keys_file;
mod layer;
mod layer_entries;
mod layer_rows;
mod manifest;
mod mask_rows;
mod part_file;
mod picture_file;
mod picture_output;
mod picture_seal;
mod png_file;
mod presets;
mod project_file;
mod recipe;
mod recovery;
mod replacement;
mod scene_checksum;
mod scene_path;
mod strokes_file;
mod surface_file;
mod texel_bytes;
mod texel_set;
mod thumbnail;
mod world_file;
mod z_test;

pub use aperture_mask_file::read_aperture_mask;
pub use camera::{camera_from_json, camera_to_json, read_camera, write_camera};
pub use capture_choices::CaptureChoices;
pub use color_space::ColorSpace;
pub use compare::{Comparison, ErrorMaps, compare, error_maps, psnr};
pub use cryptomatte::{Cryptomatte, RankedCoverage};
pub use error::ProjectError;
pub use error_map_file::{false_color_error_map, write_error_map};
pub use exr_form::Compression;
pub use focus_map_file::{FocusMapFile, write_focus_map};
pub use keys_file::{read_keys, write_keys};
pub use layer::Layer;
pub use part_file::{NumberReader, PartFile, PartWriter, Section};
pub use picture_file::{LinearPicture, read_picture};
pub use picture_output::{PictureOptions, write_picture, write_picture_in_bands, write_rgb};
pub use picture_seal::{is_finished, seal_picture};
pub use png_file::texture_png;
pub use presets::{LensPreset, LibraryEntry, Preset, PresetContent, PresetKind, PresetLibrary};
pub use project_file::{NamedCamera, ProjectFile, SceneState};
pub use recipe::{FocusFile, read_focus, read_recipe};
pub use recovery::{find_recovery, recovery_path_for, remove_recovery, unsaved_recovery_path};
pub use strokes_file::{
    RecordedFill, RecordedGradient, RecordedSelection, RecordedStep, RecordedStroke, SelectionShape,
    StrokeView, read_strokes, write_strokes,
};
pub use surface_file::{surface_from_bytes, surface_to_bytes};
pub use texel_set::TexelSet;
pub use thumbnail::Thumbnail;
pub use world_file::{EnvironmentChoice, WorldFile};
pub use z_test::{ZAgreement, z_test};
