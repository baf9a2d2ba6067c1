//! How nodes and records are packed into words, and how many threads work on them: what Rust and the shaders agree on beside
//! the structs of `shader_structs`.

/// Words of a node: see `words_of_node`.
pub const NODE_WORDS: usize = 13;

/// The lower half of a node's fourth word: its level …
pub const NODE_LEVEL_MASK: u32 = 7;
/// … flags …
pub const NODE_IS_HIGHLIGHT: u32 = 1 << 3;
pub const NODE_IS_LEAF: u32 = 1 << 4;
pub const NODE_IS_OPEN: u32 = 1 << 5;
pub const NODE_IS_BRIGHT: u32 = 1 << 7;
/// … and its contrast.
pub const NODE_CONTRAST_BIT: u32 = 8;
pub const NODE_CONTRAST_MASK: u32 = 15;

/// The parent of a node that has none.
pub const NO_PARENT: u32 = u32::MAX;

/// Words of a node's focus.
pub const FOCUS_WORDS: usize = 4;

/// Words of a partly occluded node's cells (eight) and moments.
pub const PARTIAL_WORDS: usize = 11;

/// Words of a record: node, signed radius, the form's argument, flags. A record of a large image has twice as many.
pub const RECORD_WORDS: usize = 4;

/// Kinds of records. Each is drawn by a pass of its own.
pub const KINDS: usize = 4;
pub const KIND_BOXES: usize = 0;
pub const KIND_IMAGES: usize = 1;
/// Images of partly occluded nodes; their boxes are among [`KIND_BOXES`].
pub const KIND_PARTIAL: usize = 2;
pub const KIND_LARGE: usize = 3;

/// Kinds of records for ordinary accumulators and for wide ones.
pub const COUNTS: usize = 2 * KINDS;

/// Forms, in the lowest bits of a record's last word.
pub const FORM_BOX: u32 = 0;
pub const FORM_PARTS: u32 = 1;
pub const FORM_IMAGE: u32 = 2;
pub const FORM_TILTED: u32 = 3;
pub const FORM_PARTIAL_BOX: u32 = 4;
pub const FORM_PARTIAL_IMAGE: u32 = 5;
pub const FORM_MASK: u32 = 7;

/// Flags of a record's last word: the light goes to the sum of sharing nodes …
pub const IS_SHARING: u32 = 8;
/// … is subtracted …
pub const IS_REMOVED: u32 = 16;
/// … is only its coverage …
pub const IS_COVERAGE: u32 = 32;
/// … or is that of a piece of a large cell.
pub const IS_PIECE: u32 = 64;

/// Where in that word the level begins that the record is drawn on.
pub const LEVEL_BIT: u32 = 8;
pub const LEVEL_MASK: u32 = 7;
/// Where in that word the number of the piece begins.
pub const PIECE_BIT: u32 = 16;

/// Threads of a workgroup in most passes.
pub const THREADS: u32 = 64;

/// Threads of a workgroup that integrates a row.
pub const SCAN_THREADS: u32 = 256;

/// Threads that draw one record where there are few records: a divisor of [`THREADS`].
pub const LANES: u32 = 16;
