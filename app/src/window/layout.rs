//! The two views side by side; the user may drag them apart, on top of each other or into tabs.

use egui::{Ui, WidgetText};
use egui_tiles::{Behavior, Linear, LinearDir, SimplificationOptions, TileId, Tiles, Tree, UiResponse};
use serde::{Deserialize, Serialize};

/// What a tile holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Pane {
    /// The scene in 3D.
    Paint,
    /// The refocused picture.
    Picture,
}

/// The tiles as they are at first.
pub fn initial() -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let paint = tiles.insert_pane(Pane::Paint);
    let picture = tiles.insert_pane(Pane::Picture);
    let row = Linear::new_binary(LinearDir::Horizontal, [paint, picture], 0.46);
    let root = tiles.insert_container(row);
    Tree::new(egui::Id::unique("views"), root, tiles)
}

/// Whether both views are still there (a stored layout may be of another version).
pub fn is_whole(tree: &Tree<Pane>) -> bool {
    [Pane::Paint, Pane::Picture].iter().all(|pane| {
        let tile = tree.tiles.find_pane(pane);
        tile.is_some_and(|tile| tree.is_visible(tile))
    })
}

/// Draws the panes; `pane_ui` returns whether the pane is being dragged by its header.
pub struct Panes<F> {
    /// Draws one pane.
    pub pane_ui: F,
}

impl<F: FnMut(&mut Ui, Pane) -> bool> Behavior<Pane> for Panes<F> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        if (self.pane_ui)(ui, *pane) { UiResponse::DragStarted } else { UiResponse::None }
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
        match pane {
            Pane::Paint => "Paint".into(),
            Pane::Picture => "Picture".into(),
        }
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        4.0
    }

    fn min_size(&self) -> f32 {
        160.0
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { all_panes_must_have_tabs: false, ..Default::default() }
    }
}
