//! Modal dialogs.

pub mod depth_polarity_dialog;
pub mod export_dialog;
pub mod file_dialog;
pub mod preset_name_dialog;
pub mod unsaved_changes_dialog;
