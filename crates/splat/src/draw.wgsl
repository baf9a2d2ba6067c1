// Drawing placed nodes onto the accumulators: the twin of draw.rs and of the files in draw/, term by term. Read after
// pen.wgsl. One thread or several draw a record, each its own pixel rows. Additions to accumulators are atomic; integers make
// the order irrelevant.

// The visibility of partly occluded nodes, PARTIAL_WORDS each: 16 rows of cells, share, mean, half width.
@group(0) @binding(1) var<storage, read> cells: array<u32>;
// The aperture's rows, and stencils; see `Shapes` in shapes.rs.
@group(0) @binding(3) var<storage, read> shape: array<u32>;
@group(0) @binding(4) var<storage, read> stencils: array<u32>;
@group(0) @binding(5) var<storage, read> records: array<u32>;
@group(0) @binding(6) var<storage, read_write> free: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> sharing: array<atomic<u32>>;
@group(0) @binding(8) var<uniform> batch: Batch;

// Whether the accumulators hold 64 bits.
override IS_WIDE: bool = false;
// Which records are drawn: boxes, images, images through cells, large images.
override KIND: u32 = 0u;
// How many threads draw a record: a divisor of a workgroup's.
override LANES: u32 = 1u;

struct Batch {
    // The number of records, and of those before them in the buffer.
    count: u32,
    first: u32,
}

struct Image {
    node: Node,
    level: u32,
    center: vec2<i32>,
    radius: i32,
    mantissa: vec4<u32>,
    exponent: i32,
    share: u32,
    dither: u32,
    // Which accumulator, and whether light is taken away.
    is_sharing: bool,
    is_removed: bool,
    slot: u32,
    // Which of the record's rows this thread draws: one of LANES.
    lane: u32,
}

// Accumulators

fn add_word(is_sharing: bool, at: u32, value: u32) -> u32 {
    if is_sharing {
        return atomicAdd(&sharing[at], value);
    }
    return atomicAdd(&free[at], value);
}

fn add_wide(is_sharing: bool, at: u32, value: vec2<u32>) {
    let before = add_word(is_sharing, at, value.x);
    let high = value.y + select(0u, 1u, before + value.x < before);
    if high != 0u {
        add_word(is_sharing, at + 1u, high);
    }
}

// Light of `near` and `far` at one end of a run, of either sign; returns the coverage that it throws at the row.
fn add_end(image: ptr<function, Image>, line: u32, last: i32, at: i32, value: array<vec2<u32>, 4>, is_negative: bool) -> vec2<u32> {
    let column = (at >> POSITION_BITS) + 1;
    let rest = u32(PIXEL - (at & (PIXEL - 1)));
    let first = clamp(column, 0, last);
    let second = clamp(column + 1, 0, last);
    let is_sharing = (*image).is_sharing;
    var total = vec2<u32>(0u, 0u);
    for (var c = 0u; c < 4u; c += 1u) {
        var near: vec2<u32>;
        var far: vec2<u32>;
        if IS_WIDE {
            near = wide_right(wide_times(value[c], rest), POSITION_BITS);
            far = wide_sum(value[c], wide_negative(near));
        } else {
            near = vec2<u32>(mul_shift(value[c].x, rest, POSITION_BITS), 0u);
            far = vec2<u32>(value[c].x - near.x, 0u);
        }
        if c == 3u {
            total = wide_sum(wide_times(near, u32(last - first)), wide_times(far, u32(last - second)));
        }
        if is_negative {
            near = wide_negative(near);
            far = wide_negative(far);
        }
        if IS_WIDE {
            if any(near != vec2<u32>()) {
                add_wide(is_sharing, line + u32(first) * 8u + 2u * c, near);
            }
            if any(far != vec2<u32>()) {
                add_wide(is_sharing, line + u32(second) * 8u + 2u * c, far);
            }
        } else {
            if near.x != 0u {
                add_word(is_sharing, line + u32(first) * 4u + c, near.x);
            }
            if far.x != 0u {
                add_word(is_sharing, line + u32(second) * 4u + c, far.x);
            }
        }
    }
    if is_negative {
        return wide_negative(total);
    }
    return total;
}

fn add_run(image: ptr<function, Image>, row: i32, start: i32, end: i32, value: array<vec2<u32>, 4>) {
    let level = pen.levels[(*image).level];
    let stride = u32(level.width + 3);
    let last = level.width + 2;
    let place = u32(row + 1);
    let words = select(4u, 8u, IS_WIDE);
    let line = level.pixels + place * stride * words;
    let is_removed = (*image).is_removed;
    let begun = add_end(image, line, last, start, value, is_removed);
    let ended = add_end(image, line, last, end, value, !is_removed);
    let total = wide_sum(begun, ended);
    if any(total != vec2<u32>()) {
        add_wide((*image).is_sharing, level.totals + 2u * (place * SLOTS + (*image).slot), total);
    }
}

fn clamped(image: ptr<function, Image>, x: i32) -> i32 {
    let level = pen.levels[(*image).level];
    return clamp(x, -4 * PIXEL, (level.width + 4) << POSITION_BITS);
}

// Images

fn shift_to(image: ptr<function, Image>, mean: vec2<i32>) {
    let x = signed_mul_shift((*image).radius, mean.x, 14u);
    let y = signed_mul_shift((*image).radius, mean.y, 14u);
    (*image).center += vec2<i32>(x, -y);
}

fn lean(image: ptr<function, Image>) {
    shift_to(image, ((*image).node.tilt * pen.tilt_shift) >> vec2<u32>(14u));
}

fn light_shift(image: ptr<function, Image>, bits: u32) -> u32 {
    return u32(clamp(i32(bits) - (*image).exponent, 0, 63));
}

fn value_of(image: ptr<function, Image>, height: u32, share: u32, shift: u32, row: i32) -> array<vec2<u32>, 4> {
    let from_center = bitcast<u32>(row - ((*image).center.y >> POSITION_BITS));
    var hash = (*image).dither + from_center * GOLDEN;
    hash = (hash ^ (hash >> 15u)) * HASH_DITHER;
    var dither: vec2<u32>;
    if shift >= 32u {
        let more = shift - 32u;
        dither = vec2<u32>(hash << more, select(hash >> ((32u - more) & 31u), 0u, more == 0u));
    } else {
        dither = vec2<u32>(select(hash >> ((32u - shift) & 31u), 0u, shift == 0u), 0u);
    }
    let shared_height = mul_shift(height, share, 24u);
    var value: array<vec2<u32>, 4>;
    for (var c = 0u; c < 4u; c += 1u) {
        value[c] = wide_right(wide_sum(wide_product((*image).mantissa[c], shared_height), dither), shift);
    }
    return value;
}

// Boxes

fn too_blurred(level: u32) -> u32 {
    let half = u32(PIXEL / 2) * u32(PIXEL / 2);
    return half - (half >> (2u * level));
}

fn scaled(image: ptr<function, Image>, share: vec2<u32>, bits: u32) -> vec2<u32> {
    let radius = u32(abs((*image).radius));
    return vec2<u32>(mul_shift(radius, share.x, bits), mul_shift(radius, share.y, bits));
}

fn draw_box(image: ptr<function, Image>, half_size: vec2<u32>, of_aperture: vec2<u32>) {
    let less = too_blurred((*image).level);
    let half_x = max(hypotenuse(half_size.x, of_aperture.x, less), SMALLEST_HALF);
    let half_y = max(hypotenuse(half_size.y, of_aperture.y, less), SMALLEST_HALF);
    let center = (*image).center;
    let top = center.y - i32(half_y);
    let bottom = center.y + i32(half_y);
    let level = pen.levels[(*image).level];
    let first = max(top >> POSITION_BITS, -1);
    let last = min((bottom - 1) >> POSITION_BITS, level.height);
    if first > last {
        return;
    }
    let across = reciprocal_of(half_x);
    let down = reciprocal_of(half_y);
    let density = mul_shift(across.value, (*image).share, 26u);
    let shift = light_shift(image, HEIGHT_BITS);
    for (var row = first + i32((*image).lane); row <= last; row += i32(LANES)) {
        let overlap = u32(min(bottom, (row + 1) << POSITION_BITS) - max(top, row << POSITION_BITS));
        let share = mul_shift(overlap, down.value, down.bits + 1u);
        let height = mul_shift(share, density, across.bits + 25u);
        let value = value_of(image, height, WHOLE, shift, row);
        add_run(image, row, center.x - i32(half_x), center.x + i32(half_x), value);
    }
}

fn draw_partial_box(image: ptr<function, Image>, through: u32) {
    let mean = vec2<i32>(low_half(cells[through + 9u]), high_half(cells[through + 9u]));
    shift_to(image, mean);
    (*image).share = cells[through + 8u];
    let half = vec2<u32>(cells[through + 10u] & 0xFFFFu, cells[through + 10u] >> 16u);
    let most = scaled(image, vec2<u32>(ONE - abs(mean)), 14u) + u32(PIXEL);
    draw_box(image, (*image).node.half_size >> vec2<u32>((*image).level), min(scaled(image, half, 14u), most));
}

fn stretched(half_size: u32, tilt: i32, mean: i32, depth_share: i32) -> u32 {
    let slope = (tilt * depth_share) >> 14u;
    let factor = u32(max(abs(ONE + ((slope * mean) >> 14u)), ONE / 16));
    return min(mul_shift(half_size, factor, 14u), LARGEST_HALF);
}

fn draw_parts(image: ptr<function, Image>, depth_share: i32) {
    let node = (*image).node;
    let tilt = (node.tilt * pen.stop) >> vec2<u32>(14u);
    for (var index = 0u; index < pen.part_count; index += 1u) {
        let of_part = pen.parts[index];
        let exact = (node.base << 10u) + ((tilt.x * of_part.mean.x + tilt.y * of_part.mean.y) >> 4u);
        let weight = exact >> 10u;
        if weight <= 0 {
            continue;
        }
        var part = *image;
        part.share = mul_shift(mul_shift((*image).share, of_part.share, 24u), u32(exact), 24u);
        part.dither = (*image).dither + index;
        let most = vec2<i32>(of_part.half >> vec2<u32>(2u));
        shift_to(&part, of_part.mean + clamp(tilt * of_part.variance / vec2<i32>(weight), -most, most));
        let half_x = stretched(node.half_size.x, tilt.x, of_part.mean.x, depth_share);
        let half_y = stretched(node.half_size.y, tilt.y, of_part.mean.y, depth_share);
        draw_box(&part, vec2<u32>(half_x, half_y), scaled(image, of_part.half, 16u));
    }
}

// Stencils: a table of (first run, runs, bits of the heights), then runs of four words.

// A stencil as an image meets it.
struct PlacedStencil {
    first_run: u32,
    count: u32,
    base: i32,
    shift: u32,
    // Additional bits of precision for the light that passes a row.
    finer: u32,
}

fn place_stencil(image: ptr<function, Image>, place: u32) -> PlacedStencil {
    let word = stencils[2u * place + 1u];
    let height_bits = (word >> 16u) & 63u;
    let half_step = i32(word >> 22u);
    let base = ((*image).center.y + half_step) >> POSITION_BITS;
    let finer = POSITION_BITS + height_bits - HEIGHT_BITS;
    return PlacedStencil(stencils[2u * place], word & 0xFFFFu, base, light_shift(image, height_bits), finer);
}

fn draw_image(image: ptr<function, Image>, place: u32) {
    let placed = place_stencil(image, place);
    let level = pen.levels[(*image).level];
    let center = (*image).center.x;
    for (var k = (*image).lane; k < placed.count; k += LANES) {
        let at = placed.first_run + 4u * k;
        let row = placed.base + high_half(stencils[at + 3u]);
        if row >= -1 && row <= level.height {
            let value = value_of(image, stencils[at + 2u], (*image).share, placed.shift, row);
            let start = center + bitcast<i32>(stencils[at]);
            let end = center + bitcast<i32>(stencils[at + 1u]);
            add_run(image, row, start, end, value);
        }
    }
}

// What occluders let through of this thread's rows: drawn, or only summed (of all rows, also those beyond the picture).
fn visible_rows(image: ptr<function, Image>, place: u32, cells: u32, is_counted: bool) -> u32 {
    let placed = place_stencil(image, place);
    let level = pen.levels[(*image).level];
    let center = (*image).center.x;
    let runs = visible_runs_of(image, cells);
    let takes_all = takes_all_rows(image);
    var passing = 0u;
    for (var k = (*image).lane; k < placed.count; k += LANES) {
        let at = placed.first_run + 4u * k;
        let row = placed.base + high_half(stencils[at + 3u]);
        let v = low_half(stencils[at + 3u]);
        let span = vec2<i32>(center + bitcast<i32>(stencils[at]), center + bitcast<i32>(stencils[at + 1u]));
        if is_counted || (row >= -1 && row <= level.height) {
            let here = VisibleRow(row, v, span, stencils[at + 2u], placed.shift, placed.finer, is_counted);
            passing += visible_row(image, runs, here, takes_all);
        }
    }
    return passing;
}

// Draws what occluders let through of an image, of all of whose rows `passing` passes.
fn draw_partial(image: ptr<function, Image>, place: u32, cells: u32, share: u32, passing: u32) {
    if cells != OPEN && passing < share / LARGEST_SCALE {
        // The few cells of a partly occluded node are missed.
        draw_partial_box(image, cells);
        return;
    }
    (*image).share = ratio(share, passing, LARGEST_SCALE);
    visible_rows(image, place, cells, false);
}

// Large images; `height`, its bits and the share come with the record.

fn draw_large(image: ptr<function, Image>, height_of_clear: u32, height_bits: u32, cells: u32) {
    let size = max(abs((*image).radius), PIXEL);
    let radius = select(size, -size, (*image).radius < 0);
    let per_radius = divisor_of(u32(size));
    let center = (*image).center;
    let level = pen.levels[(*image).level];
    let runs = visible_runs_of(image, cells);
    let shift = light_shift(image, height_bits);
    let first = max((center.y - size) >> POSITION_BITS, -1);
    let last = min((center.y + size) >> POSITION_BITS, level.height);
    for (var row = first + i32((*image).lane); row <= last; row += i32(LANES)) {
        let up = divide(per_radius, center.y - ((row << POSITION_BITS) + PIXEL / 2));
        let v = select(up, -up, radius < 0);
        let shape_row = min(mul_shift(u32(max(v + ONE, 0)), pen.shape_rows, 15u), pen.shape_rows - 1u);
        for (var run = shape[shape_row]; run < shape[shape_row + 1u]; run += 1u) {
            let at = pen.shape_runs + 3u * run;
            let a = center.x + signed_mul_shift(radius, bitcast<i32>(shape[at]), 24u);
            let b = center.x + signed_mul_shift(radius, bitcast<i32>(shape[at + 1u]), 24u);
            let height = mul_shift(height_of_clear, shape[at + 2u], 16u);
            let span = vec2<i32>(min(a, b), max(a, b));
            if cells == OPEN - 1u {
                let value = value_of(image, mul_shift(height, u32(ONE), 14u), (*image).share, shift, row);
                add_run(image, row, clamped(image, span.x), clamped(image, span.y), value);
            } else {
                visible_row(image, runs, VisibleRow(row, v, span, height, shift, 0u, false), false);
            }
        }
    }
}

// Records: node, signed radius, what the form needs, flags.

fn light_of(image: ptr<function, Image>, at: u32, gain: i32, is_coverage: bool) {
    let bits = vec4<u32>(nodes[at + 6u], nodes[at + 7u], nodes[at + 8u], nodes[at + 9u]) * select(vec4<u32>(1u), vec4<u32>(0u, 0u, 0u, 1u), is_coverage);
    let exponents = bits >> vec4<u32>(23u);
    let top = max(max(exponents.x, exponents.y), max(exponents.z, exponents.w));
    for (var c = 0u; c < 4u; c += 1u) {
        let mantissa = select(0u, (bits[c] & 0x7FFFFFu) | 0x800000u, exponents[c] > 0u);
        (*image).mantissa[c] = (mantissa << 7u) >> min(top - exponents[c], 31u);
    }
    (*image).exponent = i32(top) - 157 + gain;
}

struct DrawRecord {
    form: u32,
    // What the form needs: a stencil's number, or the share of depth.
    form_argument: u32,
    first_word: u32,
    // What it is runs through, and how much of it passes.
    through: u32,
    share: u32,
    // The part of it that is drawn as a stencil, of 65536.
    far: u32,
}

fn read_record(image: ptr<function, Image>, index: u32, lane: u32, slot: u32) -> DrawRecord {
    let words = select(RECORD_WORDS, 2u * RECORD_WORDS, KIND == KIND_LARGE);
    let first_word = words * (batch.first + index);
    let at = NODE_WORDS * records[first_word];
    let flags = records[first_word + 3u];
    let form = flags & FORM_MASK;

    (*image).node = node_at(at);
    let level = (flags >> LEVEL_BIT) & LEVEL_MASK;
    if (flags & IS_PIECE) != 0u {
        (*image).node = piece_of((*image).node, level, flags >> PIECE_BIT);
    }
    let node = (*image).node;
    (*image).level = level;
    (*image).center = node.center >> vec2<u32>(level);
    (*image).radius = bitcast<i32>(records[first_word + 1u]) / (1i << level);
    (*image).share = WHOLE;
    (*image).dither = seed(node, level);
    (*image).is_sharing = (flags & IS_SHARING) != 0u;
    (*image).is_removed = (flags & IS_REMOVED) != 0u;
    (*image).slot = slot;
    (*image).lane = lane;
    let is_coverage = (flags & IS_COVERAGE) != 0u;
    var gain = 0;
    if !IS_WIDE {
        gain = select(pen.dim_exponent, pen.coverage_exponent, node.is_bright);
    }
    // Light is that of a pixel of the node's own level.
    gain -= 2 * i32(level - node.level);
    light_of(image, at, gain, is_coverage);

    let of_finest = part_drawn_as_stencil(u32(abs(bitcast<i32>(records[first_word + 1u]))), (*image).dither);
    let far = select(of_finest, 65536u, level > 0u);
    var through = OPEN;
    var share = WHOLE;
    if form == FORM_PARTIAL_IMAGE || form == FORM_PARTIAL_BOX {
        through = PARTIAL_WORDS * node.cells;
        share = cells[through + 8u];
    }
    if form == FORM_TILTED {
        let leaning = node.tilt.x * pen.mean.x + node.tilt.y * pen.mean.y;
        share = mul_shift(far << 8u, u32(max((node.base << 14u) + leaning, 0)), 28u);
    }
    if form == FORM_IMAGE {
        (*image).share = far << 8u;
        lean(image);
    }
    return DrawRecord(form, records[first_word + 2u], first_word, through, share, far);
}

fn draw_record(image: ptr<function, Image>, record: DrawRecord) {
    if KIND == KIND_IMAGES {
        draw_image(image, record.form_argument);
    } else if KIND == KIND_LARGE {
        (*image).share = records[record.first_word + 6u];
        let cells_or_clear = select(record.through, OPEN - 1u, record.form == FORM_IMAGE);
        draw_large(image, records[record.first_word + 4u], records[record.first_word + 5u], cells_or_clear);
    } else if record.form == FORM_PARTIAL_BOX {
        draw_partial_box(image, record.through);
    } else {
        (*image).share = WHOLE - (record.far << 8u);
        if record.form == FORM_PARTS {
            draw_parts(image, bitcast<i32>(record.form_argument));
        } else {
            lean(image);
            shift_to(image, pen.mean);
            draw_box(image, (*image).node.half_size, scaled(image, pen.half, 16u));
        }
    }
}

// What passes of each record, of all its rows.
var<workgroup> passing_of: array<atomic<u32>, THREADS>;

@compute @workgroup_size(THREADS)
fn draw(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = id.x / LANES;
    let is_active = index < batch.count;
    var image: Image;
    var record: DrawRecord;
    if is_active {
        record = read_record(&image, index, id.x % LANES, group.x % SLOTS);
    }
    if KIND != KIND_PARTIAL {
        if is_active {
            draw_record(&image, record);
        }
        return;
    }
    var passing = 0u;
    if is_active {
        passing = visible_rows(&image, record.form_argument, record.through, true);
    }
    if LANES > 1u {
        atomicAdd(&passing_of[thread / LANES], passing);
        workgroupBarrier();
        passing = atomicLoad(&passing_of[thread / LANES]);
    }
    if is_active {
        draw_partial(&image, record.form_argument, record.through, record.share, passing);
    }
}
