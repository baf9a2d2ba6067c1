//! The inspector's choice of a variant, and the name of a scene's own light.

use crate::acting::Person;
use crate::{small_scene, tiny_glb};
use egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable;

#[test]
fn a_variant_is_chosen_from_a_list_and_undone() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("varied.glb");
    std::fs::write(&file, tiny_glb::varied(&tiny_glb::QUADS)).unwrap();
    let mut person = Person::opens(&file);
    let variant = |person: &Person| person.document().scene().variant.clone();
    let before = person.picture();
    person.scrolls_to("Material variants");
    person.window.get_by_role_and_label(Role::ComboBox, "Variant").click_accesskit();
    person.window.run_steps(4);
    person.window.get_by_label("Green").click_accesskit();
    person.waits();
    assert_eq!(
        (variant(&person).as_deref(), person.document().undo_name()),
        (Some("Green"), Some("Variant"))
    );
    assert!(crate::acting::difference(&before, &person.picture()) > 0.5);
    person.presses(Modifiers::COMMAND, Key::Z);
    person.waits();
    assert_eq!(variant(&person), None);
    assert!(crate::acting::difference(&before, &person.picture()) < 0.01);
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn a_scene_without_variants_has_no_choice() {
    let (person, _folder) = small_scene::opened();
    assert!(person.window.query_by_label("Material variants").is_none());
}

#[test]
fn the_world_panel_names_the_light_that_the_scene_brings() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("lit.glb");
    std::fs::write(&file, tiny_glb::lit(&tiny_glb::QUADS)).unwrap();
    let person = Person::opens(&file);
    assert!(person.window.query_by_label("image-based light six colours of the scene").is_some());
}
