//! The engine as functions of a WebAssembly module: numbers in, numbers out, nothing imported.
//!
//! Functions that can fail return 0 for success, or 1, and the reason is at `message_start`. Distances are reciprocals, 1/length; places of the
//! picture go from 0 at the upper left to 1.
#![allow(unsafe_code, reason = "functions have the names by which the page calls them")]

use crate::{ApertureChoice, Engine, EngineError, FieldOfPage, LensChoice, PageBrush, Paint};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What the module keeps from call to call.
#[derive(Default)]
struct State {
    /// The bytes that the page fills in before `open`.
    input: Vec<u8>,
    engine: Option<Engine>,
    /// How the picture is painted, when it was asked for last.
    paint_map: Vec<u8>,
    /// Why the last call failed.
    message: String,
}

static STATE: Mutex<State> =
    Mutex::new(State { input: Vec::new(), engine: None, paint_map: Vec::new(), message: String::new() });

/// There is one thread, so that nothing waits.
fn state() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Does something with the engine; 1, and a message, where it fails.
fn attempt(work: impl FnOnce(&mut Engine) -> Result<(), EngineError>) -> u32 {
    let mut state = state();
    let Some(engine) = &mut state.engine else {
        state.message = "nothing is open".into();
        return 1;
    };
    match work(engine) {
        Ok(()) => 0,
        Err(error) => {
            state.message = error.to_string();
            1
        }
    }
}

/// A number of the engine; NaN where there is none.
fn number(of: impl FnOnce(&Engine) -> Option<f64>) -> f64 {
    state().engine.as_ref().and_then(of).unwrap_or(f64::NAN)
}

/// Makes room for `bytes` bytes of a [`FieldOfPage`], and returns where.
#[unsafe(no_mangle)]
pub extern "C" fn make_room(bytes: usize) -> *mut u8 {
    let mut state = state();
    state.input = vec![0; bytes];
    state.input.as_mut_ptr()
}

/// Opens the light field that was written there.
#[unsafe(no_mangle)]
pub extern "C" fn open() -> u32 {
    let mut state = state();
    let input = std::mem::take(&mut state.input);
    match FieldOfPage::from_bytes(&input) {
        Ok(field) => {
            drop(input);
            state.engine = Some(Engine::new(field));
            0
        }
        Err(error) => {
            state.message = error.to_string();
            1
        }
    }
}

/// Where the message of what failed last begins, in UTF-8.
#[unsafe(no_mangle)]
pub extern "C" fn message_start() -> *const u8 {
    state().message.as_ptr()
}

/// Its length, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn message_length() -> usize {
    state().message.len()
}

/// The reciprocal of the farthest distance.
#[unsafe(no_mangle)]
pub extern "C" fn farthest() -> f64 {
    number(|engine| Some(engine.range()[0]))
}

/// The reciprocal of the nearest distance.
#[unsafe(no_mangle)]
pub extern "C" fn nearest() -> f64 {
    number(|engine| Some(engine.range()[1]))
}

/// The reciprocal of the exported camera's focus distance.
#[unsafe(no_mangle)]
pub extern "C" fn exported_distance() -> f64 {
    number(|engine| Some(engine.exported_camera().optics().inverse_focus_distance))
}

/// The exported camera's f-number.
#[unsafe(no_mangle)]
pub extern "C" fn exported_f_number() -> f64 {
    number(|engine| Some(engine.exported_camera().f_number()))
}

/// Puts on a lens and draws. `blades`: 0 as exported, 1 a disc, else the number of blades. A draft has half the columns and rows.
#[unsafe(no_mangle)]
pub extern "C" fn refocus(
    inverse_distance: f64,
    aperture_share: f64,
    blades: u32,
    is_painted: u32,
    is_draft: u32,
) -> u32 {
    let aperture = match blades {
        0 => ApertureChoice::Exported,
        1 => ApertureChoice::Disc,
        _ => ApertureChoice::Blades(blades),
    };
    let lens = LensChoice { inverse_distance, aperture_share, aperture, is_painted: is_painted != 0 };
    attempt(|engine| engine.refocus(lens, is_draft != 0))
}

/// Finds how the first surface of each pixel is painted: a byte each, from 1 (near) over 128 (sharp) to 255 (far), 0 where it is not. Returns
/// where they begin, row by row; there are as many as pixels of the full picture.
#[unsafe(no_mangle)]
pub extern "C" fn paint_map() -> *const u8 {
    let mut state = state();
    let found = state.engine.as_ref().map(Engine::paint_map);
    state.paint_map = found.unwrap_or_default();
    state.paint_map.as_ptr()
}

/// Where the pixels of the picture begin: red, green, blue and 255, row by row.
#[unsafe(no_mangle)]
pub extern "C" fn pixels_start() -> *const u8 {
    state().engine.as_ref().map_or(std::ptr::null(), |engine| engine.screen().pixels.as_ptr().cast())
}

/// The columns of the picture.
#[unsafe(no_mangle)]
pub extern "C" fn columns() -> u32 {
    state().engine.as_ref().map_or(0, |engine| engine.screen().size[0])
}

/// The rows of the picture.
#[unsafe(no_mangle)]
pub extern "C" fn rows() -> u32 {
    state().engine.as_ref().map_or(0, |engine| engine.screen().size[1])
}

/// The reciprocal distance that makes sharp what is at a place; NaN where there is nothing, infinite where paint alone decides.
#[unsafe(no_mangle)]
pub extern "C" fn sharp_distance(x: f64, y: f64) -> f64 {
    number(|engine| Some(engine.sharp_inverse_distance(x, y)?.unwrap_or(f64::INFINITY)))
}

/// Begins a stroke. Returns whether there is a surface. `circle_px`: what is painted, as the diameter of the blur, negative as if near; NaN paints the ordinary lens.
#[unsafe(no_mangle)]
pub extern "C" fn begin_stroke(x: f64, y: f64, radius_px: f64, hardness: f64, circle_px: f64) -> u32 {
    let paint = if circle_px.is_nan() { Paint::OrdinaryLens } else { Paint::Circle(circle_px) };
    let brush = PageBrush { radius_px, hardness, paint };
    state().engine.as_mut().map_or(0, |engine| u32::from(engine.begin_stroke(brush, x, y)))
}

/// The radius of the stroke in progress, world units; NaN without one.
#[unsafe(no_mangle)]
pub extern "C" fn stroke_radius() -> f64 {
    number(|engine| Some(engine.stroke_facts()?.0))
}

/// The t of the stroke in progress; NaN without one.
#[unsafe(no_mangle)]
pub extern "C" fn stroke_t() -> f64 {
    number(|engine| Some(engine.stroke_facts()?.1.t))
}

/// Goes on with the stroke to another place.
#[unsafe(no_mangle)]
pub extern "C" fn extend_stroke(x: f64, y: f64) {
    if let Some(engine) = &mut state().engine {
        engine.extend_stroke(x, y);
    }
}

/// Draws what was painted since.
#[unsafe(no_mangle)]
pub extern "C" fn draw_stroke() -> u32 {
    attempt(Engine::draw_stroke)
}

/// Ends the stroke. Returns whether it changed anything.
#[unsafe(no_mangle)]
pub extern "C" fn end_stroke() -> u32 {
    state().engine.as_mut().map_or(0, |engine| u32::from(engine.end_stroke()))
}

/// Undoes the last stroke.
#[unsafe(no_mangle)]
pub extern "C" fn undo() -> u32 {
    attempt(Engine::undo)
}

/// Does again the stroke that was undone last.
#[unsafe(no_mangle)]
pub extern "C" fn redo() -> u32 {
    attempt(Engine::redo)
}
