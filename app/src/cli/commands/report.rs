//! `focus-brush report`.

use super::render::open_gpu;
use crate::cli::arguments::{BackendName, ReportArguments};
use crate::cli::console::{Console, path_texts, print_json};
use crate::cli::failure::Failure;
use crate::cli::input::{read_world, refuse_additions, unwrap_options};
use crate::window::demo;
use graphics_card::Gpu;
use report::{ReportOptions, SceneRequest, build_checksum};
use serde_json::json;
use std::path::PathBuf;

/// Measures, and writes the report.
///
/// # Errors
/// An argument is invalid, a scene cannot be measured, a check fails (partly done), or a file cannot be written.
pub fn run(arguments: &ReportArguments, console: &Console) -> Result<(), Failure> {
    let default_spp = match (arguments.engine, arguments.quick) {
        (true, _) => ReportOptions::ENGINE_REFERENCE_SPP,
        (false, true) => ReportOptions::QUICK_REFERENCE_SPP,
        (false, false) => ReportOptions::REFERENCE_SPP,
    };
    let options = ReportOptions {
        resources: console.resources().clone(),
        size: arguments.shot.size,
        reference_spp: arguments.spp.unwrap_or(default_spp),
        is_quick: arguments.quick,
        with_hard_cases: arguments.hard,
        build: program_checksum()?,
        unwrap: unwrap_options(None),
    };
    let note = |line: &str| console.note(line);
    if arguments.engine {
        return run_engine(arguments, &options, console);
    }
    let report = report::run(&scene_requests(arguments)?, &options, &arguments.output, console, &note)?;
    let failed_cases =
        report.hard.iter().flatten().filter(|outcome| !(outcome.pass && outcome.control_fails));
    let failed_names: Vec<&str> = failed_cases.map(|outcome| outcome.case.as_str()).collect();
    if arguments.json {
        print_json(&json!({
            "files": path_texts(&report.files),
            "measurements": report.measured.len(),
            "new": report.new,
            "hard_cases": report.hard.as_ref().map(Vec::len),
            "hard_cases_failed": failed_names,
            "machine": report.machine,
            "seconds": report.seconds,
        }));
    } else {
        let (all, new) = (report.measured.len(), report.new);
        console.note(&format!("{all} measurements, {new} of them new, in {:.0} s", report.seconds));
        report.files.iter().for_each(|file| console.note(&format!("wrote {}", file.display())));
    }
    if !failed_names.is_empty() {
        let table = arguments.output.join("hard.json");
        let what = format!("hard cases failed: {}", failed_names.join("; "));
        return Err(Failure::partly_done(format!(
            "{}: {what} (see its `expected` and `found`)",
            table.display()
        )));
    }
    Ok(())
}

/// Measures the engine alone.
fn run_engine(
    arguments: &ReportArguments,
    options: &ReportOptions,
    console: &Console,
) -> Result<(), Failure> {
    let note = |line: &str| console.note(line);
    let backends = backends(arguments)?;
    let requests = scene_requests(arguments)?;
    let report = report::run_engine(&requests, options, &backends, &arguments.output, console, &note)?;
    let broken: Vec<_> = report.checks.iter().filter(|check| !check.holds).collect();
    if arguments.json {
        print_json(&json!({
            "files": path_texts(&report.files),
            "measurements": report.records.len(),
            "checks": report.checks,
            "machine": report.machine,
        }));
    } else {
        report.files.iter().for_each(|file| console.note(&format!("wrote {}", file.display())));
    }
    match broken.first() {
        None => Ok(()),
        Some(check) => {
            let about = arguments.output.join("about.json");
            let what = format!("{}: does not hold: {}", check.scene, check.what);
            Err(Failure::partly_done(format!("{}: {what} (see its `checks`)", about.display())))
        }
    }
}

/// The devices that the engine is measured on; `None` is the processor.
fn backends(arguments: &ReportArguments) -> Result<Vec<Option<Gpu>>, Failure> {
    let gpu = open_gpu(arguments.backend, arguments.adapter.as_deref())?;
    let with_processor = match arguments.backend {
        BackendName::Auto => arguments.adapter.is_none(),
        BackendName::Gpu => false,
        BackendName::Cpu => true,
    };
    let card = gpu.map(Some);
    Ok(with_processor.then_some(None).into_iter().chain(card).collect())
}

/// The named scenes; by default the demo, or nothing if the hard cases were requested.
fn scene_requests(arguments: &ReportArguments) -> Result<Vec<SceneRequest>, Failure> {
    let shot = &arguments.shot;
    refuse_additions(&shot.appearance)?;
    let world = read_world(&shot.appearance)?;
    let request = |file: &PathBuf| SceneRequest {
        file: file.clone(),
        camera: shot.camera.clone(),
        focus: shot.focus.clone(),
        back_faces: shot.appearance.back_faces,
        variant: shot.appearance.variant(),
        world: world.clone(),
        light: shot.appearance.light(),
    };
    if !arguments.scenes.is_empty() {
        let requests: Vec<_> = arguments.scenes.iter().map(request).collect();
        requests.iter().try_for_each(SceneRequest::check)?;
        return Ok(requests);
    }
    if arguments.hard {
        return Ok(Vec::new());
    }
    let demo = demo::demo_project()
        .ok_or_else(|| Failure::bad_input("assets/demo: the demo is not installed (name a scene)"))?;
    Ok(vec![request(&demo)])
}

/// Identifies this build of the program.
fn program_checksum() -> Result<String, Failure> {
    std::env::current_exe().and_then(|program| build_checksum(&program)).map_err(|error| {
        Failure::try_again(format!("the running program cannot be read: {error} (start it by another path)"))
    })
}
