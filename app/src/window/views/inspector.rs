//! The inspector: the settings of the document, section by section. Panels read the document and emit actions.

mod brush_panel;
mod cameras_panel;
mod character_panel;
mod curve_editor;
mod falloff_editor;
mod focus_panel;
mod history_panel;
mod layers_panel;
mod lens_panel;
mod memory_panel;
mod modelled_panel;
mod plane_editor;
mod presets;
mod scene_panel;
mod shape_panel;
mod spread_rows;
mod tool_panel;
mod variant_panel;
mod world_panel;

pub use layers_panel::is_layer_command_possible;
pub use tool_panel::selection_summary;

use crate::window::{Action, Tool, ViewSettings};
use document::SurfaceHit;
use egui::{CollapsingHeader, ScrollArea, Ui};
use project::PresetLibrary;
use session::Session;
use std::collections::BTreeMap;

/// State of the inspector between frames.
#[derive(Default)]
pub struct Inspector {
    scene: scene_panel::ScenePanel,
    splats: scene_panel::SplatsRows,
    cameras: cameras_panel::CamerasPanel,
    layers: layers_panel::LayersPanel,
}

/// Inputs of the inspector.
pub struct Inspected<'a> {
    /// The session.
    pub session: &'a Session,
    /// All presets.
    pub presets: &'a PresetLibrary,
    /// The active tool.
    pub tool: Tool,
    /// The surface point under the pointer.
    pub hover: Option<SurfaceHit>,
}

impl Inspector {
    /// Draws all sections.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        inspected: Inspected<'_>,
        settings: &mut ViewSettings,
        actions: &mut Vec<Action>,
    ) {
        let Inspected { session, presets, tool, hover } = inspected;
        // Narrow enough for label, slider and number at the inspector's minimum width.
        ui.spacing_mut().slider_width = 110.0;
        let mut toggled = std::mem::take(&mut settings.toggled_sections);
        ScrollArea::vertical().auto_shrink([false; 2]).show(ui, |ui| {
            let Some(document) = session.document() else {
                ui.add_space(8.0);
                ui.weak("Nothing is open.");
                return;
            };
            let toggled = &mut toggled;
            if tool_panel::has_settings(tool) {
                section(ui, toggled, (tool.label(), true), |ui| {
                    tool_panel::tool_panel(ui, document, tool, &mut settings.tools, actions);
                });
            }
            section(ui, toggled, ("Lens", true), |ui| lens_panel::lens_panel(ui, document, presets, actions));
            section(ui, toggled, ("Lens character", false), |ui| {
                character_panel::character_panel(ui, &document.camera, actions);
            });
            section(ui, toggled, ("Cameras", false), |ui| self.cameras.ui(ui, document, actions));
            section(ui, toggled, ("Focus", true), |ui| focus_panel::focus_panel(ui, document, actions));
            section(ui, toggled, ("Layers", true), |ui| {
                self.layers.ui(ui, document, &mut settings.tools.spread, actions);
            });
            section(ui, toggled, ("Brush", true), |ui| {
                brush_panel::brush_panel(ui, document, settings, presets, hover, actions);
            });
            section(ui, toggled, ("Picture", true), |ui| {
                lens_panel::picture_panel(ui, session, document, settings, actions);
            });
            if !document.scene().variants.is_empty() {
                section(ui, toggled, ("Material variants", true), |ui| {
                    variant_panel::variant_panel(ui, document, actions);
                });
            }
            if document.scene().splats.is_some() {
                section(ui, toggled, ("Splats", true), |ui| self.splats.ui(ui, document, actions));
            }
            section(ui, toggled, ("World", true), |ui| world_panel::world_panel(ui, document, actions));
            section(ui, toggled, ("Scene", false), |ui| self.scene.ui(ui, document, actions));
            section(ui, toggled, ("Statistics", false), |ui| {
                modelled_panel::modelled_panel(ui, session, document)
            });
            section(ui, toggled, ("Memory", false), |ui| memory_panel::memory_panel(ui, session));
            section(ui, toggled, ("History", false), |ui| {
                history_panel::history_panel(ui, document, actions)
            });
        });
        settings.toggled_sections = toggled;
    }
}

/// Sections that the user opened or closed: their title, and whether it is open.
type ToggledSections = BTreeMap<String, bool>;

/// A section that is open or closed as the user left it, at first as `open` says.
fn section(
    ui: &mut Ui,
    toggled: &mut ToggledSections,
    (title, open): (&str, bool),
    add: impl FnOnce(&mut Ui),
) {
    let is_open = toggled.get(title).copied().unwrap_or(open);
    let header = CollapsingHeader::new(egui::RichText::new(title).strong()).default_open(is_open);
    let shown = header.show_unindented(ui, |ui| {
        add(ui);
        ui.add_space(6.0);
    });
    if shown.header_response.clicked() {
        toggled.insert(title.into(), !is_open);
    }
}
