//! Seven views: a centre and six on a ring around it.
//!
//! `center.png` (`centre`, `central`, `middle`) with `0.png` to `5.png` (or `1` to `6`, or `ring_0` …), or `view_0.png` (`hex_0`), which is
//! the centre, to `view_6.png`. The ring has the radius 1; its first view is right of the centre, and each further one is 60° on,
//! counter-clockwise in the picture: the second is right above.

use super::arrangement::{Arrangement, Placed, ViewLayout};
use super::numbered_name::NumberedName;
use glam::DVec2;
use std::path::{Path, PathBuf};

/// Names of the centre.
const MIDDLES: [&str; 5] = ["center", "centre", "central", "middle", "mid"];

/// The position of a view on the ring, numbered from 0: x right, y down.
fn on_ring(number: usize) -> DVec2 {
    let angle = std::f64::consts::FRAC_PI_3 * number as f64;
    DVec2::new(angle.cos(), -angle.sin())
}

/// The hexagon of a folder's files, if it is one.
pub(super) fn arrange_hexagon(folder: &Path, files: &[PathBuf]) -> Option<Arrangement> {
    let stem = |file: &PathBuf| file.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
    let middle = files.iter().find(|file| {
        let stem = stem(file);
        MIDDLES.iter().any(|name| stem == *name || stem.ends_with(&format!("_{name}")))
    });
    let mut numbered: Vec<(u32, String, &PathBuf)> = files
        .iter()
        .filter(|file| Some(*file) != middle)
        .filter_map(|file| {
            let name = NumberedName::parse(&stem(file))
                .filter(|name| name.numbers.len() == 1 && name.texts[1].is_empty())?;
            Some((name.numbers[0], name.texts[0].trim_end_matches(['_', '-', ' ']).to_owned(), file))
        })
        .collect();
    numbered.sort();
    let first = numbered.first()?.0;
    let in_order = numbered
        .iter()
        .enumerate()
        .all(|(at, (number, text, _))| *number == first + at as u32 && *text == numbered[0].1);
    let ordered: Vec<PathBuf> = match (middle, numbered.len()) {
        (Some(middle), 6) if in_order && first <= 1 => {
            std::iter::once(middle).chain(numbered.iter().map(|(.., file)| *file)).cloned().collect()
        }
        (None, 7)
            if in_order
                && first <= 1
                && ["view", "hex", "hexagon", "sai"].contains(&numbered[0].1.as_str()) =>
        {
            numbered.iter().map(|(.., file)| (*file).clone()).collect()
        }
        _ => return None,
    };
    let views = ordered.into_iter().enumerate().map(|(at, file)| {
        let position = if at == 0 { DVec2::ZERO } else { on_ring(at - 1) };
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Placed { name, cell: None, position, file }
    });
    Some(Arrangement {
        layout: ViewLayout::Hexagon,
        folder: folder.into(),
        views: views.collect(),
        grid: None,
        first_number: 0,
        reference: Some(0),
        disparity: None,
        is_certain: true,
        notes: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(files: &[&str]) -> Option<Vec<String>> {
        let files: Vec<PathBuf> = files.iter().map(PathBuf::from).collect();
        Some(arrange_hexagon(Path::new(""), &files)?.views.into_iter().map(|view| view.name).collect())
    }

    #[test]
    fn seven_names() {
        let ring = ["0.png", "1.png", "2.png", "3.png", "4.png", "5.png"];
        let seven = |middle: &'static str| [&ring[..], &[middle]].concat();
        assert_eq!(names(&seven("center.png")).unwrap()[..3], ["center", "0", "1"]);
        assert!(names(&seven("6.png")).is_none() && names(&seven("cat.png")).is_none());
        assert!(names(&ring).is_none());
        let views: Vec<String> = (0..7).map(|k| format!("view_{k}.png")).collect();
        let views: Vec<&str> = views.iter().map(String::as_str).collect();
        assert_eq!(names(&views).unwrap()[..2], ["view_0", "view_1"]);
        assert!(names(&views[1..]).is_none());
    }

    #[test]
    fn the_second_is_right_above() {
        assert!(on_ring(0).abs_diff_eq(DVec2::X, 1e-12));
        let second = on_ring(1);
        assert!((second.x - 0.5).abs() < 1e-12 && second.y < -0.8);
        let sum: DVec2 = (0..6).map(on_ring).sum();
        assert!(sum.length() < 1e-12);
    }
}
