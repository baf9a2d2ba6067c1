//! Speed against error: every renderer measured against the ground truth.
//!
//! [`run`] takes scenes and a folder and leaves there a page that can be published, and all its figures:
//!
//! ```text
//! report.html   one page, nothing loaded from elsewhere: plots, pictures, error maps, tables
//! report.md     the tables
//! report.json   a record a measurement; report.csv the same
//! about.json    machine, version, scenes, what was modelled
//! hard.json     the hard cases, if they were asked for
//! ```
//!
//! [`run_engine`] measures the splat engine alone, against its own converged picture.
//!
//! The road of the data: `subject` opens a scene with its camera and focuses, `plan` lists what to measure, `reference`
//! makes the ground truth of each picture with its own error, `contender` draws and is timed, `live` watches the preview, `photographs` leaves some of a capture out, `views` asks those of a light field, `store` keeps every finished
//! measurement at once (so that a run that was stopped goes on where it was), `findings` draws conclusions, `page` and
//! `tables` write them down with `plot`.

mod band;
mod contender;
mod default_lens;
mod engine;
mod fields;
mod findings;
mod fingerprint;
mod generic_focus;
mod live;
mod machine;
mod markup;
mod measure;
mod memory;
mod options;
mod page;
mod photographs;
mod plan;
mod plot;
mod record;
mod reference;
mod refined;
mod report;
mod run;
mod stopwatch;
mod store;
mod subdivision;
mod subject;
mod summary;
mod table;
mod tables;
mod views;
mod write;

pub use contender::Contender;
pub use engine::{Check, EngineRecord, EngineReport, run_engine};
pub use live::ShownPicture;
pub use machine::Machine;
pub use options::{ReportOptions, SceneRequest};
pub use photographs::{Photographs, ReconstructedPhotograph, SparseLightField};
pub use record::{Record, Series};
pub use report::Report;
pub use run::run;
pub use summary::{FocusSummary, SceneSummary};
pub use views::{Disparity, Views};
