//! `export --web`, end to end: the slices are what `render` draws, and clicks in a browser focus on what is there.

#[allow(dead_code, reason = "shared with other tests")]
#[path = "../card_light_field/mod.rs"]
mod card_light_field;
#[allow(dead_code, reason = "shared with the tests of `web-page`")]
#[path = "../../../crates/web-page/tests/browser/chromium.rs"]
mod chromium;
mod engine_page;
mod exported_page;
mod kinds;
#[path = "../program/mod.rs"]
mod program;
#[path = "../../../crates/session/tests/tiny_glb/mod.rs"]
mod tiny_glb;
#[allow(dead_code, reason = "shared with other tests")]
#[path = "../wall_capture/mod.rs"]
mod wall_capture;

use chromium::Chromium;
use exported_page::{ExportedPage, Shown};
use program::{done, run};
use project::{LinearPicture, read_picture};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The demo's size in these tests.
const SIZE: [u32; 2] = [192, 108];

fn demo() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/demo").canonicalize().unwrap()
}

/// The demo's camera, focused on a reciprocal distance.
fn write_camera(file: &Path, inverse_distance: f64) {
    let text = std::fs::read_to_string(demo().join("demo.camera.json")).unwrap();
    let mut camera: Value = serde_json::from_str(&text).unwrap();
    let distance = if inverse_distance > 0.0 { json!(1.0 / inverse_distance) } else { json!("inf") };
    camera["focus_distance"] = distance;
    std::fs::write(file, camera.to_string()).unwrap();
}

/// A point of the picture, and the reciprocal distances that make it sharp for the ordinary lens and as painted.
struct KnownPoint {
    pixel: [u32; 2],
    ordinary: f64,
    painted: Option<f64>,
}

/// Points all over the picture around which depth and paint are even, from the layers of a rendered picture.
fn known_points(picture: &LinearPicture) -> Vec<KnownPoint> {
    let layer = |name: &str, [x, y]: [u32; 2]| f64::from(picture.layers[name][(y * SIZE[0] + x) as usize]);
    let camera: Value =
        serde_json::from_str(&std::fs::read_to_string(demo().join("demo.camera.json")).unwrap()).unwrap();
    let number = |name: &str| camera[name].as_f64().unwrap();
    let image_distance = number("sensor_height") / (2.0 * (number("yfov") / 2.0).tan());
    let point = |pixel: [u32; 2]| {
        let around =
            (pixel[0] - 2..=pixel[0] + 2).flat_map(|x| (pixel[1] - 2..=pixel[1] + 2).map(move |y| [x, y]));
        let nearness = |at| 1.0 / layer("depth.Z", at);
        let is_even = around.clone().all(|at| {
            (nearness(at) - nearness(pixel)).abs() < 0.03
                && ["t", "anchor"].iter().all(|name| layer(name, at) == layer(name, pixel))
        });
        let [t, anchor] = ["t", "anchor"].map(|name| layer(name, pixel));
        let painted = nearness(pixel) - (t - 1.0) / (image_distance * t * (1.0 - anchor));
        let painted = Some(painted).filter(|_| anchor < 1.0);
        is_even.then(|| KnownPoint { pixel, ordinary: nearness(pixel), painted })
    };
    let grid = (0..8).flat_map(|row| (0..12).map(move |column| [8 + 16 * column, 6 + 13 * row]));
    grid.filter_map(point).collect()
}

#[test]
fn the_demo_as_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let project = demo().join("demo.fbrush").display().to_string();
    let size = format!("{}x{}", SIZE[0], SIZE[1]);
    let report = done(
        place,
        &format!(
            "export {project} --web page.html --size {size} --apertures 1,2 --url https://example.org/a/page.html --json"
        ),
    );
    let report: Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["files"], json!(["page.html", "page.poster.png"]));
    assert_eq!(report["page"]["bytes"], place.join("page.html").metadata().unwrap().len());
    let stacks = report["page"]["stacks"].as_array().unwrap();
    let kinds: Vec<_> = stacks.iter().map(|stack| (&stack["aperture"], &stack["painted"])).collect();
    let [wide, half] = [json!("f/1.08"), json!("f/2.15")];
    let [yes, no] = [json!(true), json!(false)];
    assert_eq!(kinds, [(&wide, &yes), (&wide, &no), (&half, &yes)]);
    for stack in stacks {
        let number = |value: &Value| value.as_f64().unwrap();
        assert!((0.0..=1.0 + 1e-9).contains(&number(&stack["largest_blur_px"])), "{stack}");
        assert!(number(&stack["at_rest"]["lowest"]) >= 40.0, "{stack}");
        assert!(number(&stack["midway"]["lowest"]) >= 38.0, "{stack}");
    }

    // Slices are what `render` draws, exactly.
    let page = ExportedPage::read(&place.join("page.html"));
    assert!(
        page.html.contains(r#"<meta property="og:image" content="https://example.org/a/page.poster.png">"#)
    );
    let opening = page.opening();
    assert!((opening.inverse_distance - 1.0 / 0.72).abs() < 1e-6, "it opens as the project is focused");
    let psnr = |shown: &Shown, exact: &str| {
        shown.picture.save(place.join("slice.png")).unwrap();
        let compared: Value =
            serde_json::from_str(&done(place, &format!("compare slice.png {exact} --json"))).unwrap();
        compared["psnr"].as_f64().unwrap()
    };
    let farthest = page.slice(2, 0);
    let a_difference = page.slice(0, 1);
    assert!(page.differences().iter().all(|&count| count > 3), "{:?}", page.differences());
    let half = "--aperture-radius 0.010250000283122063";
    for (shown, lens) in [(&a_difference, ""), (&opening, ""), (&farthest, half)] {
        write_camera(&place.join("camera.json"), shown.inverse_distance);
        done(place, &format!("render {project} --camera camera.json {lens} --size {size} -o exact.png"));
        assert!(psnr(shown, "exact.png") >= 40.0, "{} dB", psnr(shown, "exact.png"));
    }
    assert!(psnr(&opening, "exact.png") < 25.0, "another distance and aperture look different");
    assert!(psnr(&opening, "page.poster.png") >= 40.0);

    done(place, &format!("render {project} --size {size} --renderer blur -o layers.exr --aov depth,t"));
    let points = known_points(&read_picture(&place.join("layers.exr")).unwrap());
    let stays_so = points.iter().filter(|point| point.painted.is_none()).count();
    assert!(points.len() >= 20 && stays_so >= 2, "{} points, of which {stays_so} stay so", points.len());
    click_points(&place.join("page.html"), &page, &points);
}

/// Clicks the points in a browser, first as painted, then for the ordinary lens.
fn click_points(file: &Path, page: &ExportedPage, points: &[KnownPoint]) {
    let Some(mut browser) = Chromium::start() else { return };
    let address = format!("file://{}", file.display());
    browser.open(&address);
    browser.wait_for("document.getElementById('viewer').dataset.drawn !== undefined");
    let rectangle = browser.evaluate("(() => { const r = document.getElementById('screen').getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; })()");
    let [left, top, width, height]: [f64; 4] = std::array::from_fn(|k| rectangle[k].as_f64().unwrap());
    for (stack, key) in [(0, None), (1, Some("p"))] {
        if let Some(key) = key {
            browser.key(key);
            browser.wait_for("document.getElementById('viewer').dataset.drawn.startsWith('1/')");
        }
        for point in points {
            let [x, y] = [0, 1].map(|axis| (f64::from(point.pixel[axis]) + 0.5) / f64::from(SIZE[axis]));
            browser.evaluate("document.getElementById('message').textContent = ''");
            let before = browser.evaluate("document.getElementById('viewer').dataset.drawn");
            browser.click([left + x * width, top + y * height]);
            browser.wait_for("document.getElementById('message').textContent !== ''");
            let message = browser.evaluate("document.getElementById('message').textContent");
            let sharp = if stack == 0 { point.painted } else { Some(point.ordinary) };
            let Some(sharp) = sharp else {
                assert_eq!(message, "Painted, stays so", "{:?}", point.pixel);
                assert_eq!(browser.evaluate("document.getElementById('viewer').dataset.drawn"), before);
                continue;
            };
            // Within a slice of the sharp distance, once it is drawn.
            browser.wait_for("document.getElementById('screen').ariaBusy === 'false'");
            let drawn =
                browser.evaluate("Number(document.getElementById('viewer').dataset.drawn.split('/')[1])");
            let expected = page.nearest_slice(stack, sharp) as f64;
            assert!((drawn.as_f64().unwrap() - expected).abs() <= 1.0, "{drawn} instead of {expected}");
        }
    }
    assert_eq!(browser.complaints(&[&address]), Vec::<String>::new());
}

/// A project of the small scene, whose camera has an aperture radius of `radius`.
fn small_project(place: &Path, radius: f64) {
    let camera = json!({"width": 96, "height": 64, "focus_distance": 2.0, "aperture_radius": radius, "sensor_height": 0.1});
    tiny_glb::write(&place.join("quads.glb"));
    std::fs::write(place.join("camera.json"), camera.to_string()).unwrap();
    std::fs::write(place.join("focus.json"), r#"{"nodes": {"card": {"t": 1.2, "anchor": 1}}}"#).unwrap();
    done(place, "new quads.glb --camera camera.json --focus focus.json -o p.fbrush");
}

#[test]
fn what_cannot_be_a_page_is_refused_with_a_cure() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let fails = |arguments: &str, code: i32, words: [&str; 2]| {
        let output = run(place, arguments);
        let errors = String::from_utf8_lossy(&output.stderr);
        let line = errors.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
        assert!(output.status.code() == Some(code) && line.ends_with(')'), "{arguments}: {errors}");
        assert!(words.iter().all(|word| line.contains(word)), "{arguments}: {line}");
        assert!(!place.join("page.html").exists());
    };
    small_project(place, 0.1);
    fails("export p.fbrush --web page.txt", 2, ["page.txt", ".html"]);
    fails("export p.fbrush --web nowhere/page.html", 3, ["nowhere/page.html", "create it"]);
    fails("export p.fbrush --web page.html --apertures 2,1", 3, ["page.html", "ascending"]);
    fails("export p.fbrush --web page.html --url page.html", 3, ["page.html", "https://"]);
    fails("export p.fbrush --web page.html --size 16384x9", 3, ["16384 × 9", "16383"]);
    for (wrong, said) in [("--apertures 0.5", "1 or more"), ("--size 9", "WIDTHxHEIGHT")] {
        let output = run(place, &format!("export p.fbrush --web page.html {wrong}"));
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && errors.contains(said), "{wrong}: {errors}");
    }
    small_project(place, 0.0);
    fails("export p.fbrush --web page.html", 3, ["pinhole", "aperture radius"]);
    // The demo's depth is continuous.
    let text = std::fs::read_to_string(demo().join("demo.camera.json")).unwrap();
    let mut camera: Value = serde_json::from_str(&text).unwrap();
    camera["aperture_radius"] = json!(30.0);
    std::fs::write(place.join("camera.json"), camera.to_string()).unwrap();
    done(place, &format!("new {}/demo.glb --camera camera.json -o wide.fbrush", demo().display()));
    fails("export wide.fbrush --web page.html", 3, ["1000 slices", "smaller aperture"]);
}

#[test]
fn an_unpainted_project_has_the_ordinary_lens_only() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    small_project(place, 0.1);
    done(place, "new quads.glb --camera camera.json -o plain.fbrush");
    let report = done(place, "export plain.fbrush --web page.html --apertures 1,3 --json");
    let report: Value = serde_json::from_str(&report).unwrap();
    let painted: Vec<_> =
        report["page"]["stacks"].as_array().unwrap().iter().map(|stack| stack["painted"].clone()).collect();
    assert_eq!(painted, [false, false]);
    let page = ExportedPage::read(&place.join("page.html"));
    assert!(page.html.contains("<title>plain</title>"), "named after the project");
    assert_eq!(page.data["maps"]["paint"], Value::Null);
    let Shown { inverse_distance, .. } = page.opening();
    assert!((inverse_distance - 0.5).abs() < 1e-9);
}

#[cfg(unix)]
#[test]
fn a_signal_ends_it_and_leaves_no_page() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    small_project(place, 0.4);
    let mut running = Command::new(env!("CARGO_BIN_EXE_focus-brush"))
        .args("export p.fbrush --web page.html --size 960x640".split(' '))
        .current_dir(place)
        .env("XDG_CACHE_HOME", place.join("cache"))
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(running.stderr.take().unwrap()).lines().map_while(Result::ok);
    assert!(lines.any(|line| line.starts_with("slices at ")), "it draws");
    Command::new("kill").args(["-TERM", &running.id().to_string()]).status().unwrap();
    assert_eq!(running.wait().unwrap().code(), Some(75));
    let left: Vec<_> = std::fs::read_dir(place).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(!left.iter().any(|name| name.to_string_lossy().contains("page")), "{left:?}");
}
