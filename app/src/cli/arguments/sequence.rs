//! Arguments for sequences of frames and for keyframes.

use super::parsers::{name_parser, parse_positive};
use clap::Args;
use focus::Ease;
use render::{FrameList, Shard};
use std::path::PathBuf;

/// Which frames of a sequence to render, and their timing.
#[derive(Debug, Args)]
pub struct SequenceArguments {
    /// Render a single frame of the animation. Frame 1 is at 0 s, earlier ones are before
    #[arg(long, value_name = "N", allow_negative_numbers = true, conflicts_with_all = ["frames", "shard", "stereo"])]
    pub frame: Option<i32>,
    /// Render these frames to -o out.####.exr: 1-100, 1-100x2 (every second), 1-3,5,7-10:2, -10--5. Frames
    /// already rendered with the same settings are skipped
    #[arg(long, value_name = "LIST", allow_hyphen_values = true, conflicts_with = "stereo")]
    pub frames: Option<FrameList>,
    /// Frames per second
    #[arg(long, value_name = "N", default_value_t = 24.0, value_parser = parse_positive)]
    pub fps: f64,
    /// The animation to play, by name (default: the first; info lists them)
    #[arg(long, value_name = "NAME", value_parser = name_parser())]
    pub animation: Option<String>,
    /// Lens keyframes from a file, overriding the project's (docs/guide/sequences.md)
    #[arg(long, value_name = "KEYS.json")]
    pub keys: Option<PathBuf>,
    /// Render only the K-th of N shares of the frames or tiles; env reads the share from the farm (Slurm
    /// arrays, Kubernetes indexed jobs, GNU parallel)
    #[arg(long, value_name = "K/N|env", value_parser = shard)]
    pub shard: Option<Shard>,
}

impl SequenceArguments {
    /// Whether frames of a sequence are requested.
    pub fn is_sequence(&self) -> bool {
        self.frame.is_some() || self.frames.is_some()
    }
}

fn shard(text: &str) -> Result<Shard, String> {
    match text {
        "env" => Shard::from_environment(&|name| std::env::var(name).ok()),
        _ => text.parse(),
    }
}

/// `keys`.
#[derive(Debug, Args)]
pub struct KeysArguments {
    /// The project (.fbrush)
    pub project: PathBuf,
    /// Where to write the project with the new keys; without it, the existing keys are written to stdout as
    /// JSON
    #[arg(short, long, value_name = "OUT.fbrush")]
    pub output: Option<PathBuf>,
    /// Replace all lens keys by those in a file
    #[arg(long, value_name = "KEYS.json", requires = "output")]
    pub set: Option<PathBuf>,
    /// Focus the lens on the surface visible at a pixel position, from a time (s) on, and follow it as it moves
    #[arg(long, value_name = "X,Y@SECONDS", value_parser = place_at, requires = "output")]
    pub point: Vec<(glam::DVec2, f64)>,
    /// Focus the lens at a distance (or inf), from a time (s) on
    #[arg(long, value_name = "DISTANCE@SECONDS", value_parser = number_at, requires = "output")]
    pub distance: Vec<(f64, f64)>,
    /// Set the f-number at a time (s)
    #[arg(long, value_name = "N@SECONDS", value_parser = number_at, requires = "output")]
    pub f_number: Vec<(f64, f64)>,
    /// Set the character of a lens at a time (s): that of a preset or lens file, or none
    #[arg(long, value_name = "LENS@SECONDS", value_parser = lens_at, requires = "output")]
    pub character: Vec<(String, f64)>,
    /// Set the opacity of a layer, by name, at a time (s)
    #[arg(long, value_name = "LAYER=OPACITY@SECONDS", value_parser = layer_at, requires = "output")]
    pub opacity: Vec<(String, f64, f64)>,
    /// Interpolation from the new keys to the next ones
    #[arg(long, value_name = "hold|linear|smooth", default_value = "smooth", value_parser = ease)]
    pub ease: Ease,
}

fn ease(text: &str) -> Result<Ease, String> {
    Ease::from_name(text).ok_or_else(|| "hold, linear or smooth".into())
}

/// Parses `VALUE@SECONDS`. Values out of range are reported later, with their context.
fn number_at(text: &str) -> Result<(f64, f64), String> {
    let parts =
        text.rsplit_once('@').and_then(|(value, at)| Some((value.trim().parse().ok()?, seconds(at)?)));
    parts.ok_or_else(|| "VALUE@SECONDS".into())
}

fn lens_at(text: &str) -> Result<(String, f64), String> {
    let parts = text.rsplit_once('@').and_then(|(lens, at)| Some((lens.trim().to_string(), seconds(at)?)));
    parts.filter(|(lens, _)| !lens.is_empty()).ok_or_else(|| "LENS@SECONDS".into())
}

fn place_at(text: &str) -> Result<(glam::DVec2, f64), String> {
    let place = |text: &str| {
        let (x, y) = text.split_once(',')?;
        let place = glam::DVec2::new(x.trim().parse().ok()?, y.trim().parse().ok()?);
        place.is_finite().then_some(place)
    };
    let parts = text.rsplit_once('@').and_then(|(value, at)| Some((place(value)?, seconds(at)?)));
    parts.ok_or_else(|| "X,Y@SECONDS".into())
}

fn layer_at(text: &str) -> Result<(String, f64, f64), String> {
    let parts = text.rsplit_once('=');
    let parts =
        parts.and_then(|(layer, value)| number_at(value).ok().map(|(value, at)| (layer.into(), value, at)));
    parts.ok_or_else(|| "LAYER=OPACITY@SECONDS".into())
}

fn seconds(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|seconds: &f64| seconds.is_finite())
}
