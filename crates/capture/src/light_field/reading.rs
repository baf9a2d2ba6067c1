//! Opening a light field: the story from top to bottom.

use super::arrangement::{Arrangement, Placed, ViewLayout};
use super::attributes::read_attributes;
use super::disparity::{DisparitySearch, DisparitySource, find_disparity};
use super::light_field_type::{LightField, SubAperture, ViewDisparity};
use super::optics::{Optics, read_parameters};
use super::parallax::{GridTurn, GridTurnEstimate, estimate_grid_turn};
use super::view_discovery::find_views;
use crate::depth_map::{DepthMap, DepthMeaning, NearEnd};
use crate::files::folder::Folder;
use crate::files::picture_header::read_header;
use crate::mosaic::{Mosaic, detect_pitch};
use crate::pictures::picture_source::PictureSource;
use crate::unsupported_format::unsupported_format_error;
use crate::{CaptureError, Remark};
use glam::DVec2;
use progress::{Progress, Stage};
use scene::{LoadOptions, Photograph};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Options for reading a light field.
#[derive(Clone, Debug, Default)]
pub struct LightFieldOptions {
    /// Columns and rows of pixels of a mosaic's micro-images; `None`: detected from its pixels.
    pub pitch: Option<[u32; 2]>,
    /// The disparity map of the middle view; `None`: looked for next to the views.
    pub disparity: Option<PathBuf>,
    /// The near end of a relative map.
    pub near: Option<NearEnd>,
    /// Limits on memory and size.
    pub load: LoadOptions,
}

/// Opens a light field: a folder of views, or a mosaic of micro-images.
///
/// Only the pixels of the middle view and of its neighbours are read, to detect which way rows and columns run.
///
/// # Errors
/// There are no views, or a file that describes them is malformed or exceeds the limits. [`CaptureError::Cancelled`] if `progress`
/// cancels.
pub fn open_light_field(
    path: &Path,
    options: &LightFieldOptions,
    progress: &dyn Progress,
) -> Result<LightField, CaptureError> {
    let mut field = if path.is_dir() {
        open_folder(path, options, &Stage::new(progress, 0.0, 0.6))?
    } else {
        open_mosaic(path, options)?
    };
    progress.check()?;
    orient_by_parallax(&mut field, options, &Stage::new(progress, 0.6, 1.0))?;
    progress.report(1.0);
    Ok(field)
}

fn name_of(path: &Path) -> String {
    let whole = path.canonicalize().unwrap_or_else(|_| path.into());
    whole.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The light field in a folder, with positions according to the names.
fn open_folder(
    path: &Path,
    options: &LightFieldOptions,
    progress: &dyn Progress,
) -> Result<LightField, CaptureError> {
    let folder = Folder::open(path)?;
    let none = |detail: &str| CaptureError::NoViews { path: path.into(), detail: detail.into() };
    let Some((arrangement, others)) = find_views(&folder)? else {
        // Lytro's files alone get their own message.
        let entries = folder.entries(&folder.shown);
        return Err(entries
            .iter()
            .find_map(|(file, _)| unsupported_format_error(file))
            .unwrap_or_else(|| none("")));
    };
    let mut remarks = Vec::new();
    let base = arrangement.folder.clone();
    let shown = base.display();
    remarks.extend(Remark::about(
        others.iter().map(|other| other.display().to_string()).collect(),
        false,
        |names| {
            format!(
                "{shown}: is used for the views; there are also {names} (open that folder to use it instead)"
            )
        },
    ));
    for (what, names) in &arrangement.notes {
        let is_incomplete = what.contains("missing");
        remarks
            .extend(Remark::about(names.clone(), is_incomplete, |names| format!("{shown}: {what}: {names}")));
    }
    let (placed, size) = views_of_one_size(&arrangement, &mut remarks, progress)?;
    if placed.len() < 2 {
        return Err(none(": fewer than two pictures of one size can be read"));
    }
    remarks.extend(missing(&arrangement, &placed));
    // Files in the folder of the views, or above it.
    let places: Vec<&Path> = if base == folder.shown { vec![&base] } else { vec![&base, &folder.shown] };
    let optics = optics(&folder, &places)?;
    let reference = reference(&arrangement, &placed);
    let middle = placed[reference].position;
    let views = placed.iter().map(|placed| SubAperture {
        name: placed.name.clone(),
        cell: placed.cell,
        position: placed.position - middle,
        picture: PictureSource::stored(&placed.file),
    });
    let mut field = LightField {
        name: name_of(path),
        path: path.into(),
        layout: arrangement.layout,
        views: views.collect(),
        size,
        grid: arrangement.grid,
        reference,
        disparity: None,
        coded_disparity: None,
        optics,
        remarks,
    };
    let source = match options.disparity.as_ref().or(arrangement.disparity.as_ref()) {
        Some(file) => Some(DisparitySource::from_file(file, options.near, &options.load)?),
        None => {
            let search = DisparitySearch {
                folder: &folder,
                places: &places,
                size,
                optics: &field.optics,
                near: options.near,
                load: &options.load,
            };
            find_disparity(&search)?
        }
    };
    if let Some(source) = source {
        set_disparity_source(&mut field, source);
    }
    Ok(field)
}

/// The light field in a picture that is a mosaic.
fn open_mosaic(path: &Path, options: &LightFieldOptions) -> Result<LightField, CaptureError> {
    if let Some(error) = unsupported_format_error(path) {
        return Err(error);
    }
    read_header(path).map_err(|why| CaptureError::malformed(path, "picture", why))?;
    let pitch = options.pitch.or_else(|| detect_pitch(path, &options.load));
    let Some(pitch) = pitch else {
        let detail =
            ": it is not a mosaic of micro-images, or its pitch cannot be detected and has to be specified"
                .into();
        return Err(CaptureError::NoViews { path: path.into(), detail });
    };
    let mosaic = Mosaic::open(path, pitch)?;
    let [columns, rows] = pitch;
    let mut remarks = Vec::new();
    let size = mosaic.view_size();
    let shown = path.display();
    remarks.push(Remark::note(format!(
        "{shown}: micro-images of {columns} × {rows} px, so as many views of {} × {} px{}",
        size[0],
        size[1],
        if options.pitch.is_none() { ", as detected from its pixels" } else { "" }
    )));
    if mosaic.left_over() != [0, 0] {
        let [right, bottom] = mosaic.left_over();
        remarks.push(Remark::note(format!("{shown}: {right} columns at the right and {bottom} rows at the bottom do not form a whole micro-image and are ignored")));
    }
    let middle = [(columns - 1) / 2, (rows - 1) / 2];
    let views =
        (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row])).map(|cell| SubAperture {
            name: format!("{:02}_{:02}", cell[1], cell[0]),
            cell: Some(cell),
            position: DVec2::new(
                f64::from(cell[0]) - f64::from(middle[0]),
                f64::from(cell[1]) - f64::from(middle[1]),
            ),
            picture: PictureSource::MicroImages { mosaic: mosaic.clone(), cell },
        });
    let mut field = LightField {
        name: name_of(path),
        path: path.into(),
        layout: ViewLayout::MicroImages,
        views: views.collect(),
        size,
        grid: Some(pitch),
        reference: (middle[1] * columns + middle[0]) as usize,
        disparity: None,
        coded_disparity: None,
        optics: Optics::default(),
        remarks,
    };
    if let Some(file) = &options.disparity {
        set_disparity_source(&mut field, DisparitySource::from_file(file, options.near, &options.load)?);
    }
    Ok(field)
}

/// The views that can be read and have the size that most of them have.
fn views_of_one_size(
    arrangement: &Arrangement,
    remarks: &mut Vec<Remark>,
    progress: &dyn Progress,
) -> Result<(Vec<Placed>, [u32; 2]), CaptureError> {
    let shown = arrangement.folder.display();
    let (mut read, mut wrong) = (Vec::new(), Vec::new());
    let mut sizes: HashMap<[u32; 2], usize> = HashMap::new();
    for (index, placed) in arrangement.views.iter().enumerate() {
        progress.check()?;
        progress.report(index as f32 / arrangement.views.len() as f32);
        match read_header(&placed.file) {
            Ok((size, _)) => {
                *sizes.entry(size).or_default() += 1;
                read.push((placed.clone(), size));
            }
            Err(why) => wrong.push(format!("{} ({why})", placed.name)),
        }
    }
    let size = sizes.into_iter().max_by_key(|(size, count)| (*count, *size)).map_or([0; 2], |(size, _)| size);
    let (fit, other): (Vec<_>, Vec<_>) =
        read.into_iter().partition(|(_, picture_size)| *picture_size == size);
    let other =
        other.iter().map(|(placed, [width, height])| format!("{} ({width} × {height} px)", placed.name));
    remarks
        .extend(Remark::about(wrong, true, |names| format!("{shown}: views that cannot be used: {names}")));
    remarks.extend(Remark::about(other.collect(), true, |names| {
        format!(
            "{shown}: views that do not have the {} × {} px of the others and are ignored: {names}",
            size[0], size[1]
        )
    }));
    Ok((fit.into_iter().map(|(placed, _)| placed).collect(), size))
}

/// A remark on missing views of the grid.
fn missing(arrangement: &Arrangement, placed: &[Placed]) -> Option<Remark> {
    let [columns, rows] = arrangement.grid?;
    let shown = arrangement.folder.display();
    let there: std::collections::HashSet<[u32; 2]> = placed.iter().filter_map(|placed| placed.cell).collect();
    let all = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
    let missing: Vec<[u32; 2]> = all.filter(|cell| !there.contains(cell)).collect();
    let is_on_cross = |cell: &[u32; 2]| 2 * cell[0] + 1 == columns || 2 * cell[1] + 1 == rows;
    if columns > 1
        && rows > 1
        && !missing.is_empty()
        && missing.iter().all(|cell| !is_on_cross(cell))
        && there.iter().all(is_on_cross)
    {
        return Some(Remark::note(format!("{shown}: a cross of {columns} and {rows} views")));
    }
    let names = missing.iter().map(|[column, row]| match arrangement.layout {
        ViewLayout::Numbered => format!("number {}", arrangement.first_number + row * columns + column),
        _ => format!("row {row} column {column}"),
    });
    let count = missing.len();
    Remark::about(names.collect(), true, |names| {
        format!("{shown}: {count} of {columns} × {rows} views are missing: {names} (the others are used)")
    })
}

/// The camera parameters in the files next to the views.
fn optics(folder: &Folder, places: &[&Path]) -> Result<Optics, CaptureError> {
    let file = |name: &str| places.iter().map(|place| place.join(name)).find(|file| folder.has_file(file));
    if let Some(file) = file("parameters.cfg") {
        return read_parameters(&file);
    }
    let disparity_range = match file("attributes.dat") {
        Some(file) => read_attributes(&file)?.range,
        None => None,
    };
    Ok(Optics { disparity_range, ..Optics::default() })
}

/// The view that a list declares as the middle one, or the one nearest the middle of the aperture.
fn reference(arrangement: &Arrangement, placed: &[Placed]) -> usize {
    let listed = arrangement.reference.map(|index| &arrangement.views[index].file);
    if let Some(index) = placed.iter().position(|placed| Some(&placed.file) == listed) {
        return index;
    }
    let middle = arrangement.middle();
    let distance = |index: &usize| placed[*index].position.distance(middle);
    // Of equals the first.
    (0..placed.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b))).unwrap_or(0)
}

/// Stores the disparities in the light field.
fn set_disparity_source(field: &mut LightField, source: DisparitySource) {
    match source {
        DisparitySource::Map(map, file) => set_disparity(field, map, file),
        DisparitySource::Coded(file) => {
            field.remarks.push(Remark::note(format!(
                "{}: is coded by colour; the code is inferred from the views",
                file.display()
            )));
            field.coded_disparity = Some(PictureSource::stored(&file));
        }
    }
}

/// Stores a disparity map: for the view that its file is named after, else for the middle one.
fn set_disparity(field: &mut LightField, map: DepthMap, file: PathBuf) {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
    let is_named = |view: &SubAperture| view.name.len() >= 3 && stem.contains(&view.name.to_lowercase());
    let view = field.views.iter().position(is_named).unwrap_or(field.reference);
    if [map.width, map.height] != field.size {
        field.remarks.push(Remark::note(format!(
            "{}: of {} × {} px, the views are of {} × {} px; it is stretched over them",
            file.display(),
            map.width,
            map.height,
            field.size[0],
            field.size[1]
        )));
    }
    if map.meaning == DepthMeaning::Relative {
        field.remarks.push(Remark::note(format!(
            "{}: levels of grey, which are disparities up to scale and offset",
            file.display()
        )));
    }
    field.disparity = Some(ViewDisparity { map, view, file });
}

/// The views around the reference that determine which way rows and columns run: two on each axis, else the nearest.
fn neighbours(field: &LightField) -> Vec<usize> {
    let position = |index: usize| field.views[index].position;
    let mut nearest: Vec<usize> =
        (0..field.views.len()).filter(|index| position(*index).length() > 0.0).collect();
    nearest.sort_by(|a, b| position(*a).length().total_cmp(&position(*b).length()));
    let sides = [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y];
    // Within 20° of the axis: positions of gantries are not exact.
    let on_side = |side: DVec2| {
        nearest.iter().copied().find(|index| position(*index).normalize_or_zero().dot(side) > 0.94)
    };
    let mut chosen: Vec<usize> = sides.into_iter().filter_map(on_side).collect();
    let is_new = |chosen: &[usize], index: usize| !chosen.contains(&index);
    for index in nearest {
        if chosen.len() < 4 && is_new(&chosen, index) {
            chosen.push(index);
        }
    }
    chosen
}

/// Turns the positions as parallax shows, and adds a remark.
fn orient_by_parallax(
    field: &mut LightField,
    options: &LightFieldOptions,
    progress: &dyn Progress,
) -> Result<(), CaptureError> {
    let mut indices = vec![field.reference];
    indices.extend(neighbours(field));
    let Some(pictures) = small_pictures(field, &indices, options, progress)? else { return Ok(()) };
    let [reference, others @ ..] = &pictures[..] else { return Ok(()) };
    let (reference, scale) = (&reference.0, reference.1);
    let at = |index: &usize| field.views[*index].position;
    let others: Vec<(DVec2, &Photograph)> =
        indices[1..].iter().map(at).zip(others.iter().map(|other| &other.0)).collect();
    // In pixels of the reduced pictures.
    let map = field.disparity.as_ref().filter(|supplied| {
        supplied.view == field.reference && supplied.map.meaning == DepthMeaning::Disparity
    });
    let map = map.map(|supplied| {
        let values = supplied.map.values.iter().map(|value| value / scale as f32).collect();
        DepthMap { values, ..supplied.map.clone() }
    });
    let shown = field.path.display();
    let estimate = estimate_grid_turn(reference, &others, map.as_ref());
    // A map that fits nothing, or has the other sign, is ignored: the pictures alone decide.
    let estimate = match estimate {
        GridTurnEstimate::Unclear if map.is_some() => estimate_grid_turn(reference, &others, None),
        estimate => estimate,
    };
    let remark = match estimate {
        GridTurnEstimate::Turned(turn) if turn == GridTurn::default() => return Ok(()),
        GridTurnEstimate::Turned(turn) => {
            for view in &mut field.views {
                view.position = turn.apply(view.position);
            }
            format!("{shown}: {}, as parallax shows; views are placed accordingly", describe_turn(turn))
        }
        GridTurnEstimate::OneLine => {
            format!("{shown}: all views lie in one line; which way other rows would run cannot be determined")
        }
        GridTurnEstimate::Unclear => format!(
            "{shown}: parallax does not show which way rows and columns run; the names of the views are trusted"
        ),
    };
    field.remarks.push(Remark::note(remark));
    Ok(())
}

/// Describes how a grid differs from its names.
fn describe_turn(turn: GridTurn) -> &'static str {
    match (turn.is_transposed, turn.columns_reversed, turn.rows_reversed) {
        (false, false, _) => "rows run from the bottom up",
        (false, true, false) => "columns run from right to left",
        (false, true, true) => "columns run from right to left and rows from the bottom up",
        (true, false, false) => "the column is named before the row",
        (true, false, true) => "the column is named before the row, and rows run from the bottom up",
        (true, true, false) => "the column is named before the row, and columns run from right to left",
        (true, true, true) => {
            "the column is named before the row, columns run from right to left and rows from the bottom up"
        }
    }
}

/// Pictures of some views, no wider than needed, with their reduction factor; `None` with a remark if one cannot be
/// read.
fn small_pictures(
    field: &mut LightField,
    indices: &[usize],
    options: &LightFieldOptions,
    progress: &dyn Progress,
) -> Result<Option<Vec<(Photograph, u32)>>, CaptureError> {
    /// px
    const WIDEST: u32 = 1024;
    let factor = field.size[0].max(field.size[1]).div_ceil(WIDEST).max(1);
    let mosaic = field.views.iter().find_map(|view| match &view.picture {
        PictureSource::MicroImages { mosaic, .. } => Some(mosaic.clone()),
        _ => None,
    });
    let read = || -> Result<Vec<(Photograph, u32)>, CaptureError> {
        if let Some(mosaic) = &mosaic {
            let cells: Vec<[u32; 2]> = indices.iter().filter_map(|index| field.views[*index].cell).collect();
            let views = mosaic.views(&cells, &options.load)?;
            return Ok(views.into_iter().map(|view| (view.downsampled(factor), factor)).collect());
        }
        let mut pictures = Vec::new();
        for (done, index) in indices.iter().enumerate() {
            progress.check()?;
            progress.report(done as f32 / indices.len() as f32);
            pictures
                .push((field.views[*index].picture.photograph(&options.load)?.downsampled(factor), factor));
        }
        Ok(pictures)
    };
    match read() {
        Ok(pictures) => Ok(Some(pictures)),
        Err(error @ CaptureError::Cancelled(_)) => Err(error),
        // A picture that is truncated after its header: the error is reported again when it is read.
        Err(error) => {
            let names = vec![error.to_string()];
            let text = format!("{error}; which way rows and columns run was not checked");
            field.remarks.push(Remark { text, names, is_incomplete: true });
            Ok(None)
        }
    }
}
