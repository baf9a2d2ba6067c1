//! Locates the demo: beside the program, in its share folder, or in the source tree it was built from.

use std::path::{Path, PathBuf};

/// The project file of the demo; `None` if it is not installed.
pub fn demo_project() -> Option<PathBuf> {
    let program = std::env::current_exe().ok();
    let beside = program.as_deref().and_then(Path::parent);
    let folders = [
        beside.map(|folder| folder.join("assets/demo")),
        beside.map(|folder| folder.join("../share/focus-brush/demo")),
        Some(Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/demo")),
        Some(PathBuf::from("assets/demo")),
    ];
    let files = folders.into_iter().flatten().map(|folder| folder.join("demo.fbrush"));
    let file = files.into_iter().find(|file| file.is_file())?;
    Some(file.canonicalize().unwrap_or(file))
}

#[cfg(test)]
mod tests {
    use super::*;
    use document::{Input, Stage};
    use progress::Unwatched;

    #[test]
    fn the_demo_is_painted_and_fits_its_scene() {
        let file = demo_project().expect("assets/demo/demo.fbrush is there");
        let input = Input::open(&file, &Default::default(), &Unwatched).unwrap();
        assert_eq!(input.warnings, Vec::<String>::new(), "made for the scene beside it");
        let atlas = input.atlas(&Default::default(), &Unwatched).unwrap();
        let stage = Stage::new(input.lit_scene().unwrap(), atlas, &Unwatched).unwrap();
        let map = input.project.unwrap().focus_map.expect("it is painted");
        let sharp = stage.canvas.texels().filter(|t| map.at(t.x, t.y) == lens::FocusOffset::SHARP);
        let share = sharp.count() as f64 / stage.canvas.texels().len() as f64;
        assert!(share > 0.01 && share < 0.9, "some of it is painted sharp: {share}");
    }
}
