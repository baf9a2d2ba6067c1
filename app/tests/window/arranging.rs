//! Panels are docked, tabbed, floated, enlarged, collapsed and restored.

use crate::acting::{Person, at};
use crate::small_scene::opened;
use egui::{Key, Modifiers, Pos2};
use egui_kittest::kittest::Queryable;
use focus_brush::window::{Arrangement, Pane};
use session::CommandId;

impl Person {
    /// Picks an entry of a panel's menu.
    fn arranges(&mut self, pane: Pane, entry: &str) {
        let menu = format!("{} panel's menu", pane.title());
        self.window.get_by_label(&menu).click();
        self.window.run_steps(3);
        self.window.get_by_label(entry).click();
        self.window.run_steps(4);
    }

    fn is_shown(&self, pane: Pane) -> bool {
        self.shell().layout().is_shown(pane)
    }

    /// Whether the panel is in the accessibility tree.
    fn finds(&self, pane: Pane) -> bool {
        let name = format!("{} panel", pane.title());
        self.window.query_all_by(|node| node.label().is_some_and(|l| l == name)).count() == 1
    }

    /// Moves the pointer without a button.
    fn points(&mut self, at: Pos2) {
        self.window.hover_at(at);
        self.window.run_steps(2);
    }
}

#[test]
fn a_panel_floats_and_is_docked_again() {
    let (mut person, _folder) = opened();
    let narrow = person.picture_rect().width();
    assert!(person.finds(Pane::Inspector));
    person.arranges(Pane::Inspector, "Float");
    assert!(person.shell().layout().is_floating(Pane::Inspector) && person.finds(Pane::Inspector));
    person.window.run_steps(10);
    assert!(person.picture_rect().width() > narrow, "the views take its room");
    let number = person.window.get_by_label("f-number");
    assert!(number.rect().width() > 0.0, "it is all there");
    person.arranges(Pane::Inspector, "Dock");
    assert!(!person.shell().layout().is_floating(Pane::Inspector) && person.is_shown(Pane::Inspector));
    person.window.run_steps(4);
    assert!((person.picture_rect().width() - narrow).abs() < 1.0, "as before");

    person.presses(Modifiers::NONE, Key::F9);
    assert!(person.is_shown(Pane::Histogram) && person.finds(Pane::Histogram));
    // The tab beside it.
    person.window.get_by_label("Atlas").click();
    person.window.run_steps(4);
    assert!(person.is_shown(Pane::Atlas) && !person.is_shown(Pane::Histogram));
    person.arranges(Pane::Atlas, "Float");
    assert!(person.is_shown(Pane::Atlas));
    // It can be painted on as in any other place.
    person.window.run_steps(20);
    let map = person.document().map.clone();
    let rect = person.shell().drawer().atlas_rect();
    for _ in 0..6 {
        person.presses(Modifiers::NONE, Key::Period);
    }
    let across: Vec<_> = (0..=16).map(|k| at(rect, 0.1 + 0.05 * k as f32, 0.1)).collect();
    person.paints(&across);
    assert_ne!(person.document().map, map);
    person.arranges(Pane::Atlas, "Close");
    assert!(!person.is_shown(Pane::Atlas) && !person.finds(Pane::Atlas));
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn the_panel_under_the_pointer_is_enlarged_and_comes_back() {
    let (mut person, _folder) = opened();
    let before = (person.paint_rect(), person.picture_rect());
    person.points(before.0.center());
    person.presses(Modifiers::COMMAND, Key::Space);
    person.window.run_steps(4);
    assert_eq!(person.shell().layout().enlarged(), Some(Pane::Paint));
    assert!(person.paint_rect().width() > 1200.0, "{:?}", person.paint_rect());
    assert!(person.window.query_by_label("f-number").is_none(), "nothing else is there");
    person.arranges(Pane::Paint, "All panels");
    assert_eq!((person.paint_rect(), person.picture_rect()), before);
    // A collapsed panel is shown although another one was enlarged.
    person.presses(Modifiers::COMMAND, Key::Space);
    person.presses(Modifiers::NONE, Key::F7);
    assert!(person.is_shown(Pane::Atlas) && person.is_shown(Pane::Paint));
}

#[test]
fn a_view_is_dragged_into_a_tab_of_the_other_and_the_layout_is_reset() {
    let (mut person, _folder) = opened();
    let before = (person.paint_rect(), person.picture_rect());
    // By its name, to the middle of the picture.
    let names = person.window.get_all_by_label("Paint").map(|node| node.rect());
    let name = names.min_by(|a, b| a.left().total_cmp(&b.left())).unwrap().center();
    let target = before.1.center();
    let path: Vec<_> = (0..=12).map(|k| name.lerp(target, k as f32 / 12.0)).collect();
    person.drags(&path);
    person.window.run_steps(3);
    person.lets_go(target);
    person.window.run_steps(6);
    assert!(person.is_shown(Pane::Paint) != person.is_shown(Pane::Picture), "one lies behind the other");
    assert!(person.picture_rect().width().max(person.paint_rect().width()) > 700.0);
    assert_eq!(person.document().undo_name(), None, "nothing was painted on the way");
    let context = person.window.ctx.clone();
    person.window.state_mut().run(CommandId::ResetLayout, &context);
    person.window.run_steps(4);
    assert_eq!(person.shell().layout().arrangement(), Arrangement::Navigator, "as at first");
    assert!(before.1.width() < person.picture_rect().width(), "the picture is large");
    assert!(
        person.picture_rect().expand(20.0).contains_rect(person.paint_rect()),
        "the paint view lies over it"
    );
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}
