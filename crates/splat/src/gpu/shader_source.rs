//! The WGSL source of each shader module: constants from Rust, then the files of the module.
//!
//! A constant that both Rust and WGSL need is written in Rust only. The macro [`constants`] turns it into a `const` of WGSL under the same
//! name.

use crate::aperture::stencil::{HEIGHT_BITS, MANTISSA_BITS, PHASE_BITS, RADIUS_BITS};
use crate::canvas::{PIXEL, POSITION_BITS};
use crate::draw::MAX_PARTS;
use crate::draw::boxes::LARGEST_HALF;
use crate::draw::image::{HASH_DITHER, HASH_MIX, HASH_Y};
use crate::draw::sized_box::SMALLEST_HALF;
use crate::draw::stencilled::LARGEST_SCALE;
use crate::draw::visible_runs::{
    CELL_BITS, COLUMN_BITS, LARGEST_REACH, LAST_COLUMN, SMALLEST_REACH, TALLEST_ROW,
};
use crate::fixed::{GOLDEN, ONE, WHOLE};
use crate::gpu::formats::{
    COUNTS, FOCUS_WORDS, FORM_BOX, FORM_IMAGE, FORM_MASK, FORM_PARTIAL_BOX, FORM_PARTIAL_IMAGE, FORM_PARTS,
    FORM_TILTED, IS_COVERAGE, IS_PIECE, IS_REMOVED, IS_SHARING, KIND_BOXES, KIND_IMAGES, KIND_LARGE,
    KIND_PARTIAL, KINDS, LEVEL_BIT, LEVEL_MASK, NO_PARENT, NODE_CONTRAST_BIT, NODE_CONTRAST_MASK,
    NODE_IS_BRIGHT, NODE_IS_HIGHLIGHT, NODE_IS_LEAF, NODE_IS_OPEN, NODE_LEVEL_MASK, NODE_WORDS,
    PARTIAL_WORDS, PIECE_BIT, RECORD_WORDS, SCAN_THREADS, THREADS,
};
use crate::gpu::layout::SLOTS;
use crate::lens_in_use::{
    ALIKE, FINENESSES, FLAT, LARGEST_DEPTH_SHARE, LARGEST_OFFSET, LARGEST_RADIUS, SHARP,
};
use crate::nodes::{CONTRASTS, OPEN};
use crate::resolve::balance::Scaled;
use crate::resolve::knots::SPACING;
use crate::resolve::partition::{COVERAGE_ONE, LARGEST_SHARE, MAX_QUANTA, MIN_PARTIAL, RIPPLE};
use crate::resolve::{CUBIC, MARGIN};
use graphics_card::constants;
use salf::tree::LEVELS;

const FIXED: &str = include_str!("../fixed.wgsl");
const PEN: &str = include_str!("../draw/pen.wgsl");
const DRAW_LIST: &str = include_str!("../draw_list.wgsl");
const DRAW: &str = include_str!("../draw.wgsl");
const VISIBLE_RUNS: &str = include_str!("../draw/visible_runs.wgsl");
const RESOLVE: &str = include_str!("resolve.wgsl");
const SCAN: &str = include_str!("scan.wgsl");
const SCAN_SUBGROUPS: &str = include_str!("scan_subgroups.wgsl");

fn joined(parts: &[&str]) -> String {
    parts.join("\n")
}

/// What both drawing and listing need.
fn of_pen() -> String {
    constants!(
        POSITION_BITS,
        PIXEL,
        ONE,
        WHOLE,
        LEVELS,
        MAX_PARTS,
        SMALLEST_HALF,
        GOLDEN,
        HASH_Y,
        HASH_MIX,
        THREADS,
        NODE_WORDS,
        NODE_LEVEL_MASK,
        NODE_IS_HIGHLIGHT,
        NODE_IS_LEAF,
        NODE_IS_OPEN,
        NODE_IS_BRIGHT,
        NODE_CONTRAST_BIT,
        NODE_CONTRAST_MASK,
        RECORD_WORDS,
        FORM_BOX,
        FORM_PARTS,
        FORM_IMAGE,
        FORM_TILTED,
        FORM_PARTIAL_BOX,
        FORM_PARTIAL_IMAGE,
        KIND_BOXES,
        KIND_IMAGES,
        KIND_PARTIAL,
        KIND_LARGE,
        IS_SHARING,
        IS_REMOVED,
        IS_COVERAGE,
        IS_PIECE,
        LEVEL_BIT,
        LEVEL_MASK,
        FORM_MASK,
        PIECE_BIT,
    )
}

/// The module that lists what is drawn.
pub fn list() -> String {
    let constants = constants!(
        KINDS,
        COUNTS,
        FOCUS_WORDS,
        NO_PARENT,
        FINENESSES,
        CONTRASTS,
        FLAT,
        ALIKE,
        SHARP,
        LARGEST_RADIUS,
        LARGEST_DEPTH_SHARE,
        LARGEST_OFFSET,
        RADIUS_BITS,
        MANTISSA_BITS,
        PHASE_BITS,
    );
    joined(&[&of_pen(), &constants, FIXED, PEN, DRAW_LIST])
}

/// The WGSL source of the module that draws.
pub fn draw() -> String {
    let constants = constants!(
        PARTIAL_WORDS,
        HEIGHT_BITS,
        LARGEST_HALF,
        LARGEST_SCALE,
        TALLEST_ROW,
        SMALLEST_REACH,
        LARGEST_REACH,
        OPEN,
        SLOTS,
        HASH_DITHER,
        CELL_BITS,
        COLUMN_BITS,
        LAST_COLUMN,
    );
    joined(&[&of_pen(), &constants, FIXED, PEN, DRAW, VISIBLE_RUNS])
}

/// The module that integrates sums and makes pictures of them. `by_subgroups`: with sums over subgroups, where a card has them.
pub fn resolve(by_subgroups: bool) -> String {
    let [behind, near, far, beyond] = CUBIC;
    let constants = constants!(
        THREADS,
        SCAN_THREADS,
        SLOTS,
        MARGIN,
        LARGEST_SHARE,
        MIN_PARTIAL,
        RIPPLE,
        COVERAGE_ONE,
        MAX_QUANTA;
        SPACING = SPACING as i32,
        KNOT_STEP = 1.0 / SPACING as f32,
        SHARING = Scaled::Sharing as i32,
        ALL = Scaled::All as i32,
        CUBIC_BEHIND = behind,
        CUBIC_NEAR = near,
        CUBIC_FAR = far,
        CUBIC_BEYOND = beyond,
    );
    joined(&[&constants, FIXED, if by_subgroups { SCAN_SUBGROUPS } else { SCAN }, RESOLVE])
}
