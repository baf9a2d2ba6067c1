//! Light fields and pictures with depth in the window: dropped, painted, saved and reopened.

use crate::acting::{Person, at, difference};
use crate::card_light_field;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use focus_brush::window::Shell;
use glam::DVec2;
use render::StereoForm;
use session::ReferenceKind;
use std::path::Path;

/// Copies the depth of the card over the wall beside it, undoes and redoes it.
fn repairs_depth(person: &mut Person) {
    let painted = person.document().map.clone();
    let depth = |person: &Person| {
        let camera = &person.document().camera;
        let ray = person.shell().session().picture_ray(DVec2::new(0.85, 0.5)).unwrap();
        person.shell().session().pick(&ray).map(|hit| camera.camera_from_world(hit.position).z).unwrap()
    };
    let (before, picture) = (depth(person), person.picture());
    // A point is chosen for the aperture view meanwhile; it is no longer on the surface afterwards.
    person.presses(Modifiers::NONE, Key::F8);
    person.clicks(at(person.picture_rect(), 0.5, 0.5));
    let rect = person.picture_rect();
    person.presses(Modifiers::NONE, Key::U);
    person.drags(&[at(rect, 0.5, 0.5), at(rect, 0.7, 0.5), at(rect, 0.9, 0.5)]);
    person.lets_go(at(rect, 0.9, 0.5));
    let made_of = |strokes| {
        move |shell: &Shell| shell.session().document().unwrap().stage.depth_strokes.len() == strokes
    };
    person.wait_until("depth is repaired", made_of(1));
    person.waits();
    let after = depth(person);
    assert!(after < 0.9 * before, "{after} {before}");
    assert_eq!(person.document().map, painted, "paint stays where it is");
    assert!(difference(&person.picture(), &picture) > 0.0, "it is seen");
    person.presses(Modifiers::COMMAND, Key::Z);
    person.wait_until("it is taken back", made_of(0));
    person.waits();
    assert_eq!((depth(person), difference(&person.picture(), &picture)), (before, 0.0));
    person.presses(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    person.wait_until("it is done again", made_of(1));
    person.waits();
    assert_eq!(depth(person), after);
    assert_eq!(person.complaints(), [""; 0]);
}

/// Drops a capture, paints on its card, saves, and opens the project again.
fn is_the_same_when_opened_again(capture: &Path, project: &Path) {
    let mut person = Person::starts(None);
    person.drops(capture);
    person.wait_until("it is open", |shell| shell.session().document().is_some());
    person.wait_until("the surface is drawn", |shell| shell.paint_view().is_ready());
    person.waits();
    assert_eq!(person.complaints(), [""; 0]);
    let camera = person.document().camera.clone();
    assert_eq!([camera.width, camera.height], card_light_field::SIZE, "it is the picture's");
    assert!(camera.aperture_radius > 0.0);
    let before = person.picture();
    person.presses(Modifiers::NONE, Key::G);
    person.clicks(at(person.picture_rect(), 0.5, 0.5));
    assert!(difference(&person.picture(), &before) > 0.0, "paint is seen");
    repairs_depth(&mut person);
    person.presses(Modifiers::COMMAND, Key::S);
    person.window.get_by_label("Save").click();
    person.waits();
    assert!(project.is_file(), "{:?}", person.complaints());
    let (map, picture) = (person.document().map.clone(), person.picture());
    drop(person);

    let person = Person::opens(project);
    assert_eq!(person.document().map, map);
    assert_eq!(person.document().camera, camera);
    assert_eq!(difference(&person.picture(), &picture), 0.0);
}

#[test]
fn a_light_field_is_painted_and_the_same_when_opened_again() {
    let folder = tempfile::tempdir().unwrap();
    let capture = folder.path().join("card");
    card_light_field::write(&capture);
    is_the_same_when_opened_again(&capture, &folder.path().join("card.fbrush"));
}

#[test]
fn two_eyes_look_where_one_clicks() {
    let folder = tempfile::tempdir().unwrap();
    let capture = folder.path().join("card");
    card_light_field::write(&capture);
    let mut person = Person::opens(&capture);
    let of = |form| ReferenceKind::Stereo(form);
    let current = |kind| move |shell: &Shell| shell.session().is_reference_current(kind);
    let focused = |person: &Person, kind| {
        let reference = person.shell().session().reference(kind).unwrap();
        ([reference.picture.width, reference.picture.height], reference.camera.focus_distance)
    };
    let [width, height] = card_light_field::SIZE;
    let lens = person.document().camera.focus_distance;
    // Anaglyph, fixated on the focus distance.
    let picture_rect = person.picture_rect();
    person.presses(Modifiers::ALT, Key::S);
    person.wait_until("it is drawn for glasses", current(of(StereoForm::Anaglyph)));
    assert_eq!(focused(&person, of(StereoForm::Anaglyph)), ([width, height], lens));
    // Then fixated on the card by a click: the nearest surface, one unit away.
    person.presses(Modifiers::ALT, Key::H);
    person.clicks(at(picture_rect, 0.5, 0.5));
    person.wait_until("they look at the card", current(of(StereoForm::Anaglyph)));
    let (_, near) = focused(&person, of(StereoForm::Anaglyph));
    assert!((near - 1.0).abs() < 0.01 && lens > 1.1, "{near} {lens}");
    assert_eq!(person.document().camera.focus_distance, lens, "the lens stays as it is");
    assert!(person.document().undo_name().is_none(), "it is no change of the document");
    // Side by side; in the right one the wall is clicked.
    person.presses(Modifiers::ALT, Key::S);
    person.wait_until("it is drawn side by side", current(of(StereoForm::SideBySide)));
    person.waits();
    assert_eq!(focused(&person, of(StereoForm::SideBySide)), ([2 * width, height], near));
    let left = person.picture_rect();
    assert!(left.width() < picture_rect.width(), "two of them have room");
    person.clicks(at(left, 1.0 + 0.85, 0.5));
    person.wait_until("they look at the wall", current(of(StereoForm::SideBySide)));
    let (_, far) = focused(&person, of(StereoForm::SideBySide));
    assert!((far - 5.0).abs() < 0.05, "{far}");
    person.window.get_by_label("Fixated ×").click();
    person.window.run_steps(3);
    person.wait_until("they look at the focus again", current(of(StereoForm::SideBySide)));
    assert_eq!(focused(&person, of(StereoForm::SideBySide)).1, lens);
    person.presses(Modifiers::ALT, Key::S);
    assert_eq!(person.shell().picture_view().displayed, focus_brush::window::DisplayedPicture::Painted);
    assert_eq!(person.complaints(), [""; 0]);
}

#[test]
fn a_depth_map_that_does_not_say_which_end_is_near_is_asked_about() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("card.png");
    card_light_field::view([0.0; 2]).save(&picture).unwrap();
    let [width, height] = card_light_field::SIZE;
    let is_card = |x: u32, y: u32| x.abs_diff(width / 2) < width / 6 && y.abs_diff(height / 2) < height / 6;
    let level = |x, y| image::Luma([if is_card(x, y) { 60u8 } else { 200 }]);
    image::GrayImage::from_fn(width, height, level).save(folder.path().join("card_depth.png")).unwrap();
    let mut person = Person::starts(None);
    person.drops(&picture);
    person.wait_until("it asks", |shell| shell.depth_polarity_dialog_is_open());
    person.window.run_steps(3);
    person.window.get_by_label("Black is near").click();
    person.wait_until("it is open", |shell| shell.session().document().is_some());
    person.waits();
    assert_eq!(person.complaints(), [""; 0]);
    let depth = |x: f64| {
        let session = person.shell().session();
        let hit = session.pick(&session.picture_ray(DVec2::new(x, 0.5)).unwrap()).unwrap();
        person.document().camera.camera_from_world(hit.position).z
    };
    assert!(depth(0.5) < depth(0.9), "{} {}", depth(0.5), depth(0.9));
}

#[test]
fn a_picture_with_depth_is_painted_and_the_same_when_opened_again() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("card.png");
    card_light_field::view([0.0; 2]).save(&picture).unwrap();
    card_light_field::pfm(&folder.path().join("card_depth.pfm"), |disparity| 1.0 / (1.0 + disparity));
    is_the_same_when_opened_again(&picture, &folder.path().join("card.fbrush"));
}
