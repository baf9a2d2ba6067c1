// Which nodes of a chunk are drawn, and in which forms: the twin of draw_list.rs, lens_in_use.rs and gpu/records.rs. Read
// after pen.wgsl. One thread handles one node. The node is drawn if it is a sample or may replace all nodes below it, and
// no node above it is drawn. Records are counted first; a second pass writes each kind to its own range.
//
// A product that is then added to something passes through `exact`: compilers would otherwise fuse the two operations and
// round once.

struct Lens {
    // Radii of aperture images, 1/4096 px: at infinity; decrease per unit of 1/z; increase at t = 2.
    radius_at_infinity: f32,
    radius_per_kappa: f32,
    radius_per_offset: f32,
    // Always 0; unknown to the compiler.
    zero: u32,
    // Columns and rows of the picture.
    size: vec2<i32>,
    box_radius: u32,
    one_box_radius: u32,
    even_tilt: i32,
    per_variance: u32,
    // Half the number of stencil places, and the places from which stencils are cut at fewer heights.
    half_places: u32,
    coarser: array<u32, 2>,
    // By level.
    too_blurred: array<vec2<u32>, LEVELS>,
    // By fineness and level.
    smallest_radius: array<u32, FINENESSES * LEVELS>,
    // By contrast, fineness and level.
    smallest_joint_radius: array<u32, CONTRASTS * FINENESSES * LEVELS>,
}

struct Chunk {
    node_count: u32,
    is_painted: u32,
    // Offsets in `record_counts` of the chunk's counts, and of the bits that mark requested stencils.
    counts: u32,
    places: u32,
    // The first record of each kind: for ordinary accumulators, then for wide ones.
    first: array<vec4<u32>, 2>,
}

// The focus painted on the nodes, FOCUS_WORDS each: t, anchor, and how much each varies below the node.
@group(0) @binding(1) var<storage, read> focus: array<f32>;
@group(0) @binding(3) var<storage, read> lens: Lens;
@group(0) @binding(4) var<storage, read_write> record_counts: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> records: array<u32>;
@group(0) @binding(6) var<uniform> chunk: Chunk;

// Whether records are counted and their stencils marked, or written.
override IS_COUNTING: bool = true;

const NO_FORM: u32 = 0xFFFFFFFFu;
const TOO_LARGE: u32 = 0xFFFFFFFFu;

fn exact(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ lens.zero);
}

struct Focus {
    t: f32,
    anchor: f32,
    t_apart: f32,
    anchor_apart: f32,
}

struct Placed {
    radius: i32,
    depth_share: i32,
    is_standard: bool,
    level: u32,
}

fn focus_of(index: u32) -> Focus {
    if chunk.is_painted == 0u {
        return Focus(1.0, 0.0, 0.0, 0.0);
    }
    let at = FOCUS_WORDS * index;
    return Focus(focus[at], focus[at + 1u], focus[at + 2u], focus[at + 3u]);
}

fn standard_radius(at: u32) -> f32 {
    return lens.radius_at_infinity - exact(lens.radius_per_kappa * bitcast<f32>(nodes[at + 10u]));
}

// Fields of a node's words: see `words_of_node` in scene.rs.
fn level_of(at: u32) -> u32 {
    return nodes[at + 3u] & NODE_LEVEL_MASK;
}

fn is_leaf(at: u32) -> bool {
    return (nodes[at + 3u] & NODE_IS_LEAF) != 0u;
}

fn contrast_of(at: u32) -> u32 {
    return (nodes[at + 3u] >> NODE_CONTRAST_BIT) & NODE_CONTRAST_MASK;
}

fn fineness_of(at: u32) -> u32 {
    let word = nodes[at + 3u];
    if (word & NODE_IS_BRIGHT) != 0u {
        return 3u;
    }
    if (word & NODE_IS_HIGHLIGHT) != 0u {
        return 2u;
    }
    return select(1u, 0u, (word & NODE_IS_OPEN) != 0u);
}

fn place(at: u32, painted: Focus) -> Placed {
    let of_depth = exact(painted.t * (1.0 - painted.anchor));
    let by_offset = exact(lens.radius_per_offset * (painted.t - 1.0));
    let exact_radius = by_offset + exact(of_depth * standard_radius(at));
    let radius = i32(round(clamp(exact_radius, -LARGEST_RADIUS, LARGEST_RADIUS)));
    let depth_share = i32(clamp(of_depth * f32(ONE), -LARGEST_DEPTH_SHARE, LARGEST_DEPTH_SHARE));
    let of_fineness = LEVELS * fineness_of(at);
    var level = 0u;
    while level + 1u < LEVELS && u32(abs(radius)) >= lens.smallest_radius[of_fineness + level + 1u] {
        level += 1u;
    }
    return Placed(radius, depth_share, painted.t == 1.0 && painted.anchor == 0.0, level);
}

fn may_merge(at: u32, painted: Focus, radius: i32) -> bool {
    if painted.t_apart >= LARGEST_OFFSET {
        return false;
    }
    let size = u32(abs(radius));
    let level = level_of(at);
    let is_sharp = level == 0u && size <= SHARP;
    let is_blurred = size >= lens.smallest_joint_radius[LEVELS * (FINENESSES * contrast_of(at) + fineness_of(at)) + level];
    if !is_sharp && !is_blurred {
        return false;
    }
    let of_depth = exact(painted.t * (1.0 - painted.anchor));
    var apart = exact(abs(of_depth) * exact(lens.radius_per_kappa * bitcast<f32>(nodes[at + 11u])));
    if painted.t_apart > 0.0 || painted.anchor_apart > 0.0 {
        let standard = standard_radius(at);
        let by_t = abs(lens.radius_per_offset + exact((1.0 - painted.anchor) * standard));
        let by_anchor = abs(exact(painted.t * standard));
        apart += exact(by_t * painted.t_apart) + exact(by_anchor * painted.anchor_apart);
    }
    let side = f32(u32(PIXEL) << level);
    return apart <= select(f32(SHARP), max(FLAT * side, ALIKE * float_of(size)), is_blurred);
}

// Whether a node above replaces it.
fn is_below_drawn(at: u32) -> bool {
    var parent = nodes[at + 12u];
    while parent != NO_PARENT {
        let above = NODE_WORDS * parent;
        let painted = focus_of(parent);
        if may_merge(above, painted, place(above, painted).radius) {
            return true;
        }
        parent = nodes[above + 12u];
    }
    return false;
}

fn is_within(center: i32, half_size: u32, leaning: i32, placed: Placed, side: i32) -> bool {
    let middle = center >> POSITION_BITS;
    let reach = (abs(placed.radius) >> POSITION_BITS) * 33 / 32 + leaning
        + i32(half_size >> (POSITION_BITS - 1u)) + (5i << placed.level);
    return clamp(middle - reach, 0, side) < clamp(middle + reach + 1, 0, side);
}

// How far beyond its image a node's light may lean along a row.
fn leaning_of(node: Node, placed: Placed) -> i32 {
    let radius = abs(placed.radius) >> POSITION_BITS;
    let is_flat = abs(node.tilt.x) + abs(node.tilt.y) <= ONE / 8;
    return select(select(radius, radius / 3, node.base == ONE), radius / 16, is_flat);
}

fn is_even(node: Node) -> bool {
    return abs(node.tilt.x) + abs(node.tilt.y) < lens.even_tilt;
}

// The forms that a node is drawn in.
fn forms_of(node: Node, placed: Placed) -> vec2<u32> {
    let radius = u32(abs(placed.radius));
    if !node.is_open {
        let is_box = (radius >> placed.level) < lens.box_radius;
        return vec2<u32>(select(FORM_PARTIAL_IMAGE, FORM_PARTIAL_BOX, is_box), NO_FORM);
    }
    var far = 65536u;
    if placed.level == 0u {
        far = part_drawn_as_stencil(radius, seed(node, 0u));
    }
    var forms = vec2<u32>(NO_FORM, NO_FORM);
    if far < 65536u {
        forms.x = select(FORM_PARTS, FORM_BOX, is_even(node) && radius < lens.one_box_radius);
    }
    if far > 0u {
        forms.y = select(FORM_TILTED, FORM_IMAGE, is_even(node));
    }
    return forms;
}

// A third of a wide integer.
fn third_of(x: vec2<u32>) -> vec2<u32> {
    let middle = ((x.y % 3u) << 16u) | (x.x >> 16u);
    let low = ((middle % 3u) << 16u) | (x.x & 0xFFFFu);
    return vec2<u32>(((middle / 3u) << 16u) | (low / 3u), x.y / 3u);
}

fn index_of(square: u32) -> u32 {
    let size = 31u - countLeadingZeros(square | 1u);
    let octave = size - min(size, MANTISSA_BITS);
    let steps = (square + ((1u << octave) / 2u)) >> octave;
    return (octave << MANTISSA_BITS) + steps;
}

// The number of the stencil of an image whose centre is at the height `y`; TOO_LARGE if it has none.
fn stencil_of(node: Node, radius: i32, level: u32, y: i32) -> u32 {
    let size = node.half_size;
    let squares = wide_sum(vec2<u32>(size.x * size.x, 0u), vec2<u32>(size.y * size.y, 0u));
    let variance = wide_product(wide_right(squares, 2u * level + 1u).x, lens.per_variance);
    let footprint = third_of(wide_right(variance, 14u));
    let length = u32(abs(radius));
    var square = wide_sum(wide_product(length, length), footprint);
    square = wide_sum(square, wide_negative(lens.too_blurred[level]));
    if i32(square.y) < 0 {
        square = vec2<u32>();
    }
    // 64 px squared, (1/4096 px)².
    if square.y > 16u || (square.y == 16u && square.x > 0u) {
        return TOO_LARGE;
    }
    let index = index_of(wide_right(square, 2u * (POSITION_BITS - RADIUS_BITS)).x);
    let phase_bits = PHASE_BITS - u32(index >= lens.coarser[0]) - u32(index >= lens.coarser[1]);
    let bits = POSITION_BITS - phase_bits;
    let phase = u32((y + ((1i << bits) / 2)) & (PIXEL - 1)) >> bits;
    return ((index + select(0u, lens.half_places, radius < 0)) << PHASE_BITS) + phase;
}

fn light_center(node: Node, form: u32, radius: i32, level: u32) -> i32 {
    let center = node.center.y >> level;
    if form != FORM_IMAGE {
        return center;
    }
    return center - signed_mul_shift(radius, (node.tilt.y * pen.tilt_shift.y) >> 14u, 14u);
}

struct Record {
    kind: u32,
    form_argument: u32,
}

fn record_of(node: Node, placed: Placed, form: u32) -> Record {
    if form == FORM_BOX || form == FORM_PARTIAL_BOX {
        return Record(KIND_BOXES, 0u);
    }
    if form == FORM_PARTS {
        return Record(KIND_BOXES, bitcast<u32>(placed.depth_share));
    }
    let radius = placed.radius / (1i << placed.level);
    let stencil = stencil_of(node, radius, placed.level, light_center(node, form, radius, placed.level));
    if stencil == TOO_LARGE {
        return Record(KIND_LARGE, 0u);
    }
    return Record(select(KIND_PARTIAL, KIND_IMAGES, form == FORM_IMAGE), stencil);
}

// The whole node or, of a sample of a large cell, one of the pieces that it is drawn in.
fn part_drawn(node: Node, level: u32, piece: u32) -> Node {
    if level < node.level {
        return piece_of(node, level, piece);
    }
    return node;
}

// The workgroup's number of records of each kind, then their first indices.
var<workgroup> of_group: array<atomic<u32>, COUNTS>;

@compute @workgroup_size(THREADS)
fn list(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = id.x;
    let at = NODE_WORDS * index;
    var piece_count = 0u;
    var node: Node;
    var placed: Placed;
    var flags = 0u;
    if index < chunk.node_count {
        let painted = focus_of(index);
        placed = place(at, painted);
        node = node_at(at);
        let is_in_frame = is_within(node.center.x, node.half_size.x, leaning_of(node, placed), placed, lens.size.x)
            && is_within(node.center.y, node.half_size.y, 0, placed, lens.size.y);
        if is_in_frame && (is_leaf(at) || may_merge(at, painted, placed.radius)) && !is_below_drawn(at) {
            piece_count = 1u;
            flags = select(0u, IS_SHARING, placed.is_standard && !node.is_open) | (placed.level << LEVEL_BIT);
            if placed.level < node.level {
                let across = pieces_of(node, placed.level);
                piece_count = across * across;
                flags |= IS_PIECE;
            }
        }
    }
    // Bright nodes go to wide accumulators, their coverage to ordinary ones as well.
    let width = select(0u, 1u, node.is_bright);
    var counts = vec4<u32>();
    for (var piece = 0u; piece < piece_count; piece += 1u) {
        let drawn = part_drawn(node, placed.level, piece);
        let forms = forms_of(drawn, placed);
        for (var k = 0u; k < 2u; k += 1u) {
            if forms[k] != NO_FORM {
                let record = record_of(drawn, placed, forms[k]);
                counts[record.kind] += 1u;
                if IS_COUNTING && (record.kind == KIND_IMAGES || record.kind == KIND_PARTIAL) {
                    mark(record.form_argument >> PHASE_BITS);
                }
            }
        }
    }
    var next: array<u32, COUNTS>;
    for (var kind = 0u; kind < KINDS; kind += 1u) {
        if counts[kind] > 0u {
            next[KINDS * width + kind] = atomicAdd(&of_group[KINDS * width + kind], counts[kind]);
            if width == 1u {
                next[kind] = atomicAdd(&of_group[kind], counts[kind]);
            }
        }
    }
    workgroupBarrier();
    if thread < COUNTS {
        let count = atomicLoad(&of_group[thread]);
        if count > 0u {
            let before = atomicAdd(&record_counts[chunk.counts + thread], count);
            atomicStore(&of_group[thread], before + chunk.first[thread / KINDS][thread % KINDS]);
        }
    }
    if IS_COUNTING {
        return;
    }
    workgroupBarrier();
    for (var k = 0u; k < COUNTS; k += 1u) {
        next[k] += atomicLoad(&of_group[k]);
    }
    for (var piece = 0u; piece < piece_count; piece += 1u) {
        let drawn = part_drawn(node, placed.level, piece);
        let forms = forms_of(drawn, placed);
        for (var k = 0u; k < 2u; k += 1u) {
            if forms[k] != NO_FORM {
                let record = record_of(drawn, placed, forms[k]);
                let own = forms[k] | flags | (piece << PIECE_BIT);
                write(next[KINDS * width + record.kind], index, placed.radius, record.form_argument, own);
                next[KINDS * width + record.kind] += 1u;
                if width == 1u {
                    write(next[record.kind], index, placed.radius, record.form_argument, own | IS_COVERAGE);
                    next[record.kind] += 1u;
                }
            }
        }
    }
}

fn mark(stencil_place: u32) {
    let at = chunk.places + stencil_place / 32u;
    let bit = 1u << (stencil_place % 32u);
    // Most are marked already.
    if (atomicLoad(&record_counts[at]) & bit) == 0u {
        atomicOr(&record_counts[at], bit);
    }
}

fn write(record: u32, index: u32, radius: i32, form_argument: u32, flags: u32) {
    let at = RECORD_WORDS * record;
    records[at] = index;
    records[at + 1u] = bitcast<u32>(radius);
    records[at + 2u] = form_argument;
    records[at + 3u] = flags;
}
