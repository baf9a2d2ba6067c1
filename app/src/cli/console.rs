//! Progress on stderr, results on stdout.

use super::arguments::ProgressName;
use super::stopping;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use progress::{Part, Progress};
use serde_json::{Value, json};
use session::Steps;
use std::borrow::Cow;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Without a terminal, long steps say how far they are this often.
const LINE_INTERVAL: Duration = Duration::from_secs(5);

/// Where commands tell what they do.
pub struct Console {
    format: ProgressFormat,
}

/// How it is told.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ProgressFormat {
    Bars,
    Lines,
    Json,
}

impl Console {
    /// The console of this process.
    pub fn new() -> Self {
        Self {
            format: if std::io::stderr().is_terminal() {
                ProgressFormat::Bars
            } else {
                ProgressFormat::Lines
            },
        }
    }

    /// The same, which tells progress in this form.
    pub fn with_format(format: ProgressName) -> Self {
        match format {
            ProgressName::Text => Self::new(),
            ProgressName::Json => Self { format: ProgressFormat::Json },
        }
    }

    /// Tells what is odd but does no harm.
    pub fn warn<'a>(&self, warnings: impl IntoIterator<Item = &'a String>) {
        for warning in warnings {
            match self.format {
                ProgressFormat::Json => write_json_line(&json!({ "warning": warning })),
                _ => eprintln!("warning: {}", warning.replace('\n', " ")),
            }
        }
    }

    /// Tells on stderr what was done.
    pub fn note(&self, line: &str) {
        match self.format {
            ProgressFormat::Json => write_json_line(&json!({ "note": line })),
            _ => eprintln!("{line}"),
        }
    }

    /// Tells on stderr what a script wants to know: as `line`, or as JSON where that is asked for.
    pub fn event(&self, line: &str, event: &Value) {
        match self.format {
            ProgressFormat::Json => write_json_line(event),
            _ => eprintln!("{line}"),
        }
    }
}

fn write_json_line(value: &Value) {
    let _ = writeln!(std::io::stderr(), "{value}");
}

/// A line of the result on stdout. A reader that has gone is no error.
pub fn print_line(line: impl AsRef<str>) {
    let _ = writeln!(std::io::stdout(), "{}", line.as_ref());
}

/// A path in the result for a script. JSON is UTF-8: bytes of a path that are not become U+FFFD.
pub fn path_text(path: &Path) -> Cow<'_, str> {
    path.to_string_lossy()
}

/// The same of several paths.
pub fn path_texts<T: AsRef<Path>>(paths: &[T]) -> Vec<Cow<'_, str>> {
    paths.iter().map(|path| path_text(path.as_ref())).collect()
}

/// The result for a script.
pub fn print_json(value: &Value) {
    print_line(format!("{value:#}"));
}

impl Steps for Console {
    fn begin(&self, label: &str) -> Box<dyn Progress + '_> {
        if self.format == ProgressFormat::Json {
            return Box::new(JsonStep::begin(label));
        }
        if self.format == ProgressFormat::Bars {
            let style = ProgressStyle::with_template("{msg:12} {bar:32} {percent:>3} % {elapsed}");
            let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr_with_hz(10));
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar.set_message(label.to_owned());
            Box::new(ProgressBarStep(bar))
        } else {
            Box::new(LineStep::begin(label))
        }
    }

    fn notice(&self, sentence: &str) {
        self.note(sentence);
    }
}

/// Whoever asks only whether to go on.
impl Progress for Console {
    fn report(&self, _fraction: f32) {}
    fn cancelled(&self) -> bool {
        stopping::is_requested()
    }
}

/// A bar on a terminal; it goes when the step is over.
struct ProgressBarStep(ProgressBar);

impl Progress for ProgressBarStep {
    fn report(&self, fraction: f32) {
        let position = (fraction.clamp(0.0, 1.0) * 1000.0) as u64;
        if position > self.0.position() {
            self.0.set_position(position);
        }
    }
    fn cancelled(&self) -> bool {
        stopping::is_requested()
    }
    fn begin_part(&self, part: &Part) {
        self.0.set_message(part.name);
    }
}

impl Drop for ProgressBarStep {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Plain lines where there is no terminal.
struct LineStep {
    last: Mutex<LineState>,
}

/// What was told last.
struct LineState {
    /// What is being done, and the share of the step that is done when it begins and ends.
    part: Cow<'static, str>,
    shares: [f32; 2],
    reported_at: Instant,
    furthest: f32,
}

impl LineStep {
    fn begin(label: &str) -> Self {
        eprintln!("{label}…");
        let part = label.to_owned().into();
        Self {
            last: Mutex::new(LineState {
                part,
                shares: [0.0, 1.0],
                reported_at: Instant::now(),
                furthest: 0.0,
            }),
        }
    }
}

impl Progress for LineStep {
    fn report(&self, fraction: f32) {
        let Ok(mut last) = self.last.try_lock() else { return };
        if fraction > last.furthest && last.reported_at.elapsed() >= LINE_INTERVAL {
            (last.reported_at, last.furthest) = (Instant::now(), fraction);
            let [from, to] = last.shares;
            let done = if to > from { ((fraction - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
            eprintln!("{} {:.0} %", last.part, done * 100.0);
        }
    }
    fn cancelled(&self) -> bool {
        stopping::is_requested()
    }
    fn begin_part(&self, part: &Part) {
        eprintln!("{}…", part.name);
        if let Ok(mut last) = self.last.lock() {
            (last.part, last.shares, last.reported_at) =
                (part.name.into(), [part.from, part.to], Instant::now());
        }
    }
}

/// A line of JSON at the beginning of a step, now and then while it goes on, and at its end.
struct JsonStep {
    label: String,
    last: Mutex<(Instant, f32)>,
}

impl JsonStep {
    fn begin(label: &str) -> Self {
        write_json_line(&json!({ "step": label, "done": 0.0 }));
        Self { label: label.to_owned(), last: Mutex::new((Instant::now(), 0.0)) }
    }
}

impl Progress for JsonStep {
    fn report(&self, fraction: f32) {
        const JSON_INTERVAL: Duration = Duration::from_secs(1);
        let Ok(mut last) = self.last.try_lock() else { return };
        if fraction > last.1 && last.0.elapsed() >= JSON_INTERVAL {
            *last = (Instant::now(), fraction);
            write_json_line(&json!({ "step": self.label, "done": fraction }));
        }
    }
    fn cancelled(&self) -> bool {
        stopping::is_requested()
    }
    fn begin_part(&self, part: &Part) {
        write_json_line(&json!({ "step": self.label, "part": part.name, "done": part.from }));
    }
}

impl Drop for JsonStep {
    fn drop(&mut self) {
        if !stopping::is_requested() {
            write_json_line(&json!({ "step": self.label, "done": 1.0 }));
        }
    }
}
