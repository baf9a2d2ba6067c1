//! Measurements of the engine: in progress, and the final report.

use super::EngineRecord;
use super::frame_copy::FrameCopy;
use crate::measurement::machine::Machine;
use graphics_card::Gpu;
use std::path::PathBuf;

/// Measurements so far.
pub struct EngineMeasurements {
    /// The unit of time.
    pub frame: FrameCopy,
    /// The measurements.
    pub records: Vec<EngineRecord>,
    /// Invariants that were checked.
    pub checks: Vec<Check>,
    /// Device that sums the pictures; `None`: the processor.
    pub gpu: Option<Gpu>,
}

/// The report on the engine.
#[derive(Clone, Debug)]
pub struct EngineReport {
    /// The measurements.
    pub records: Vec<EngineRecord>,
    /// Invariants that must hold, with their outcomes.
    pub checks: Vec<Check>,
    /// The machine it ran on.
    pub machine: Machine,
    /// The written files.
    pub files: Vec<PathBuf>,
}

/// A checked invariant.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Check {
    /// The scene.
    pub scene: String,
    /// Invariants that were checked.
    pub what: String,
    /// Whether it holds.
    pub holds: bool,
}
