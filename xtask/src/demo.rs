//! The demo scene: a garden at dusk, made by code.
//!
//! A paper fox sits on a wet path behind an iron fence; far behind it stands a clock tower. The camera
//! focuses on the fox with a wide aperture, so that the fence, the lanterns and the strings of bulbs melt
//! into veils and discs. The painted focus keeps two more things sharp that no lens could: a butterfly on the
//! fence, close to the lens, and the tower at the end of the garden.
//!
//! It is built like a stage set: see [`view::View::staged`]. Light is computed in the unsqueezed garden.
//!
//! Everything is unlit: the light is baked into one texture (the *light sheet*), in which every surface has a
//! block of its own; its texture coordinates therefore serve as an atlas as they are.

mod butterfly;
mod fence;
mod fox;
mod garden;
mod glb;
mod ground;
mod lamps;
mod light;
mod noise;
mod rays;
mod sheet;
mod solids;
mod surface;
mod tower;
mod view;

use crate::chore::{Failure, repository};
use crate::run::focus_brush;
use glam::Vec3;
use serde_json::{Value, json};
use sheet::Sheet;
use surface::Object;
use view::View;

/// Columns of the light sheet.
const SHEET_WIDTH: usize = 1024;

/// Writes `demo.glb`, `demo.camera.json`, `demo.focus.json` and the project of the three, `demo.fbrush`, into
/// `assets/demo`. `sky_rays` a texel decide how smooth the light is.
///
/// # Errors
/// A file cannot be written, or `focus-brush` fails.
pub fn demo(sky_rays: usize) -> Result<(), Failure> {
    let view = View::default();
    let (objects, lamps) = garden_at_dusk(&view);
    let triangles: usize = objects.iter().flat_map(|o| &o.surfaces).map(|s| s.triangles().len()).sum();
    let sheet = Sheet::new(&objects, SHEET_WIDTH);
    println!(
        "{} objects, {triangles} triangles, light sheet {}×{}",
        objects.len(),
        sheet.width,
        sheet.height
    );
    let texture = sheet.bake(&objects, &lamps, view.eye, sky_rays);
    let folder = repository().join("assets/demo");
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::create_dir_all(&folder)
            .and_then(|()| std::fs::write(&path, bytes))
            .map_err(|e| Failure::new(format!("{}: {e}", path.display())))?;
        println!("{} ({} kB)", path.display(), bytes.len() / 1000);
        Ok(())
    };
    write("demo.glb", &glb::glb(&objects, &sheet, &texture, &view)?)?;
    write("demo.camera.json", pretty(&view.file()).as_bytes())?;
    write("demo.focus.json", pretty(&recipe()).as_bytes())?;
    let file = |name: &str| folder.join(name).into_os_string();
    let [scene, camera, focus] = ["demo.glb", "demo.camera.json", "demo.focus.json"].map(file);
    focus_brush(&[
        "new".into(),
        scene,
        "--camera".into(),
        camera,
        "--focus".into(),
        focus,
        "-o".into(),
        file("demo.fbrush"),
    ])
}

fn pretty(value: &Value) -> String {
    format!("{value:#}\n")
}

/// All objects, and the lamps that light them.
fn garden_at_dusk(view: &View) -> (Vec<Object>, Vec<light::Lamp>) {
    let fox = view.ground(-0.62, 0.73).with_y(0.008);
    let tower = view.at(0.80, 0.0, 6.2).with_y(0.0);
    let butterfly = fence::point(0.084, fence::HEIGHT + 0.013) + Vec3::Z * 0.006;
    let mut objects = vec![
        fox::fox(fox, 0.70, 0.92),
        butterfly::butterfly(butterfly, 0.038),
        fence::fence(),
        fence::ivy(view),
        ground::ground(),
        tower::tower(tower),
        tower::clock(tower),
        garden::trees(),
        garden::hedges(),
        garden::houses(),
        garden::windows(),
        garden::hills(),
        garden::backdrop(view),
        lamps::lantern_frames(),
        lamps::lantern_glass(),
        lamps::wires(view),
    ];
    objects.extend(lamps::bulbs(view));
    (objects, lamps::lamps(view, tower))
}

/// The focus that no lens has: sharp, whatever the depth, what is named here.
fn recipe() -> Value {
    let sharp = json!({"t": 1.0, "anchor": 1.0});
    json!({
        "default": {"t": 1.0, "anchor": 0.0},
        "materials": {"fox": sharp, "butterfly": sharp, "tower": sharp, "clock": sharp},
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn blocks_do_not_overlap_and_names_are_unique() {
        let (objects, _) = garden_at_dusk(&View::default());
        let sheet = Sheet::new(&objects, SHEET_WIDTH);
        let mut taken = vec![false; sheet.width * sheet.height];
        for block in sheet.blocks.iter().flatten() {
            for y in block.y..block.y + block.size[1] {
                for x in block.x..block.x + block.size[0] {
                    assert!(!std::mem::replace(&mut taken[y * sheet.width + x], true), "{block:?} overlaps");
                }
            }
        }
        let names: HashSet<_> = objects.iter().map(|o| o.name).collect();
        assert_eq!(names.len(), objects.len());
    }

    #[test]
    fn the_recipe_names_what_is_there() {
        let (objects, _) = garden_at_dusk(&View::default());
        for name in recipe()["materials"].as_object().unwrap().keys() {
            assert!(objects.iter().any(|o| o.name == name), "{name}");
        }
    }

    #[test]
    fn solids_face_outward() {
        let shader = surface::plain(Vec3::ONE);
        let center = Vec3::new(1.0, 2.0, 3.0);
        let mut closed = vec![solids::sphere(center, 0.5, 8, [2, 2], shader.clone())];
        closed.push(solids::tube(
            &[center - Vec3::Y, center, center + Vec3::Y],
            0.1,
            6,
            [2, 2],
            shader.clone(),
        ));
        closed.push(solids::turned(center, &[(0.2, -0.1), (0.1, 0.3)], 6, [2, 2], shader.clone()));
        closed.extend(solids::block(center - Vec3::Y * 0.5, Vec3::new(0.3, 1.0, 0.2), 0.4, [2, 2], &shader));
        for surface in &closed {
            for corners in surface.triangles() {
                let [a, b, c] = corners.map(|i| surface.points[i as usize]);
                let outward = ((a + b + c) / 3.0 - center).dot((b - a).cross(c - a));
                assert!(outward > 0.0, "{a} {b} {c}");
            }
        }
    }

    #[test]
    fn the_shot_puts_things_where_it_says() {
        let view = View::default();
        let camera_from_world = view.matrix().inverse();
        let seen = camera_from_world.transform_point3(view.at(0.5, -0.25, 3.0));
        let tan = (view.yfov / 2.0).tan();
        assert!(seen.distance(Vec3::new(0.5 * tan * 3.0, -0.25 * tan * 3.0, -3.0)) < 1e-5, "{seen}");
    }

    #[test]
    fn staging_changes_nothing_for_the_eye() {
        let view = View::default();
        for depth in [0.4, 1.0, 1.5, 7.0] {
            let point = view.at(0.7, 0.3, depth);
            let (before, after) =
                ((point - view.eye).normalize(), (view.staged(point) - view.eye).normalize());
            assert!(before.distance(after) < 1e-5);
            assert!((depth > 1.0) == (view.staged(point) != point));
        }
        assert!(view.eye.distance(view.staged(view.at(0.0, 0.0, 1e6))) < 1.0 / 0.3 + 1e-3);
    }
}
