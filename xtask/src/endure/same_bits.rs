//! Pictures drawn on the processor and on a graphics card: the same files.

mod captures;
pub mod scenes;

use super::harness::promise::{Context, Promise, Verdict, Workplace};
use std::collections::BTreeSet;
use std::path::Path;

/// Processor and card: the same bits.
pub const PROMISE: Promise = Promise {
    name: "same-bits",
    sentence: "Processor and card: the same bits",
    what_is_done: "twenty scenes of all inputs (scenes with and without light, textures, worlds, projects, light \
                   fields, captures, pictures with depth, frames) through all kinds of lenses, each drawn with --backend \
                   cpu and --backend gpu: the files are compared byte for byte",
    full: DRAWN.len(),
    short: 6,
    batch: 2,
    at_once: 1,
    prepare,
    case: draw,
};

/// What is drawn; `@` is the folder of inputs. Every input of another kind is among the first six.
const DRAWN: [&str; 20] = [
    "render @/walls.glb --camera @/cam.json -o o.exr",
    "render @/p.fbrush --size 160x120 -o o.png",
    "render @/l.salf --focus @/recipe.json -o o.exr",
    "render @/depth/a.jpg -o o.exr",
    "render @/p.fbrush --frames 1-2 --size 64x48 -o o.####.exr",
    "render @/lit.glb --camera @/dark.json --bokeh @/bokeh.json -o o.exr",
    "render @/views -o o.exr",
    "render @/photos --camera photo:1.png --aperture-radius 0.05 -o o.exr",
    "render @/painted.fbrush --exposure conserve -o o.exr",
    "render @/texture.gltf --camera @/cam.json --size 200x150 -o o.exr",
    "render @/lit.glb --camera @/dark.json --world @/world.json -o o.exr",
    "render @/metal.glb --camera @/dark.json --focus @/gloss.json -o o.exr",
    "render @/walls.glb --camera @/cam.json --lens @/lens.json --size 300x200 -o o.exr",
    "render @/walls.glb --camera @/cam.json --aperture-radius 0.8 --size 256x256 -o o.exr",
    "render @/walls.glb --camera @/cam.json --stereo anaglyph -o o.png",
    "render @/walls.glb --camera @/cam.json --tolerance 0 -o o.exr",
    "render @/walls.glb --camera @/cam.json --tolerance 6 --cells 2 -o o.exr",
    "render @/painted.fbrush --aov alpha,crypto,coverage,coc,depth,t,pinhole --half --overscan 9 -o o.exr",
    "render @/walls.glb --camera @/cam.json --bokeh @/bokeh.json --size 333x77 -o o.exr",
    "render @/lit.glb --camera @/dark.json --light-passes 2 --size 48x48 -o o.exr",
];

/// Exit code where there is no card.
const NO_CARD: i32 = 5;

fn prepare(folder: &Path, context: &Context) -> Result<(), String> {
    if folder.join("painted.fbrush").exists() {
        return Ok(());
    }
    scenes::write(folder, context)?;
    captures::write(folder)?;
    let run = context.program.line(folder, "render s.glb --camera cam.json --backend gpu -o card.png").run();
    match run.code {
        Some(NO_CARD) => Err(run.last_line().trim_start_matches("error: ").to_owned()),
        _ => scenes::write_painted(folder, context),
    }
}

fn draw(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let command = DRAWN[case % DRAWN.len()].replace("@/", "../../prepared/");
    let mut names = BTreeSet::new();
    for backend in ["cpu", "gpu"] {
        let folder = place.own.join(backend);
        std::fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
        context.program.line(&folder, &format!("{command} --backend {backend}")).succeed()?;
        let entries = std::fs::read_dir(&folder).map_err(|e| e.to_string())?;
        names.extend(entries.flatten().map(|entry| entry.file_name()));
    }
    if names.is_empty() {
        return Err(format!("focus-brush {command}: no file"));
    }
    for name in names {
        let [processor, card] =
            ["cpu", "gpu"].map(|backend| std::fs::read(place.own.join(backend).join(&name)));
        let shown = name.to_string_lossy();
        let [processor, card] = [processor, card].map(|bytes| bytes.map_err(|e| format!("{shown}: {e}")));
        let (processor, card) = (processor?, card?);
        if processor != card {
            let at = processor.iter().zip(&card).position(|(a, b)| a != b);
            let at = at.unwrap_or(processor.len().min(card.len()));
            return Err(format!("focus-brush {command}: {shown} differs with --backend gpu at byte {at}"));
        }
    }
    Ok(())
}
