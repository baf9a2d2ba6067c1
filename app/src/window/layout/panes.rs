//! Appearance and behaviour of the tiles.

use super::pane::Pane;
use egui::accesskit::Role;
use egui::{Ui, WidgetText};
use egui_tiles::{Behavior, Container, SimplificationOptions, TileId, Tiles, UiResponse};
use std::collections::HashSet;

/// How a panel is docked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DockState {
    /// Beside others: its header shows its title and can be dragged.
    Tiled,
    /// In a tab, which does this instead of the header.
    Tab,
    /// Floating over the others, in a window with its title.
    Floating,
    /// Small, over a corner of the picture.
    Navigator,
    /// Enlarged over all others.
    Enlarged,
}

/// The contents of the panels.
pub trait PaneContents {
    /// Draws a panel. Returns whether it is being dragged by its header.
    fn pane_ui(&mut self, ui: &mut Ui, pane: Pane, docked: DockState) -> bool;

    /// Draws the controls at the right end of the tab bar whose active tab is `pane`.
    fn tabs_ui(&mut self, ui: &mut Ui, pane: Pane);
}

/// Sets the accessible name of a panel.
pub fn set_accessible_name(ui: &Ui, pane: Pane) {
    ui.ctx().accesskit_node_builder(ui.unique_id(), |node| {
        node.set_role(Role::Pane);
        node.set_label(format!("{} panel", pane.title()));
    });
}

/// egui_tiles' view of the panels.
pub struct TileBehavior<'a> {
    pub panes: &'a mut dyn PaneContents,
    pub tabbed: HashSet<Pane>,
}

impl Behavior<Pane> for TileBehavior<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        set_accessible_name(ui, *pane);
        let docked = if self.tabbed.contains(pane) { DockState::Tab } else { DockState::Tiled };
        if self.panes.pane_ui(ui, *pane, docked) { UiResponse::DragStarted } else { UiResponse::None }
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
        pane.title().into()
    }

    /// A tile with several panels shows all of their titles.
    fn tab_title_for_tile(&mut self, tiles: &Tiles<Pane>, tile: TileId) -> WidgetText {
        fn names(tiles: &Tiles<Pane>, tile: TileId) -> Vec<&'static str> {
            match (tiles.get_pane(&tile), tiles.get_container(tile)) {
                (Some(pane), _) => vec![pane.title()],
                (_, Some(container)) => container.children().flat_map(|id| names(tiles, *id)).collect(),
                _ => Vec::new(),
            }
        }
        names(tiles, tile).join(", ").into()
    }

    fn top_bar_right_ui(
        &mut self,
        tiles: &Tiles<Pane>,
        ui: &mut Ui,
        _tile: TileId,
        tabs: &egui_tiles::Tabs,
        _scroll_offset: &mut f32,
    ) {
        if let Some(pane) = tabs.active.and_then(|active| tiles.get_pane(&active)) {
            ui.add_space(4.0);
            self.panes.tabs_ui(ui, *pane);
        }
    }

    fn tab_bar_color(&self, visuals: &egui::Visuals) -> egui::Color32 {
        visuals.panel_fill
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        4.0
    }

    fn min_size(&self) -> f32 {
        120.0
    }

    fn is_tile_draggable(&self, tiles: &Tiles<Pane>, tile: TileId) -> bool {
        !matches!(tiles.get_container(tile), Some(Container::Grid(_)))
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { all_panes_must_have_tabs: false, ..Default::default() }
    }
}
