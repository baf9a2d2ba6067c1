//! What a run comes to.

use crate::machine::Machine;
use crate::record::Record;
use crate::summary::SceneSummary;
use std::path::PathBuf;

/// A measurement, and the pictures of it.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The figures.
    pub record: Record,
    /// The picture and its FLIP error map; only where the knob was turned.
    pub pictures: Option<[PathBuf; 2]>,
}

/// Everything that a report tells.
pub struct Report {
    /// The machine.
    pub machine: Machine,
    /// The scenes.
    pub scenes: Vec<SceneSummary>,
    /// The measurements, in the order of the plan.
    pub measured: Vec<Measured>,
    /// The hard cases, if they were asked for.
    pub hard: Option<Vec<hard_cases::Outcome>>,
    /// How many of the measurements were made in this run.
    pub new: usize,
    /// Files that were written for people and programs.
    pub files: Vec<PathBuf>,
    /// Seconds of this run.
    pub seconds: f64,
}
