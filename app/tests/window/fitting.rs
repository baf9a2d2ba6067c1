//! Nothing runs out of the window, and no text lies over another, whatever is open and however large everything is.

use crate::acting::Person;
use crate::small_scene::opened;
use egui::Rect;
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use session::{CommandId, Menu};

/// A text or control on screen.
struct Shown {
    name: String,
    rect: Rect,
    /// The window over the views that it belongs to, by its identity in the tree.
    window: Option<String>,
    /// Whether it can be scrolled to from above or below.
    is_scrolled: bool,
}

/// What scrolls where it is longer than the window, as does what lies over the views.
const SCROLLED: [&str; 2] = ["Inspector panel", "Tools"];

/// What is on screen.
fn shown(person: &Person) -> Vec<Shown> {
    let root = person.window.root();
    // The tree is in pixels.
    let scale = person.window.ctx.pixels_per_point();
    let mut found = Vec::new();
    for node in root.children_recursive() {
        let inner = node.accesskit_node();
        let is_text = matches!(
            inner.role(),
            Role::Label | Role::Button | Role::CheckBox | Role::ComboBox | Role::SpinButton | Role::TextInput
        );
        let name = inner.label().or_else(|| inner.value()).unwrap_or_default();
        // The library's buttons lie over tabs that are cut, to scroll them.
        if !is_text || name.trim().is_empty() || name.starts_with("Scroll tabs") {
            continue;
        }
        let mut above = node.parent();
        let (mut window, mut is_scrolled) = (None, false);
        while let Some(parent) = above {
            let role = parent.accesskit_node().role();
            let name = parent.accesskit_node().label().unwrap_or_default();
            is_scrolled |= SCROLLED.contains(&name.as_str());
            if matches!(role, Role::Window | Role::Dialog | Role::Tooltip | Role::Menu) && window.is_none() {
                window = Some(format!("{:?}", parent.accesskit_node().id()));
            }
            above = parent.parent();
        }
        let Some(bounds) = inner.bounding_box() else { continue };
        let [min, max] =
            [[bounds.x0, bounds.y0], [bounds.x1, bounds.y1]].map(|[x, y]| egui::pos2(x as f32, y as f32));
        found.push(Shown { name, rect: Rect::from_min_max(min, max) / scale, window, is_scrolled });
    }
    found
}

/// What is cut at the window's edge, or lies over another text of the same bar or dialog.
fn misplaced(person: &Person) -> Vec<String> {
    let whole = person.window.ctx.content_rect().expand(1.0);
    let all = shown(person);
    assert!(all.len() > 20, "there are texts: {}", all.len());
    let mut found = Vec::new();
    for Shown { name, rect, is_scrolled, window } in &all {
        let is_inside = match *is_scrolled || window.is_some() {
            true => rect.left() >= whole.left() && rect.right() <= whole.right(),
            false => whole.contains_rect(*rect),
        };
        if !is_inside {
            found.push(format!("{name:?} at {rect:?} is not within {whole:?}"));
        }
    }
    for (at, one) in all.iter().enumerate() {
        for other in &all[at + 1..] {
            let is_apart = one.window != other.window || one.is_scrolled || other.is_scrolled;
            let common = one.rect.shrink(1.0).intersect(other.rect.shrink(1.0));
            // A text within a control has the control's place.
            let is_within = one.rect.contains_rect(other.rect) || other.rect.contains_rect(one.rect);
            if !is_apart && !is_within && common.is_positive() {
                found.push(format!(
                    "{:?} at {:?} over {:?} at {:?}",
                    one.name, one.rect, other.name, other.rect
                ));
            }
        }
    }
    found
}

/// Everything that opens a panel or a dialog.
pub const OPENERS: [CommandId; 12] = [
    CommandId::Gradient,
    CommandId::SelectLasso,
    CommandId::ShowAtlas,
    CommandId::ShowAperture,
    CommandId::ShowHistogram,
    CommandId::ShowPhotographs,
    CommandId::ShowTimeline,
    CommandId::Palette,
    CommandId::Shortcuts,
    CommandId::ShowMessages,
    CommandId::ExportPicture,
    CommandId::SaveAs,
];

#[test]
fn nothing_is_cut_and_nothing_overlaps() {
    for (steps, arrangement) in [
        (0, CommandId::PaintAsNavigator),
        (0, CommandId::PaintBeside),
        (0, CommandId::PaintAbove),
        (8, CommandId::PaintAsNavigator),
    ] {
        let (mut person, _folder) = opened();
        person.does(arrangement);
        for _ in 0..steps {
            person.does(CommandId::ScaleUp);
        }
        person.window.run_steps(8);
        let scale = person.window.ctx.zoom_factor();
        assert_eq!(misplaced(&person), [""; 0], "{arrangement:?} at {scale}");
        for menu in Menu::ALL {
            person.window.get_all_by_label(menu.title()).next().expect("a menu").click();
            person.window.run_steps(4);
            assert_eq!(misplaced(&person), [""; 0], "the menu {} at {scale}", menu.title());
            person.presses(egui::Modifiers::NONE, egui::Key::Escape);
            person.window.run_steps(3);
        }
        for opener in OPENERS {
            person.does(opener);
            person.window.run_steps(6);
            assert_eq!(misplaced(&person), [""; 0], "{} at {scale}", opener.info().name);
            person.presses(egui::Modifiers::NONE, egui::Key::Escape);
            person.window.run_steps(3);
        }
    }
}
