//! `focus-brush info`.

use crate::cli::arguments::InfoArguments;
use crate::cli::console::{Console, path_text, print_json, print_line};
use crate::cli::failure::Failure;
use crate::cli::input::{open_input, unwrap_options};
use document::{Input, InputKind};
use lens::Camera;
use progress::Unwatched;
use project::{ProjectFile, camera_to_json};
use render::{Modelled, RenderOptions};
use scene::{
    Animation, EXTRAS_KEY, Environment, Inspection, LoadOptions, MeshHealth, Scene, SceneCamera, View,
};
use serde_json::{Value, json};
use std::sync::Arc;

/// Prints what a file contains.
///
/// # Errors
/// The file cannot be read or is of an unsupported type.
pub fn run(arguments: &InfoArguments, console: &Console) -> Result<(), Failure> {
    let file = arguments.file.as_path();
    let kind = InputKind::from_path(file)?;
    let inspection = match kind {
        InputKind::Scene => {
            let variant = arguments.appearance.variant.clone().filter(|name| !name.is_empty());
            let options = LoadOptions { variant, ..LoadOptions::default() };
            Some(scene::inspect(file, &options).map_err(document::DocumentError::from)?)
        }
        _ => None,
    };
    if let Some(inspection) =
        inspection.as_ref().filter(|inspection| inspection.triangles + inspection.splats == 0)
    {
        let note = format!("{}: no triangle, so there is nothing to render", file.display());
        return report_empty_scene(arguments, inspection, &note, console);
    }
    let input =
        open_input(file, &arguments.appearance, arguments.layer.as_deref(), console.resources(), &Unwatched)?;
    console.warn(&input.warnings);
    let health = MeshHealth::measure(&input.scene);
    let modelled = count_modelled(&input, arguments.bake, console)?;
    if arguments.json {
        print_json(&json!({
            "file": path_text(file),
            "kind": match kind {
                InputKind::Scene => "scene",
                InputKind::Project => "project",
                InputKind::LightField => "light field",
                InputKind::Capture => "capture",
                InputKind::Splats => "splats",
            },
            "contents": inspection,
            "scene": scene_json(&input.scene),
            "mesh": health,
            "project": input.project.as_ref().map(project_json),
            "capture": capture_json(&input),
            "camera": camera_to_json(&input.camera),
            "salf": input.salf.as_ref().map(|salf| json!({
                "samples": salf.samples.len(),
                "bytes": salf.statistics().bytes,
                "margin_px": salf.margin_px,
                "baked_on": salf.baked_on.name(),
            })),
            "modelled": modelled.as_ref().map(modelled_json),
            "would_bake": { "width": input.camera.width, "height": input.camera.height },
            "warnings": input.warnings,
        }));
        return check_completeness(&input);
    }
    print_line(format!("{}", file.display()));
    if let Some(inspection) = &inspection {
        print_contents(inspection);
    }
    if let Some(project) = &input.project {
        print_project(project);
    }
    print_capture(&input);
    print_scene(&input.scene, &health);
    print_lenses(&input.scene);
    if let Some(modelled) = &modelled {
        print_modelled(modelled);
    }
    print_bake_estimate(&input.camera, &input.scene);
    check_completeness(&input)
}

fn check_completeness(input: &Input) -> Result<(), Failure> {
    if input.is_incomplete { Err(Failure::incomplete_capture(&input.path)) } else { Ok(()) }
}

fn capture_json(input: &Input) -> Option<Value> {
    let Scene { views, excluded_views: left_out, .. } = &*input.scene;
    let photograph = |view: &View| {
        json!({
            "name": view.name,
            "width": view.lens.size_px()[0],
            "height": view.lens.size_px()[1],
            "position": view.position().to_array(),
            "exposure_hint_stops": view.exposure_hint,
        })
    };
    let all = |views: &[View]| views.iter().map(photograph).collect::<Vec<_>>();
    let fit = input.mesh_fit.map(|fit| json!({ "agreement": fit.agreement, "patches": fit.patches }));
    (!views.is_empty())
        .then(|| json!({ "photographs": all(views), "left_out": all(left_out), "mesh_fit": fit }))
}

fn print_capture(input: &Input) {
    let Scene { views, excluded_views: left_out, .. } = &*input.scene;
    let Some(first) = views.first() else { return };
    let [width, height] = first.lens.size_px();
    let others =
        if views.iter().all(|view| view.lens.size_px() == [width, height]) { "" } else { " and others" };
    print_line(format!(
        "  photographs  {} of {width} × {height} px{others}, {} left out",
        views.len(),
        left_out.len()
    ));
    if let Some(fit) = &input.mesh_fit {
        print_line(format!("  mesh fit     {fit}"));
    }
}

/// Reports a file without triangles: its contents and a note.
fn report_empty_scene(
    arguments: &InfoArguments,
    inspection: &Inspection,
    note: &String,
    console: &Console,
) -> Result<(), Failure> {
    console.warn(&inspection.warnings);
    if arguments.json {
        let file = path_text(&arguments.file);
        print_json(&json!({ "file": file, "kind": "scene", "contents": inspection, "note": note }));
    } else {
        print_line(format!("{}", arguments.file.display()));
        print_contents(inspection);
        print_line(format!("note: {note}"));
    }
    Ok(())
}

fn print_contents(inspection: &Inspection) {
    const MODES: [&str; 7] =
        ["points", "lines", "line loops", "line strips", "triangles", "triangle strips", "triangle fans"];
    let Inspection { nodes, meshes, materials, images, cameras, lights, skins, animations, .. } = inspection;
    if let Some(generator) = &inspection.generator {
        print_line(format!("  written by   {generator}"));
    }
    print_line(format!(
        "  file         {nodes} nodes, {meshes} meshes, {materials} materials, {images} images"
    ));
    print_line(format!(
        "               {cameras} cameras, {lights} lights, {skins} skins, {animations} animations"
    ));
    for Animation { name, seconds, channels } in &inspection.animation_list {
        print_line(format!("  animation    {name:?}: {seconds:.3} s, {channels} channels"));
    }
    let modes = inspection.primitives.iter().zip(MODES).filter(|(count, _)| **count > 0);
    let modes: Vec<_> = modes.map(|(count, mode)| format!("{count} × {mode}")).collect();
    print_line(format!("  primitives   {}", if modes.is_empty() { "none".into() } else { modes.join(", ") }));
    if !inspection.extensions_used.is_empty() {
        print_line(format!("  extensions   {}", inspection.extensions_used.join(", ")));
    }
}

fn print_project(project: &ProjectFile) {
    print_line(format!("  scene        {}", project.scene.display()));
    let names: Vec<_> = project.cameras.iter().map(|camera| format!("\"{}\"", camera.name)).collect();
    print_line(format!("  cameras      {}", names.join(", ")));
    match &project.focus_map {
        Some(map) => print_line(format!("  focus map    {} × {} texels", map.width(), map.height())),
        None => print_line("  focus map    nothing painted"),
    }
}

fn project_json(project: &ProjectFile) -> Value {
    json!({
        "scene": path_text(&project.scene),
        "scene_state": format!("{:?}", project.scene_state()).to_lowercase(),
        "cameras": project.cameras.iter().map(|camera| &camera.name).collect::<Vec<_>>(),
        "active_camera": project.active_camera,
        "exposure": format!("{:?}", project.exposure).to_lowercase(),
        "focus_map": project.focus_map.as_ref().map(|map| map.size()),
    })
}

fn print_scene(scene: &Scene, health: &MeshHealth) {
    let invented_note = |is_invented: bool| if is_invented { " (made up: the file has none)" } else { "" };
    if health.triangles > 0 {
        print_line(format!(
            "  scene        {} triangles in {} parts of {} objects, area {:.4}",
            health.triangles,
            scene.parts.len(),
            scene.nodes.len(),
            health.area
        ));
    }
    print_splats(scene);
    if let Some(picture) = &scene.picture {
        print_line(format!("  picture      {}", picture.origin));
    }
    let size = std::array::from_fn::<f64, 3, _>(|k| health.high[k] - health.low[k]);
    print_line(format!("  size         {:.4} × {:.4} × {:.4}", size[0], size[1], size[2]));
    let names: Vec<_> = scene.cameras.iter().map(|camera| format!("\"{}\"", camera.name)).collect();
    print_line(format!("  cameras      {}{}", names.join(", "), invented_note(scene.has_default_camera)));
    print_line(format!("  lights       {}", scene.lights.len()));
    if let Some(name) = own_environment_name(scene) {
        let override_note = if scene.world.is_some() { "; another world was chosen" } else { "" };
        print_line(format!("  lit by       {name}{override_note}"));
    }
    if !scene.variants.is_empty() {
        let names: Vec<_> = scene.variants.iter().map(|name| format!("{name:?}")).collect();
        let chosen = scene.variant.as_ref();
        let chosen =
            chosen.map_or_else(|| "none: the scene's own materials".into(), |name| format!("{name:?}"));
        print_line(format!("  variants     {} (chosen: {chosen})", names.join(", ")));
    }
    if health.triangles > 0 {
        print_line(format!("  mesh         {}", mesh_sentence(health)));
    }
}

fn print_splats(scene: &Scene) {
    let Some(splats) = &scene.splats else { return };
    let cloud = &splats.cloud;
    print_line(format!(
        "  splats       {} of {}, colours of degree {}, {:.1} MiB",
        cloud.len(),
        splats.format,
        cloud.degree(),
        cloud.bytes() as f64 / f64::from(1 << 20)
    ));
    if cloud.hidden_count() > 0 {
        print_line(format!("               {} of them are hidden", cloud.hidden_count()));
    }
    if let Some(file) = &splats.file {
        print_line(format!("               from {}", path_text(file)));
    }
    print_line(
        "               they send their own light: no lamp or world lights them, and mirrors do not show them",
    );
}

fn splats_json(scene: &Scene) -> Option<Value> {
    let splats = scene.splats.as_ref()?;
    Some(json!({
        "count": splats.cloud.len(),
        "format": splats.format,
        "degree": splats.cloud.degree(),
        "left_out": splats.cloud.left_out().rows().len(),
        "hidden": splats.cloud.hidden_count(),
        "file": splats.file.as_deref().map(path_text),
        "bytes": splats.cloud.bytes(),
    }))
}

/// The name of the environment that the scene itself provides, if any.
fn own_environment_name(scene: &Scene) -> Option<&str> {
    match &scene.embedded_world.as_ref()?.environment {
        Environment::Map(map) => Some(&map.name),
        Environment::Uniform(_) => None,
    }
}

fn mesh_sentence(health: &MeshHealth) -> String {
    let counts = [
        (health.degenerate, "degenerate triangles"),
        (health.duplicates, "duplicate triangles"),
        (health.inverted, "triangles that face away from the outside of a closed mesh (--back-faces show)"),
        (health.non_manifold_edges, "edges of more than two triangles"),
        (health.boundary_edges, "open edges"),
        (health.without_uv, "triangles without texture coordinates"),
    ];
    let defects: Vec<_> =
        counts.iter().filter(|(count, _)| *count > 0).map(|(n, what)| format!("{n} {what}")).collect();
    if defects.is_empty() { "closed, no defects".into() } else { defects.join(", ") }
}

/// Counts what is modelled: in the light field that the file is, or in one baked for a small picture if `bake`.
fn count_modelled(input: &Input, bake: bool, console: &Console) -> Result<Option<BakedField>, Failure> {
    // Unwrapping is slow: without --bake only a stored atlas is used.
    let is_stored = input.project.as_ref().is_some_and(|project| project.atlas.is_some());
    if !bake && input.salf.is_none() {
        return Ok(None);
    }
    let atlas = if bake || is_stored { Some(input.atlas(&unwrap_options(None), console)?) } else { None };
    let lit = input.lit_scene()?;
    let salf = match &input.salf {
        Some(salf) => salf.clone(),
        None => {
            let camera = reduced_camera(&input.camera);
            let focus = input.focus(None, &unwrap_options(None), console)?;
            let tolerance_px = RenderOptions::default().tolerance_px;
            Arc::new(render::bake(&lit, &camera, &focus, tolerance_px, console)?)
        }
    };
    let size = [salf.camera.width, salf.camera.height];
    Ok(Some(BakedField { modelled: Modelled::measure(&salf, lit.tracer(), atlas.as_deref()), size }))
}

/// The contents of a light field baked for a picture of this size.
struct BakedField {
    modelled: Modelled,
    size: [u32; 2],
}

/// Height of the picture that `--bake` bakes, px.
const BAKE_HEIGHT_PX: u32 = 180;

/// The camera with a reduced picture size.
fn reduced_camera(camera: &Camera) -> Camera {
    let height = camera.height.min(BAKE_HEIGHT_PX);
    let width = (f64::from(height) * camera.aspect()).round().max(1.0) as u32;
    Camera { width, height, ..camera.clone() }
}

fn modelled_json(field: &BakedField) -> Value {
    json!({
        "width": field.size[0],
        "height": field.size[1],
        "kinds": field.modelled.rows(),
        "texels_asked": field.modelled.texels.map(|texels| texels.sampled),
        "bytes_a_sample": field.modelled.bytes_a_sample(),
    })
}

fn print_modelled(BakedField { modelled, size }: &BakedField) {
    let [width, height] = size;
    print_line(format!("  modelled     for {width} × {height} px    texels     samples        bytes"));
    let text = |value: Option<usize>| value.map_or_else(|| "–".into(), |n| n.to_string());
    for row in modelled.rows() {
        let [texels, samples, bytes] = [row.texels, row.samples, row.bytes].map(text);
        print_line(format!("    {:<22} {texels:>13} {samples:>11} {bytes:>12}", row.kind));
    }
    print_line(format!("    {:.1} bytes a visible sample", modelled.bytes_a_sample()));
}

fn scene_json(scene: &Scene) -> Value {
    json!({
        "path": path_text(&scene.path),
        "triangles": scene.triangles.len(),
        "parts": scene.parts.len(),
        "nodes": scene.nodes.iter().map(|node| &node.name).collect::<Vec<_>>(),
        "materials": scene.materials.iter().map(|material| &material.name).collect::<Vec<_>>(),
        "cameras": scene.cameras.iter().map(|camera| &camera.name).collect::<Vec<_>>(),
        "camera_lenses": scene.cameras.iter().map(lens_json).collect::<Vec<_>>(),
        "camera_is_invented": scene.has_default_camera,
        "image_based_light": own_environment_name(scene),
        "variants": scene.variants,
        "variant": scene.variant,
        "lights": scene.lights.len(),
        "splats": splats_json(scene),
        "picture": scene.picture.as_ref().map(|picture| &picture.origin),
    })
}

/// Fields of a camera file that glTF provides.
const GLTF_FIELDS: [&str; 2] = ["yfov", "camera_to_world"];
/// Fields that a file may provide in `extras`; otherwise defaults apply (focus distance: the first surface
/// ahead).
const EXTRAS_FIELDS: [&str; 7] =
    ["width", "height", "focus_distance", "aperture_radius", "sensor_height", "shift", "aperture"];

/// The source of each field of a scene camera.
fn lens_json(camera: &SceneCamera) -> Value {
    let from_extras = camera.lens.specified_fields();
    let default: Vec<&str> = EXTRAS_FIELDS.into_iter().filter(|field| !from_extras.contains(field)).collect();
    json!({ "name": camera.name, "gltf": GLTF_FIELDS, "extras": from_extras, "default": default })
}

fn print_lenses(scene: &Scene) {
    for camera in scene.cameras.iter().filter(|_| !scene.has_default_camera) {
        let from_extras = camera.lens.specified_fields();
        let lens = match from_extras.is_empty() {
            true => "no lens in the file: the default one, focused on the first surface ahead".into(),
            false => format!("from extras.{EXTRAS_KEY}: {}", from_extras.join(", ")),
        };
        print_line(format!("  camera       {}: {lens}", camera.name));
    }
}

fn print_bake_estimate(camera: &Camera, scene: &Scene) {
    let optics = camera.optics();
    let pixels = camera.width as f64 * camera.height as f64;
    print_line(format!(
        "  would bake   {} × {} px, f/{:.2}, focused at {:.3}, {:.1}° high: about {:.1} million samples",
        camera.width,
        camera.height,
        camera.f_number(),
        camera.focus_distance,
        camera.yfov.to_degrees(),
        pixels / 1e6
    ));
    let depths = visible_depth_range(camera, scene);
    if let Some((near, far)) = depths {
        let blur = |depth: f64| optics.circle_of_confusion_px(optics.standard_kappa(1.0 / depth));
        print_line(format!(
            "               depths {near:.3} to {far:.3}: circles of confusion up to {:.1} px near, {:.1} px far",
            if near < camera.focus_distance { blur(near) } else { 0.0 },
            if far > camera.focus_distance { blur(far) } else { 0.0 },
        ));
    }
}

/// The smallest and largest depth of the vertices inside the picture.
fn visible_depth_range(camera: &Camera, scene: &Scene) -> Option<(f64, f64)> {
    let optics = camera.optics();
    let [width, height] = [camera.width, camera.height].map(f64::from);
    let in_picture = scene.positions.iter().map(|&p| camera.camera_from_world(p)).filter(|p| {
        let pixel = camera.pixel_from_q(optics.chief(*p));
        p.z > 0.0 && (0.0..=width).contains(&pixel.x) && (0.0..=height).contains(&pixel.y)
    });
    in_picture.map(|p| p.z).fold(None, |range, z| {
        Some(range.map_or((z, z), |(near, far): (f64, f64)| (near.min(z), far.max(z))))
    })
}
