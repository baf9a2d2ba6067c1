//! What can be typed about frames.

use super::arguments::{name_parser, positive};
use clap::Args;
use session::{FrameList, Shard};
use std::path::PathBuf;

/// Which frames of a sequence, and how they follow each other.
#[derive(Debug, Args)]
pub struct SequenceArguments {
    /// The picture of one frame: with what moves where it is then. Frame 1 is at 0 s
    #[arg(long, value_name = "N", conflicts_with_all = ["frames", "shard"])]
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
    /// How the lens moves: keys in a file instead of the project's (docs/sequences.md)
    #[arg(long, value_name = "KEYS.json")]
    pub keys: Option<PathBuf>,
    /// This share of the frames: the K-th of N; env: as the farm says (Slurm's arrays, indexed jobs of Kubernetes, GNU parallel)
    #[arg(long, value_name = "K/N|env", value_parser = shard, requires = "frames")]
    pub shard: Option<Shard>,
}

impl SequenceArguments {
    /// Whether the picture is one of a sequence.
    pub fn is_asked_for(&self) -> bool {
        self.frame.is_some() || self.frames.is_some()
    }
}

fn shard(text: &str) -> Result<Shard, String> {
    match text {
        "env" => Shard::of_environment(&|name| std::env::var(name).ok()),
        _ => text.parse(),
    }
}
