//! The result of a run.

use crate::measurement::machine::Machine;
use crate::measurement::record::Record;
use crate::summary::SceneSummary;
use std::path::PathBuf;

/// A measurement with its pictures.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The record.
    pub record: Record,
    /// The picture and its FLIP error map; only in the knob series.
    pub pictures: Option<[PathBuf; 2]>,
}

/// The contents of a report.
pub struct Report {
    /// The machine.
    pub machine: Machine,
    /// The scenes.
    pub scenes: Vec<SceneSummary>,
    /// The measurements, in the order of the plan.
    pub measured: Vec<Measured>,
    /// The hard cases, if requested.
    pub hard: Option<Vec<hard_cases::Outcome>>,
    /// Number of measurements made in this run.
    pub new: usize,
    /// The written files.
    pub files: Vec<PathBuf>,
    /// Seconds of this run.
    pub seconds: f64,
}
