//! `focus-brush export`.

use crate::cli::arguments::{BackendName, ExportArguments, WebPageArguments};
use crate::cli::commands::render::open_gpu;
use crate::cli::console::{Console, path_texts, print_json};
use crate::cli::failure::Failure;
use crate::cli::input::{check_folder, unwrap_options};
use crate::cli::termination;
use document::{Input, InputKind, is_focus_table, write_splat_focus};
use focus::FocusMap;
use lens::{Camera, FocusOffset, Picture};
use project::{FocusMapFile, Layer, PictureOptions, write_focus_map, write_picture};
use render::{
    Aov, Caption, RenderOptions, Rendered, Tone, WebPageOptions, WebPageReport, export_engine_page,
    export_web_page, render_input,
};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Writes the requested parts of a project. A failure of one does not prevent the others from being written.
///
/// # Errors
/// The project cannot be opened, or a part cannot be written; the first failure is returned after all parts were tried.
pub fn run(arguments: &ExportArguments, console: &Console) -> Result<(), Failure> {
    let project = &arguments.project;
    if InputKind::from_path(project)? != InputKind::Project {
        return Err(Failure::bad_input(format!(
            "{}: not a project (give a .fbrush file)",
            project.display()
        )));
    }
    if let Some(page) = &arguments.page.web {
        check_page(page)?;
        termination::install_handler()?;
    }
    let mut input = Input::open(project, console.resources(), console)?;
    input.transfer_paint_if_changed(&unwrap_options(None), console)?;
    console.warn(&input.warnings);
    let mut written: Vec<PathBuf> = Vec::new();
    let mut failures = Vec::new();
    let mut record_result = |path: &Path, result: Result<(), Failure>| match result {
        Ok(()) => {
            console.note(&format!("wrote {}", path.display()));
            written.push(path.to_owned());
        }
        Err(failure) => failures.push(failure),
    };
    if let Some(path) = &arguments.focus_map {
        record_result(path, export_focus_map(&input, path, console));
    }
    if let Some(path) = &arguments.glb {
        record_result(path, export_glb(&input, path, console));
    }
    if let Some(path) = &arguments.layers {
        record_result(path, export_layers(&input, path, console));
    }
    for (name, path) in &arguments.photo {
        record_result(path, export_photograph(&input, name, path, console));
    }
    let mut page_report = None;
    if let Some(path) = &arguments.page.web {
        match export_page(&input, path, &arguments.page, console) {
            Ok(report) => {
                report.files.iter().for_each(|file| record_result(file, Ok(())));
                page_report = Some(report);
            }
            Err(failure) => record_result(path, Err(failure)),
        }
    }
    if arguments.json {
        print_json(&json!({ "files": path_texts(&written), "page": page_report }));
    }
    match (written.len(), failures.len()) {
        (_, 0) => Ok(()),
        (0, 1) => Err(failures.remove(0)),
        (_, _) => {
            let all: Vec<_> = failures.iter().map(|failure| failure.message.as_str()).collect();
            let all = all.join("; ");
            if written.is_empty() { Err(Failure::bad_input(all)) } else { Err(Failure::partly_done(all)) }
        }
    }
}

fn export_focus_map(input: &Input, path: &Path, console: &Console) -> Result<(), Failure> {
    check_folder(path)?;
    let atlas = input.atlas(&unwrap_options(None), console)?;
    let project = input.project.as_ref();
    let blank = || {
        let mut map = FocusMap::new(atlas.width, atlas.height, FocusOffset::STANDARD);
        map.background = project.map_or(FocusOffset::STANDARD, |project| project.background_focus);
        map
    };
    let map = project.and_then(|project| project.focus_map.clone()).unwrap_or_else(blank);
    if is_focus_table(path) {
        return Ok(write_splat_focus(path, &input.scene, &atlas, &map)?);
    }
    let lost = write_focus_map(path, &FocusMapFile::from_atlas_map(&map, &atlas))?;
    console.warn(&lost.iter().map(|what| format!("{}: {what}", path.display())).collect::<Vec<_>>());
    Ok(())
}

fn export_glb(input: &Input, path: &Path, console: &Console) -> Result<(), Failure> {
    check_folder(path)?;
    Ok(render::export_glb(input, path, &unwrap_options(None), console)?)
}

fn export_photograph(input: &Input, name: &str, path: &Path, console: &Console) -> Result<(), Failure> {
    check_folder(path)?;
    let (picture, layers) = render::render_photograph(input, name, console)?;
    write_layered_picture(input, path, &picture, &layers)
}

/// Checks that a page can be written to `path`, before any work is done.
fn check_page(path: &Path) -> Result<(), Failure> {
    let is_html =
        path.extension().is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm"));
    if !is_html {
        let what = "web pages are written as .html (name one)";
        return Err(Failure::wrong_usage(format!("{}: {what}", path.display())));
    }
    check_folder(path)
}

fn export_page(
    input: &Input,
    path: &Path,
    arguments: &WebPageArguments,
    console: &Console,
) -> Result<WebPageReport, Failure> {
    let focus = input.focus(None, &unwrap_options(None), console)?;
    let [width, height] = arguments.size.unwrap_or([input.camera.width, input.camera.height]);
    let camera = Camera { width, height, ..input.camera.clone() };
    let file_name = || input.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let gpu = open_gpu(BackendName::Auto, None)?;
    let defaults = WebPageOptions::default();
    let options = WebPageOptions {
        caption: Caption {
            title: arguments.title.clone().unwrap_or_else(file_name),
            author: arguments.author.clone(),
            licence: arguments.licence.clone(),
        },
        aperture_divisors: arguments.apertures.clone(),
        has_ordinary_focus: !arguments.painted_only,
        is_autoplaying: arguments.autoplay,
        tone: Tone { exposure: input.exposure(), ..Tone::default() },
        render: RenderOptions { gpu, ..defaults.render },
        address: arguments.url.clone(),
        is_large_allowed: arguments.large,
    };
    let export = if arguments.engine { export_engine_page } else { export_web_page };
    let report = export(path, &input.lit_scene()?, &camera, &focus, &options, console)?;
    for stack in &report.stacks {
        console.note(&stack.to_string());
    }
    console.warn(&report.warnings());
    Ok(report)
}

fn export_layers(input: &Input, path: &Path, console: &Console) -> Result<(), Failure> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
        return Err(Failure::wrong_usage(format!(
            "{}: layers are written as .exr (name one)",
            path.display()
        )));
    }
    check_folder(path)?;
    let focus = input.focus(None, &unwrap_options(None), console)?;
    let aovs = vec![Aov::Coverage, Aov::CircleOfConfusion, Aov::Depth, Aov::Focus, Aov::Seen];
    let options = RenderOptions { aovs, ..RenderOptions::default() };
    let Rendered { picture, layers, warnings, .. } =
        render_input(input, &input.camera, &focus, &options, console)?;
    console.warn(&warnings);
    write_layered_picture(input, path, &picture, &layers)
}

fn write_layered_picture(
    input: &Input,
    path: &Path,
    picture: &Picture,
    layers: &[Layer],
) -> Result<(), Failure> {
    let options = PictureOptions { exposure: input.exposure(), ..PictureOptions::default() };
    write_picture(path, picture, layers, &options)?;
    Ok(())
}
