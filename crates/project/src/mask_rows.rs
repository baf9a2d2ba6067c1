//! An aperture mask within a JSON file, so that one file says all.
//!
//! ```text
//! {"name": "heart.png", "rows": ["00ff00", …]}
//! ```
//!
//! A row of the mask a text, from v = +R down: two hexadecimal digits a texel, from 00 (closed) to ff (open).

use crate::ProjectError;
use crate::json::{Field, Json};
use lens::ApertureMask;
use serde_json::{Value, json};
use std::fmt::Write;

/// Sides of a mask that is written, texels, at most: stencils are cut from fewer.
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
    let Json::List(list) = rows.value else { return Err(wrong("is no list".into())) };
    let mut transmission = Vec::new();
    let mut width = 0;
    for (index, row) in list.iter().enumerate() {
        let Json::Text(digits) = row else { return Err(wrong(format!("row {index} is no text"))) };
        let texels = texels_from_hex(digits)
            .ok_or_else(|| wrong(format!("row {index} is not of hexadecimal digits")))?;
        if index == 0 {
            width = texels.len();
        }
        if texels.len() != width {
            return Err(wrong(format!("row {index} has {} texels, the first {width}", texels.len())));
        }
        transmission.extend(texels);
    }
    let [width, height] = [width, list.len()].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
    Ok(ApertureMask { width, height, transmission, file: name.to_string() })
}

fn texels_from_hex(digits: &str) -> Option<Vec<f32>> {
    let pair = |pair: &[u8]| {
        let [high, low] = [pair[0], *pair.get(1)?].map(|digit| char::from(digit).to_digit(16));
        Some((high? * 16 + low?) as f32 / 255.0)
    };
    digits.as_bytes().chunks(2).map(pair).collect()
}

/// Writes a mask, of at most 512 texels a side: larger ones are averaged.
pub(crate) fn mask_to_json(mask: &ApertureMask) -> Value {
    let [width, height] = [mask.width, mask.height].map(|side| side.min(MAX_SIDE));
    let ends = |k: u32, count: u32| [k, k + 1].map(|k| 2.0 * f64::from(k) / f64::from(count) - 1.0);
    let rows = (0..height).map(|row| {
        let [low, high] = ends(height - 1 - row, height);
        (0..width).fold(String::new(), |mut digits, column| {
            let open = mask.mean(ends(column, width), [low, high]);
            let _ = write!(digits, "{:02x}", (open * 255.0).round().clamp(0.0, 255.0) as u8);
            digits
        })
    });
    json!({ "name": mask.file, "rows": rows.collect::<Vec<_>>() })
}
