//! What was measured of the engine: so far, and in the end.

use crate::engine::EngineRecord;
use crate::engine::frame_copy::FrameCopy;
use crate::machine::Machine;
use splat::Gpu;
use std::path::PathBuf;

/// What has been found so far.
pub struct EngineMeasurements {
    /// What times are told in.
    pub frame: FrameCopy,
    /// The measurements.
    pub records: Vec<EngineRecord>,
    /// What must hold.
    pub checks: Vec<Check>,
    /// What pictures are summed on; none: the processor.
    pub gpu: Option<Gpu>,
}

/// What was measured of the engine.
#[derive(Clone, Debug)]
pub struct EngineReport {
    /// The measurements.
    pub records: Vec<EngineRecord>,
    /// What must hold whatever the speed, and whether it does.
    pub checks: Vec<Check>,
    /// Where it ran.
    pub machine: Machine,
    /// Files that were written.
    pub files: Vec<PathBuf>,
}

/// Something that must hold.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Check {
    /// The scene.
    pub scene: String,
    /// What must hold.
    pub what: String,
    /// Whether it does.
    pub holds: bool,
}
