//! The inspector: what the document is made of, section by section. Panels read the document and emit actions.

mod brush_panel;
mod focus_panel;
mod lens_panel;
mod modelled_panel;
mod scene_panel;
mod shape_panel;

use super::{Action, ViewSettings};
use egui::{CollapsingHeader, ScrollArea, Ui};
use session::{Document, Session, SurfaceHit};

/// What the inspector keeps between frames.
#[derive(Default)]
pub struct Inspector {
    scene: scene_panel::ScenePanel,
}

impl Inspector {
    /// Draws all sections.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        session: &Session,
        settings: &mut ViewSettings,
        hover: Option<SurfaceHit>,
        actions: &mut Vec<Action>,
    ) {
        ScrollArea::vertical().auto_shrink([false; 2]).show(ui, |ui| {
            let Some(document) = session.document() else {
                ui.add_space(8.0);
                ui.weak("Nothing is open.");
                return;
            };
            section(ui, "Lens", true, |ui| lens_panel::lens_panel(ui, document, actions));
            section(ui, "Focus", true, |ui| focus_panel::focus_panel(ui, document, actions));
            section(ui, "Brush", true, |ui| brush_panel::brush_panel(ui, document, hover, actions));
            section(ui, "Picture", true, |ui| lens_panel::picture_panel(ui, document, settings, actions));
            section(ui, "Scene", false, |ui| self.scene.ui(ui, document, actions));
            section(ui, "Modelled", true, |ui| modelled_panel::modelled_panel(ui, session, document));
            section(ui, "History", false, |ui| history(ui, document));
        });
    }
}

fn section(ui: &mut Ui, title: &str, open: bool, add: impl FnOnce(&mut Ui)) {
    CollapsingHeader::new(egui::RichText::new(title).strong()).default_open(open).show_unindented(ui, |ui| {
        add(ui);
        ui.add_space(6.0);
    });
}

/// What undo would take back, and what redo would do again.
fn history(ui: &mut Ui, document: &Document) {
    let line = |name: Option<&str>| name.unwrap_or("nothing").to_string();
    ui.label(format!("Undo takes back: {}", line(document.undo_name())));
    ui.label(format!("Redo does again: {}", line(document.redo_name())));
}
