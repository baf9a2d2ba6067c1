//! Captures from end to end: photographs of a wall that the test takes itself.

use glam::{DMat3, DQuat, DVec3};
use image::{Rgb, RgbImage};
use project::read_picture;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// Width and height of the photographs, and the focal length of their lens, px.
const SIZE: [u32; 2] = [120, 80];
const FOCAL: f64 = 100.0;

/// What the wall sends at a place, linear.
fn wall(x: f64, y: f64) -> [f64; 3] {
    let wave = |k: f64| 0.3 + 0.2 * (k * x).sin() * (1.3 * k * y).cos();
    [wave(3.0), wave(2.0), 0.5 * wave(1.5) + 0.1]
}

/// Where photograph k was taken: a ring that looks at the wall's middle; right, down and forward.
fn camera(k: usize) -> (DVec3, DMat3) {
    let angle = k as f64 * 1.1;
    let center = DVec3::new(0.6 * angle.cos(), 0.4 * angle.sin(), 2.0);
    let forward = -center.normalize();
    let right = forward.cross(DVec3::Y).normalize();
    (center, DMat3::from_cols(right, forward.cross(right), forward))
}

/// Stops that photograph k is brighter by.
fn stops(k: usize) -> f64 {
    0.2 * (k as f64 - 2.5)
}

fn photograph(k: usize) -> RgbImage {
    let (center, axes) = camera(k);
    RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let at = |at: u32, side: u32| (f64::from(at) + 0.5 - f64::from(side) / 2.0) / FOCAL;
        let direction = axes * DVec3::new(at(x, SIZE[0]), at(y, SIZE[1]), 1.0);
        let place = center - direction * (center.z / direction.z);
        Rgb(wall(place.x, place.y).map(|linear| {
            let shown = (linear * stops(k).exp2()).min(1.0);
            let encoded =
                if shown <= 0.0031308 { 12.92 * shown } else { 1.055 * shown.powf(1.0 / 2.4) - 0.055 };
            (encoded * 255.0).round() as u8
        }))
    })
}

/// Six photographs, COLMAP's cameras, and the wall in front of them.
fn capture(folder: &Path) {
    std::fs::create_dir_all(folder.join("images")).unwrap();
    std::fs::create_dir_all(folder.join("sparse/0")).unwrap();
    let mut images = String::new();
    for k in 0..6 {
        photograph(k).save(folder.join(format!("images/{k}.png"))).unwrap();
        let (center, axes) = camera(k);
        let rotation = DQuat::from_mat3(&axes).inverse();
        let (q, t) = (rotation, rotation * -center);
        images += &format!("{} {} {} {} {} {} {} {} 1 {k}.png\n\n", k + 1, q.w, q.x, q.y, q.z, t.x, t.y, t.z);
    }
    let [width, height] = SIZE;
    let lens = format!("1 PINHOLE {width} {height} {FOCAL} {FOCAL} {} {}\n", width / 2, height / 2);
    std::fs::write(folder.join("sparse/0/cameras.txt"), lens).unwrap();
    std::fs::write(folder.join("sparse/0/images.txt"), images).unwrap();
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n-3 -2 0\n3 -2 0\n3 2 0\n-3 2 0\n4 0 1 2 3\n";
    std::fs::write(folder.join("mesh.ply"), ply).unwrap();
}

fn run(folder: &Path, arguments: &str) -> Output {
    let program = Command::new(env!("CARGO_BIN_EXE_focus-brush"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .env("XDG_CACHE_HOME", folder.join("cache"))
        .env_remove("XDG_RUNTIME_DIR")
        .output();
    program.unwrap()
}

fn done(folder: &Path, arguments: &str) -> String {
    let output = run(folder, arguments);
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_photograph_left_out_is_what_the_others_tell() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    capture(&folder.join("wall"));
    done(folder, "import wall -o wall.fbrush --leave-out 2.png");
    let info: Value = serde_json::from_str(&done(folder, "info wall.fbrush --json")).unwrap();
    assert_eq!(info["capture"]["photographs"].as_array().unwrap().len(), 5);
    assert_eq!(info["capture"]["left_out"][0]["name"], "2.png");
    assert_eq!(info["project"]["scene_state"], "same");

    // Through the camera of one that is there, and of the one that is not.
    for name in ["3.png", "2.png"] {
        done(folder, &format!("export wall.fbrush --photo {name}=photo.exr"));
        let photo = read_picture(&folder.join("photo.exr")).unwrap();
        let render = format!(
            "render wall.fbrush --camera photo:{name} -o shown.exr --renderer truth --spp 16 --aov seen"
        );
        done(folder, &render);
        let shown = read_picture(&folder.join("shown.exr")).unwrap();
        assert_eq!([shown.width, shown.height], SIZE);
        let squares = photo.rgb.iter().zip(&shown.rgb);
        let squares = squares.flat_map(|(a, b)| (0..3).map(move |c| f64::from(a[c] - b[c]).powi(2)));
        // All that it shows is seen by others, but for its very rim.
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
    capture(&folder.join("wall"));
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
    // Changed since: told, not refused.
    capture(&folder.join("wall"));
    let wider = std::fs::read_to_string(folder.join("wall/mesh.ply")).unwrap().replace("3 2 0", "3.5 2 0");
    std::fs::write(folder.join("wall/mesh.ply"), wider).unwrap();
    let info: Value = serde_json::from_str(&done(folder, "info wall.fbrush --json")).unwrap();
    assert_eq!(info["project"]["scene_state"], "changed");
}
