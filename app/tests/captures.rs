//! Captures, end to end: synthetic photographs of a wall.

mod card_light_field;
mod program;
mod wall_capture;

use glam::{DVec2, Vec2};
use program::{done, run};
use project::read_picture;
use serde_json::Value;

#[test]
fn a_photograph_left_out_is_what_the_others_tell() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    wall_capture::write(&folder.join("wall"));
    done(folder, "import wall -o wall.fbrush --leave-out 2.png");
    let info: Value = serde_json::from_str(&done(folder, "info wall.fbrush --json")).unwrap();
    assert_eq!(info["capture"]["photographs"].as_array().unwrap().len(), 5);
    assert_eq!(info["capture"]["left_out"][0]["name"], "2.png");
    let agreement = info["capture"]["mesh_fit"]["agreement"].as_f64().unwrap();
    assert!((0.6..=1.0).contains(&agreement), "{agreement}");
    assert!(done(folder, "info wall").contains("patches look alike in two photographs"));
    assert_eq!(info["project"]["scene_state"], "same");

    // Through the camera of a present photograph and of the missing one.
    for name in ["3.png", "2.png"] {
        done(folder, &format!("export wall.fbrush --photo {name}=photo.exr"));
        let photo = read_picture(&folder.join("photo.exr")).unwrap();
        let render = format!(
            "render wall.fbrush --camera photo:{name} -o shown.exr --renderer truth --spp 16 --aov seen"
        );
        done(folder, &render);
        let shown = read_picture(&folder.join("shown.exr")).unwrap();
        assert_eq!([shown.width, shown.height], wall_capture::SIZE);
        let squares = photo.rgb.iter().zip(&shown.rgb);
        let squares = squares.flat_map(|(a, b)| (0..3).map(move |c| f64::from(a[c] - b[c]).powi(2)));
        // Everything it shows, except for its rim, is visible in others.
        let psnr = -10.0 * (squares.sum::<f64>() / (3 * photo.rgb.len()) as f64).log10();
        assert!(psnr > 40.0, "{name}: {psnr} dB");
    }
    // Negative control: another photograph's camera shows something else.
    done(folder, "render wall.fbrush --camera photo:0.png -o shown.exr --renderer truth --spp 4");
    let [photo, other] = ["photo.exr", "shown.exr"].map(|name| read_picture(&folder.join(name)).unwrap());
    let far = photo.rgb.iter().zip(&other.rgb).map(|(a, b)| f64::from(a[0] - b[0]).powi(2)).sum::<f64>();
    assert!(-10.0 * (far / photo.rgb.len() as f64).log10() < 30.0);

    // The splatted picture, with a lens.
    done(folder, "render wall.fbrush --camera photo:3.png --aperture-radius 0.01 -o splat.exr --backend cpu");
    let output = run(folder, "render wall.fbrush --camera photo:none.png -o x.exr");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3));
    assert!(errors.contains("no photograph is called \"none.png\" (there are 0.png"), "{errors}");
}

#[test]
fn what_is_missing_is_told_and_the_rest_goes_on() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    wall_capture::write(&folder.join("wall"));
    std::fs::remove_file(folder.join("wall/images/4.png")).unwrap();
    let output = run(folder, "import wall -o wall.fbrush");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{errors}");
    assert!(errors.contains("4.png"), "{errors}");
    assert!(folder.join("wall.fbrush").exists());
    std::fs::remove_file(folder.join("wall/mesh.ply")).unwrap();
    let output = run(folder, "import wall -o other.fbrush");
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("delaunay_mesher"));
    let output = run(folder, "info .");
    assert_eq!(output.status.code(), Some(3), "a folder that is none");
    // Changed since: reported, not rejected.
    wall_capture::write(&folder.join("wall"));
    let wider = std::fs::read_to_string(folder.join("wall/mesh.ply")).unwrap().replace("3 2 0", "3.5 2 0");
    std::fs::write(folder.join("wall/mesh.ply"), wider).unwrap();
    let info: Value = serde_json::from_str(&done(folder, "info wall.fbrush --json")).unwrap();
    assert_eq!(info["project"]["scene_state"], "changed");
}

#[test]
fn a_captures_surface_is_written_with_its_light_as_a_texture() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    wall_capture::write(&folder.join("wall"));
    done(folder, "import wall -o wall.fbrush");
    done(folder, "export wall.fbrush --glb wall.glb");
    let options = scene::LoadOptions::default();
    let scene = scene::load(&folder.join("wall.glb"), &options, &progress::Unwatched).unwrap();
    assert!(scene.triangles.len() == 2 && scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert!(scene.materials[0].unlit && scene.materials[0].double_sided);
    for [x, y] in [[0.0, 0.0], [0.4, 0.3], [-0.5, 0.2], [0.3, -0.35]] {
        let point = on_wall(&scene, x, y);
        let vertices = scene.triangles[point.triangle as usize].vertices;
        let places = vertices.iter().zip(point.weights());
        let place: Vec2 = places.map(|(&v, weight)| scene.uv[0][v as usize] * weight as f32).sum();
        let found = scene.images[0].sample(place, [scene::Wrap::Clamp; 2], false, true);
        let told = wall_capture::wall(x, y).map(|v| v as f32);
        let off = (0..3).map(|c| (found[c] - told[c]).abs()).fold(0.0, f32::max);
        assert!(off < 0.02, "{x} {y}: {found:?} for {told:?}");
    }
    let output = run(folder, "export wall.fbrush --glb wall.obj");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(3) && errors.contains("are written as .glb"), "{errors}");
}

#[test]
fn a_light_fields_surface_is_written_with_its_picture_as_a_texture() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    card_light_field::write(&folder.join("card"));
    done(folder, "import card -o card.fbrush");
    done(folder, "export card.fbrush --glb card.glb");
    let render = |of: &str| {
        done(folder, &format!("render {of} --aperture-radius 0 -o shown.exr"));
        read_picture(&folder.join("shown.exr")).unwrap()
    };
    let [own, written] = [render("card.fbrush"), render("card.glb")];
    assert_eq!([written.width, written.height], [own.width, own.height], "the camera comes along");
    let off = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>();
    let square = own.rgb.iter().zip(&written.rgb).map(off).sum::<f64>() / (3 * own.rgb.len()) as f64;
    assert!(-10.0 * square.log10() > 32.0, "{} dB", -10.0 * square.log10());
}

/// The point of a scene's surface at (x, y, 0).
fn on_wall(scene: &scene::Scene, x: f64, y: f64) -> scene::SurfacePoint {
    let place = DVec2::new(x, y);
    let of_triangle = |triangle: u32| {
        let [a, b, c] = scene.corners(triangle).map(|corner| corner.truncate());
        let area = (b - a).perp_dot(c - a);
        let barycentric = DVec2::new((place - a).perp_dot(c - a), (b - a).perp_dot(place - a)) / area;
        let is_in = barycentric.min_element() >= 0.0 && barycentric.element_sum() <= 1.0;
        is_in.then_some(scene::SurfacePoint { triangle, barycentric })
    };
    (0..scene.triangles.len() as u32).find_map(of_triangle).unwrap()
}
