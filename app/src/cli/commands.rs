//! The subcommands, one module each: `run` takes the parsed arguments and does the work.

pub mod bake;
pub mod compare;
pub mod doctor;
pub mod export;
pub mod import;
pub mod info;
pub mod keys;
pub mod merge;
pub mod new;
pub mod presets;
pub mod render;
pub mod replay;
pub mod report;
pub mod thumbnail;
pub mod unwrap;
