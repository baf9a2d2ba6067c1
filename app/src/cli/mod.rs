//! The command line: a thin layer over the `session` crate.
//!
//! * `arguments`: what can be typed. One file a subcommand does it: `info`, `new`, `import`, `replay`, `keys`, `unwrap`, `bake`, `render`,
//!   `merge`, `compare`, `report`, `export`, `presets`, `thumbnail`, `doctor`.
//! * `sequence`: `render` of frames. `tiles`: of a picture in tiles. `stopping`: what a signal to end does.
//! * `console`: progress on stderr, results on stdout. `failure`: errors and exit codes.

mod arguments;
mod bake;
mod compare;
mod console;
mod doctor;
mod export;
mod failure;
mod import;
mod info;
mod keys;
mod merge;
mod new;
mod parsers;
mod presets;
mod render;
mod replay;
mod report;
mod sequence;
mod sequence_arguments;
mod shot;
mod stopping;
mod thumbnail;
mod tiles;
mod unwrap;

use crate::window;
use arguments::{Arguments, Subcommand};
use clap::Parser;
use clap::error::ErrorKind;
use console::Console;
use failure::Failure;
use session::{InputKind, LightFieldStore};
use std::process::ExitCode;
use std::sync::Mutex;

/// Stack of the thread that works: deep scenes must not end the program.
const WORKER_STACK_BYTES: usize = 64 << 20;

/// Where the last panic was, for the error's line.
static LAST_PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Runs the command line of this process and says how it went.
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return report_usage_error(&error),
    };
    record_panic_location();
    let outcome = match arguments {
        // The window's event loop must have the main thread.
        Arguments { command: None, .. } => session::catch_panics("the window", || Ok(open_window(arguments)))
            .unwrap_or_else(|e| Err(e.into())),
        Arguments { command: Some(command), .. } => run_on_large_stack(move || dispatch(command)),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let place = LAST_PANIC.lock().ok().and_then(|mut place| place.take());
            let place = place.filter(|_| failure.is_internal).map(|p| format!(" at {p}")).unwrap_or_default();
            eprintln!("error: {}{place}", failure.message);
            ExitCode::from(failure.code)
        }
    }
}

fn dispatch(command: Subcommand) -> Result<(), Failure> {
    let console = Console::new();
    match command {
        Subcommand::Info(arguments) => info::run(&arguments, &console),
        Subcommand::New(arguments) => new::run(&arguments, &console),
        Subcommand::Import(arguments) => {
            enable_disk_caches();
            import::run(&arguments, &console)
        }
        Subcommand::Replay(arguments) => replay::run(&arguments, &console),
        Subcommand::Keys(arguments) => keys::run(&arguments, &console),
        Subcommand::Unwrap(arguments) => unwrap::run(&arguments, &console),
        Subcommand::Bake(arguments) => {
            enable_disk_caches();
            bake::run(&arguments, &console)
        }
        Subcommand::Render(arguments) => {
            enable_disk_caches();
            let console = Console::with_format(arguments.progress);
            let sequence = &arguments.sequence;
            match (arguments.tiles, sequence.is_sequence()) {
                (Some(grid), _) => tiles::run(&arguments, grid, &console),
                (None, true) => sequence::run(&arguments, &console),
                (None, false) if sequence.shard.is_some() => {
                    Err(Failure::wrong_usage("--shard is a share of --frames or --tiles (give one of them)"))
                }
                (None, false) => render::run(&arguments, &console),
            }
        }
        Subcommand::Merge(arguments) => merge::run(&arguments, &Console::with_format(arguments.progress)),
        Subcommand::Compare(arguments) => compare::run(&arguments),
        Subcommand::Report(arguments) => report::run(&arguments, &console),
        Subcommand::Export(arguments) => {
            enable_disk_caches();
            export::run(&arguments, &console)
        }
        Subcommand::Presets(arguments) => presets::run(&arguments),
        Subcommand::Thumbnail(arguments) => thumbnail::run(&arguments, &console),
        Subcommand::Doctor(arguments) => doctor::run(&arguments),
    }
}

fn open_window(arguments: Arguments) -> Result<(), Failure> {
    let Arguments { file, replay, trace, preview_size, backend, command: _ } = arguments;
    let replay = replay.map(|recording| project::read_strokes(&recording)).transpose()?;
    if let Some(trace) = &trace {
        shot::check_folder(trace)?;
    }
    if let Some(file) = &file {
        InputKind::from_path(file)?;
        if !file.exists() {
            return Err(Failure::bad_input(format!("{}: no such file (check the path)", file.display())));
        }
    }
    let unwrap = shot::unwrap_options(None);
    let display = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"];
    if cfg!(target_os = "linux") && display.iter().all(|name| std::env::var_os(name).is_none()) {
        let what = "no window: neither DISPLAY nor WAYLAND_DISPLAY is set";
        return Err(Failure::bad_input(format!(
            "{what} (start it on a desktop, or use `focus-brush render`)"
        )));
    }
    // What is measured does not depend on what the window was like when it was last closed.
    let remember = trace.is_none();
    enable_disk_caches();
    let light_fields =
        app_folders().map(|folders| LightFieldStore::new(folders.cache_dir().join("light-fields")));
    let options = window::WindowOptions {
        file,
        unwrap,
        replay,
        trace,
        preview_size,
        remember,
        light_fields,
        backend: backend.into(),
        ..Default::default()
    };
    window::run(options).map_err(|error| {
        let why = format!("{error:#}").replace('\n', " ");
        Failure::bad_input(format!("no window: {why} (`focus-brush doctor` says what is missing)"))
    })
}

/// Has what is worked out (light, atlases) kept from one run to the next. What is measured (`report`) is measured from the start.
fn enable_disk_caches() {
    if let Some(folders) = app_folders() {
        session::set_cache_folder(folders.cache_dir().into());
    }
}

/// Where the program keeps what is its own.
fn app_folders() -> Option<directories::ProjectDirs> {
    directories::ProjectDirs::from("", "", "focus-brush")
}

fn run_on_large_stack(work: impl FnOnce() -> Result<(), Failure> + Send + 'static) -> Result<(), Failure> {
    let guarded =
        move || session::catch_panics("focus-brush", || Ok(work())).unwrap_or_else(|e| Err(e.into()));
    let thread =
        std::thread::Builder::new().name("work".into()).stack_size(WORKER_STACK_BYTES).spawn(guarded);
    match thread {
        Ok(thread) => {
            thread.join().unwrap_or_else(|_| Err(Failure::internal("the work ended without a result")))
        }
        Err(error) => Err(Failure::try_again(format!("no thread could be started: {error} (try again)"))),
    }
}

/// A panic is told as an error of one line; RUST_BACKTRACE brings the usual report back.
fn record_panic_location() {
    if std::env::var_os("RUST_BACKTRACE").is_some() {
        return;
    }
    std::panic::set_hook(Box::new(|info| {
        let place = info.location().map(|at| format!("{}:{}", at.file(), at.line()));
        if let Ok(mut last) = LAST_PANIC.lock() {
            *last = place;
        }
    }));
}

/// Help and version go to stdout; a mistake is one line on stderr.
fn report_usage_error(error: &clap::Error) -> ExitCode {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        // Nothing can be done about a closed pipe.
        let _ = error.print();
        return ExitCode::SUCCESS;
    }
    let text = error.to_string();
    let lines = text
        .lines()
        .map(str::trim)
        .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"));
    let message_lines = lines.filter(|line| !line.is_empty() && !line.starts_with("tip:"));
    let message = message_lines.collect::<Vec<_>>().join(" ");
    eprintln!("{message} (see focus-brush --help)");
    ExitCode::from(failure::WRONG_USAGE)
}
