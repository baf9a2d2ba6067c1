//! Validation of a light field and of a request, before anything is computed.

use crate::error::DisparityError;
use crate::request::DisparityRequest;
use crate::view::{MIN_SIDE_PX, View};

/// The most pixels of a view: the memory needed stays below 4 GB.
const MAX_PIXELS: usize = 64_000_000;

/// Checks that the views, at least two of one size, and the request can be used.
///
/// # Errors
/// What is wrong with the views, or with the request.
pub fn validate(views: &[View<'_>], request: &DisparityRequest) -> Result<(), DisparityError> {
    if views.len() < 2 {
        return Err(DisparityError::TooFewViews { views: views.len() });
    }
    for view in std::iter::once(&request.reference).chain(&request.others) {
        if *view >= views.len() {
            return Err(DisparityError::NoSuchView { view: *view, views: views.len() });
        }
    }
    if let Some((low, high)) = request.range {
        let why = if !(low.is_finite() && high.is_finite()) {
            "not finite numbers (give the least and the largest, or none)"
        } else if low >= high {
            "empty (give the least and the largest, in this order)"
        } else {
            ""
        };
        if !why.is_empty() {
            return Err(DisparityError::Range { low, high, why: why.to_string() });
        }
    }
    for (index, view) in views.iter().enumerate() {
        validate_view(index, view, &views[0])?;
        if let Some(other) = views[..index].iter().position(|other| other.position == view.position) {
            let [column, row] = view.position;
            let what = format!("it is at column {column}, row {row}, like view {other}");
            return Err(DisparityError::Position { view: index, what });
        }
    }
    Ok(())
}

fn validate_view(index: usize, view: &View<'_>, first: &View<'_>) -> Result<(), DisparityError> {
    let picture = &view.picture;
    let (width, height) = (picture.width, picture.height);
    let size = |what: String| Err(DisparityError::Size { view: index, what });
    if width.min(height) < MIN_SIDE_PX {
        return size(format!("{width} × {height} pixels are too few"));
    }
    match width.checked_mul(height) {
        Some(pixels) if pixels > MAX_PIXELS => {
            return size(format!("{width} × {height} pixels are too many"));
        }
        Some(pixels) if pixels == picture.rgb.len() => {}
        _ => return size(format!("{width} × {height} pixels, but {} colours", picture.rgb.len())),
    }
    if (width, height) != (first.picture.width, first.picture.height) {
        let others = format!("{} × {}", first.picture.width, first.picture.height);
        return size(format!("{width} × {height} pixels, the first view has {others}"));
    }
    if !view.position.iter().all(|p| p.is_finite() && p.abs() < 1e6) {
        let what = format!("its position is {:?}", view.position);
        return Err(DisparityError::Position { view: index, what });
    }
    if let Some(pixel) = picture.rgb.iter().position(|rgb| !rgb.iter().all(|value| value.is_finite())) {
        return Err(DisparityError::NotFinite { view: index, x: pixel % width, y: pixel / width });
    }
    Ok(())
}
