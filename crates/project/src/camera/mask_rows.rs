//! An aperture mask within a JSON file, so that one file is complete.
//!
//! ```text
//! {"name": "heart.png", "rows": ["00ff00", …]}
//! ```
//!
//! One text per row of the mask, from v = +R down: two hexadecimal digits per texel, from 00 (closed) to ff (open).

use crate::ProjectError;
use crate::json::{Field, Json};
use lens::ApertureMask;
use serde_json::{Value, json};

/// Maximum side, in texels, of a mask that is written: stencils are cut from fewer.
const MAX_SIDE: u32 = 512;

/// Reads a mask.
pub(crate) fn mask_from_json(field: &Field<'_>) -> Result<ApertureMask, ProjectError> {
    let fields = field.object()?;
    fields.allow_only(&["name", "rows"])?;
    let name = fields.get("name").map_or(Ok(""), |name| name.text())?;
    let Some(rows) = fields.get("rows") else {
        return Err(field.error("has no \"rows\"", "add them, a text of hexadecimal digits each"));
    };
    let wrong =
        |problem: String| rows.error(problem, "give texts of one length, two hexadecimal digits a texel");
    let Json::List(list) = rows.value else { return Err(wrong("is not a list".into())) };
    let mut transmission = Vec::new();
    let mut width = 0;
    for (index, row) in list.iter().enumerate() {
        let Json::Text(digits) = row else { return Err(wrong(format!("row {index} is not a text"))) };
        let texels =
            hex::decode(digits).map_err(|_| wrong(format!("row {index} is not of hexadecimal digits")))?;
        if index == 0 {
            width = texels.len();
        }
        if texels.len() != width {
            return Err(wrong(format!("row {index} has {} texels, the first {width}", texels.len())));
        }
        transmission.extend(texels.into_iter().map(|texel| f32::from(texel) / 255.0));
    }
    let [width, height] = [width, list.len()].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
    Ok(ApertureMask { width, height, transmission, file: name.to_string() })
}

/// Writes a mask of at most 512 texels per side: larger ones are averaged.
pub(crate) fn mask_to_json(mask: &ApertureMask) -> Value {
    let [width, height] = [mask.width, mask.height].map(|side| side.min(MAX_SIDE));
    let ends = |k: u32, count: u32| [k, k + 1].map(|k| 2.0 * f64::from(k) / f64::from(count) - 1.0);
    let rows = (0..height).map(|row| {
        let [low, high] = ends(height - 1 - row, height);
        let texel = |column| {
            let open = mask.mean(ends(column, width), [low, high]);
            (open * 255.0).round().clamp(0.0, 255.0) as u8
        };
        hex::encode((0..width).map(texel).collect::<Vec<_>>())
    });
    json!({ "name": mask.file, "rows": rows.collect::<Vec<_>>() })
}
