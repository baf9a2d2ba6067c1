//! The files of a report: page, plots, tables and JSON.

pub mod fields;
pub mod markup;
pub mod page;
pub mod plot;
pub mod table;
pub mod tables;
pub mod write;
