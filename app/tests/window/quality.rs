//! The picture refines itself and reports its quality.

use crate::acting::{Person, at};
use crate::small_scene;
use egui_kittest::kittest::Queryable;
use focus_brush::window::WindowOptions;
use session::Quality;
use std::time::Duration;

impl Person {
    fn quality(&self) -> Quality {
        self.shell().session().preview().expect("a picture").quality
    }

    /// Whether there is a label with this prefix.
    fn reads(&self, begin: &str) -> bool {
        self.window.query_all_by(|node| node.value().is_some_and(|text| text.starts_with(begin))).count() > 0
    }

    fn waits_for(&mut self, quality: Quality) {
        self.wait_until(&format!("{quality:?}"), |shell| {
            shell.session().preview().is_some_and(|preview| preview.quality == quality)
        });
        self.window.run_steps(2);
    }
}

#[test]
fn the_picture_becomes_exact_by_itself_and_the_status_line_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wall.glb");
    small_scene::write(&file);
    // Sufficient for a busy machine to draw frames before it.
    let exact_after = Some(Duration::from_millis(1500));
    let options = WindowOptions { exact_after, ..Person::usual(Some(&file)) };
    let mut person = Person::starts_with(options);
    person.waits_for(Quality::Viewing);
    assert!(person.reads("live picture"));
    person.waits_for(Quality::Exact);
    assert!(person.reads("exact picture") && !person.reads("live picture"));
    let known = person.shell().session().preview().unwrap().costs;
    assert!(known.viewing_psnr > Some(20.0) && known.exact_seconds > Some(0.0), "{known:?}");

    let wall = at(person.picture_rect(), 0.8, 0.8);
    person.paints(&[wall]);
    assert_eq!(person.quality(), Quality::Viewing);
    person.window.run_steps(2);
    assert!(person.reads("live picture"));
    person.waits_for(Quality::Exact);

    // Without tolerance, every picture is exact at once.
    person.scrolls_to("Tolerance");
    let field = person.window.get_by_role_and_label(egui::Role::Slider, "Tolerance").rect();
    let left = egui::pos2(field.left() + 2.0, field.center().y);
    person.paints(&[field.center(), left, left - egui::vec2(80.0, 0.0)]);
    assert_eq!(person.shell().settings().tolerance_px, 0.0);
    person.waits();
    assert_eq!(person.quality(), Quality::Exact);
    person.paints(&[wall]);
    assert_eq!(person.quality(), Quality::Exact);
}
