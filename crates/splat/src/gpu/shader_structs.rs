//! The structs that shaders read from uniform and storage buffers, laid out as WGSL lays them out.
//!
//! Each struct has the name and the fields of its twin in WGSL; padding is a field of its own. A test (`shader_tests`) compares
//! names, offsets and sizes with what naga makes of the shaders, so that neither side can be changed alone.

use crate::draw::MAX_PARTS;
use crate::gpu::formats::COUNTS;
use crate::lens_in_use::FINENESSES;
use crate::nodes::CONTRASTS;
use bytemuck::{Pod, Zeroable};
use salf::tree::LEVELS;

/// Where a field of a struct lies, in bytes.
#[cfg(test)]
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldLayout {
    /// The field's name.
    pub name: String,
    /// Its offset in the struct, bytes.
    pub offset: usize,
    /// Its size, bytes.
    pub size: usize,
}

/// How a struct lies in memory, in bytes.
#[cfg(test)]
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StructLayout {
    /// The struct's name.
    pub name: String,
    /// Its size, bytes.
    pub size: usize,
    /// Without padding.
    pub fields: Vec<FieldLayout>,
}

/// Declares structs with the layout of C and lists them for the test of their layouts. The field `padding` has no twin.
macro_rules! shader_structs {
    ($($(#[$of_struct:meta])* $name:ident { $($(#[$of_field:meta])* $field:ident: $type:ty,)* })*) => {
        $(
            $(#[$of_struct])*
            #[repr(C)]
            #[derive(Clone, Copy, Debug, Pod, Zeroable)]
            pub struct $name { $($(#[$of_field])* pub $field: $type,)* }
        )*

        /// The layouts in memory of all structs that shaders read.
        #[cfg(test)]
        pub fn layouts() -> Vec<StructLayout> {
            vec![$({
                let fields = [$((stringify!($field), std::mem::offset_of!($name, $field), size_of::<$type>())),*];
                let fields = fields.into_iter().filter(|(name, ..)| *name != "padding");
                let fields = fields.map(|(name, offset, size)| FieldLayout { name: name.into(), offset, size });
                StructLayout { name: stringify!($name).into(), size: size_of::<$name>(), fields: fields.collect() }
            }),*]
        }
    };
}

shader_structs! {
    /// A level of an accumulator that is drawn on (pen.wgsl).
    SumLevel {
        width: i32,
        height: i32,
        /// Offset of its pixels in the accumulator, in words.
        pixels: u32,
        /// Offset of its totals, in words.
        totals: u32,
    }

    /// A part of the aperture whose image is a box: the twin of that of the pen (pen.wgsl).
    BoxPart {
        share: u32,
        padding: u32,
        mean: [i32; 2],
        variance: [i32; 2],
        half: [u32; 2],
    }

    /// What nodes are drawn with: [`crate::draw::Pen`] (pen.wgsl).
    Pen {
        middle: [i32; 2],
        stop: i32,
        per_stop: u32,
        half: [u32; 2],
        tilt_shift: [i32; 2],
        mean: [i32; 2],
        stencil_radius: u32,
        per_stencil_radius: u32,
        /// Rows of the aperture's shape.
        shape_rows: u32,
        /// Offset of its runs, in words.
        shape_runs: u32,
        /// Added to the exponent of ordinary nodes' light in the ordinary sum.
        dim_exponent: i32,
        /// Added to the exponent of bright nodes' coverage there.
        coverage_exponent: i32,
        part_count: u32,
        even_partial_tilt: i32,
        all_rows_radius: u32,
        is_exact: u32,
        levels: [SumLevel; LEVELS],
        parts: [BoxPart; MAX_PARTS],
    }

    /// What decides which nodes are drawn: [`crate::lens_in_use::LensInUse`], and some of the pen (draw_list.wgsl).
    Lens {
        radius_at_infinity: f32,
        radius_per_kappa: f32,
        radius_per_offset: f32,
        /// Always 0, unknown to the compiler.
        zero: u32,
        size: [i32; 2],
        box_radius: u32,
        one_box_radius: u32,
        even_tilt: i32,
        per_variance: u32,
        half_places: u32,
        coarser: [u32; 2],
        padding: u32,
        /// By level; of 64 bits, the lower word first.
        too_blurred: [[u32; 2]; LEVELS],
        smallest_radius: [[u32; LEVELS]; FINENESSES],
        smallest_joint_radius: [[[u32; LEVELS]; FINENESSES]; CONTRASTS],
    }

    /// A chunk of nodes that is listed (draw_list.wgsl).
    Chunk {
        node_count: u32,
        is_painted: u32,
        /// Offset of its counts, in words.
        counts: u32,
        /// Offset of the bits of requested stencils, in words.
        places: u32,
        /// The first record of each kind: for ordinary accumulators, then for wide ones.
        first: [u32; COUNTS],
    }

    /// Records that are drawn at once (draw.wgsl).
    Batch {
        count: u32,
        /// Records before them in the buffer.
        first: u32,
    }

    /// A level of an accumulator that is integrated (resolve.wgsl).
    LineLevel {
        width: i32,
        height: i32,
        pixels: u32,
        totals: u32,
        /// Offset of its lines, in pixels.
        lines: u32,
        /// Offset of the next coarser level's lines; its size, 0 if there is none.
        coarse_lines: u32,
        coarse_width: i32,
        coarse_height: i32,
        level: u32,
    }

    /// The part of the picture that is made (resolve.wgsl).
    Frame {
        /// The first pixel row.
        first: i32,
        /// The row behind the last one.
        end: i32,
        width: i32,
        is_evened: u32,
        /// Always 0, unknown to the compiler.
        zero: u32,
        quantum: f32,
        wide_quantum: f32,
        /// Colours of pixels with more coverage than this may have wrapped.
        largest: i32,
        /// The same for wide sums: 64 bits, the lower word first.
        wide_largest: [u32; 2],
        is_sharing: u32,
        padding: u32,
    }
}
