//! Speed against error: every renderer measured against the ground truth.
//!
//! [`run`] measures scenes and writes a self-contained page and all its figures into a folder:
//!
//! ```text
//! report.html   one page, nothing loaded from elsewhere: plots, pictures, error maps, tables
//! report.md     the tables
//! report.json   one record per measurement; report.csv the same
//! about.json    machine, version, scenes, what was modelled
//! hard.json     the hard cases, if requested
//! ```
//!
//! [`run_engine`] measures the splat engine alone, against its own converged picture.
//!
//! Data flow: `subject` opens a scene with its camera and focuses; `plan` lists the settings to measure;
//! `measurement` traces references, and draws, times and compares the contenders; `studies` measures the live
//! preview, left-out photographs, views of light fields and light refinement; `store` saves every finished
//! measurement immediately, so that an interrupted run resumes; `findings` draws conclusions; `output` writes
//! page, tables and plots.
//!
//! ```
//! use report::ReportOptions;
//!
//! let folder = tempfile::tempdir()?;
//! let options = ReportOptions {
//!     size: None,
//!     reference_spp: ReportOptions::QUICK_REFERENCE_SPP,
//!     is_quick: true,
//!     with_hard_cases: false,
//!     build: "example".into(),
//!     unwrap: atlas::UnwrapOptions::default(),
//!     resources: light::Resources::default(),
//! };
//! let report = report::run(&[], &options, folder.path(), &progress::Unwatched, &|line| println!("{line}"))?;
//! assert!(report.files.iter().any(|file| file.ends_with("report.html")));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod engine;
mod findings;
mod fingerprint;
mod measurement;
mod number_text;
mod options;
mod output;
mod plan;
mod report;
mod run;
mod store;
mod studies;
mod subject;
mod summary;

pub use engine::{Check, EngineRecord, EngineReport, run_engine};
pub use measurement::contender::Contender;
pub use measurement::machine::Machine;
pub use measurement::memory::resident_bytes;
pub use measurement::record::{Record, Series};
pub use options::{ReportOptions, SceneRequest, build_checksum};
pub use report::Report;
pub use run::run;
pub use studies::left_out_photographs::{Photographs, ReconstructedPhotograph, SparseLightField};
pub use studies::light_field_views::{Disparity, Views};
pub use studies::live_preview::ShownPicture;
pub use summary::{FocusSummary, SceneSummary};
