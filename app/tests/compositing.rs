//! Output for compositing: alpha, Cryptomatte, overscan, circles of confusion, colour spaces, the pinhole
//! picture.

mod program;
#[path = "../../crates/session/tests/tiny_glb/mod.rs"]
#[allow(dead_code, reason = "the scene is one of its own")]
mod tiny_glb;

use program::{done, run};
use project::{LinearPicture, read_picture};
use std::collections::BTreeMap;
use std::path::Path;
use tempfile::TempDir;
use tiny_glb::Quad;

/// A wall with background at its sides, and a card and a dot in front of it.
const QUADS: [Quad; 3] = [
    Quad { name: "wall", center: [0.0, -0.3], half: [1.2, 0.8], depth: 4.0, color: [0.3, 0.35, 0.4] },
    Quad { name: "card", center: [-0.45, 0.1], half: [0.2, 0.3], depth: 1.5, color: [0.8, 0.1, 0.1] },
    Quad { name: "dot", center: [0.8, 0.5], half: [0.15, 0.15], depth: 3.0, color: [1.0, 1.0, 0.6] },
];
const CAMERA: &str =
    r#"{"width": 60, "height": 40, "focus_distance": 3.0, "aperture_radius": 0.1, "sensor_height": 0.1}"#;
const RECIPE: &str = r#"{"nodes": {"card": {"t": 1.2, "anchor": 1}, "wall": {"t": 0.9, "anchor": 0.5}}}"#;

fn workplace() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    put("scene.glb", &tiny_glb::glb(&QUADS));
    put("camera.json", CAMERA.as_bytes());
    put("recipe.json", RECIPE.as_bytes());
    put("blue.json", br#"{"environment": [1, 1, 1], "backdrop": [0.2, 0.5, 0.9]}"#);
    folder
}

/// Renders the scene with additional options.
fn rendered(folder: &Path, options: &str) -> LinearPicture {
    done(folder, &format!("render scene.glb --camera camera.json -o out.exr --backend cpu {options}"));
    read_picture(&folder.join("out.exr")).unwrap()
}

fn fails(folder: &Path, options: &str, code: i32, word: &str) {
    let output = run(folder, &format!("render scene.glb --camera camera.json {options}"));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{options}: {errors}");
    assert!(errors.contains("error: ") && errors.contains(word), "{options}: {errors}");
}

fn psnr(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    let squares = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| f64::from(a - b).powi(2));
    -10.0 * (squares.sum::<f64>() / (3 * a.len()) as f64).log10()
}

/// The coverage of each object, by the bits of its id.
fn shares(picture: &LinearPicture, kind: &str) -> BTreeMap<u32, Vec<f32>> {
    let mut things: BTreeMap<u32, Vec<f32>> = BTreeMap::new();
    for pair in 0.. {
        let Some(first) = picture.layers.get(&format!("Crypto{kind}{pair:02}.R")) else { break };
        let of = |channel| &picture.layers[&format!("Crypto{kind}{pair:02}.{channel}")];
        for (ids, shares) in [(first, of("G")), (of("B"), of("A"))] {
            for (pixel, (id, share)) in ids.iter().zip(shares).enumerate() {
                if *id == 0.0 {
                    assert_eq!(*share, 0.0, "nothing has no share");
                } else {
                    things.entry(id.to_bits()).or_insert_with(|| vec![0.0; ids.len()])[pixel] += share;
                }
            }
        }
    }
    things
}

#[test]
fn a_picture_over_a_backdrop_is_the_picture_before_it() {
    let folder = workplace();
    for focus in ["", "--focus recipe.json"] {
        for renderer in ["", "--renderer truth --spp 64"] {
            let options = format!("--world blue.json {focus} {renderer}");
            let before = rendered(folder.path(), &options);
            let matted = rendered(folder.path(), &format!("{options} --aov alpha"));
            let alpha = &matted.layers["A"];
            assert!(alpha.iter().all(|alpha| (0.0..=1.0).contains(alpha)));
            assert!(alpha.contains(&0.0) && alpha.iter().any(|alpha| *alpha > 0.999), "both are seen");
            let over = |(rgb, alpha): (&[f32; 3], &f32)| {
                let mut over = [0.2, 0.5, 0.9].map(|c| (1.0 - alpha) * c);
                (0..3).for_each(|c| over[c] += rgb[c]);
                over
            };
            let over: Vec<_> = matted.rgb.iter().zip(alpha).map(over).collect();
            let found = psnr(&over, &before.rgb);
            assert!(found >= 45.0, "{options}: {found} dB");
            let control = psnr(&matted.rgb, &before.rgb);
            assert!(control < 20.0, "{options}: {control} dB without the backdrop");
        }
    }
}

#[test]
fn cryptomatte_sums_to_alpha_and_is_the_truths() {
    let folder = workplace();
    for focus in ["", "--focus recipe.json"] {
        let aovs = format!("--aov alpha,crypto {focus}");
        let splat = rendered(folder.path(), &format!("--cells 2 {aovs}"));
        let truth = rendered(folder.path(), &format!("--renderer truth --spp 256 {aovs}"));
        for kind in ["Object", "Material"] {
            let [of_splat, of_truth] = [&splat, &truth].map(|picture| shares(picture, kind));
            assert_eq!(of_splat.len(), QUADS.len(), "{kind}");
            assert!(of_splat.keys().eq(of_truth.keys()));
            for (things, picture) in [(&of_splat, &splat), (&of_truth, &truth)] {
                for (pixel, alpha) in picture.layers["A"].iter().enumerate() {
                    let sum: f32 = things.values().map(|shares| shares[pixel]).sum();
                    assert!((sum - alpha).abs() <= 1e-4, "{kind} {focus}: {sum} is not {alpha}");
                }
            }
            for (thing, shares) in &of_splat {
                let squares = shares.iter().zip(&of_truth[thing]).map(|(a, b)| (a - b).powi(2));
                let error = (squares.sum::<f32>() / shares.len() as f32).sqrt();
                assert!(error <= 0.01, "{kind} {focus}: {error}");
            }
        }
        // Objects and materials coincide here, under different names.
        let [objects, materials] = ["Object", "Material"].map(|kind| shares(&splat, kind));
        let sums = |things: &BTreeMap<u32, Vec<f32>>| {
            let mut sums: Vec<f32> = things.values().map(|shares| shares.iter().sum()).collect();
            sums.sort_by(f32::total_cmp);
            sums
        };
        assert!(sums(&objects).iter().zip(sums(&materials)).all(|(a, b)| (a - b).abs() < 1e-2));
        assert!(objects.keys().all(|id| !materials.contains_key(id)));
    }
}

#[test]
fn overscan_shows_what_lies_around_the_same_picture() {
    let folder = workplace();
    let frame = rendered(folder.path(), "--aov depth,coc --coc-convention flame");
    // Cropped to its display window, it equals the frame.
    let larger = rendered(folder.path(), "--overscan 16 --aov depth,coc --coc-convention flame");
    assert_eq!((larger.width, larger.height), (60, 40));
    assert!(psnr(&frame.rgb, &larger.rgb) > 45.0, "{}", psnr(&frame.rgb, &larger.rgb));
    for layer in ["depth.Z", "coc"] {
        let pairs = frame.layers[layer].iter().zip(&larger.layers[layer]);
        let apart = pairs.filter(|(a, b)| a != b && (**a - **b).abs() > 1e-5).count();
        assert!(apart <= 4, "{layer}: {apart} pixels, of which rays meet an edge");
    }
    done(folder.path(), "bake scene.glb --camera camera.json -o field.salf");
    let refused = run(folder.path(), "render field.salf -o x.exr --overscan 4");
    assert_eq!(refused.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--overscan"));
}

#[test]
fn the_pinholes_picture_is_sharp_and_comes_along() {
    let folder = workplace();
    let both = rendered(folder.path(), "--aov pinhole,alpha");
    let sharp = rendered(folder.path(), "--aperture-radius 0 --aov alpha");
    let layer = |channel: &str| &both.layers[&format!("pinhole.{channel}")];
    let pixels = layer("R").iter().zip(layer("G")).zip(layer("B"));
    let pinhole: Vec<_> = pixels.map(|((r, g), b)| [*r, *g, *b]).collect();
    assert_eq!(pinhole, sharp.rgb);
    assert_eq!(layer("A"), &sharp.layers["A"]);
    assert!(psnr(&both.rgb, &pinhole) < 30.0, "the picture itself is not sharp");
}

/// One golden picture per convention of circles of confusion; `UPDATE_GOLDEN=1 cargo test` updates them.
#[test]
fn circles_of_confusion_are_told_in_four_conventions() {
    let folder = workplace();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/coc");
    let mut pictures = Vec::new();
    for convention in ["signed-px", "nuke", "magicdefocus", "flame"] {
        let options = format!("--size 24x16 --focus recipe.json --aov coc --coc-convention {convention}");
        let written = format!("render scene.glb --camera camera.json -o {convention}.png {options}");
        done(folder.path(), &written);
        let (file, golden) =
            (folder.path().join(format!("{convention}.coc.exr")), golden.join(format!("{convention}.exr")));
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            std::fs::copy(&file, &golden).unwrap();
        }
        let [made, golden] = [&file, &golden].map(|file| read_picture(file).unwrap());
        for (made, golden) in made.rgb.iter().zip(&golden.rgb) {
            assert!(
                (made[0] - golden[0]).abs() <= 1e-4 * golden[0].abs().max(1.0),
                "{convention}: {made:?} {golden:?}"
            );
        }
        pictures.push(made.rgb.iter().map(|rgb| rgb[0]).collect::<Vec<_>>());
    }
    let [signed, nuke, magic, flame] = &pictures[..] else { unreachable!("four") };
    assert!(signed.iter().any(|d| *d < -0.5) && signed.iter().any(|d| *d > 0.5), "near and far");
    for (pixel, diameter) in signed.iter().enumerate() {
        assert_eq!((nuke[pixel], magic[pixel]), (diameter / 2.0, -diameter / 2.0));
        assert!((flame[pixel] - (0.5 + diameter / 32.0).clamp(0.0, 1.0)).abs() < 1e-6);
    }
}

#[test]
fn other_colours_are_the_same_picture_and_png_has_straight_alpha() {
    let folder = workplace();
    let own = rendered(folder.path(), "--aov alpha,pinhole");
    done(
        folder.path(),
        "render scene.glb --camera camera.json -o aces.exr --color-space acescg --half --compression piz",
    );
    done(folder.path(), "render scene.glb --camera camera.json -o plain.exr");
    let [aces, plain] =
        ["aces.exr", "plain.exr"].map(|file| read_picture(&folder.path().join(file)).unwrap());
    assert!(psnr(&aces.rgb, &plain.rgb) > 60.0, "read as what it is: {}", psnr(&aces.rgb, &plain.rgb));
    done(folder.path(), "render scene.glb --camera camera.json -o out.png --aov alpha,crypto");
    let png = image::open(folder.path().join("out.png")).unwrap();
    assert!(png.color().has_alpha());
    for (pixel, (rgb, alpha)) in png.into_rgba8().pixels().zip(own.rgb.iter().zip(&own.layers["A"])) {
        assert_eq!(pixel[3], (alpha * 255.0).round() as u8);
        if *alpha > 0.05 {
            let straight = scene::srgb_from_linear((rgb[0] / alpha).clamp(0.0, 1.0)) * 255.0;
            assert!((f32::from(pixel[0]) - straight).abs() <= 0.51, "{pixel:?} {straight}");
        }
    }
    assert!(folder.path().join("out.crypto.exr").is_file());
    done(folder.path(), "render scene.glb --camera camera.json -o opaque.png");
    assert!(!image::open(folder.path().join("opaque.png")).unwrap().color().has_alpha());
}

#[test]
fn what_cannot_be_is_refused_before_the_work() {
    let folder = workplace();
    let folder = folder.path();
    fails(folder, "-o x.exr --aov crypto --compression dwaa", 2, "Cryptomatte");
    fails(folder, "-o x.exr --aov alpha --renderer blur", 2, "alpha");
    fails(folder, "-o x.png --half", 2, "--half");
    fails(folder, "-o x.png --overscan 8", 2, "--overscan");
    fails(folder, "-o x.png --color-space acescg", 2, "--color-space");
    fails(folder, "-o x.png --compression piz", 2, "--compression");
    fails(folder, "-o x.exr --coc-convention fusion", 2, "magicdefocus");
    fails(folder, "-o x.exr --overscan 8 --stereo anaglyph", 2, "--overscan");
    assert!(!folder.join("x.exr").exists() && !folder.join("x.png").exists());
}
