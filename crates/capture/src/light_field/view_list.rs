//! `views.json`: a list of views and their positions, for arrangements that no naming scheme covers.
//!
//! ```json
//! {
//!   "views": [ { "file": "middle.png", "position": [0, 0] }, { "file": "right.png", "position": [1, 0] } ],
//!   "reference": "middle.png",
//!   "disparity": "middle.pfm"
//! }
//! ```
//!
//! Positions are x right, y down, in the unit of disparities: the point that the reference shows at p with disparity d is at
//! p − d·position, relative to the reference's position. Files are named relative to the list, and lie below its folder.

use super::arrangement::{Arrangement, Placed, ViewLayout};
use crate::CaptureError;
use crate::files::folder::Folder;
use crate::files::text::quoted;
use crate::files::whole_file::whole_file;
use glam::DVec2;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The list's name.
pub(super) const NAME: &str = "views.json";
/// The largest list in bytes, and the most views.
const MAX_BYTES: u64 = 4 << 20;
const MAX_VIEWS: usize = 20_000;

/// Reads the views of a list.
pub(super) fn read_view_list(folder: &Folder, file: &Path) -> Result<Arrangement, CaptureError> {
    let malformed = |place: String, what: String| CaptureError::malformed(file, place, what);
    let bytes = whole_file(file, MAX_BYTES)?;
    let list: Value = serde_json::from_slice(&bytes).map_err(|error| {
        malformed(format!("line {}", error.line()), format!("its JSON is invalid: {error}"))
    })?;
    let base = file.parent().unwrap_or(Path::new(""));
    let named = |name: &str| -> Option<PathBuf> {
        let path = base.join(name.replace('\\', "/"));
        folder.has_file(&path).then_some(path)
    };
    let all = list.get("views").and_then(Value::as_array);
    let all = all.ok_or_else(|| malformed("views".into(), "there is no such list".into()))?;
    if all.len() > MAX_VIEWS {
        return Err(malformed("views".into(), format!("has {} views, the limit is {MAX_VIEWS}", all.len())));
    }
    let (mut views, mut missing, mut reference) = (Vec::new(), Vec::new(), None);
    for (index, entry) in all.iter().enumerate() {
        let place = || format!("views[{index}]");
        let name = entry.get("file").and_then(Value::as_str);
        let name = name.ok_or_else(|| malformed(place(), "its file is not a text".into()))?;
        let numbers: Option<Vec<f64>> = entry
            .get("position")
            .and_then(Value::as_array)
            .and_then(|numbers| numbers.iter().map(Value::as_f64).collect());
        let position = match numbers.as_deref() {
            Some([x, y, ..]) if x.is_finite() && y.is_finite() && x.abs().max(y.abs()) < 1e9 => {
                DVec2::new(*x, *y)
            }
            _ => {
                return Err(malformed(
                    place(),
                    format!("the position of {} is not two numbers", quoted(name)),
                ));
            }
        };
        match named(name) {
            Some(path) => {
                if list.get("reference").and_then(Value::as_str) == Some(name) {
                    reference = Some(views.len());
                }
                views.push(Placed { file: path, name: name.into(), cell: None, position });
            }
            None => missing.push(name.to_owned()),
        }
    }
    if let (Some(name), None) = (list.get("reference").and_then(Value::as_str), reference) {
        return Err(malformed(
            "reference".into(),
            format!("{} is not one of the existing views", quoted(name)),
        ));
    }
    let disparity =
        match list.get("disparity").and_then(Value::as_str) {
            Some(name) => {
                let path = named(name);
                Some(path.ok_or_else(|| {
                    malformed("disparity".into(), format!("{} does not exist", quoted(name)))
                })?)
            }
            None => None,
        };
    let notes = if missing.is_empty() {
        Vec::new()
    } else {
        vec![(format!("{} of {} views are missing", missing.len(), all.len()), missing)]
    };
    Ok(Arrangement {
        layout: ViewLayout::Listed,
        folder: base.into(),
        views,
        grid: None,
        first_number: 0,
        reference,
        disparity,
        is_certain: true,
        notes,
    })
}
