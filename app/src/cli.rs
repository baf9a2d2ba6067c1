//! The command line: a thin layer over the `render` crate; exit codes follow `session::SessionError`, which all errors become.
//!
//! * `arguments`: the arguments and their parsers. `commands`: one file per subcommand; below `render`, its
//!   variants for frames and tiles.
//! * `input`: opens the scene, camera and focus that the arguments describe. `termination`: being asked to end.
//! * `own_console`: the console that Windows opens for the program alone.
//! * `console`: progress on stderr, results on stdout. `stderr`: lines there that may fail. `failure`: errors and exit codes.

mod arguments;
mod camera_presets;
mod commands;
mod console;
mod failure;
mod input;
mod own_console;
mod stderr;
mod termination;

use crate::window;
use ::render::LightFieldStore;
use arguments::{Arguments, Subcommand};
use clap::Parser;
use clap::error::ErrorKind;
use commands::{
    bake, compare, doctor, export, import, info, keys, merge, new, presets, render, replay, report,
    thumbnail, unwrap,
};
use console::Console;
use document::InputKind;
use failure::Failure;
pub use failure::TRY_AGAIN;
use light::{DiskCache, Resources};
use std::process::ExitCode;
use std::sync::Mutex;
use stderr::write_line;

/// Stack size of the worker thread: deeply nested scenes must not overflow it.
const WORKER_STACK_BYTES: usize = 64 << 20;

/// Location of the last panic, for the error message.
static LAST_PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Runs the command line of this process and returns its exit code.
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return report_usage_error(&error),
    };
    record_panic_location();
    // If it runs already, or no thread can be started, the first task tells.
    let _ = jobs::start_global_pool(0);
    let outcome = match arguments {
        // The window's event loop must have the main thread.
        Arguments { command: None, .. } => jobs::catch_panics("the window", || open_window(arguments)),
        Arguments { command: Some(command), .. } => run_on_large_stack(move || dispatch(command)),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let place = LAST_PANIC.lock().ok().and_then(|mut place| place.take());
            let place = place.filter(|_| failure.is_internal).map(|p| format!(" at {p}")).unwrap_or_default();
            write_line(&format!("error: {}{place}", failure.message));
            ExitCode::from(failure.code)
        }
    }
}

fn dispatch(command: Subcommand) -> Result<(), Failure> {
    let console = Console::new();
    let caching_console = || Console::new().with_resources(cached_resources());
    match command {
        Subcommand::Info(arguments) => info::run(&arguments, &console),
        Subcommand::New(arguments) => new::run(&arguments, &console),
        Subcommand::Import(arguments) => import::run(&arguments, &caching_console()),
        Subcommand::Replay(arguments) => replay::run(&arguments, &console),
        Subcommand::Keys(arguments) => keys::run(&arguments, &console),
        Subcommand::Unwrap(arguments) => unwrap::run(&arguments, &console),
        Subcommand::Bake(arguments) => bake::run(&arguments, &caching_console()),
        Subcommand::Render(arguments) => {
            let console = Console::with_format(arguments.progress).with_resources(cached_resources());
            let sequence = &arguments.sequence;
            match (arguments.tiles, sequence.is_sequence()) {
                (Some(grid), _) => render::tiles::run(&arguments, grid, &console),
                (None, true) => render::sequence::run(&arguments, &console),
                (None, false) if sequence.shard.is_some() => {
                    Err(Failure::wrong_usage("--shard is a share of --frames or --tiles (give one of them)"))
                }
                (None, false) => render::run(&arguments, &console),
            }
        }
        Subcommand::Merge(arguments) => merge::run(&arguments, &Console::with_format(arguments.progress)),
        Subcommand::Compare(arguments) => compare::run(&arguments),
        Subcommand::Report(arguments) => report::run(&arguments, &console),
        Subcommand::Export(arguments) => export::run(&arguments, &caching_console()),
        Subcommand::Presets(arguments) => presets::run(&arguments),
        Subcommand::Thumbnail(arguments) => thumbnail::run(&arguments, &console),
        Subcommand::Doctor(arguments) => doctor::run(&arguments),
    }
}

fn open_window(arguments: Arguments) -> Result<(), Failure> {
    let Arguments { file, replay, trace, preview_size, backend, command: _ } = arguments;
    let replay = replay.map(|recording| project::read_strokes(&recording)).transpose()?;
    if let Some(trace) = &trace {
        input::check_folder(trace)?;
    }
    if let Some(file) = &file {
        InputKind::from_path(file)?;
        if !file.exists() {
            return Err(Failure::bad_input(format!("{}: no such file (check the path)", file.display())));
        }
    }
    let unwrap = input::unwrap_options(None);
    let display = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"];
    if cfg!(target_os = "linux") && display.iter().all(|name| std::env::var_os(name).is_none()) {
        let what = "no window: neither DISPLAY nor WAYLAND_DISPLAY is set";
        return Err(Failure::bad_input(format!(
            "{what} (start it on a desktop, or use `focus-brush render`)"
        )));
    }
    // Measurements must not depend on the window's saved state.
    let remember = trace.is_none();
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
        resources: cached_resources(),
        backend: backend.into(),
        ..Default::default()
    };
    own_console::close();
    window::run(options).map_err(|error| {
        let why = format!("{error:#}").replace('\n', " ");
        Failure::bad_input(format!("no window: {why} (`focus-brush doctor` says what is missing)"))
    })
}

/// Resources whose results later runs reuse: computed light and atlases. `report` does without, because it measures from scratch.
fn cached_resources() -> Resources {
    app_folders().map_or_else(Resources::default, |folders| {
        Resources::with_cache(DiskCache::in_folder(folders.cache_dir()))
    })
}

/// The folders for the program's own files.
fn app_folders() -> Option<directories::ProjectDirs> {
    directories::ProjectDirs::from("", "", "focus-brush")
}

fn run_on_large_stack(work: impl FnOnce() -> Result<(), Failure> + Send + 'static) -> Result<(), Failure> {
    let guarded = move || jobs::catch_panics("focus-brush", work);
    let thread =
        std::thread::Builder::new().name("work".into()).stack_size(WORKER_STACK_BYTES).spawn(guarded);
    match thread {
        Ok(thread) => {
            thread.join().unwrap_or_else(|_| Err(Failure::internal("the work ended without a result")))
        }
        Err(error) => Err(Failure::try_again(format!("no thread could be started: {error} (try again)"))),
    }
}

/// Reports a panic as a one-line error; with RUST_BACKTRACE set, the usual report is printed instead.
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

/// Prints help and version to stdout, and a usage error as one line to stderr.
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
    write_line(&format!("{message} (see focus-brush --help)"));
    ExitCode::from(failure::WRONG_USAGE)
}
