// Nodes and the parameters they are drawn with: read before draw_list.wgsl and before draw.wgsl. The twin of pen.rs.
// Constants that are not declared in WGSL come from Rust (shader_source.rs), as do the layouts of the structs in buffers
// (shader_structs.rs).

struct SumLevel {
    width: i32,
    height: i32,
    // Offsets of its pixels and of its totals in the accumulator, in words.
    pixels: u32,
    totals: u32,
}

struct BoxPart {
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
    // The number of rows of the aperture's shape, and the offset of its runs, in words.
    shape_rows: u32,
    shape_runs: u32,
    // Added to the exponent of light in the ordinary sum: of ordinary nodes, and of the coverage of bright ones.
    dim_exponent: i32,
    coverage_exponent: i32,
    part_count: u32,
    even_partial_tilt: i32,
    all_rows_radius: u32,
    is_exact: u32,
    levels: array<SumLevel, LEVELS>,
    parts: array<BoxPart, MAX_PARTS>,
}

// The nodes of a chunk, NODE_WORDS each: see `words_of_node` in scene.rs.
@group(0) @binding(0) var<storage, read> nodes: array<u32>;
@group(0) @binding(2) var<storage, read> pen: Pen;

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
    node.level = nodes[at + 3u] & NODE_LEVEL_MASK;
    node.is_open = (nodes[at + 3u] & NODE_IS_OPEN) != 0u;
    node.is_bright = (nodes[at + 3u] & NODE_IS_BRIGHT) != 0u;
    node.base = high_half(nodes[at + 3u]);
    node.tilt = vec2<i32>(low_half(nodes[at + 4u]), high_half(nodes[at + 4u]));
    node.cells = nodes[at + 5u];
    return node;
}

// The number of pieces of a sample of a large cell along each side.
fn pieces_of(node: Node, level: u32) -> u32 {
    return 1u << (node.level - level);
}

fn piece_of(node: Node, level: u32, index: u32) -> Node {
    let finer = node.level - level;
    let count = i32(pieces_of(node, level));
    var piece = node;
    piece.half_size = max(node.half_size >> vec2<u32>(finer), vec2<u32>(SMALLEST_HALF));
    let step = vec2<i32>(2 * (i32(index) % count) + 1 - count, 2 * (i32(index) / count) + 1 - count);
    piece.center += step * vec2<i32>(piece.half_size);
    piece.level = level;
    return piece;
}

fn seed(node: Node, level: u32) -> u32 {
    let x = bitcast<u32>(node.center.x - pen.middle.x);
    let y = bitcast<u32>(node.center.y - pen.middle.y);
    return ((x * GOLDEN) ^ (y * HASH_Y) ^ level) * HASH_MIX;
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
