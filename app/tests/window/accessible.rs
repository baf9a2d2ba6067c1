//! Every control has a name for screen readers.

use crate::acting::Person;
use crate::small_scene::opened;
use egui::accesskit::{Action, Role};
use egui_kittest::kittest::{NodeT, Queryable};
use session::{CommandId, Menu};

/// Controls without a name in the accessibility tree.
fn nameless(person: &Person) -> Vec<String> {
    let nodes = person.window.root().children_recursive();
    let mut found = Vec::new();
    let mut controls = 0;
    for node in nodes {
        let node = node.accesskit_node();
        let acts = node.data().supports_action(Action::Click)
            || matches!(node.role(), Role::TextInput | Role::Slider | Role::SpinButton | Role::ComboBox);
        // Scroll areas are not controls; the handle between two tiles has no role, and can only be dragged.
        let other = [Role::ScrollView, Role::ScrollBar, Role::Window, Role::Splitter, Role::Unknown];
        if !acts || other.contains(&node.role()) {
            continue;
        }
        controls += 1;
        let name = node.label().or_else(|| node.value());
        if name.is_none_or(|name| name.trim().is_empty()) {
            found.push(format!("{:?} at {:?}", node.role(), node.bounding_box()));
        }
    }
    assert!(controls > 20, "there are controls: {controls}");
    found
}

#[test]
fn every_control_has_a_name_whatever_is_open() {
    let (mut person, _folder) = opened();
    assert_eq!(nameless(&person), [""; 0], "the window");
    for menu in Menu::ALL {
        person.window.get_all_by_label(menu.title()).next().unwrap().click();
        person.window.run_steps(3);
        assert_eq!(nameless(&person), [""; 0], "the menu {}", menu.title());
        person.presses(egui::Modifiers::NONE, egui::Key::Escape);
    }
    let context = person.window.ctx.clone();
    // Everything with settings or a window of its own.
    let commands = [
        CommandId::Gradient,
        CommandId::SelectLasso,
        CommandId::AddDepthCurve,
        CommandId::ShowAtlas,
        CommandId::ShowAperture,
        CommandId::ShowHistogram,
        CommandId::ShowPhotographs,
        CommandId::ShowTimeline,
        CommandId::Wipe,
        CommandId::Palette,
        CommandId::Shortcuts,
        CommandId::About,
        CommandId::SaveAs,
    ];
    for id in commands {
        person.window.state_mut().run(id, &context);
        person.window.run_steps(3);
        assert_eq!(nameless(&person), [""; 0], "{}", id.info().name);
        if id == CommandId::Palette {
            person.presses(egui::Modifiers::NONE, egui::Key::Escape);
        }
    }
    for section in ["Scene", "Statistics", "History"] {
        person.scrolls_to(section);
        person.window.get_all_by_label(section).last().unwrap().click();
        person.window.run_steps(20);
        assert_eq!(nameless(&person), [""; 0], "{section}");
    }
}
