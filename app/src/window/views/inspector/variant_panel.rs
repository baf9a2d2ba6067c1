//! The material variant of the scene, if its file has several (KHR_materials_variants).

use crate::window::Action;
use crate::window::widgets::controls::{row, rows};
use document::Document;
use egui::{ComboBox, Ui};
use session::Command;

/// Name of the scene's default materials in the list.
const OWN: &str = "The scene's own";

/// Draws the menu of variants.
pub fn variant_panel(ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
    let scene = document.scene();
    let mut chosen = None;
    rows(ui, "variant", |ui| {
        let tip = "Material variant of the scene. Paint is kept; the light is computed again.";
        row(ui, "Variant", tip, |ui| {
            ComboBox::from_id_salt("variant")
                .selected_text(scene.variant.as_deref().unwrap_or(OWN))
                .truncate()
                .show_ui(ui, |ui| {
                    let own = ui.selectable_label(scene.variant.is_none(), OWN);
                    if own.on_hover_text("The default materials of the file.").clicked() {
                        chosen = Some(None);
                    }
                    for name in &scene.variants {
                        let is_chosen = scene.variant.as_ref() == Some(name);
                        let label = ui.selectable_label(is_chosen, name);
                        if label
                            .on_hover_text(format!("Show the scene in its variant \u{201c}{name}\u{201d}."))
                            .clicked()
                        {
                            chosen = Some(Some(name.clone()));
                        }
                    }
                })
                .response
        });
    });
    if let Some(variant) = chosen {
        actions.push(Command::SetVariant(variant).into());
    }
}
