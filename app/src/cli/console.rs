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
const REPORT_EVERY: Duration = Duration::from_secs(5);

/// Where commands tell what they do.
pub struct Console {
    form: Form,
}

/// How it is told.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    Bars,
    Lines,
    Json,
}

impl Console {
    /// The console of this process.
    pub fn new() -> Self {
        Self { form: if std::io::stderr().is_terminal() { Form::Bars } else { Form::Lines } }
    }

    /// The same, which tells progress in this form.
    pub fn telling(form: ProgressName) -> Self {
        match form {
            ProgressName::Text => Self::new(),
            ProgressName::Json => Self { form: Form::Json },
        }
    }

    /// Tells what is odd but does no harm.
    pub fn warn<'a>(&self, warnings: impl IntoIterator<Item = &'a String>) {
        for warning in warnings {
            match self.form {
                Form::Json => tell_json(&json!({ "warning": warning })),
                _ => eprintln!("warning: {}", warning.replace('\n', " ")),
            }
        }
    }

    /// Tells on stderr what was done.
    pub fn note(&self, line: &str) {
        match self.form {
            Form::Json => tell_json(&json!({ "note": line })),
            _ => eprintln!("{line}"),
        }
    }

    /// Tells on stderr what a script wants to know: as `line`, or as JSON where that is asked for.
    pub fn event(&self, line: &str, event: &Value) {
        match self.form {
            Form::Json => tell_json(event),
            _ => eprintln!("{line}"),
        }
    }
}

fn tell_json(value: &Value) {
    let _ = writeln!(std::io::stderr(), "{value}");
}

/// A line of the result on stdout. A reader that has gone is no error.
pub fn say(line: impl AsRef<str>) {
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
pub fn say_json(value: &Value) {
    say(format!("{value:#}"));
}

impl Steps for Console {
    fn begin(&self, label: &str) -> Box<dyn Progress + '_> {
        if self.form == Form::Json {
            return Box::new(Events::begin(label));
        }
        if self.form == Form::Bars {
            let style = ProgressStyle::with_template("{msg:12} {bar:32} {percent:>3} % {elapsed}");
            let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr_with_hz(10));
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar.set_message(label.to_owned());
            Box::new(Bar(bar))
        } else {
            Box::new(Lines::begin(label))
        }
    }

    fn tell(&self, sentence: &str) {
        self.note(sentence);
    }
}

/// Whoever asks only whether to go on.
impl Progress for Console {
    fn report(&self, _fraction: f32) {}
    fn cancelled(&self) -> bool {
        stopping::is_asked_for()
    }
}

/// A bar on a terminal; it goes when the step is over.
struct Bar(ProgressBar);

impl Progress for Bar {
    fn report(&self, fraction: f32) {
        let position = (fraction.clamp(0.0, 1.0) * 1000.0) as u64;
        if position > self.0.position() {
            self.0.set_position(position);
        }
    }
    fn cancelled(&self) -> bool {
        stopping::is_asked_for()
    }
    fn begin_part(&self, part: &Part) {
        self.0.set_message(part.name);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Plain lines where there is no terminal.
struct Lines {
    last: Mutex<Line>,
}

/// What was told last.
struct Line {
    /// What is being done, and the share of the step that is done when it begins and ends.
    part: Cow<'static, str>,
    shares: [f32; 2],
    told: Instant,
    furthest: f32,
}

impl Lines {
    fn begin(label: &str) -> Self {
        eprintln!("{label}…");
        let part = label.to_owned().into();
        Self { last: Mutex::new(Line { part, shares: [0.0, 1.0], told: Instant::now(), furthest: 0.0 }) }
    }
}

impl Progress for Lines {
    fn report(&self, fraction: f32) {
        let Ok(mut last) = self.last.try_lock() else { return };
        if fraction > last.furthest && last.told.elapsed() >= REPORT_EVERY {
            (last.told, last.furthest) = (Instant::now(), fraction);
            let [from, to] = last.shares;
            let done = if to > from { ((fraction - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
            eprintln!("{} {:.0} %", last.part, done * 100.0);
        }
    }
    fn cancelled(&self) -> bool {
        stopping::is_asked_for()
    }
    fn begin_part(&self, part: &Part) {
        eprintln!("{}…", part.name);
        if let Ok(mut last) = self.last.lock() {
            (last.part, last.shares, last.told) = (part.name.into(), [part.from, part.to], Instant::now());
        }
    }
}

/// A line of JSON at the beginning of a step, now and then while it goes on, and at its end.
struct Events {
    label: String,
    last: Mutex<(Instant, f32)>,
}

impl Events {
    fn begin(label: &str) -> Self {
        tell_json(&json!({ "step": label, "done": 0.0 }));
        Self { label: label.to_owned(), last: Mutex::new((Instant::now(), 0.0)) }
    }
}

impl Progress for Events {
    fn report(&self, fraction: f32) {
        const EVERY: Duration = Duration::from_secs(1);
        let Ok(mut last) = self.last.try_lock() else { return };
        if fraction > last.1 && last.0.elapsed() >= EVERY {
            *last = (Instant::now(), fraction);
            tell_json(&json!({ "step": self.label, "done": fraction }));
        }
    }
    fn cancelled(&self) -> bool {
        stopping::is_asked_for()
    }
    fn begin_part(&self, part: &Part) {
        tell_json(&json!({ "step": self.label, "part": part.name, "done": part.from }));
    }
}

impl Drop for Events {
    fn drop(&mut self) {
        if !stopping::is_asked_for() {
            tell_json(&json!({ "step": self.label, "done": 1.0 }));
        }
    }
}
