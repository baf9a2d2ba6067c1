//! Actions on presets: apply, name, save, import and export.

use super::Shell;
use crate::window::action::PresetAction;
use crate::window::dialogs::file_dialog::Purpose;
use crate::window::dialogs::preset_name_dialog::PresetNaming;
use document::CameraEdit;
use egui::Context;
use project::{LensPreset, Preset, PresetContent, PresetKind};
use session::Command;
use std::path::{Path, PathBuf};

impl Shell {
    pub(super) fn apply_preset_action(&mut self, action: PresetAction, context: &Context) {
        match action {
            PresetAction::Use(preset) => self.use_preset(&preset),
            PresetAction::Rename(file, name) => {
                self.preset_name_dialog.open(PresetNaming::Rename(file), name)
            }
            PresetAction::Delete(file) => match self.presets.delete(&file) {
                Ok(backup) => self.toasts.notice(format!("The preset was moved to {}", backup.display())),
                Err(error) => self.toasts.error(error.to_string()),
            },
            PresetAction::Export(preset) => {
                let name = PathBuf::from(preset.name.replace(['/', '\\', ':'], "-")).with_extension("json");
                self.exported_preset = Some(*preset);
                self.open_dialog_in_user_folder(Purpose::ExportPreset, &name, context);
            }
        }
    }

    /// Applies a preset as one undo step, like the same change by hand.
    pub(super) fn use_preset(&mut self, preset: &Preset) {
        let Some(document) = self.session.document() else { return };
        let brush = preset.apply_to_brush(&document.brush);
        let camera = preset.apply_to_camera(&document.camera);
        if let Some(brush) = brush {
            self.apply(Command::SetBrush(brush));
        }
        match camera {
            Some(Ok(camera)) => {
                self.apply(Command::FinishEdit);
                let kind = preset.kind();
                self.apply(Command::EditCamera(match kind {
                    PresetKind::Bokeh => CameraEdit::Aperture(camera.aperture),
                    _ => CameraEdit::Whole(Box::new(camera)),
                }));
                self.apply(Command::FinishEdit);
            }
            Some(Err(problem)) => self.toasts.error(problem),
            None => {}
        }
    }

    /// Opens the name dialog for a new preset.
    pub(super) fn save_preset(&mut self, kind: PresetKind) {
        let Some(document) = self.session.document() else { return };
        let content = match kind {
            PresetKind::Brush => PresetContent::Brush(Box::new(document.brush.clone())),
            PresetKind::Lens => PresetContent::Lens(LensPreset::from_camera(&document.camera)),
            PresetKind::Bokeh => PresetContent::Bokeh(document.camera.aperture.clone()),
        };
        self.preset_name_dialog.open(PresetNaming::New(content), String::new());
    }

    pub(super) fn import_preset(&mut self, file: &Path) {
        match self.presets.import(file) {
            Ok(preset) => {
                self.toasts.notice(format!(
                    "{}: imported to the {} presets",
                    preset.name,
                    preset.kind().name()
                ));
            }
            Err(error) => self.toasts.error(error.to_string()),
        }
    }

    pub(super) fn export_preset(&mut self, file: &Path) {
        let Some(preset) = self.exported_preset.take() else { return };
        match preset.write(file) {
            Ok(()) => self.toasts.notice(format!("Wrote {}", file.display())),
            Err(error) => self.toasts.error(error.to_string()),
        }
    }

    /// Shows the name dialog and handles its result.
    pub(super) fn show_preset_name_dialog(&mut self, context: &Context) {
        let Some((naming, name)) = self.preset_name_dialog.show(context, &self.presets) else { return };
        let done = match naming {
            PresetNaming::New(content) => match Preset::new(&name, content) {
                Ok(preset) => self.presets.save(&preset).map(|_| ()).map_err(|error| error.to_string()),
                Err(problem) => Err(problem.to_string()),
            },
            PresetNaming::Rename(file) => {
                self.presets.rename(&file, &name).map_err(|error| error.to_string())
            }
        };
        if let Err(problem) = done {
            self.toasts.error(problem);
        }
    }
}
