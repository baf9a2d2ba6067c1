//! The demo, shown at first start.

use crate::window::installed;
use std::path::PathBuf;

/// The project file of the demo; `None` if it is not installed.
pub fn demo_project() -> Option<PathBuf> {
    installed::find("share/focus-brush/demo", "assets/demo", "demo.fbrush")
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
