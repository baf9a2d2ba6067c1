//! A simulated user of the window: opens files, waits, drags, presses keys, inspects the screen.

use document::Document;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use focus_brush::window::{Severity, Shell, WindowOptions};
use lens::Picture;
use session::CommandId;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// More than any of the small scenes needs on a busy machine.
const PATIENCE: Duration = Duration::from_secs(90);

/// A file dropped by the system.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }
    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// The window with a simulated user.
pub struct Person {
    /// The window, without a display.
    pub window: Harness<'static, Shell>,
}

impl Person {
    /// Opens the window on a file and waits for the first complete picture.
    pub fn opens(file: &Path) -> Self {
        let mut person = Self::starts(Some(file));
        person.waits();
        assert!(person.has_document(), "opened: {:?}", person.complaints());
        person.wait_until("the surface is drawn", |shell| shell.paint_view().is_ready());
        person.waits();
        person
    }

    /// Opens the window with a file, or with nothing.
    pub fn starts(file: Option<&Path>) -> Self {
        Self::starts_with(Self::usual(file))
    }

    /// Options of most tests: small pictures, no stored settings, no background refinement.
    pub fn usual(file: Option<&Path>) -> WindowOptions {
        WindowOptions {
            file: file.map(Path::to_path_buf),
            demo: false,
            remember: false,
            preview_size: Some(180),
            exact_after: None,
            light_passes: 0,
            system_dialogs: false,
            ..WindowOptions::default()
        }
    }

    /// Opens the window.
    pub fn starts_with(options: WindowOptions) -> Self {
        let builder = Harness::builder().with_size([1280.0, 720.0]).with_max_steps(64).wgpu();
        let window = builder.build_eframe(move |creation| Shell::new(creation, options).unwrap());
        let mut person = Self { window };
        // Both views are large: most tests act in either.
        person.does(CommandId::PaintBeside);
        person
    }

    /// Runs a command.
    pub fn does(&mut self, id: CommandId) {
        let context = self.window.ctx.clone();
        self.window.state_mut().run(id, &context);
        self.window.run_steps(3);
    }

    pub fn shell(&self) -> &Shell {
        self.window.state()
    }

    pub fn has_document(&self) -> bool {
        self.shell().session().document().is_some()
    }

    pub fn document(&self) -> &Document {
        self.shell().session().document().expect("a document is open")
    }

    pub fn picture(&self) -> Arc<Picture> {
        self.shell().session().preview().expect("a picture").picture.fetch().expect("its card is there")
    }

    pub fn complaints(&self) -> Vec<String> {
        let errors = self.shell().messages().filter(|(severity, _)| *severity == Severity::Error);
        errors.map(|(_, text)| text.to_string()).collect()
    }

    /// Waits until the picture shows the current document.
    pub fn waits(&mut self) {
        self.window.step();
        self.wait_until("everything is done", |shell| shell.session().is_settled());
        self.window.run_steps(2);
    }

    pub fn wait_until(&mut self, what: &str, done: impl Fn(&Shell) -> bool) {
        let start = Instant::now();
        while !done(self.window.state()) {
            assert!(start.elapsed() < PATIENCE, "waited in vain until {what}");
            std::thread::sleep(Duration::from_millis(3));
            self.window.step();
        }
    }

    /// The paint view on screen.
    pub fn paint_rect(&self) -> Rect {
        self.shell().paint_view().rect()
    }

    /// The picture on screen.
    pub fn picture_rect(&self) -> Rect {
        self.shell().picture_view().image_rect()
    }

    /// Presses the left button and drags along `path`, without releasing it.
    pub fn drags(&mut self, path: &[Pos2]) {
        self.window.hover_at(path[0]);
        self.window.step();
        self.button(path[0], true);
        for position in &path[1..] {
            self.window.hover_at(*position);
            self.window.step();
        }
    }

    /// Releases the left button.
    pub fn lets_go(&mut self, at: Pos2) {
        self.button(at, false);
        self.window.step();
    }

    fn button(&mut self, pos: Pos2, pressed: bool) {
        let event =
            Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE };
        self.window.event(event);
        self.window.step();
    }

    /// A complete stroke; waits for its picture.
    pub fn paints(&mut self, path: &[Pos2]) {
        self.drags(path);
        self.lets_go(path[path.len() - 1]);
        self.waits();
    }

    pub fn clicks(&mut self, at: Pos2) {
        self.paints(&[at]);
    }

    /// Scrolls until a control is in view, and waits until the scrolling ends.
    pub fn scrolls_to(&mut self, label: &str) {
        let found = self.window.get_all_by_label(label).last();
        found.unwrap_or_else(|| panic!("there is no {label}")).scroll_to_me();
        self.window.run_steps(60);
    }

    /// Drops a file or folder on the window.
    pub fn drops(&mut self, file: &Path) {
        self.window.input_mut().dropped_files.push(Arc::new(Dropped(file.to_owned())));
        self.window.run_steps(3);
    }

    pub fn presses(&mut self, modifiers: Modifiers, key: Key) {
        self.window.key_press_modifiers(modifiers, key);
        self.window.run_steps(2);
    }
}

/// A position in a rectangle, (0, 0) upper left, (1, 1) lower right.
pub fn at(rect: Rect, x: f32, y: f32) -> Pos2 {
    pos2(rect.left() + rect.width() * x, rect.top() + rect.height() * y)
}

/// The largest difference of radiance between two pictures of one size.
pub fn difference(a: &Picture, b: &Picture) -> f32 {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let pairs = a.radiance.iter().flatten().zip(b.radiance.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// The mean colour of a few pixels of a screenshot.
pub fn color_at(image: &image::RgbaImage, at: Pos2) -> [f32; 3] {
    let mut sum = [0.0; 3];
    for dy in 0..3 {
        for dx in 0..3 {
            let pixel = image.get_pixel(at.x as u32 + dx - 1, at.y as u32 + dy - 1);
            (0..3).for_each(|c| sum[c] += pixel.0[c] as f32 / 9.0);
        }
    }
    sum
}
