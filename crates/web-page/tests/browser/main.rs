//! The page in a browser: from a disk, from a server and in a sandboxed frame it works alike, and requests nothing.

mod chromium;
mod server;
mod synthetic_page;

use chromium::Chromium;
use serde_json::json;
use std::path::Path;
use synthetic_page::{HOSTILE, PATCHES, SIZE, SLICES, grey, ordinary, painted};

/// Counts decoded pictures, now and at most.
const COUNT_DECODED: &str = "window.decoded = 0; window.mostDecoded = 0;
const decode = window.createImageBitmap, close = ImageBitmap.prototype.close;
window.createImageBitmap = (...a) => { mostDecoded = Math.max(mostDecoded, ++decoded); return decode(...a); };
ImageBitmap.prototype.close = function () { --decoded; close.call(this); };";

/// A page that is open, at the top or in a frame.
struct OpenPage {
    browser: Chromium,
    /// Its execution context, in a frame.
    context: Option<i64>,
    /// Where its stage lies: left, top, width, height, px.
    stage: [f64; 4],
}

impl OpenPage {
    /// Opens the page, counting its decoded pictures. `None` without a browser.
    fn open(address: &str, is_framed: bool) -> Option<Self> {
        let mut browser = Chromium::start()?;
        browser.call("Page.addScriptToEvaluateOnNewDocument", json!({"source": COUNT_DECODED}));
        browser.open(address);
        let context = is_framed.then(|| *browser.contexts().last().unwrap());
        let mut page = Self { browser, context, stage: [0.0; 4] };
        page.wait_for("document.getElementById('viewer').dataset.drawn !== undefined");
        page.measure();
        Some(page)
    }

    fn evaluate(&mut self, expression: &str) -> serde_json::Value {
        self.browser.evaluate_in(self.context, expression)
    }

    fn text(&mut self, expression: &str) -> String {
        self.evaluate(expression).as_str().unwrap_or_default().to_owned()
    }

    fn wait_for(&mut self, expression: &str) {
        self.browser.wait_for_in(self.context, expression);
    }

    /// Finds where the stage lies. A frame lies at the window's upper left corner.
    fn measure(&mut self) {
        let rectangle = "(() => { const r = document.getElementById('stage').getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; })()";
        let numbers = self.evaluate(rectangle);
        self.stage = std::array::from_fn(|k| numbers[k].as_f64().unwrap());
    }

    /// The point of the window of a point of the picture, from 0 to 1.
    fn point(&self, x: f64, y: f64) -> [f64; 2] {
        let [left, top, width, height] = self.stage;
        [left + x * width, top + y * height]
    }

    /// The middle of a patch.
    fn patch(&self, patch: u32) -> [f64; 2] {
        let share = |index: u32, count: u32| (f64::from(index) + 0.5) / f64::from(count);
        self.point(share(patch % PATCHES[0], PATCHES[0]), share(patch / PATCHES[0], PATCHES[1]))
    }

    /// Stack and slice on the screen, at rest, as the page says and as its pixels are.
    fn shown(&mut self) -> [usize; 2] {
        // At once: a fade may be at its end.
        let shown = self.evaluate(
            "[document.getElementById('viewer').dataset.drawn, \
             document.getElementById('screen').getContext('2d').getImageData(96, 64, 1, 1).data[0]]",
        );
        let (drawn, level) = (shown[0].as_str().unwrap_or_default(), &shown[1]);
        let numbers: Vec<usize> = drawn.split('/').map(|n| n.parse().unwrap()).collect();
        let expected = f64::from(grey(numbers[0], numbers[1]));
        assert!((level.as_f64().unwrap() - expected).abs() <= 2.0, "{drawn}: {level}, not {expected}");
        [numbers[0], numbers[1]]
    }

    fn wait_until_shown(&mut self, stack: usize, slice: usize) {
        self.wait_for(&format!("document.getElementById('viewer').dataset.drawn === '{stack}/{slice}'"));
        assert_eq!(self.shown(), [stack, slice]);
    }

    /// Clicks every patch, and checks that the slice it asks for is shown, or that the page says that there is none.
    fn click_patches(&mut self, stack: usize, slices: usize, sharp: impl Fn(u32) -> Option<f64>) {
        for patch in 0..PATCHES[0] * PATCHES[1] {
            let before = self.shown();
            // Another message, so that the next one is seen to come.
            self.evaluate("document.getElementById('message').textContent = ''");
            self.browser.click(self.patch(patch));
            self.wait_for("document.getElementById('message').textContent !== ''");
            let message = self.text("document.getElementById('message').textContent");
            match sharp(patch) {
                Some(inverse_distance) => {
                    assert!(message.starts_with("Focused at "), "{patch}: {message}");
                    let exact = inverse_distance / 2.0 * (slices - 1) as f64;
                    let distance = format!(
                        "Math.abs(document.getElementById('viewer').dataset.inverseDistance / 2 * {} - {exact}) <= 0.55",
                        slices - 1
                    );
                    self.wait_for(&distance);
                    let [shown_stack, slice] = self.shown();
                    assert!(
                        shown_stack == stack && (slice as f64 - exact).abs() <= 0.55,
                        "{patch}: {slice} {exact}"
                    );
                }
                None => {
                    assert_eq!(message, "Painted, stays so");
                    assert_eq!(self.shown(), before, "{patch}");
                }
            }
        }
    }

    /// Everything that pointer and keys do.
    fn use_all(&mut self) {
        self.wait_until_shown(0, 7);
        self.click_patches(0, SLICES[0], painted);

        // Keys step through slices, apertures and kinds of focusing.
        self.browser.key("Home");
        self.wait_until_shown(0, 20);
        self.browser.key("ArrowRight");
        self.wait_until_shown(0, 19);
        self.browser.key("ArrowLeft");
        self.wait_until_shown(0, 20);
        self.browser.key("End");
        self.wait_until_shown(0, 0);
        self.browser.key("]");
        self.wait_until_shown(1, 0);
        self.click_patches(1, SLICES[1], painted);
        self.browser.key("[");
        self.wait_for("document.getElementById('viewer').dataset.drawn.startsWith('0/')");
        self.browser.key("p");
        self.wait_for("document.getElementById('viewer').dataset.drawn.startsWith('2/')");
        self.click_patches(2, SLICES[0], |patch| Some(ordinary(patch)));
        let disabled = "[...document.querySelectorAll('#apertures input')].map((input) => input.disabled)";
        assert_eq!(self.evaluate(disabled), json!([false, true]), "the ordinary lens has one aperture");
        self.browser.key("p");
        self.wait_for("document.getElementById('viewer').dataset.drawn.startsWith('0/')");
        assert_eq!(self.evaluate("document.getElementById('tint').hidden"), true);
        self.browser.key("t");
        assert_eq!(self.evaluate("document.getElementById('tint').hidden"), false);
        let tint = "(() => { const c = document.getElementById('tint'), x = c.getContext('2d'); const at = (u) => [...x.getImageData(u * c.width, 5, 1, 1).data]; return [at(0.1), at(0.95)]; })()";
        assert_eq!(self.evaluate(tint), json!([[0, 0, 0, 0], [240, 240, 237, 255]]));
        self.browser.key("t");

        self.drag();
        self.zoom();
        let playing = "document.getElementById('play').getAttribute('aria-pressed')";
        self.browser.key(" ");
        assert_eq!(self.text(playing), "true");
        self.wait_for("document.getElementById('viewer').dataset.drawn.includes('-')");
        self.browser.click(self.patch(5));
        assert_eq!(self.text(playing), "false");
        self.wait_for("!document.getElementById('viewer').dataset.drawn.includes('-')");
        assert!(self.evaluate("window.mostDecoded").as_u64().unwrap() <= 8);
        assert!(self.evaluate("window.decoded").as_u64().unwrap() > 2, "some were decoded");
    }

    /// A drag fades, and its end rests.
    fn drag(&mut self) {
        self.browser.key("Home");
        self.wait_until_shown(0, 20);
        let button = json!({"button": "left", "buttons": 1, "clickCount": 1});
        self.browser.mouse("mousePressed", self.point(0.1, 0.5), button.clone());
        for step in 1..=20 {
            self.browser.mouse("mouseMoved", self.point(0.1 + 0.0312 * f64::from(step), 0.5), button.clone());
        }
        self.wait_for("document.getElementById('viewer').dataset.drawn === '0/8-7'");
        let level = "document.getElementById('screen').getContext('2d').getImageData(9, 9, 1, 1).data[0]";
        let level = self.evaluate(level).as_f64().unwrap();
        assert!((f64::from(grey(0, 7)) + 1.0..f64::from(grey(0, 8))).contains(&level), "{level}");
        self.browser.mouse("mouseReleased", self.point(0.724, 0.5), button);
        self.wait_until_shown(0, 8);
    }

    /// The wheel zooms where it is turned, and what is clicked there is still right.
    fn zoom(&mut self) {
        let at = self.patch(0);
        self.browser.mouse("mouseWheel", at, json!({"deltaX": 0, "deltaY": -300}));
        self.wait_for("document.getElementById('stage').style.transform !== ''");
        let unzoomed = self.stage;
        self.measure();
        assert!(self.stage[2] > 1.5 * unzoomed[2] && self.stage[0] >= unzoomed[0] - self.stage[2]);
        self.browser.click(self.patch(1));
        self.wait_until_shown(0, 19);
        self.browser.key("0");
        self.wait_for("document.getElementById('stage').style.transform === ''");
        self.measure();
        assert_eq!(self.stage, unzoomed);
    }

    /// Nothing but the page itself was requested, and nothing went wrong.
    fn check_silence(&self, own_addresses: &[&str]) {
        assert_eq!(self.browser.complaints(own_addresses), Vec::<String>::new());
    }
}

fn write_page(folder: &Path) -> String {
    let file = folder.join("page.html");
    std::fs::write(&file, synthetic_page::page().to_html().unwrap()).unwrap();
    format!("file://{}", file.display())
}

#[test]
fn from_a_disk() {
    let folder = tempfile::tempdir().unwrap();
    let address = write_page(folder.path());
    let Some(mut page) = OpenPage::open(&address, false) else { return };
    page.use_all();
    page.check_silence(&[&address]);

    // Texts are texts.
    assert_eq!(page.text("document.title"), HOSTILE);
    assert_eq!(page.text("document.querySelector('#caption .title').textContent"), HOSTILE);
    assert_eq!(page.text("document.querySelector('#caption .author').textContent"), HOSTILE);
    assert!(page.text("document.getElementById('screen').ariaLabel").starts_with(HOSTILE));
    assert_eq!(page.text("typeof hacked"), "undefined");
    let unnamed = "[...document.querySelectorAll('button, input')].filter((e) => !(e.ariaLabel || e.textContent.trim() || e.labels?.length)).length";
    assert_eq!(page.evaluate(unnamed), 0, "every control has a name for screen readers");
}

#[test]
fn a_complaint_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("noisy.html");
    std::fs::write(&file, "<img src='missing.png'><script>undefinedFunction()</script>").unwrap();
    let Some(mut browser) = Chromium::start() else { return };
    let address = format!("file://{}", file.display());
    browser.open(&address);
    let complaints = browser.complaints(&[&address]).join("\n");
    assert!(complaints.contains("missing.png") && complaints.contains("undefinedFunction"), "{complaints}");
}

#[test]
fn in_a_sandboxed_frame() {
    let folder = tempfile::tempdir().unwrap();
    let page_address = write_page(folder.path());
    let host = folder.path().join("host.html");
    let frame =
        "<!doctype html><link rel='icon' href='data:,'><style>body { margin: 0 } iframe { border: 0 }</style>
        <iframe sandbox='allow-scripts' src='page.html' width='900' height='560'></iframe>";
    std::fs::write(&host, frame).unwrap();
    let host_address = format!("file://{}", host.display());
    let Some(mut page) = OpenPage::open(&host_address, true) else { return };
    assert_eq!(page.text("window.origin"), "null", "it is sandboxed");
    page.use_all();
    assert_eq!(page.evaluate("document.getElementById('full-screen').hidden"), true, "it is not allowed");
    page.check_silence(&[&host_address, &page_address]);
}

#[test]
fn from_a_server_on_a_phone() {
    let folder = tempfile::tempdir().unwrap();
    write_page(folder.path());
    let requests = server::serve(std::fs::read(folder.path().join("page.html")).unwrap());
    let address = format!("http://{}/page.html", requests.address);
    let Some(mut page) = OpenPage::open(&address, false) else { return };
    page.browser.call("Emulation.setTouchEmulationEnabled", json!({"enabled": true, "maxTouchPoints": 2}));
    page.browser.resize([390, 700]);
    page.wait_for("innerWidth === 390");
    page.measure();
    assert!(page.stage[0] >= 0.0 && page.stage[2] <= 390.0, "{:?}", page.stage);

    // A tap focuses.
    let tapped = page.patch(4);
    page.browser.touch("touchStart", &[tapped]);
    page.browser.touch("touchEnd", &[]);
    page.wait_until_shown(0, 17);
    // A finger that moves racks; two that part zoom.
    page.browser.touch("touchStart", &[page.point(0.2, 0.5)]);
    for step in 1..=10 {
        page.browser.touch("touchMove", &[page.point(0.2 + 0.05 * f64::from(step), 0.5)]);
    }
    page.browser.touch("touchEnd", &[]);
    page.wait_until_shown(0, 7);
    page.browser.touch("touchStart", &[page.point(0.4, 0.5), page.point(0.6, 0.5)]);
    page.browser.touch("touchMove", &[page.point(0.2, 0.5), page.point(0.8, 0.5)]);
    page.browser.touch("touchEnd", &[]);
    page.wait_for("document.getElementById('stage').style.transform.includes('scale(')");
    assert_eq!(page.shown(), [0, 7], "fingers that zoom do not focus");
    page.check_silence(&[&address]);
    assert_eq!(requests.paths(), ["/page.html"]);
}

#[test]
fn without_scripts_the_picture_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let address = write_page(folder.path());
    let Some(mut browser) = Chromium::start() else { return };
    browser.call("Emulation.setScriptExecutionDisabled", json!({"value": true}));
    browser.open(&address);
    let poster = "(() => { const p = document.getElementById('poster'); return [p.naturalWidth, p.clientWidth > 300, document.getElementById('bar').clientHeight]; })()";
    assert_eq!(browser.evaluate(poster), json!([SIZE[0], true, 0]));
    assert!(
        browser
            .evaluate("document.querySelector('noscript').innerText")
            .as_str()
            .unwrap()
            .contains("switched off")
    );
}
