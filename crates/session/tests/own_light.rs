//! The light that a scene brings: seen, scaled, saved and opened again.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;
#[allow(dead_code, reason = "shared by several tests")]
mod tiny_glb;

use at_work::{opened, picture, settle};
use glam::Vec3;
use scene::{Backdrop, Environment, World};
use session::{Command, Session};
use std::path::{Path, PathBuf};

/// The radiance of the picture's upper left corner, where no quad is.
fn corner(session: &Session) -> [f32; 3] {
    picture(session).radiance[0]
}

fn is_blue(color: [f32; 3], radiance: f32) -> bool {
    color[0].abs() < 1e-3 && color[1].abs() < 1e-3 && (color[2] - radiance).abs() < 0.02 * radiance
}

#[test]
fn it_is_seen_scaled_and_kept_as_the_scene_s_own() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("lit.glb");
    // Without the wall, the world is seen beside the card.
    std::fs::write(&file, tiny_glb::lit(&tiny_glb::QUADS[1..])).unwrap();
    let mut session = opened(&file);
    assert!(is_blue(corner(&session), 2.0), "{:?}", corner(&session));
    let own = session.document().unwrap().scene().embedded_world.clone().unwrap();
    let Environment::Map(map) = &own.environment else { panic!("no picture") };
    assert_eq!(map.name, "image-based light six colours");

    session.apply(Command::SetWorld(Some(World { strength: 0.5, ..own.clone() }))).unwrap();
    settle(&mut session);
    assert!(is_blue(corner(&session), 1.0), "{:?}", corner(&session));
    let project = folder.path().join("lit.fbrush");
    session.apply(Command::SaveAs(project.clone())).unwrap();
    settle(&mut session);
    drop(session);
    let again = opened(&project);
    assert!(is_blue(corner(&again), 1.0), "{:?}", corner(&again));
    assert_eq!(again.document().unwrap().warnings, [""; 0]);
    drop(again);

    // A scene that no longer brings it opens, and says so.
    std::fs::write(&file, tiny_glb::glb(&tiny_glb::QUADS[1..])).unwrap();
    let without = opened(&project);
    let warnings = &without.document().unwrap().warnings;
    assert!(warnings.iter().any(|warning| warning.contains("EXT_lights_image_based")), "{warnings:?}");
    assert!(corner(&without) != [0.0, 0.0, 1.0]);
}

/// A card and a dot of metal, lit by the world alone, opened; and their file.
fn opened_metal(folder: &Path) -> (Session, PathBuf) {
    let file = folder.join("quads.glb");
    std::fs::write(&file, tiny_glb::metal(&tiny_glb::QUADS[1..])).unwrap();
    (opened(&file), file)
}

/// The largest difference between the picture that is shown and that of a light field baked in this world.
fn difference_from_baked(session: &Session, file: &Path, world: World) -> f32 {
    let mut fresh = opened(file);
    fresh.apply(Command::SetWorld(Some(world))).unwrap();
    settle(&mut fresh);
    fresh.apply(Command::Bake).unwrap();
    settle(&mut fresh);
    assert!(fresh.baked_light_fields() > 1, "it is baked");
    let kept = picture(session).radiance.into_flattened();
    let pairs = kept.into_iter().zip(picture(&fresh).radiance.into_flattened());
    pairs.map(|(kept, fresh)| (kept - fresh).abs()).fold(0.0, f32::max)
}

#[test]
fn another_backdrop_needs_no_bake() {
    let folder = tempfile::tempdir().unwrap();
    let (mut session, file) = opened_metal(folder.path());
    let bakes = session.baked_light_fields();
    let studio = World::studio();
    let backdrops = [Vec3::new(0.1, 0.5, 2.0), Vec3::new(0.9, 0.0, 0.3)];
    let world = |color| World { backdrop: Backdrop::Color(color), ..studio.clone() };
    for color in backdrops {
        session.apply(Command::SetWorld(Some(world(color)))).unwrap();
        settle(&mut session);
        assert_eq!(session.baked_light_fields(), bakes);
        let corner = Vec3::from(corner(&session));
        assert!((corner - color).abs().max_element() < 2e-3 * color.max_element());
    }
    let largest = difference_from_baked(&session, &file, world(backdrops[1]));
    assert!(largest < 4e-3, "{largest}");
    // A sky is not the same everywhere.
    let sky = World { backdrop: Backdrop::Environment, ..studio.clone() };
    session.apply(Command::SetWorld(Some(sky))).unwrap();
    settle(&mut session);
    assert_eq!(session.baked_light_fields(), bakes + 1);
}

#[test]
fn another_brightness_needs_no_bake_where_all_light_is_the_world_s() {
    let folder = tempfile::tempdir().unwrap();
    let (mut session, file) = opened_metal(folder.path());
    let bakes = session.baked_light_fields();
    let bright = World { strength: 2.0, ..World::studio() };
    for world in [&World { strength: 0.1, ..World::studio() }, &bright] {
        session.apply(Command::SetWorld(Some(world.clone()))).unwrap();
        settle(&mut session);
        assert_eq!(session.baked_light_fields(), bakes);
    }
    let largest = difference_from_baked(&session, &file, bright.clone());
    assert!(largest < 1e-2, "{largest}");
    // Light from elsewhere is other light.
    session.apply(Command::SetWorld(Some(World { rotation: 1.0, ..bright }))).unwrap();
    settle(&mut session);
    assert_eq!(session.baked_light_fields(), bakes + 1);
}
