//! `export --web --engine`, end to end: the page draws and paints in the same bytes as the program.

use crate::chromium::Chromium;
use crate::exported_page::{ExportedPage, decode_base122};
use crate::program::done;
use crate::{demo, small_project};
use flate2::read::ZlibDecoder;
use serde_json::{Value, json};
use std::io::Read;
use std::path::Path;
use web_engine::{ApertureChoice, Engine, FieldOfPage, LensChoice, PageBrush, Paint};

/// Keeps what the page offers for download.
const KEEP_DOWNLOADS: &str = "const make = URL.createObjectURL;
URL.createObjectURL = (blob) => { blob.text().then((text) => { window.downloaded = text; }); return make(blob); };
HTMLAnchorElement.prototype.click = () => {};";

/// A page that is open, and the engine of the program with the same light field.
struct OpenPage {
    browser: Chromium,
    engine: Engine,
    /// Left, top, width and height of the stage, px.
    stage: [f64; 4],
}

impl OpenPage {
    /// `None` without a browser.
    fn open(file: &Path) -> Option<Self> {
        let page = ExportedPage::read_as(file, "showEnginePage");
        let mut field = Vec::new();
        let packed = decode_base122(page.data["field"].as_str().unwrap());
        ZlibDecoder::new(&*packed).read_to_end(&mut field).unwrap();
        let engine = Engine::new(FieldOfPage::from_bytes(&field).unwrap());
        let mut browser = Chromium::start()?;
        browser.call("Page.addScriptToEvaluateOnNewDocument", json!({"source": KEEP_DOWNLOADS}));
        browser.open(&format!("file://{}", file.display()));
        browser.wait_for("document.getElementById('viewer').dataset.drawn === 'full'");
        let rectangle = browser.evaluate("(() => { const r = document.getElementById('stage').getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; })()");
        let stage = std::array::from_fn(|k| rectangle[k].as_f64().unwrap());
        Some(Self { browser, engine, stage })
    }

    fn at(&self, x: f64, y: f64) -> [f64; 2] {
        let [left, top, width, height] = self.stage;
        [left + x * width, top + y * height]
    }

    fn number(&mut self, expression: &str) -> f64 {
        let value = self.browser.evaluate(&format!("Number({expression})"));
        value.as_f64().unwrap()
    }

    /// The lens that the page says it shows.
    fn lens(&mut self) -> LensChoice {
        self.browser.wait_for("document.getElementById('screen').ariaBusy === 'false'");
        let [inverse_distance, aperture_share, blades, painted] =
            ["inverseDistance", "apertureShare", "blades", "isPainted"]
                .map(|name| self.number(&format!("document.getElementById('viewer').dataset.{name}")));
        let aperture = match blades as u32 {
            0 => ApertureChoice::Exported,
            1 => ApertureChoice::Disc,
            blades => ApertureChoice::Blades(blades),
        };
        LensChoice { inverse_distance, aperture_share, aperture, is_painted: painted == 1.0 }
    }

    /// The bytes on the canvas are those of the engine. Returns the lens.
    fn check(&mut self, what: &str) -> LensChoice {
        let lens = self.lens();
        self.engine.refocus(lens, false).unwrap();
        let screen = self.engine.screen();
        // 32-bit FNV-1a of all bytes, as numbers of JavaScript have it.
        let expression = "(() => { const c = document.getElementById('screen'); const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let h = 2166136261; for (const b of d) h = Math.imul(h ^ b, 16777619) >>> 0; return [c.width, c.height, h]; })()";
        let hash = screen
            .pixels
            .as_flattened()
            .iter()
            .fold(2_166_136_261u32, |hash, byte| (hash ^ u32::from(*byte)).wrapping_mul(16_777_619));
        let shown = self.browser.evaluate(expression);
        assert_eq!(shown, json!([screen.size[0], screen.size[1], hash]), "{what}: {lens:?}");
        lens
    }

    fn drag(&mut self, path: &[[f64; 2]]) {
        let button = json!({"button": "left", "buttons": 1, "clickCount": 1});
        let first = self.at(path[0][0], path[0][1]);
        self.browser.mouse("mousePressed", first, button.clone());
        for [x, y] in path {
            let at = self.at(*x, *y);
            self.browser.mouse("mouseMoved", at, button.clone());
        }
        let last = path[path.len() - 1];
        let last = self.at(last[0], last[1]);
        self.browser.mouse("mouseReleased", last, button);
    }

    /// The strokes that the page offers for download.
    fn strokes(&mut self) -> Value {
        self.browser.evaluate("window.downloaded = undefined");
        self.browser.evaluate("document.getElementById('save-strokes').click()");
        self.browser.wait_for("window.downloaded !== undefined");
        let text = self.browser.evaluate("window.downloaded");
        serde_json::from_str(text.as_str().unwrap()).unwrap()
    }

    /// Paints with the engine what was recorded last, as the page has painted it.
    fn repeat_last_stroke(&mut self, paint: Paint) -> Value {
        let strokes = self.strokes();
        let stroke = strokes["steps"].as_array().unwrap().last().unwrap()["stroke"].clone();
        let radius_px = self
            .number("document.getElementById('brush-size').value * document.getElementById('screen').height");
        let points: Vec<[f64; 3]> = serde_json::from_value(stroke["points"].clone()).unwrap();
        let brush = PageBrush { radius_px, hardness: 0.5, paint };
        assert!(self.engine.begin_stroke(brush, points[0][0], points[0][1]));
        let (radius, target) = self.engine.stroke_facts().unwrap();
        assert_eq!(stroke["brush"]["radius"].as_f64(), Some(radius));
        assert_eq!(stroke["brush"]["target"]["t"].as_f64(), Some(target.t));
        for [x, y, _] in &points[1..] {
            self.engine.extend_stroke(*x, *y);
        }
        self.engine.end_stroke();
        strokes
    }
}

#[test]
fn the_demo_to_paint_on() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let project = demo().join("demo.fbrush").display().to_string();
    done(place, &format!("export {project} --web page.html --engine --size 192x108 --title Fox"));
    let file = place.join("page.html");
    assert!(file.metadata().unwrap().len() < 3_000_000);
    let Some(mut page) = OpenPage::open(&file) else { return };

    let unnamed = "[...document.querySelectorAll('button, input')].filter((e) => !(e.ariaLabel || e.textContent.trim() || e.labels?.length)).length";
    assert_eq!(page.browser.evaluate(unnamed), 0, "every control has a name for screen readers");

    // Ten states of the lens.
    let opening = page.check("as it opens");
    assert!((opening.inverse_distance - 1.0 / 0.72).abs() < 1e-6, "{opening:?}");
    for (x, y) in [(0.35, 0.62), (0.1, 0.9), (0.72, 0.2)] {
        let at = page.at(x, y);
        page.browser.click(at);
        let lens = page.check("after a click");
        let sharp = page.engine.sharp_inverse_distance(x, y).flatten();
        assert!(
            sharp.is_none_or(|sharp| (lens.inverse_distance - sharp.max(0.0)).abs() < 0.02),
            "{x} {y}: {sharp:?}"
        );
    }
    for key in ["Home", "End", "ArrowLeft", "]", "]", "["] {
        page.browser.key(key);
        page.check(key);
    }
    page.browser.evaluate("document.querySelectorAll('#shape input')[2].click()");
    assert_eq!(page.check("with six blades").aperture, ApertureChoice::Blades(6));

    page.browser.key("p");
    assert!(!page.check("with the ordinary lens").is_painted);
    page.browser.key("p");
    page.check("as painted again");

    // A drag racks: drafts, then the whole picture.
    page.drag(&[[0.62, 0.5], [0.5, 0.5], [0.4, 0.5]]);
    page.browser.wait_for("document.getElementById('viewer').dataset.drawn === 'full'");
    let lens = page.check("after a drag");
    assert!(lens.inverse_distance > 0.0);

    page.browser.key("t");
    let tint = "(() => { const c = document.getElementById('tint'); const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let n = 0; for (let k = 3; k < d.length; k += 4) n += d[k] ? 1 : 0; return n; })()";
    let painted = page.engine.paint_map().iter().filter(|code| **code > 0).count();
    assert_eq!(page.browser.evaluate(tint), painted, "all that is painted is tinted");
    assert!(painted > 100);
    page.browser.key("t");

    // Paint, and its history.
    let before = page.browser.evaluate("document.getElementById('screen').toDataURL()");
    page.browser.key("b");
    page.browser.key("b");
    page.drag(&[[0.3, 0.55], [0.36, 0.6], [0.4, 0.75], [0.37, 0.8]]);
    page.browser.wait_for("document.getElementById('screen').ariaBusy === 'false'");
    let circle = page.number(
        "document.getElementById('brush-blur').value * 0.25 * document.getElementById('screen').height",
    );
    page.repeat_last_stroke(Paint::Circle(circle));
    page.check("with a blurred stroke");
    page.browser.key("b");
    page.drag(&[[0.38, 0.76], [0.39, 0.78]]);
    page.browser.wait_for("document.getElementById('screen').ariaBusy === 'false'");
    let strokes = page.repeat_last_stroke(Paint::OrdinaryLens);
    page.check("with an erased stroke");
    assert_eq!(strokes["steps"].as_array().unwrap().len(), 2);
    page.browser.evaluate("document.getElementById('undo').click(); document.getElementById('undo').click()");
    page.browser.wait_for("document.getElementById('screen').ariaBusy === 'false'");
    assert_eq!(page.browser.evaluate("document.getElementById('screen').toDataURL()"), before, "undone");
    page.browser.evaluate("document.getElementById('redo').click()");
    let strokes = page.strokes();
    assert_eq!(strokes["steps"].as_array().unwrap().len(), 1);
    let address = format!("file://{}", file.display());
    assert_eq!(page.browser.complaints(&[&address]), Vec::<String>::new());

    // The program replays the stroke on the project: the fox is blurred there, too.
    std::fs::write(place.join("strokes.json"), strokes.to_string()).unwrap();
    done(place, &format!("replay {project} strokes.json -o painted.fbrush"));
    let start: [f64; 3] = serde_json::from_value(strokes["steps"][0]["stroke"]["points"][0].clone()).unwrap();
    let pixel = (start[1] * 108.0) as usize * 192 + (start[0] * 192.0) as usize;
    let t_of = |project: &str| {
        done(place, &format!("render {project} --size 192x108 --renderer blur -o layers.exr --aov t"));
        let picture = project::read_picture(&place.join("layers.exr")).unwrap();
        f64::from(picture.layers["t"][pixel])
    };
    let target = strokes["steps"][0]["stroke"]["brush"]["target"]["t"].as_f64().unwrap();
    assert!((t_of("painted.fbrush") - target).abs() < 1e-3, "{} {target}", t_of("painted.fbrush"));
    assert!((t_of(&project) - target).abs() > 1e-3);
}

#[test]
fn contradicting_options_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    small_project(place, 0.1);
    for wrong in ["--engine", "--web p.html --engine --apertures 1,2", "--web p.html --engine --painted-only"]
    {
        let output = crate::run(place, &format!("export p.fbrush {wrong}"));
        assert_eq!(output.status.code(), Some(2), "{wrong}");
        assert!(!place.join("p.html").exists());
    }
}
