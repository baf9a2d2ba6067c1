//! From the photographs in a file of cameras to views, with remarks on what is incomplete.

pub(crate) mod exr_channels;
pub(crate) mod exr_layers;
pub(crate) mod picture_folder;
pub(crate) mod picture_names;
pub(crate) mod picture_source;

use crate::cameras::shot::{Shot, Shots};
use crate::files::picture_header::{fit_lens, read_header};
use crate::pictures::picture_folder::{PictureFolder, PictureSearch, masks};
use crate::{CaptureError, Remark};
use progress::Progress;
use scene::View;
use std::path::PathBuf;

/// The views of the shots in a file, by name, with remarks on what is incomplete.
pub(crate) fn views(
    source: &PictureSearch<'_>,
    shots: Shots,
    progress: &dyn Progress,
    remarks: &mut Vec<Remark>,
) -> Result<Vec<View>, CaptureError> {
    let file = source.cameras.display();
    let Shots { shots, notes, without_camera } = shots;
    remarks.extend(notes.into_iter().map(|note| Remark::note(format!("{file}: {note}"))));
    let [has, were, them] =
        number_of(&without_camera, ["has", "it was", "it"], ["have", "they were", "them"]);
    remarks.extend(Remark::about(without_camera.clone(), false, |names| {
        format!(
            "{file}: {names} {has} no camera: {were} not aligned by the program that wrote the file (align {them} there and export again, \
             or do without)"
        )
    }));
    let names: Vec<String> = shots.iter().map(|shot| shot.name.clone()).collect();
    let place = PictureFolder::find(source, &names)?;
    let masks = masks(source, &place, &shots);

    let (mut views, mut wrong, mut turned, mut resized) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (index, shot) in shots.iter().enumerate() {
        progress.check()?;
        progress.report(index as f32 / shots.len() as f32);
        let Some(name) = place.path(index) else { continue };
        match view(shot, name, place.base.join(name), masks[index].clone()) {
            Ok(view) => {
                if view.orientation != 1 {
                    turned.push(shot.name.clone());
                }
                if shot.lens.size_px().is_some_and(|size| size != view.lens.size_px()) {
                    resized.push(shot.name.clone());
                }
                views.push(view);
            }
            Err(what) => {
                wrong.push(format!("{} ({}): {what}", shot.name, shot.place));
            }
        }
    }
    let is_missing = |index: &usize| place.path(*index).is_none();
    let missing: Vec<String> =
        (0..names.len()).filter(is_missing).map(|index| names[index].clone()).collect();
    if views.is_empty() {
        let why = wrong.into_iter().next().unwrap_or_else(|| match missing.first() {
            Some(name) => format!("{} is not in {}", crate::files::text::quoted(name), place.base.display()),
            None => "the file has no picture".into(),
        });
        return Err(CaptureError::NoPictures { file: source.cameras.into(), cameras: shots.len(), why });
    }
    let (count, all) = (missing.len(), shots.len());
    let [are, them] = number_of(&missing, ["is", "it"], ["are", "them"]);
    remarks.extend(Remark::about(missing, true, |names| {
        format!(
            "{file}: {count} of {all} pictures {are} missing: {names} (put {them} into {})",
            place.base.display()
        )
    }));
    remarks
        .extend(Remark::about(wrong, true, |names| format!("{file}: pictures that cannot be used: {names}")));
    remarks.extend(Remark::about(turned, false, |names| {
        format!("{file}: rotated by their EXIF orientation, because their cameras have width and height swapped: {names}")
    }));
    remarks.extend(Remark::about(resized, false, |names| {
        format!("{file}: their size differs from that of their cameras, which are scaled to it: {names}")
    }));
    // Those that the file lists were told above.
    let is_listed = |name: &String| without_camera.iter().any(|listed| stem(listed) == stem(name));
    let unused: Vec<String> = place.unused().into_iter().filter(|name| !is_listed(name)).collect();
    let [has, are] = number_of(&unused, ["has", "is"], ["have", "are"]);
    remarks.extend(Remark::about(unused, false, |names| {
        format!("{}: {names} {has} no camera in {file} and {are} ignored", place.base.display())
    }));
    views.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(views)
}

/// A picture's name without folders and extension; programs write names with more or less of them.
fn stem(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}

/// The words of a sentence about one name, or about several.
fn number_of<const N: usize>(
    names: &[String],
    one: [&'static str; N],
    several: [&'static str; N],
) -> [&'static str; N] {
    if names.len() == 1 { one } else { several }
}

/// The view of a shot whose picture is this file, called `name`.
fn view(shot: &Shot, name: &str, picture: PathBuf, mask: Option<PathBuf>) -> Result<View, String> {
    let (size, exif) = read_header(&picture)?;
    let lens = shot.lens.for_size(size).map_err(|error| error.to_string())?;
    let (lens, orientation) = fit_lens(lens, size, exif.orientation)?;
    Ok(View {
        name: name.into(),
        picture,
        orientation,
        exif_orientation: exif.orientation,
        lens,
        camera_to_world: shot.camera_to_world,
        mask,
        exposure_hint: exif.exposure,
    })
}
