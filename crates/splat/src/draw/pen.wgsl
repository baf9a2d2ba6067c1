// Nodes, and what they are drawn with: what finding those that are drawn (list.wgsl) and drawing them (draw.wgsl) share.

struct Level {
    width: i32,
    height: i32,
    // Words of the accumulator before its pixels, and before its totals.
    pixels: u32,
    totals: u32,
}

struct Part {
    share: u32,
    mean: vec2<i32>,
    variance: vec2<i32>,
    half: vec2<u32>,
}

struct Pen {
    middle: vec2<i32>,
    stop: i32,
    per_stop: u32,
    half: vec2<u32>,
    tilt_shift: vec2<i32>,
    mean: vec2<i32>,
    stencil_radius: u32,
    per_stencil_radius: u32,
    // Rows of the shape, and where its runs begin.
    shape_rows: u32,
    shape_runs: u32,
    // What the light's exponent gains in the ordinary sum: that of ordinary nodes, and of the coverage of bright ones.
    dim_exponent: i32,
    coverage_exponent: i32,
    part_count: u32,
    even_seen_tilt: i32,
    all_rows_radius: u32,
    is_exact: u32,
    levels: array<Level, 5>,
    // Share, mean, variance, half.
    parts: array<Part, 16>,
}

// The nodes of a chunk, 13 words each: see `words_of_node` in scene.rs.
@group(0) @binding(0) var<storage, read> nodes: array<u32>;
// What they are drawn with: see `Shapes` in shapes.rs.
@group(0) @binding(2) var<storage, read> pen: Pen;

const NODE_WORDS: u32 = 13u;
const POSITION_BITS: u32 = 12u;
const PIXEL: i32 = 4096;
const ONE: i32 = 16384;
const WHOLE: u32 = 16777216u;
const FORM_BOX: u32 = 0u;
const FORM_PARTS: u32 = 1u;
const FORM_IMAGE: u32 = 2u;
const FORM_TILTED: u32 = 3u;
const FORM_SEEN_BOX: u32 = 4u;
const FORM_SEEN: u32 = 5u;
const KIND_BOXES: u32 = 0u;
const KIND_IMAGES: u32 = 1u;
const KIND_SEEN: u32 = 2u;
const KIND_LARGE: u32 = 3u;

struct Node {
    center: vec2<i32>,
    half_size: vec2<u32>,
    level: u32,
    is_bright: bool,
    is_open: bool,
    base: i32,
    tilt: vec2<i32>,
    cells: u32,
}

fn low_half(word: u32) -> i32 {
    return (bitcast<i32>(word) << 16u) >> 16u;
}

fn high_half(word: u32) -> i32 {
    return bitcast<i32>(word) >> 16u;
}

fn node_at(at: u32) -> Node {
    var node: Node;
    node.center = vec2<i32>(bitcast<i32>(nodes[at]), bitcast<i32>(nodes[at + 1u]));
    node.half_size = vec2<u32>(nodes[at + 2u] & 0xFFFFu, nodes[at + 2u] >> 16u);
    node.level = nodes[at + 3u] & 7u;
    node.is_open = (nodes[at + 3u] & 0x20u) != 0u;
    node.is_bright = (nodes[at + 3u] & 0x80u) != 0u;
    node.base = high_half(nodes[at + 3u]);
    node.tilt = vec2<i32>(low_half(nodes[at + 4u]), high_half(nodes[at + 4u]));
    node.cells = nodes[at + 5u];
    return node;
}

// Pieces of a sample of a large cell, along each side.
fn pieces_of(node: Node, level: u32) -> u32 {
    return 1u << (node.level - level);
}

fn piece_of(node: Node, level: u32, index: u32) -> Node {
    let finer = node.level - level;
    let count = i32(pieces_of(node, level));
    var piece = node;
    piece.half_size = max(node.half_size >> vec2<u32>(finer), vec2<u32>(128u));
    let step = vec2<i32>(2 * (i32(index) % count) + 1 - count, 2 * (i32(index) / count) + 1 - count);
    piece.center += step * vec2<i32>(piece.half_size);
    piece.level = level;
    return piece;
}

fn seed(node: Node, level: u32) -> u32 {
    let x = bitcast<u32>(node.center.x - pen.middle.x);
    let y = bitcast<u32>(node.center.y - pen.middle.y);
    return ((x * 0x9E3779B1u) ^ (y * 0x85EBCA77u) ^ level) * 0xC2B2AE3Du;
}

fn part_drawn_as_stencil(radius: u32, dither: u32) -> u32 {
    let part = part_of_stencil(radius);
    if pen.is_exact != 0u || part % 65536u == 0u {
        return part;
    }
    return select(0u, 65536u, (dither >> 16u) < part);
}

fn part_of_stencil(radius: u32) -> u32 {
    if radius <= pen.stencil_radius {
        return 0u;
    }
    if radius - pen.stencil_radius >= pen.stencil_radius {
        return 65536u;
    }
    let part = mul_shift(radius - pen.stencil_radius, pen.per_stencil_radius, 16u);
    return mul_shift(mul_shift(part, part, 16u), 3u * 65536u - 2u * part, 16u);
}
