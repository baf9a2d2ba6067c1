//! Pictures: reading, writing and sealing them, their layers, and comparing two of them.

pub(crate) mod compare;
pub(crate) mod cryptomatte;
pub(crate) mod error_map;
pub(crate) mod layer;
pub(crate) mod linear_picture;
pub(crate) mod output;
pub(crate) mod png_file;
pub(crate) mod seal;
pub(crate) mod z_agreement;

pub use compare::{Comparison, ErrorMaps, compare, error_maps};
pub use cryptomatte::{Cryptomatte, RankedCoverage};
pub use error_map::{false_color_error_map, write_error_map};
pub use layer::Layer;
pub use linear_picture::{LinearPicture, read_picture};
pub use output::{PictureOptions, write_picture, write_picture_in_bands, write_rgb};
pub use png_file::texture_png;
pub use seal::{is_finished, seal_picture};
pub use z_agreement::{ZAgreement, z_test};
