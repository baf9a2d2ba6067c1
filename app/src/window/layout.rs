//! The layout of the panels: docked side by side or in tabs, floating over the others, or one enlarged over
//! all. The paint view lies beside the picture, below it, or small over its corner.
//!
//! Docked panels form a tree of tiles. A floating panel keeps its hidden tile, to which it returns when docked.
//! A closed panel has a hidden tile, too.

mod arrangement;
mod pane;
mod panes;
mod sizes;

pub use arrangement::Arrangement;
pub use pane::Pane;
pub use panes::{DockState, PaneContents};

use egui::{Rect, Ui, Vec2, pos2, vec2};
use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};
use sizes::NOMINAL_SIZE;
use std::collections::HashSet;

/// Initial width of the inspector, points.
const INSPECTOR_WIDTH: f32 = 300.0;

/// Initial height of the tabs beneath the views, points.
const DRAWER_HEIGHT: f32 = 210.0;

/// Initial share of the views' width that the paint view takes.
const PAINT_SHARE: f32 = 0.46;

/// A floating panel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Floating {
    pane: Pane,
    /// Left, top, width and height of its contents, points.
    place: [f32; 4],
}

/// The paint view over a corner of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Navigator {
    /// Distance from the left and the lower edge of the picture's panel, width and height, points; `None` until it was
    /// shown.
    place: Option<[f32; 4]>,
}

/// The layout of the panels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Layout {
    tree: Tree<Pane>,
    floating: Vec<Floating>,
    #[serde(default)]
    navigator: Option<Navigator>,
    /// The panel that is enlarged over all others.
    #[serde(skip)]
    enlarged: Option<Pane>,
    /// Width and height of the last layout of the tiles, points.
    size: [f32; 2],
}

impl Default for Layout {
    fn default() -> Self {
        let mut tiles = Tiles::default();
        let mut pane = |pane| tiles.insert_pane(pane);
        let [paint, picture, inspector, atlas, aperture, histogram, photographs, timeline] =
            Pane::ALL.map(&mut pane);
        let views = Linear::new_binary(LinearDir::Horizontal, [paint, picture], PAINT_SHARE);
        let views = tiles.insert_container(views);
        let drawer = tiles.insert_tab_tile(vec![atlas, aperture, histogram, photographs, timeline]);
        tiles.set_visible(drawer, false);
        let drawer_share = DRAWER_HEIGHT / NOMINAL_SIZE[1];
        let left = Linear::new_binary(LinearDir::Vertical, [views, drawer], 1.0 - drawer_share);
        let left = tiles.insert_container(left);
        let inspector_share = INSPECTOR_WIDTH / NOMINAL_SIZE[0];
        let root = Linear::new_binary(LinearDir::Horizontal, [left, inspector], 1.0 - inspector_share);
        let root = tiles.insert_container(root);
        let tree = Tree::new(egui::Id::unique("panels"), root, tiles);
        let mut layout =
            Self { tree, floating: Vec::new(), navigator: None, enlarged: None, size: NOMINAL_SIZE };
        layout.arrange(Arrangement::Navigator);
        layout
    }
}

impl Layout {
    /// A layout from its stored JSON; `None` unless it contains every panel once and one of the views is
    /// visible.
    pub fn from_stored(text: &str) -> Option<Self> {
        let layout: Self = serde_json::from_str(text).ok()?;
        let panes = layout.tree.tiles.tiles().filter_map(|tile| match tile {
            Tile::Pane(pane) => Some(*pane),
            Tile::Container(_) => None,
        });
        let panes: Vec<Pane> = panes.collect();
        let is_whole = panes.len() == Pane::ALL.len() && Pane::ALL.iter().all(|pane| panes.contains(pane));
        let navigator_place = layout.navigator.and_then(|navigator| navigator.place).unwrap_or_default();
        let places = layout.floating.iter().map(|floating| floating.place).chain([navigator_place]);
        let has_place = places.flatten().all(f32::is_finite);
        let has_size = layout.size.iter().all(|side| side.is_finite() && *side > 0.0);
        let has_view = [Pane::Paint, Pane::Picture].iter().any(|view| layout.is_open(*view));
        (is_whole && has_place && has_size && has_view).then_some(layout)
    }

    fn tile_with(&self, pane: Pane) -> Option<TileId> {
        self.tree.tiles.find_pane(&pane)
    }

    /// The containers of a tile, from the innermost outward.
    fn containers_of(&self, tile: TileId) -> Vec<TileId> {
        std::iter::successors(self.tree.tiles.parent_of(tile), |id| self.tree.tiles.parent_of(*id)).collect()
    }

    /// Whether a panel is docked or floating, even if behind another tab.
    pub fn is_open(&self, pane: Pane) -> bool {
        let is_visible = |tile: TileId| {
            self.containers_of(tile).into_iter().chain([tile]).all(|tile| self.tree.is_visible(tile))
        };
        self.is_over_others(pane) || self.tile_with(pane).is_some_and(is_visible)
    }

    /// Whether a panel floats or is the navigator.
    fn is_over_others(&self, pane: Pane) -> bool {
        self.is_floating(pane) || (pane == Pane::Paint && self.navigator.is_some())
    }

    /// How the views lie.
    pub fn arrangement(&self) -> Arrangement {
        let direction = || {
            let views = self.tree.tiles.parent_of(self.tile_with(Pane::Picture)?)?;
            match self.tree.tiles.get_container(views)? {
                Container::Linear(linear) => Some(linear.dir),
                _ => None,
            }
        };
        match (self.navigator, direction()) {
            (Some(_), _) => Arrangement::Navigator,
            (None, Some(LinearDir::Vertical)) => Arrangement::Stacked,
            (None, _) => Arrangement::SideBySide,
        }
    }

    /// Lets the views lie otherwise. Views that were moved elsewhere, such as into tabs, stay docked where they are.
    pub fn arrange(&mut self, arrangement: Arrangement) {
        self.enlarged = None;
        self.floating.retain(|floating| floating.pane != Pane::Paint);
        self.open(Pane::Picture);
        let Some(paint) = self.tile_with(Pane::Paint) else { return };
        if arrangement == Arrangement::Navigator {
            self.tree.set_visible(paint, false);
            self.navigator.get_or_insert_default();
            return;
        }
        self.navigator = None;
        self.open(Pane::Paint);
        let Some(views) = self.tree.tiles.parent_of(paint) else { return };
        if let Some(Tile::Container(Container::Linear(linear))) = self.tree.tiles.get_mut(views) {
            linear.dir = match arrangement {
                Arrangement::Stacked => LinearDir::Vertical,
                _ => LinearDir::Horizontal,
            };
        }
    }

    /// Whether a panel is visible.
    pub fn is_shown(&self, pane: Pane) -> bool {
        if let Some(enlarged) = self.enlarged {
            return enlarged == pane;
        }
        let Some(tile) = self.tile_with(pane) else { return false };
        let mut child = tile;
        let is_behind = self.containers_of(tile).into_iter().any(|id| {
            let container = self.tree.tiles.get_container(id);
            let is_behind = matches!(container, Some(Container::Tabs(tabs)) if !tabs.is_active(child));
            child = id;
            is_behind
        });
        self.is_over_others(pane) || (self.is_open(pane) && !is_behind)
    }

    /// Whether a panel floats.
    pub fn is_floating(&self, pane: Pane) -> bool {
        self.floating.iter().any(|floating| floating.pane == pane)
    }

    /// The panel that is enlarged over all others.
    pub fn enlarged(&self) -> Option<Pane> {
        self.enlarged
    }

    /// Opens a panel, in front of the other tabs.
    pub fn open(&mut self, pane: Pane) {
        self.enlarged = self.enlarged.filter(|enlarged| *enlarged == pane);
        if self.is_over_others(pane) {
            return;
        }
        let Some(tile) = self.tile_with(pane) else { return };
        self.tree.set_visible(tile, true);
        let mut child = tile;
        for id in self.containers_of(tile) {
            self.tree.set_visible(id, true);
            if let Some(Tile::Container(Container::Tabs(tabs))) = self.tree.tiles.get_mut(id) {
                tabs.set_active(child);
            }
            child = id;
        }
    }

    /// Closes a panel, together with the other tabs if all of them can be closed.
    pub fn close(&mut self, pane: Pane) {
        if !pane.is_foldable() {
            return;
        }
        self.enlarged = self.enlarged.filter(|enlarged| *enlarged != pane);
        if self.is_floating(pane) {
            self.floating.retain(|floating| floating.pane != pane);
            return;
        }
        let Some(tile) = self.tile_with(pane) else { return };
        let tabs = self.tree.tiles.parent_of(tile).filter(|parent| {
            let container = self.tree.tiles.get_container(*parent);
            container.is_some_and(|container| {
                let foldable = |id: &TileId| self.tree.tiles.get_pane(id).is_some_and(|p| p.is_foldable());
                matches!(container, Container::Tabs(_)) && container.children().all(foldable)
            })
        });
        self.tree.set_visible(tabs.unwrap_or(tile), false);
    }

    /// Opens a panel in front, or closes it if it is visible.
    pub fn toggle(&mut self, pane: Pane) {
        if self.is_shown(pane) { self.close(pane) } else { self.open(pane) }
    }

    /// Enlarges a panel over all others, or restores the layout.
    pub fn toggle_enlarged(&mut self, pane: Pane) {
        if self.enlarged.take().is_none() {
            self.open(pane);
            self.enlarged = Some(pane);
        }
    }

    /// Makes a panel float over its current place, or docks it again.
    pub fn toggle_floating(&mut self, pane: Pane) {
        self.enlarged = None;
        if self.is_over_others(pane) {
            self.floating.retain(|floating| floating.pane != pane);
            self.navigator = self.navigator.filter(|_| pane != Pane::Paint);
            self.open(pane);
            return;
        }
        let Some(tile) = self.tile_with(pane) else { return };
        let rect = self.tree.tiles.rect(tile).filter(|_| self.is_shown(pane));
        let rect = rect.unwrap_or(Rect::from_min_size(pos2(120.0, 120.0), vec2(420.0, 320.0)));
        self.tree.set_visible(tile, false);
        let place = [rect.left(), rect.top(), rect.width(), rect.height()];
        self.floating.push(Floating { pane, place });
    }

    /// The panels that are in tabs.
    fn tabbed_panes(&self) -> HashSet<Pane> {
        let tiles = &self.tree.tiles;
        let tabs = tiles.tiles().filter_map(|tile| match tile {
            Tile::Container(Container::Tabs(tabs)) => Some(tabs),
            _ => None,
        });
        tabs.flat_map(|tabs| &tabs.children).filter_map(|child| tiles.get_pane(child).copied()).collect()
    }

    /// Draws all panels into the remaining space of `ui`.
    pub fn ui(&mut self, ui: &mut Ui, panes: &mut dyn PaneContents) {
        if let Some(pane) = self.enlarged {
            panes::set_accessible_name(ui, pane);
            panes.pane_ui(ui, pane, DockState::Enlarged);
            return;
        }
        let size: Vec2 = ui.available_size();
        sizes::fit_to_size(&mut self.tree, &mut self.size, size.into());
        let tabbed = self.tabbed_panes();
        self.tree.ui(&mut panes::TileBehavior { panes, tabbed }, ui);
        self.navigator_ui(ui, panes);
        self.floating_ui(ui, panes);
    }

    fn navigator_ui(&mut self, ui: &Ui, panes: &mut dyn PaneContents) {
        let room = self.tile_with(Pane::Picture).and_then(|tile| self.tree.tiles.rect(tile));
        // In a small panel it would cover the picture.
        let room = room.filter(|room| room.size().min_elem() >= arrangement::LEAST_ROOM);
        let (Some(navigator), Some(room)) = (&mut self.navigator, room) else { return };
        let [left, bottom, width, height] =
            navigator.place.unwrap_or_else(|| arrangement::navigator_place(room.size()));
        let window = egui::Window::new(Pane::Paint.title())
            .id(egui::Id::unique("navigator"))
            .title_bar(false)
            .frame(egui::Frame::window(ui.style()).inner_margin(0.0).shadow(egui::Shadow::NONE))
            .constrain_to(room)
            .default_pos(room.left_bottom() + vec2(left, -bottom - height))
            .default_size([width, height])
            .min_size(arrangement::LEAST_NAVIGATOR)
            .max_size(room.size() * arrangement::LARGEST_SHARE);
        let shown = window.show(ui.ctx(), |ui| {
            panes::set_accessible_name(ui, Pane::Paint);
            panes.pane_ui(ui, Pane::Paint, DockState::Navigator);
            ui.min_rect().size()
        });
        if let Some(shown) = shown {
            let from_corner = shown.response.rect.left_bottom() - room.left_bottom();
            let size = shown.inner.unwrap_or(vec2(width, height));
            navigator.place = Some([from_corner.x, -from_corner.y, size.x, size.y]);
        }
    }

    fn floating_ui(&mut self, ui: &Ui, panes: &mut dyn PaneContents) {
        let mut closed = None;
        for floating in &mut self.floating {
            let (pane, [left, top, width, height]) = (floating.pane, floating.place);
            let mut is_open = true;
            let title = egui::RichText::new(pane.title()).text_style(egui::TextStyle::Body).strong();
            let window = egui::Window::new(title)
                .id(egui::Id::unique(("floating", pane.title())))
                .open(&mut is_open)
                .collapsible(false)
                .frame(egui::Frame::window(ui.style()).inner_margin(0.0))
                .default_pos([left, top])
                .default_size([width, height])
                .min_size([180.0, 120.0]);
            let shown = window.show(ui.ctx(), |ui| {
                panes::set_accessible_name(ui, pane);
                panes.pane_ui(ui, pane, DockState::Floating);
                ui.min_rect().size()
            });
            if let Some(shown) = shown {
                let at = shown.response.rect.min;
                let size = shown.inner.unwrap_or(vec2(width, height));
                floating.place = [at.x, at.y, size.x, size.y];
            }
            closed = closed.or((!is_open).then_some(pane));
        }
        if let Some(pane) = closed {
            self.toggle_floating(pane);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(layout: &Layout) -> Vec<Pane> {
        Pane::ALL.into_iter().filter(|pane| layout.is_shown(*pane)).collect()
    }

    #[test]
    fn the_paint_view_lies_over_beside_or_below_the_picture() {
        let mut layout = Layout::default();
        assert_eq!(layout.arrangement(), Arrangement::Navigator);
        let views = [Pane::Paint, Pane::Picture, Pane::Inspector];
        for arrangement in [Arrangement::Stacked, Arrangement::SideBySide, Arrangement::Navigator] {
            layout.arrange(arrangement);
            assert_eq!(layout.arrangement(), arrangement);
            assert_eq!(shown(&layout), views, "{arrangement:?}");
            let stored = serde_json::to_string(&layout).unwrap();
            assert_eq!(Layout::from_stored(&stored).unwrap().arrangement(), arrangement);
        }
        layout.toggle_floating(Pane::Paint);
        assert_eq!(layout.arrangement(), Arrangement::SideBySide, "docked again");
        layout.toggle_floating(Pane::Paint);
        layout.arrange(Arrangement::Navigator);
        assert!(!layout.is_floating(Pane::Paint) && layout.is_shown(Pane::Paint));
        layout.toggle_enlarged(Pane::Paint);
        assert_eq!(shown(&layout), [Pane::Paint]);
        layout.toggle_enlarged(Pane::Paint);
        assert_eq!(shown(&layout), views);
    }

    #[test]
    fn panels_open_close_float_and_grow() {
        let mut layout = Layout::default();
        let first = [Pane::Paint, Pane::Picture, Pane::Inspector];
        assert_eq!(shown(&layout), first);
        layout.toggle(Pane::Aperture);
        assert_eq!(shown(&layout), [Pane::Paint, Pane::Picture, Pane::Inspector, Pane::Aperture]);
        assert!(layout.is_open(Pane::Atlas), "behind it, in a tab");
        layout.toggle(Pane::Histogram);
        assert_eq!(shown(&layout).last(), Some(&Pane::Histogram));
        layout.toggle(Pane::Histogram);
        assert_eq!(shown(&layout), first, "the tabs are folded away together");

        layout.toggle_floating(Pane::Atlas);
        assert!(layout.is_floating(Pane::Atlas) && layout.is_shown(Pane::Atlas));
        layout.toggle(Pane::Aperture);
        assert!(layout.is_shown(Pane::Atlas) && layout.is_shown(Pane::Aperture));
        layout.close(Pane::Atlas);
        assert!(!layout.is_open(Pane::Atlas));
        layout.open(Pane::Atlas);
        assert!(layout.is_shown(Pane::Atlas) && !layout.is_floating(Pane::Atlas), "back in its tab");

        layout.toggle_enlarged(Pane::Picture);
        assert_eq!(shown(&layout), [Pane::Picture]);
        layout.toggle_enlarged(Pane::Paint);
        assert_eq!(layout.enlarged(), None, "and back");
        layout.close(Pane::Paint);
        assert!(layout.is_shown(Pane::Paint), "a view stays");
    }

    #[test]
    fn what_is_stored_comes_back_and_what_is_not_whole_does_not() {
        let mut layout = Layout::default();
        layout.toggle_floating(Pane::Histogram);
        layout.toggle(Pane::Inspector);
        let text = serde_json::to_string(&layout).unwrap();
        let again = Layout::from_stored(&text).expect("it is whole");
        assert_eq!(shown(&again), shown(&layout));
        assert_eq!(Layout::from_stored(&text.replace("Histogram", "Atlas")), None, "a panel twice");
        assert_eq!(Layout::from_stored("{}"), None);
        let text = serde_json::to_string(&Layout { size: [0.0, 4.0], ..layout }).unwrap();
        assert_eq!(Layout::from_stored(&text), None);
    }
}
