//! Files: projects, focus maps, pictures, cameras and recipes.
//!
//! * [`read_camera`], [`write_camera`]: the camera as JSON.
//! * [`read_recipe`]: focus by name, as JSON; [`read_focus`]: a recipe or a map, by extension.
//! * [`FocusMapFile`]: focus maps as EXR or 16-bit PNG.
//! * [`write_picture`], [`read_picture`]: pictures as EXR, PNG and (reading only) HDR, with layers in addition to the colour.
//! * [`PartFile`]: a part of a picture that is yet to be merged.
//! * [`Cryptomatte`]: which objects each pixel shows, as layers.
//! * [`seal_picture`], [`is_finished`]: whether a picture is complete, and which plan it was made by.
//! * [`compare`]: error measures between two pictures; [`write_error_map`]: their differences per pixel; [`z_test`]: whether
//!   chance explains them.
//! * [`Preset`]: a reusable brush, lens or bokeh; [`PresetLibrary`]: all presets of a user.
//! * [`ProjectFile`]: the saved document; [`Thumbnail`]: the small picture in it.
//!
//! All files are written atomically: the old file stays until the new one is complete.
//!
//! # Example
//!
//! ```
//! use lens::Camera;
//! use project::{camera_from_json, camera_to_json};
//!
//! let camera = Camera { focus_distance: 2.0, ..Camera::default() };
//! let text = camera_to_json(&camera).to_string();
//! let no_mask = |_: &str| unreachable!("the aperture is a disc");
//! assert_eq!(camera_from_json("camera.json".as_ref(), &text, &Camera::default(), &no_mask).unwrap(), camera);
//! ```

mod camera;
mod color_space;
mod disk;
mod environment_file;
mod error;
mod focus_files;
mod focus_hold;
mod json;
mod named_file;
mod openexr;
mod part_file;
mod pictures;
mod presets;
mod project_file;
mod scene_path;
mod splats_file;
mod world_file;

pub use camera::{camera_from_json, camera_to_json, read_aperture_mask, read_camera, write_camera};
pub use color_space::ColorSpace;
pub use error::ProjectError;
pub use focus_files::{
    FocusFile, FocusMapFile, RecordedFill, RecordedGradient, RecordedSelection, RecordedSpread, RecordedStep,
    RecordedStroke, SelectionShape, StrokeView, read_focus, read_keys, read_recipe, read_strokes,
    write_focus_map, write_keys, write_strokes,
};
pub use focus_hold::FocusHold;
pub use openexr::Compression;
pub use part_file::{NumberReader, PartFile, PartWriter, Section};
pub use pictures::{
    Comparison, Cryptomatte, ErrorMaps, Layer, LinearPicture, PictureOptions, RankedCoverage, ZAgreement,
    compare, error_maps, false_color_error_map, is_finished, read_picture, seal_picture, texture_png,
    write_error_map, write_picture, write_picture_in_bands, write_rgb, z_test,
};
pub use presets::{LensPreset, LibraryEntry, Preset, PresetContent, PresetKind, PresetLibrary};
pub use project_file::{
    CaptureChoices, NamedCamera, ProjectFile, SceneState, TexelSet, Thumbnail, find_recovery,
    recovery_path_for, remove_recovery, surface_from_bytes, surface_to_bytes, unsaved_recovery_path,
};
pub use splats_file::SplatsFile;
pub use world_file::{EnvironmentChoice, WorldFile};
