// Which nodes of a chunk are drawn, and in which forms: the twin of `Scene::drawn`, of ../lens_in_use.rs and of records.rs.
// Read after pen.wgsl. A thread looks at one node. It is drawn if it is a sample or may stand for all below it, and
// no node above it is. Records are first counted, then written where each kind's have their place.
//
// A product that is added to something goes through `exact`, for compilers like to round the two as one.

struct Lens {
    // Radii of aperture images, 1/4096 px: of what is infinitely far, what it loses for a unit of 1/z, what t = 2 adds.
    radius_at_infinity: f32,
    radius_per_kappa: f32,
    radius_per_offset: f32,
    // Always 0, which no compiler knows.
    zero: u32,
    // Columns and rows of the picture.
    size: vec2<i32>,
    box_radius: u32,
    one_box_radius: u32,
    even_tilt: i32,
    per_variance: u32,
    // Half of all places of stencils, and from which on they are cut at fewer heights.
    half_places: u32,
    coarser: array<u32, 2>,
    // By level.
    too_blurred: array<vec2<u32>, 5>,
    // By fineness and level.
    smallest: array<u32, 20>,
    // By contrast, fineness and level.
    smallest_joint: array<u32, 140>,
}

struct Chunk {
    node_count: u32,
    is_painted: u32,
    // Where in `found` stand its counts, and the bits of the stencils that are asked for.
    counts: u32,
    places: u32,
    // Where the records of each kind begin: on ordinary accumulators, then on wide ones.
    first: array<vec4<u32>, 2>,
}

// What is painted on the nodes, four words each: t, anchor, and how far they are apart below.
@group(0) @binding(1) var<storage, read> focus: array<f32>;
@group(0) @binding(3) var<storage, read> lens: Lens;
@group(0) @binding(4) var<storage, read_write> found: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> records: array<u32>;
@group(0) @binding(6) var<uniform> chunk: Chunk;

// Whether records are counted, and the stencils they ask for marked; or written.
override IS_COUNTING: bool = true;

const FLAT: f32 = 0.3;
const ALIKE: f32 = 0.125;
const SHARP: u32 = 16u;
const LEVELS: u32 = 5u;
const LARGEST_RADIUS: f32 = 536870912.0;
const LARGEST_DEPTH_SHARE: f32 = 131071.0;
const LARGEST_OFFSET: f32 = 1e9;
const NO_PARENT: u32 = 0xFFFFFFFFu;
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
    let at = 4u * index;
    return Focus(focus[at], focus[at + 1u], focus[at + 2u], focus[at + 3u]);
}

fn standard_radius(at: u32) -> f32 {
    return lens.radius_at_infinity - exact(lens.radius_per_kappa * bitcast<f32>(nodes[at + 10u]));
}

// What stands in a node's word: see `words_of_node` in scene.rs.
fn level_of(at: u32) -> u32 {
    return nodes[at + 3u] & 7u;
}

fn is_leaf(at: u32) -> bool {
    return (nodes[at + 3u] & 0x10u) != 0u;
}

fn contrast_of(at: u32) -> u32 {
    return (nodes[at + 3u] >> 8u) & 15u;
}

fn fineness_of(at: u32) -> u32 {
    let word = nodes[at + 3u];
    if (word & 0x80u) != 0u {
        return 3u;
    }
    if (word & 8u) != 0u {
        return 2u;
    }
    return select(1u, 0u, (word & 0x20u) != 0u);
}

fn place(at: u32, painted: Focus) -> Placed {
    let of_depth = exact(painted.t * (1.0 - painted.anchor));
    let by_offset = exact(lens.radius_per_offset * (painted.t - 1.0));
    let exact_radius = by_offset + exact(of_depth * standard_radius(at));
    let radius = i32(round(clamp(exact_radius, -LARGEST_RADIUS, LARGEST_RADIUS)));
    let depth_share = i32(clamp(of_depth * f32(ONE), -LARGEST_DEPTH_SHARE, LARGEST_DEPTH_SHARE));
    let of_fineness = LEVELS * fineness_of(at);
    var level = 0u;
    while level + 1u < LEVELS && u32(abs(radius)) >= lens.smallest[of_fineness + level + 1u] {
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
    if !is_sharp && size < lens.smallest_joint[LEVELS * (4u * contrast_of(at) + fineness_of(at)) + level] {
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
    return apart <= select(max(FLAT * side, ALIKE * float_of(size)), f32(SHARP), is_sharp);
}

// Whether a node above stands for it.
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
        return vec2<u32>(select(FORM_SEEN, FORM_SEEN_BOX, is_box), NO_FORM);
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
    let octave = size - min(size, 7u);
    let steps = (square + ((1u << octave) / 2u)) >> octave;
    return (octave << 7u) + steps;
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
    let index = index_of(wide_right(square, 12u).x);
    let phase_bits = 5u - u32(index >= lens.coarser[0]) - u32(index >= lens.coarser[1]);
    let bits = POSITION_BITS - phase_bits;
    let phase = u32((y + ((1i << bits) / 2)) & (PIXEL - 1)) >> bits;
    return ((index + select(0u, lens.half_places, radius < 0)) << 5u) + phase;
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
    of_form: u32,
}

fn record_of(node: Node, placed: Placed, form: u32) -> Record {
    if form == FORM_BOX || form == FORM_SEEN_BOX {
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
    return Record(select(KIND_SEEN, KIND_IMAGES, form == FORM_IMAGE), stencil);
}

// All of a node, or of a sample of a large cell one of the pieces that it is drawn in.
fn part_drawn(node: Node, level: u32, piece: u32) -> Node {
    if level < node.level {
        return piece_of(node, level, piece);
    }
    return node;
}

// How many records of each kind the workgroup has, then where its own begin.
var<workgroup> of_group: array<atomic<u32>, 8>;

@compute @workgroup_size(64)
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
        let is_seen = is_within(node.center.x, node.half_size.x, leaning_of(node, placed), placed, lens.size.x)
            && is_within(node.center.y, node.half_size.y, 0, placed, lens.size.y);
        if is_seen && (is_leaf(at) || may_merge(at, painted, placed.radius)) && !is_below_drawn(at) {
            piece_count = 1u;
            flags = select(0u, 8u, placed.is_standard && !node.is_open) | (placed.level << 8u);
            if placed.level < node.level {
                let across = pieces_of(node, placed.level);
                piece_count = across * across;
                flags |= 64u;
            }
        }
    }
    // What is bright goes to wide accumulators, and its coverage to ordinary ones as well.
    let width = select(0u, 1u, node.is_bright);
    var counts = vec4<u32>();
    for (var piece = 0u; piece < piece_count; piece += 1u) {
        let drawn = part_drawn(node, placed.level, piece);
        let forms = forms_of(drawn, placed);
        for (var k = 0u; k < 2u; k += 1u) {
            if forms[k] != NO_FORM {
                let record = record_of(drawn, placed, forms[k]);
                counts[record.kind] += 1u;
                if IS_COUNTING && (record.kind == KIND_IMAGES || record.kind == KIND_SEEN) {
                    mark(record.of_form >> 5u);
                }
            }
        }
    }
    var next: array<u32, 8>;
    for (var kind = 0u; kind < 4u; kind += 1u) {
        if counts[kind] > 0u {
            next[4u * width + kind] = atomicAdd(&of_group[4u * width + kind], counts[kind]);
            if width == 1u {
                next[kind] = atomicAdd(&of_group[kind], counts[kind]);
            }
        }
    }
    workgroupBarrier();
    if thread < 8u {
        let count = atomicLoad(&of_group[thread]);
        if count > 0u {
            let before = atomicAdd(&found[chunk.counts + thread], count);
            atomicStore(&of_group[thread], before + chunk.first[thread / 4u][thread % 4u]);
        }
    }
    if IS_COUNTING {
        return;
    }
    workgroupBarrier();
    for (var k = 0u; k < 8u; k += 1u) {
        next[k] += atomicLoad(&of_group[k]);
    }
    for (var piece = 0u; piece < piece_count; piece += 1u) {
        let drawn = part_drawn(node, placed.level, piece);
        let forms = forms_of(drawn, placed);
        for (var k = 0u; k < 2u; k += 1u) {
            if forms[k] != NO_FORM {
                let record = record_of(drawn, placed, forms[k]);
                let own = forms[k] | flags | (piece << 16u);
                write(next[4u * width + record.kind], index, placed.radius, record.of_form, own);
                next[4u * width + record.kind] += 1u;
                if width == 1u {
                    write(next[record.kind], index, placed.radius, record.of_form, own | 32u);
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
    if (atomicLoad(&found[at]) & bit) == 0u {
        atomicOr(&found[at], bit);
    }
}

fn write(record: u32, index: u32, radius: i32, of_form: u32, flags: u32) {
    let at = 4u * record;
    records[at] = index;
    records[at + 1u] = bitcast<u32>(radius);
    records[at + 2u] = of_form;
    records[at + 3u] = flags;
}
