//! Light fields in common layouts: which views there are, their positions, what is missing, which way rows run.

use crate::made_light::{PARAMETERS, SIDE, attributes, disparity_pfm, grid, pfm, put, save, view};
use capture::{
    CaptureError, CaptureKind, DepthMeaning, LightField, LightFieldOptions, PictureSource, ViewLayout,
    detect_capture_kind, open_light_field,
};
use glam::DVec2;
use progress::Unwatched;
use scene::LoadOptions;
use std::path::{Path, PathBuf};

fn open(path: &Path) -> Result<LightField, CaptureError> {
    open_light_field(path, &LightFieldOptions::default(), &Unwatched)
}

/// The error of a path that does not open.
fn refused(path: &Path) -> String {
    let text = open(path).unwrap_err().to_string();
    assert!(text.contains(": ") && text.ends_with(')') && !text.contains('\n'), "{text}");
    text
}

/// Opens a folder that is recognised as a light field.
fn opened(folder: &Path) -> LightField {
    assert_eq!(detect_capture_kind(folder).unwrap(), CaptureKind::LightField);
    open(folder).unwrap()
}

/// Whether each view has the position of its picture: that of (column, row) of a grid of `columns` × `rows`.
fn assert_grid(field: &LightField, columns: u32, rows: u32) {
    assert_eq!(field.grid, Some([columns, rows]));
    assert_eq!(field.size, [SIDE; 2]);
    for subaperture in &field.views {
        let expected = view(subaperture.position.x, subaperture.position.y);
        let picture = image::open(subaperture.picture.file()).unwrap().into_rgb8();
        assert!(picture == expected, "{} is not at {}", subaperture.name, subaperture.position);
    }
    assert_eq!(field.views[field.reference].position, DVec2::ZERO);
}

fn remarks_text(field: &LightField) -> String {
    field.remarks.iter().map(|remark| format!("{remark}\n")).collect()
}

type Names = fn(u32, u32) -> String;

#[test]
fn layouts_with_row_and_column_in_the_names() {
    let names: [(Names, ViewLayout); 8] = [
        (|x, y| format!("{y:02}_{x:02}.png"), ViewLayout::RowColumn),
        (|x, y| format!("{}_{}.png", y + 1, x + 1), ViewLayout::RowColumn),
        (|x, y| format!("lf/{y:02}_{x:02}.png"), ViewLayout::RowColumn),
        (|x, y| format!("viewpoints_3px/{y}_{x}.png"), ViewLayout::RowColumn),
        (|x, y| format!("row{}-col{}.png", y + 9, x + 9), ViewLayout::RowColumn),
        (|x, y| format!("x{x}_y{y}.png"), ViewLayout::RowColumn),
        (|x, y| format!("input_Cam{:03}.png", y * 3 + x), ViewLayout::Numbered),
        (
            |x, y| {
                format!(
                    "out_{y:02}_{x:02}_{}_{}_.png",
                    10.5 + 100.0 * f64::from(y),
                    700.25 - 100.0 * f64::from(x)
                )
            },
            ViewLayout::Positions,
        ),
    ];
    for (name, layout) in names {
        let folder = tempfile::tempdir().unwrap();
        grid(folder.path(), 3, 3, name);
        put(&folder.path().join("parameters.cfg"), PARAMETERS);
        // Files that are not views.
        put(&folder.path().join("mask_00_07.png"), "no picture");
        let field = opened(folder.path());
        assert_eq!((field.layout, field.views.len(), field.reference), (layout, 9, 4), "{}", name(0, 0));
        if layout == ViewLayout::Positions {
            // The names say that columns run to the left, the pictures do not.
            for (subaperture, expected) in field
                .views
                .iter()
                .zip((0..9).map(|at| DVec2::new(f64::from(at % 3 - 1), f64::from(at / 3 - 1))))
            {
                let position = subaperture.position;
                assert!(
                    position.abs_diff_eq(expected, 1e-9) || position.abs_diff_eq(-expected, 1e-9),
                    "{position} {expected}"
                );
            }
        } else {
            assert_grid(&field, 3, 3);
        }
        assert!(field.remarks.iter().all(|remark| !remark.is_incomplete), "{}", remarks_text(&field));
        assert_eq!(field.optics.baseline_mm, Some(11.0));
    }
}

#[test]
fn rows_from_the_bottom_up_are_detected_and_reported() {
    for rows_reversed in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        grid(folder.path(), 3, 3, |x, y| format!("{}_{x}.png", if rows_reversed { 2 - y } else { y }));
        let field = opened(folder.path());
        assert_grid(&field, 3, 3);
        assert_eq!(
            remarks_text(&field).contains("rows run from the bottom up, as parallax shows"),
            rows_reversed,
            "{}",
            remarks_text(&field)
        );
    }
}

#[test]
fn a_column_named_before_its_row_is_detected_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    grid(folder.path(), 3, 3, |x, y| format!("{x}_{y}.png"));
    let field = opened(folder.path());
    assert_grid(&field, 3, 3);
    assert!(remarks_text(&field).contains("the column is named before the row"), "{}", remarks_text(&field));
}

#[test]
fn columns_from_right_to_left_are_detected_by_the_disparity_map() {
    let folder = tempfile::tempdir().unwrap();
    grid(folder.path(), 3, 3, |x, y| format!("{y}_{}.png", 2 - x));
    put(&folder.path().join("gt_disp_lowres.pfm"), disparity_pfm());
    let field = opened(folder.path());
    assert_grid(&field, 3, 3);
    assert!(remarks_text(&field).contains("columns run from right to left"), "{}", remarks_text(&field));
}

#[test]
fn one_row_determines_nothing_about_others() {
    let folder = tempfile::tempdir().unwrap();
    grid(folder.path(), 3, 1, |x, _| format!("input_Cam{:03}.png", 3 + x));
    put(&folder.path().join("parameters.cfg"), PARAMETERS);
    let field = opened(folder.path());
    assert_grid(&field, 3, 3);
    assert!(remarks_text(&field).contains("all views lie in one line"), "{}", remarks_text(&field));
    assert!(
        remarks_text(&field).contains("6 of 3 × 3 views are missing: number 0, number 1"),
        "{}",
        remarks_text(&field)
    );
    assert!(field.remarks.iter().any(|remark| remark.is_incomplete && remark.names.len() == 6));
}

#[test]
fn numbered_views_without_parameters_are_a_square() {
    let names: [Names; 3] = [
        |x, y| format!("input_Cam{:03}.png", y * 5 + x),
        |x, y| format!("input_Cam{}.png", y * 5 + x + 1),
        |x, y| format!("views/cam_{}.png", y * 5 + x),
    ];
    for name in names {
        let folder = tempfile::tempdir().unwrap();
        grid(folder.path(), 5, 5, name);
        assert_eq!(detect_capture_kind(folder.path()).unwrap(), CaptureKind::LightField);
        let field = opened(folder.path());
        assert_grid(&field, 5, 5);
        assert_eq!((field.views.len(), field.reference, field.layout), (25, 12, ViewLayout::Numbered));
        assert!(field.remarks.is_empty(), "{}", remarks_text(&field));
        // One is missing.
        std::fs::remove_file(folder.path().join(name(2, 1))).unwrap();
        let field = opened(folder.path());
        assert_grid(&field, 5, 5);
        let number = if name(0, 0).contains('1') { 8 } else { 7 };
        let told = format!("1 of 5 × 5 views are missing: number {number} (");
        assert!(remarks_text(&field).contains(&told), "{}", remarks_text(&field));
    }
}

#[test]
fn the_numbered_views_of_the_shared_cases_are_where_those_named_by_row_and_column_are() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/cases/field2/20-light-fields-by-other-names");
    if !folder.is_dir() {
        println!("SKIPPED: there is no {}", folder.display());
        return;
    }
    let [numbered, named] = ["hci25", "base"].map(|name| opened(&folder.join(name)));
    assert_eq!((numbered.grid, numbered.views.len()), (Some([5, 5]), 25));
    for (a, b) in numbered.views.iter().zip(&named.views) {
        let pixels = [a, b].map(|view| std::fs::read(view.picture.file()).unwrap());
        assert!(a.position == b.position && pixels[0] == pixels[1], "{} and {}", a.name, b.name);
    }
}

#[test]
fn numbered_views_that_could_be_several_grids_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    grid(folder.path(), 5, 3, |x, y| format!("input_Cam{:03}.png", y * 5 + x));
    let text = detect_capture_kind(folder.path()).unwrap_err().to_string();
    for part in ["15 views are numbered from 0 to 14", "5 × 3, 3 × 5", "num_cams_x = COLUMNS", "views.json"]
    {
        assert!(text.contains(part), "{text}");
    }
    put(&folder.path().join("parameters.cfg"), "num_cams_x = 5\nnum_cams_y = 3\n");
    assert_grid(&opened(folder.path()), 5, 3);
}

#[test]
fn crosses_and_gaps() {
    let folder = tempfile::tempdir().unwrap();
    grid(folder.path(), 5, 5, |x, y| format!("{y}_{x}.png"));
    let remove = |x: u32, y: u32| std::fs::remove_file(folder.path().join(format!("{y}_{x}.png"))).unwrap();
    remove(0, 1);
    let field = opened(folder.path());
    assert_grid(&field, 5, 5);
    assert!(
        remarks_text(&field).contains("1 of 5 × 5 views are missing: row 1 column 0"),
        "{}",
        remarks_text(&field)
    );
    (0..5)
        .flat_map(|y| (0..5).map(move |x| (x, y)))
        .filter(|(x, y)| *x != 2 && *y != 2 && (*x, *y) != (0, 1))
        .for_each(|(x, y)| remove(x, y));
    let field = opened(folder.path());
    assert_grid(&field, 5, 5);
    assert_eq!(field.views.len(), 9);
    assert!(
        remarks_text(&field).contains("a cross of 5 and 5 views")
            && field.remarks.iter().all(|remark| !remark.is_incomplete)
    );
}

#[test]
fn unusable_views_are_reported_and_the_others_used() {
    let folder = tempfile::tempdir().unwrap();
    grid(folder.path(), 3, 3, |x, y| format!("{y}_{x}.png"));
    put(&folder.path().join("0_0.png"), "no picture");
    save(&image::RgbImage::new(10, 10), &folder.path().join("0_2.png"));
    std::fs::copy(folder.path().join("1_1.png"), folder.path().join("01_01.png")).unwrap();
    let field = opened(folder.path());
    assert_eq!(field.views.len(), 7);
    let text = remarks_text(&field);
    for expected in [
        "views that cannot be used: 0_0 (cannot be decoded",
        "are ignored: 0_2 (10 × 10 px)",
        "of which one is used; ignored: 1_1",
        "2 of 3 × 3 views are missing",
    ] {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    // A picture that is truncated after its header.
    let file = folder.path().join("2_1.png");
    let bytes = std::fs::read(&file).unwrap();
    put(&file, &bytes[..bytes.len() / 2]);
    let field = open(folder.path()).unwrap();
    assert!(
        field.remarks.iter().any(|remark| remark.is_incomplete && remark.text.contains("2_1.png")),
        "{:?}",
        field.remarks
    );
}

#[test]
fn a_hexagon_with_the_disparity_of_its_middle() {
    let folder = tempfile::tempdir().unwrap();
    let ring = |k: usize| {
        let angle = std::f64::consts::FRAC_PI_3 * k as f64;
        DVec2::new(angle.cos(), -angle.sin())
    };
    for (names, first) in [
        (["center", "0", "1", "2", "3", "4", "5"], "center"),
        (["view_0", "view_1", "view_2", "view_3", "view_4", "view_5", "view_6"], "view_0"),
    ] {
        let place = folder.path().join(first);
        for (k, name) in names.iter().enumerate() {
            let at = if k == 0 { DVec2::ZERO } else { ring(k - 1) };
            save(&view(at.x, at.y), &place.join(format!("{name}.png")));
        }
        put(&place.join("disparity.pfm"), disparity_pfm());
        let field = opened(&place);
        assert_eq!(
            (field.layout, field.grid, field.views[field.reference].name.as_str()),
            (ViewLayout::Hexagon, None, first)
        );
        for (k, subaperture) in field.views.iter().enumerate().skip(1) {
            assert!(subaperture.position.abs_diff_eq(ring(k - 1), 1e-12));
        }
        let disparity = field.disparity.as_ref().unwrap();
        assert_eq!(
            (disparity.view, disparity.map.meaning, disparity.map.range()),
            (0, DepthMeaning::Disparity, Some([-1.0, 1.5]))
        );
        assert_eq!(field.remarks, [], "{}", remarks_text(&field));
    }
}

#[test]
fn a_list_of_views() {
    let folder = tempfile::tempdir().unwrap();
    let places = [("m.png", 0.0, 0.0), ("sub/r.png", 1.25, 0.0), ("d.png", 0.0, 1.5), ("gone.png", 5.0, 5.0)];
    places[..3].iter().for_each(|(name, x, y)| save(&view(*x, *y), &folder.path().join(name)));
    let views: Vec<String> = places
        .iter()
        .map(|(name, x, y)| format!("{{\"file\": \"{name}\", \"position\": [{}, {}]}}", x + 7.0, y - 2.0))
        .collect();
    let list = |rest: &str| format!("{{\"views\": [\n{}\n]{rest}}}", views.join(",\n"));
    let file = folder.path().join("views.json");
    put(&file, list(", \"reference\": \"m.png\", \"disparity\": \"map.pfm\""));
    put(&folder.path().join("map.pfm"), disparity_pfm());
    let field = opened(folder.path());
    assert_eq!(field.layout, ViewLayout::Listed);
    for (subaperture, (name, x, y)) in field.views.iter().zip(places) {
        assert!(subaperture.name == name && subaperture.position.abs_diff_eq(DVec2::new(x, y), 1e-12));
    }
    assert_eq!(field.reference, 0);
    assert!(remarks_text(&field).contains("1 of 4 views are missing: gone.png"), "{}", remarks_text(&field));
    for (text, expected) in [
        (list(", \"reference\": \"x.png\""), "reference: \"x.png\" is not one of the existing views"),
        (list(", \"disparity\": \"../x.pfm\""), "disparity: \"../x.pfm\" does not exist"),
        (
            "{\"views\": [{\"file\": \"m.png\", \"position\": [1]}]}".into(),
            "views[0]: the position of \"m.png\" is not two numbers",
        ),
        ("{\"views\": [{\"position\": [1, 2]}]}".into(), "views[0]: its file is not a text"),
        ("{\n\"views\": 3,}".into(), "line 2: its JSON is invalid"),
        ("{}".into(), "views: there is no such list"),
    ] {
        put(&file, &text);
        let text = refused(folder.path());
        assert!(text.contains(expected), "{text}");
    }
    // Files outside are not views.
    let outside = tempfile::tempdir().unwrap();
    save(&view(0.0, 0.0), &outside.path().join("secret.png"));
    put(
        &file,
        format!(
            "{{\"views\": [{{\"file\": {:?}, \"position\": [0, 0]}}]}}",
            outside.path().join("secret.png")
        ),
    );
    assert!(refused(folder.path()).contains("no views of a light field"));
}

#[test]
fn disparities_of_the_files_that_lie_with_the_views() {
    let folder = tempfile::tempdir().unwrap();
    grid(folder.path(), 3, 3, |x, y| format!("lf/{y:02}_{x:02}.png"));
    let path = |name: &str| folder.path().join(name);
    let range = || {
        let field = open(folder.path()).unwrap();
        let disparity = field.disparity.unwrap();
        (disparity.map.meaning, disparity.map.range().unwrap())
    };
    assert!(open(folder.path()).unwrap().disparity.is_none());
    // Colour-coded maps, as JPEG and as PNG.
    for name in ["disparity.jpg", "disparity.png"] {
        let code = |x: u32, _| image::Rgb([4 * x as u8, 255 - 4 * x as u8, 40]);
        image::RgbImage::from_fn(SIDE, SIDE, code).save(path(name)).unwrap();
        let field = open(folder.path()).unwrap();
        assert!(field.disparity.is_none());
        assert_eq!(field.coded_disparity.as_ref().map(PictureSource::file), Some(&*path(name)));
        assert!(remarks_text(&field).contains("is coded by colour"), "{}", remarks_text(&field));
        std::fs::remove_file(path(name)).unwrap();
    }
    // Levels, which are relative.
    image::GrayImage::from_fn(SIDE, SIDE, |x, _| image::Luma([x as u8 * 4]))
        .save(path("disp_rel.png"))
        .unwrap();
    assert_eq!(range(), (DepthMeaning::Relative, [0.0, 252.0 / 255.0]));
    // Distances, with parameters.
    std::fs::remove_file(path("disp_rel.png")).unwrap();
    put(&path("gt_depth_lowres.pfm"), pfm(SIDE, SIDE, |x, _| 1.0 + x as f32));
    assert!(open(folder.path()).unwrap().disparity.is_none());
    put(&path("parameters.cfg"), PARAMETERS);
    let (meaning, [low, high]) = range();
    let per_inverse = 11.0 * 100.0 * f64::from(SIDE) / 35.0 / 1000.0;
    let expected = |z: f64| per_inverse * (1.0 / z - 1.0 / 2.3);
    assert!(
        meaning == DepthMeaning::Disparity
            && (f64::from(high) - expected(1.0)).abs() < 1e-5
            && (f64::from(low) - expected(64.0)).abs() < 1e-5
    );
    // Disparities.
    put(&path("gt_disp_lowres.pfm"), disparity_pfm());
    assert_eq!(range(), (DepthMeaning::Disparity, [-1.0, 1.5]));
    // The older light fields'.
    put(&path("attributes.dat"), attributes(SIDE));
    put(&path("depth.bin"), vec![20.0f32.to_le_bytes(); (SIDE * SIDE) as usize].concat());
    let (_, [low, high]) = range();
    assert!(low.abs() < 1e-3 && high.abs() < 1e-3);
    put(&path("depth.bin"), [0; 12]);
    assert!(
        refused(folder.path()).contains("depth.bin: byte 12: 64 × 64 px take 16384 bytes, the file has 12")
    );
}

#[test]
fn folders_of_nothing_get_their_error() {
    let folder = tempfile::tempdir().unwrap();
    assert!(refused(folder.path()).contains("no views of a light field (name them by row and column"));
    let text = detect_capture_kind(folder.path()).unwrap_err().to_string();
    assert!(
        text.contains(
            "contains neither photographs with cameras nor a light field nor a picture with depth (open a folder"
        ),
        "{text}"
    );
    assert!(detect_capture_kind(&folder.path().join("gone")).is_err());
    // Photographs without cameras are not a light field.
    for k in 0..9 {
        save(&view(f64::from(k), 0.0), &folder.path().join(format!("IMG_2023_{k:04}.jpg")));
    }
    assert!(detect_capture_kind(folder.path()).unwrap_err().to_string().contains("contains neither"));
    for (name, kind) in CaptureKind::ALL {
        assert_eq!(CaptureKind::from_name(name), Some(kind));
    }
}

/// A folder of the shared reference data; prints a line if it is absent.
fn shared(name: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/lightfield").join(name);
    if folder.exists() {
        return Some(folder);
    }
    println!("SKIPPED: there is no {}", folder.display());
    None
}

/// How well the disparity map explains the neighbours of the middle view: the mean difference, of it and of its negative.
fn misfit(field: &LightField) -> [f64; 2] {
    let read = |index: usize| field.views[index].picture.photograph(&LoadOptions::default()).unwrap();
    let (reference, map) = (read(field.reference), &field.disparity.as_ref().unwrap().map);
    let near: Vec<usize> = (0..field.views.len())
        .filter(|index| (0.5..1.5).contains(&field.views[*index].position.length()))
        .collect();
    let mut sums = [0.0; 2];
    for index in near {
        let (other, step) = (read(index), field.views[index].position);
        for (sum, sign) in sums.iter_mut().zip([1.0, -1.0]) {
            for (at, d) in map.values.iter().enumerate().step_by(7).filter(|(_, d)| d.is_finite()) {
                let here = DVec2::new(
                    (at % map.width as usize) as f64 + 0.5,
                    (at / map.width as usize) as f64 + 0.5,
                );
                let there = other.sample(here - sign * f64::from(*d) * step);
                *sum += f64::from((there - reference.sample(here)).abs().y);
            }
        }
    }
    sums
}

#[test]
fn the_real_ones_open() {
    for (name, views, grid, reference, range) in [
        ("synthetic_helmet_cake_9x9", 81, [9, 9], "input_Cam040", Some([-0.9146, 0.6634])),
        ("hci_kitchen_row", 9, [9, 9], "input_Cam040", None),
        ("hci_stillLife_3x3", 9, [3, 3], "01_01", Some([-10.827, 10.252])),
    ] {
        let Some(folder) = shared(name) else { continue };
        let start = std::time::Instant::now();
        let field = opened(&folder);
        println!("{name}: {:?}\n{}", start.elapsed(), remarks_text(&field));
        assert_eq!((field.views.len(), field.grid), (views, Some(grid)));
        assert_eq!(field.views[field.reference].name, reference);
        let range_found = field.disparity.as_ref().and_then(|disparity| disparity.map.range());
        assert_eq!(range_found.is_some(), range.is_some());
        if let (Some(range_found), Some(range)) = (range_found, range) {
            assert!(
                (range_found[0] - range[0]).abs() < 0.01 && (range_found[1] - range[1]).abs() < 0.01,
                "{range_found:?}"
            );
            let [right, wrong] = misfit(&field);
            println!("{name}: {right:.0} with the map, {wrong:.0} with its negative");
            assert!(right < 0.7 * wrong);
        }
        let is_turned = remarks_text(&field).contains("as parallax shows");
        assert!(!is_turned, "{}", remarks_text(&field));
        assert!(matches!(field.views[0].picture, PictureSource::File { orientation: 1, .. }));
    }
}

#[test]
fn turned_copies_of_real_ones_are_detected() {
    for name in ["synthetic_helmet_cake_9x9", "hci_stillLife_3x3"] {
        let Some(folder) = shared(name) else { continue };
        let field = opened(&folder);
        let copy = tempfile::tempdir().unwrap();
        let [_, rows] = field.grid.unwrap();
        for view in &field.views {
            let [column, row] = view.cell.unwrap();
            std::fs::copy(view.picture.file(), copy.path().join(format!("{}_{column}.png", rows - 1 - row)))
                .unwrap();
        }
        let turned = opened(copy.path());
        assert!(
            remarks_text(&turned).contains("rows run from the bottom up"),
            "{name}: {}",
            remarks_text(&turned)
        );
    }
}

#[test]
fn the_real_lfp_files_get_their_sentence() {
    for (name, holds) in [
        ("lfp/IMG_0001-stk.lfp", "a stack of refocused pictures"),
        ("lfp/IMG_0002-dm.lfp", "a depth map without picture"),
    ] {
        let Some(file) = shared(name) else { continue };
        for text in [refused(&file), detect_capture_kind(&file).unwrap_err().to_string()] {
            assert!(text.contains(holds) && text.contains("PlenoptiCam") && text.contains("ESLF"), "{text}");
        }
        let folder = file.parent().unwrap();
        assert!(detect_capture_kind(folder).unwrap_err().to_string().contains("PlenoptiCam"));
        assert!(refused(folder).contains("PlenoptiCam"));
    }
}
