//! What can be typed about frames.

use super::parsers::{name_parser, positive};
use clap::Args;
use focus::Ease;
use session::{FrameList, Shard};
use std::path::PathBuf;

/// Which frames of a sequence, and how they follow each other.
#[derive(Debug, Args)]
pub struct SequenceArguments {
    /// The picture of one frame: with what moves where it is then. Frame 1 is at 0 s
    #[arg(long, value_name = "N", conflicts_with_all = ["frames", "shard", "stereo"])]
    pub frame: Option<u32>,
    /// The pictures of these frames, to -o out.####.exr: 1-100, 1-100x2 (every second), 1-3,5,7-10:2. Those that are there, whole and
    /// by the same plan, are skipped
    #[arg(long, value_name = "LIST", conflicts_with = "stereo")]
    pub frames: Option<FrameList>,
    /// Frames a second
    #[arg(long, value_name = "N", default_value_t = 24.0, value_parser = positive)]
    pub fps: f64,
    /// The animation of the scene's file, by name (default: the first; info lists them)
    #[arg(long, value_name = "NAME", value_parser = name_parser())]
    pub animation: Option<String>,
    /// How the lens moves: keys in a file instead of the project's (docs/guide/sequences.md)
    #[arg(long, value_name = "KEYS.json")]
    pub keys: Option<PathBuf>,
    /// This share of the frames or tiles: the K-th of N; env: as the farm says (Slurm's arrays, indexed jobs of Kubernetes, GNU parallel)
    #[arg(long, value_name = "K/N|env", value_parser = shard)]
    pub shard: Option<Shard>,
}

impl SequenceArguments {
    /// Whether the picture is one of a sequence.
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
    /// Where to write the project with its new keys; without it the keys that there are go to stdout as JSON
    #[arg(short, long, value_name = "OUT.fbrush")]
    pub output: Option<PathBuf>,
    /// All keys of the lens from a file, instead of those that there are
    #[arg(long, value_name = "KEYS.json", requires = "output")]
    pub set: Option<PathBuf>,
    /// Focuses the lens on what is seen at a place of the picture (px), from a time (s) on; wherever that moves
    #[arg(long, value_name = "X,Y@SECONDS", value_parser = place_at, requires = "output")]
    pub point: Vec<(glam::DVec2, f64)>,
    /// Focuses the lens at a distance (or inf), from a time (s) on
    #[arg(long, value_name = "DISTANCE@SECONDS", value_parser = number_at, requires = "output")]
    pub distance: Vec<(f64, f64)>,
    /// Sets the f-number at a time (s)
    #[arg(long, value_name = "N@SECONDS", value_parser = number_at, requires = "output")]
    pub f_number: Vec<(f64, f64)>,
    /// Sets the opacity of a layer, by name, at a time (s)
    #[arg(long, value_name = "LAYER=OPACITY@SECONDS", value_parser = layer_at, requires = "output")]
    pub opacity: Vec<(String, f64, f64)>,
    /// How the new keys go over into the next
    #[arg(long, value_name = "hold|linear|smooth", default_value = "smooth", value_parser = ease)]
    pub ease: Ease,
}

fn ease(text: &str) -> Result<Ease, String> {
    Ease::from_name(text).ok_or_else(|| "hold, linear or smooth".into())
}

/// A number that is none is told later, with what it is for.
fn number_at(text: &str) -> Result<(f64, f64), String> {
    let parts =
        text.rsplit_once('@').and_then(|(value, at)| Some((value.trim().parse().ok()?, seconds(at)?)));
    parts.ok_or_else(|| "VALUE@SECONDS".into())
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
