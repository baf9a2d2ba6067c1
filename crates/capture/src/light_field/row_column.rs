//! Grids whose files are named by row and column, or numbered row by row.
//!
//! Files of a folder whose names differ only in their numbers belong together. The last two numbers are row and column; if one of the
//! others varies, too, the two that vary. They may start anywhere and be padded or not. `c03_r01` and `x3_y1` are recognised.

use super::arrangement::{Arrangement, Placed, ViewLayout};
use super::numbered_grid::{MAX_SIDE, NumberedGrid};
use super::numbered_name::{NumberedName, parse_positions};
use crate::CaptureError;
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};

fn stem(file: &Path) -> String {
    file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// The row and column in a view's file name, and possibly its position.
struct Named {
    file: PathBuf,
    /// Row and column, counted from anywhere.
    cell: [u32; 2],
    /// y and x.
    place: Option<[f64; 2]>,
}

/// The grid numbered row by row (`input_Cam000`), if there is one; with these columns and rows if they are stated.
///
/// # Errors
/// The numbers do not tell how many columns there are.
pub(super) fn arrange_numbered(
    folder: &Path,
    files: &[PathBuf],
    grid: Option<[u32; 2]>,
) -> Result<Option<Arrangement>, CaptureError> {
    let number = |file: &PathBuf| {
        let name = NumberedName::parse(&stem(file))?;
        let is_camera = name.numbers.len() == 1
            && name.texts[0].trim_end_matches(['_', '-', ' ', '.']).ends_with("cam")
            && name.texts[1].is_empty();
        is_camera.then(|| (name.numbers[0], file.clone()))
    };
    let candidates: Vec<(u32, PathBuf)> = files.iter().filter_map(number).collect();
    let numbers: BTreeSet<u32> = candidates.iter().map(|(number, _)| *number).collect();
    let numbers: Vec<u32> = numbers.into_iter().collect();
    let [lowest, .., highest] = numbers[..] else { return Ok(None) };
    let NumberedGrid { columns, rows, first } = match grid {
        Some(grid) => NumberedGrid::stated(grid, &numbers),
        None => NumberedGrid::inferred(&numbers).map_err(|why| CaptureError::GridUnknown {
            folder: folder.into(),
            what: format!("{} views are numbered from {lowest} to {highest}: {why}", numbers.len()),
        })?,
    };
    let in_grid = |number: u32| number.checked_sub(first).filter(|index| *index < columns * rows);
    let (fit, beyond): (Vec<_>, Vec<_>) =
        candidates.into_iter().partition(|(number, _)| in_grid(*number).is_some());
    let named = fit.into_iter().filter_map(|(number, file)| {
        let index = in_grid(number)?;
        Some(Named { file, cell: [index / columns, index % columns], place: None })
    });
    let layout = ViewLayout::Numbered;
    let Some(mut arrangement) = arrange_grid(folder, named.collect(), layout, Some([columns, rows])) else {
        return Ok(None);
    };
    arrangement.first_number = first;
    let beyond: Vec<String> = beyond.into_iter().map(|(_, file)| stem(&file)).collect();
    if !beyond.is_empty() {
        let what = format!("numbers beyond a grid of {columns} × {rows}, which are ignored");
        arrangement.notes.push((what, beyond));
    }
    Ok(Some(arrangement))
}

/// The grid whose names have row, column and positions, if there is one.
pub(super) fn arrange_by_positions(folder: &Path, files: &[PathBuf]) -> Option<Arrangement> {
    let named = |file: &PathBuf| {
        let (cell, place) = parse_positions(&stem(file))?;
        Some(Named { file: file.clone(), cell, place: Some(place) })
    };
    arrange_grid(folder, files.iter().filter_map(named).collect(), ViewLayout::Positions, None)
}

/// The grid whose names have row and column, if there is one.
pub(super) fn arrange_by_row_column(folder: &Path, files: &[PathBuf]) -> Option<Arrangement> {
    let mut groups: HashMap<Vec<String>, Vec<(PathBuf, Vec<u32>)>> = HashMap::new();
    for file in files {
        if let Some(name) = NumberedName::parse(&stem(file)).filter(|name| name.numbers.len() >= 2) {
            groups.entry(name.texts).or_default().push((file.clone(), name.numbers));
        }
    }
    let mut groups: Vec<_> = groups.into_iter().collect();
    groups.sort_by(|(a_texts, a), (b_texts, b)| b.len().cmp(&a.len()).then(a_texts.cmp(b_texts)));
    let (texts, files) = groups.into_iter().next()?;
    let count = texts.len() - 1;
    let varies = |at: usize| files.iter().any(|(_, numbers)| numbers[at] != files[0].1[at]);
    let varying: Vec<usize> = (0..count).filter(|at| varies(*at)).collect();
    let (first, second) = match varying[..] {
        [] => return None,
        [only] => {
            if only + 1 == count || only > 0 {
                (only - 1, only)
            } else {
                (only, only + 1)
            }
        }
        [first, second] => (first, second),
        _ => return None,
    };
    // The letters before the numbers.
    let letters = |at: usize| -> String { texts[at].chars().filter(|c| c.is_ascii_alphabetic()).collect() };
    let names_axis = |at: usize, words: [&str; 4]| {
        words.iter().any(|word| letters(at).ends_with(word) && (word.len() > 1 || letters(at).len() == 1))
    };
    let is_swapped =
        names_axis(first, ["column", "col", "c", "x"]) && names_axis(second, ["row", "row", "r", "y"]);
    let cell = |numbers: &[u32]| {
        if is_swapped { [numbers[second], numbers[first]] } else { [numbers[first], numbers[second]] }
    };
    let named = files
        .iter()
        .map(|(file, numbers)| Named { file: file.clone(), cell: cell(numbers), place: None })
        .collect();
    let mut arrangement = arrange_grid(folder, named, ViewLayout::RowColumn, None)?;
    let [columns, rows] = arrangement.grid?;
    // Photographs may be named by date and number: a grid must be well filled, or a line of it named by little else
    // than numbers.
    let filled = arrangement.views.len() as f64 / f64::from(columns * rows);
    let is_cross = arrangement.views.len() as u32 + 1 >= columns + rows;
    let is_bare = texts.iter().all(|text| text.chars().filter(|c| c.is_alphabetic()).count() <= 4);
    let small = files.iter().all(|(_, numbers)| numbers[first] < 100 && numbers[second] < 100);
    arrangement.is_certain = small
        && if columns.min(rows) >= 2 {
            filled >= 0.2 || is_cross
        } else {
            is_bare && arrangement.views.len() >= 3
        };
    Some(arrangement)
}

/// The grid of named files; `None` if it has fewer than two views, or too many columns or rows.
fn arrange_grid(
    folder: &Path,
    named: Vec<Named>,
    layout: ViewLayout,
    grid: Option<[u32; 2]>,
) -> Option<Arrangement> {
    let least = |axis: usize| named.iter().map(|named| named.cell[axis]).min().unwrap_or(0);
    let first = if grid.is_some() { [0; 2] } else { [least(0), least(1)] };
    let mut by_cell: BTreeMap<[u32; 2], Named> = BTreeMap::new();
    let mut twice = Vec::new();
    for mut named in named {
        named.cell = [named.cell[0] - first[0], named.cell[1] - first[1]];
        match by_cell.entry(named.cell) {
            std::collections::btree_map::Entry::Occupied(_) => twice.push(stem(&named.file)),
            std::collections::btree_map::Entry::Vacant(place) => drop(place.insert(named)),
        }
    }
    if by_cell.len() < 2 {
        return None;
    }
    let count = |axis: usize| by_cell.keys().map(|cell| cell[axis]).max().unwrap_or(0).saturating_add(1);
    let [columns, rows] = grid.unwrap_or([count(1), count(0)]);
    if columns.max(rows) > MAX_SIDE {
        return None;
    }
    let step = |axis: usize| mean_step(by_cell.values(), axis);
    // Where only a line varies, the other axis has its step.
    let steps = [step(0), step(1)];
    let steps = [steps[0].or(steps[1].map(f64::abs)), steps[1].or(steps[0].map(f64::abs))];
    let views = by_cell.into_values().map(|named| {
        let [row, column] = named.cell;
        let position = match (named.place, steps) {
            // Rows and columns grow as their numbers do; whether that is right is detected from the pictures.
            (Some([y, x]), [Some(down), Some(right)]) => DVec2::new(x / right, y / down),
            _ => DVec2::new(f64::from(column), f64::from(row)),
        };
        Placed { name: stem(&named.file), cell: Some([column, row]), position, file: named.file }
    });
    let notes = if twice.is_empty() {
        Vec::new()
    } else {
        vec![("several files with the same row and column, of which one is used; ignored".to_owned(), twice)]
    };
    Some(Arrangement {
        layout,
        folder: folder.into(),
        views: views.collect(),
        grid: Some([columns, rows]),
        first_number: 0,
        reference: None,
        disparity: None,
        is_certain: true,
        notes,
    })
}

/// The mean step of the views' positions from one row (0) or column (1) to the next: least squares. `None` if it is
/// 0.
fn mean_step<'a>(views: impl Iterator<Item = &'a Named> + Clone, axis: usize) -> Option<f64> {
    let pairs = views.filter_map(|named| Some((f64::from(named.cell[axis]), named.place?[axis])));
    let count = pairs.clone().count() as f64;
    let mean =
        pairs.clone().fold([0.0; 2], |[cell, place], pair| [cell + pair.0 / count, place + pair.1 / count]);
    let [covariance, variance] = pairs.fold([0.0; 2], |[covariance, variance], (cell, place)| {
        [covariance + (cell - mean[0]) * (place - mean[1]), variance + (cell - mean[0]).powi(2)]
    });
    let step = covariance / variance;
    (step.is_finite() && step != 0.0).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(names: &[&str]) -> Option<(Vec<[u32; 2]>, [u32; 2], bool)> {
        let files: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
        let arrangement = arrange_by_row_column(Path::new(""), &files)?;
        let cells = arrangement.views.iter().filter_map(|view| view.cell).collect();
        Some((cells, arrangement.grid?, arrangement.is_certain))
    }

    #[test]
    fn counted_from_anywhere_and_padded_or_not() {
        let all = Some((vec![[0, 0], [1, 0], [0, 1], [1, 1]], [2, 2], true));
        for names in [
            ["0_0.png", "0_1.png", "1_0.png", "1_1.png"],
            ["1_1.png", "1_2.png", "2_1.png", "2_2.png"],
            ["09_09.png", "09_10.png", "10_09.png", "10_10.png"],
            ["view-9-9.jpg", "view-9-10.jpg", "view-10-9.jpg", "view-10-10.jpg"],
            ["scene7_r1c1.png", "scene7_r1c2.png", "scene7_r2c1.png", "scene7_r2c2.png"],
            ["x0y0.png", "x1y0.png", "x0y1.png", "x1y1.png"],
            ["0_0_rgb1.png", "0_1_rgb1.png", "1_0_rgb1.png", "1_1_rgb1.png"],
        ] {
            assert_eq!(cells(&names), all, "{names:?}");
        }
        // Natural order: 10 is after 9.
        let (row, grid, _) = cells(&["3_9.png", "3_10.png", "3_11.png"]).unwrap();
        assert_eq!((row, grid), (vec![[0, 0], [1, 0], [2, 0]], [3, 1]));
    }

    #[test]
    fn photographs_are_no_grid() {
        for names in [
            &["IMG_2023_0001.jpg", "IMG_2023_0002.jpg", "IMG_2023_0003.jpg"][..],
            &["20230101_101010.jpg", "20230102_111111.jpg"],
            &["DSC00001.jpg", "DSC00002.jpg"],
            &["holiday_1_1.jpg", "holiday_1_2.jpg", "holiday_1_3.jpg"],
        ] {
            assert!(cells(names).is_none_or(|(.., is_certain)| !is_certain), "{names:?}");
        }
    }

    #[test]
    fn positions_are_steps_that_grow_as_they_are_named() {
        let files = [
            "out_00_00_10.0_300.0_.png",
            "out_00_01_10.5_200.0_.png",
            "out_01_00_111.0_298.0_.png",
            "out_01_01_110.0_202.0_.png",
        ];
        let files: Vec<PathBuf> = files.iter().map(PathBuf::from).collect();
        let views = arrange_by_positions(Path::new(""), &files).unwrap().views;
        let across = views[1].position - views[0].position;
        let down = views[2].position - views[0].position;
        assert!((across.x - 1.0).abs() < 0.05 && across.y.abs() < 0.05, "{across}");
        assert!((down.y - 1.0).abs() < 0.05 && down.x.abs() < 0.05, "{down}");
    }
}
