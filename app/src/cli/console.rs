//! Progress on stderr, results on stdout.

use super::arguments::ProgressName;
use super::stderr::write_line;
use super::termination;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use light::{Resources, Steps};
use progress::{Part, Progress};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Without a terminal, long steps report their progress this often.
const LINE_INTERVAL: Duration = Duration::from_secs(5);

/// Where commands report what they do.
pub struct Console {
    format: ProgressFormat,
    resources: Resources,
}

/// Format of the reports.
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
            resources: Resources::default(),
        }
    }

    /// The console of this process, reporting progress in this format.
    pub fn with_format(format: ProgressName) -> Self {
        match format {
            ProgressName::Text => Self::new(),
            ProgressName::Json => Self { format: ProgressFormat::Json, ..Self::new() },
        }
    }

    /// The same, for commands that may use `resources`.
    pub fn with_resources(self, resources: Resources) -> Self {
        Self { resources, ..self }
    }

    /// What commands may use.
    pub fn resources(&self) -> &Resources {
        &self.resources
    }

    /// Reports oddities that do no harm, on stderr.
    pub fn warn<'a>(&self, warnings: impl IntoIterator<Item = &'a String>) {
        for warning in warnings {
            match self.format {
                ProgressFormat::Json => write_json_line(&json!({ "warning": warning })),
                _ => write_line(&format!("warning: {}", warning.replace('\n', " "))),
            }
        }
    }

    /// Reports on stderr what was done.
    pub fn note(&self, line: &str) {
        match self.format {
            ProgressFormat::Json => write_json_line(&json!({ "note": line })),
            _ => write_line(line),
        }
    }

    /// Reports an event for scripts on stderr: as `line`, or as JSON if that format was chosen.
    pub fn event(&self, line: &str, event: &Value) {
        match self.format {
            ProgressFormat::Json => write_json_line(event),
            _ => write_line(line),
        }
    }
}

fn write_json_line(value: &Value) {
    write_line(&value.to_string());
}

/// Prints a line of the result on stdout. A closed pipe is not an error.
pub fn print_line(line: impl AsRef<str>) {
    let _ = writeln!(std::io::stdout(), "{}", line.as_ref());
}

/// A path for a JSON result. JSON is UTF-8: invalid bytes of a path become U+FFFD.
pub fn path_text(path: &Path) -> Cow<'_, str> {
    path.to_string_lossy()
}

/// Several paths for a JSON result.
pub fn path_texts<T: AsRef<Path>>(paths: &[T]) -> Vec<Cow<'_, str>> {
    paths.iter().map(|path| path_text(path.as_ref())).collect()
}

/// Prints the result as JSON on stdout.
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

/// Used where only cancellation matters.
impl Progress for Console {
    fn report(&self, _fraction: f32) {}
    fn cancelled(&self) -> bool {
        termination::is_requested()
    }
}

/// A progress bar on a terminal; it is removed when the step is over.
struct ProgressBarStep(ProgressBar);

impl Progress for ProgressBarStep {
    fn report(&self, fraction: f32) {
        let position = (fraction.clamp(0.0, 1.0) * 1000.0) as u64;
        if position > self.0.position() {
            self.0.set_position(position);
        }
    }
    fn cancelled(&self) -> bool {
        termination::is_requested()
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

/// Plain lines, used where there is no terminal.
struct LineStep {
    last: Mutex<LineState>,
}

/// What was reported last.
struct LineState {
    /// The current part, and the shares of the step that are done at its start and end.
    part: Cow<'static, str>,
    shares: [f32; 2],
    reported_at: Instant,
    furthest: f32,
}

impl LineStep {
    fn begin(label: &str) -> Self {
        write_line(&format!("{label}…"));
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
            write_line(&format!("{} {:.0} %", last.part, done * 100.0));
        }
    }
    fn cancelled(&self) -> bool {
        termination::is_requested()
    }
    fn begin_part(&self, part: &Part) {
        write_line(&format!("{}…", part.name));
        if let Ok(mut last) = self.last.lock() {
            (last.part, last.shares, last.reported_at) =
                (part.name.into(), [part.from, part.to], Instant::now());
        }
    }
}

/// A line of JSON at the start of a step, at intervals while it runs, and at its end.
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
        termination::is_requested()
    }
    fn begin_part(&self, part: &Part) {
        write_json_line(&json!({ "step": self.label, "part": part.name, "done": part.from }));
    }
}

impl Drop for JsonStep {
    fn drop(&mut self) {
        if !termination::is_requested() {
            write_json_line(&json!({ "step": self.label, "done": 1.0 }));
        }
    }
}
