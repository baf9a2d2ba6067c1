// Accumulators to a picture: the twin of ../resolve.rs and of partition.rs, parts_to_pixels.rs, knots.rs and balance.rs in
// ../resolve. Read after scan.wgsl or scan_subgroups.wgsl.
//
// Floats are added and multiplied in the same order as there. A product that is then added passes through `exact`: compilers
// would otherwise fuse the two operations and round once.

struct LineLevel {
    width: i32,
    height: i32,
    // Words of the accumulator before its pixels, and before its totals.
    pixels: u32,
    totals: u32,
    // Places of this level's lines, and of the next coarser one's, which has this size; 0 wide: there is none.
    lines: u32,
    coarse_lines: u32,
    coarse_width: i32,
    coarse_height: i32,
    // Its pixel's side is 2 to this.
    level: u32,
}

struct Frame {
    // The requested pixel rows.
    first: i32,
    end: i32,
    width: i32,
    is_evened: u32,
    // Always 0; unknown to the compiler.
    zero: u32,
    quantum: f32,
    wide_quantum: f32,
    // More coverage than this may be with a colour that has wrapped.
    largest: i32,
    wide_largest: vec2<u32>,
    // Whether shares are computed, or a picture is made.
    is_sharing: u32,
}

@group(0) @binding(0) var<storage, read> sums: array<u32>;
@group(0) @binding(1) var<storage, read_write> lines: array<vec4<f32>>;
@group(0) @binding(2) var<uniform> level: LineLevel;
@group(0) @binding(3) var<uniform> frame: Frame;
@group(0) @binding(4) var<storage, read_write> overflow: atomic<u32>;

fn exact(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ frame.zero);
}

fn signed_float(x: i32) -> f32 {
    let size = float_of(u32(abs(x)));
    return select(size, -size, x < 0);
}

fn wide_float(x: vec2<u32>) -> f32 {
    let is_negative = (x.y & 0x80000000u) != 0u;
    var size = x;
    if is_negative {
        size = wide_negative(x);
    }
    var float: f32;
    if size.y == 0u {
        float = float_of(size.x);
    } else {
        let zeros = countLeadingZeros(size.y);
        let shift = 32u - zeros;
        let kept = wide_right(size, shift).x;
        let lost = size.x & select((1u << (shift & 31u)) - 1u, 0xFFFFFFFFu, shift == 32u);
        // What is lost decides ties.
        float = float_of(kept | select(0u, 1u, lost != 0u)) * bitcast<f32>((127u + shift) << 23u);
    }
    return select(float, -float, is_negative);
}

// Cubic: a fine pixel lies a quarter of a coarse one off its centre. What lies beyond a level's border is as it is there.

fn coarse(x: i32, y: i32) -> vec4<f32> {
    let column = clamp(x, -1, level.coarse_width) + 1;
    let row = clamp(y, -1, level.coarse_height) + 1;
    return lines[level.coarse_lines + u32(row * (level.coarse_width + 2) + column)];
}

fn weighted(weight: f32, light: vec4<f32>) -> vec4<f32> {
    let product = weight * light;
    return vec4<f32>(exact(product.x), exact(product.y), exact(product.z), exact(product.w));
}

fn cubic(behind: vec4<f32>, near: vec4<f32>, far: vec4<f32>, beyond: vec4<f32>) -> vec4<f32> {
    let sum = weighted(CUBIC_BEHIND, behind) + weighted(CUBIC_NEAR, near) + weighted(CUBIC_FAR, far);
    return sum + weighted(CUBIC_BEYOND, beyond);
}

// Between four rows of a coarse column.
fn mixed(x: i32, near: i32, toward: i32) -> vec4<f32> {
    return cubic(coarse(x, near - toward), coarse(x, near), coarse(x, near + toward), coarse(x, near + 2 * toward));
}

fn upsampled(x: i32, y: i32) -> vec4<f32> {
    if level.coarse_width == 0 {
        return vec4<f32>();
    }
    let near = vec2<i32>(x, y) >> vec2<u32>(1u);
    let toward = select(vec2<i32>(1), vec2<i32>(-1), (vec2<i32>(x, y) & vec2<i32>(1)) == vec2<i32>(0));
    return cubic(
        mixed(near.x - toward.x, near.y, toward.y),
        mixed(near.x, near.y, toward.y),
        mixed(near.x + toward.x, near.y, toward.y),
        mixed(near.x + 2 * toward.x, near.y, toward.y),
    );
}

// The row of this level that a workgroup integrates.
fn row_of(group: u32) -> i32 {
    var first = frame.first;
    if level.level > 0u {
        first = (frame.first >> level.level) - MARGIN;
    }
    return max(first, -1) + i32(group);
}

fn end_of_rows() -> i32 {
    var end = frame.end;
    if level.level > 0u {
        end = ((frame.end - 1) >> level.level) + MARGIN + 1;
    }
    return min(end, level.height + 1);
}

fn total_of(row: i32) -> vec2<u32> {
    var total = vec2<u32>();
    for (var slot = 0u; slot < SLOTS; slot += 1u) {
        let at = level.totals + 2u * (u32(row + 1) * SLOTS + slot);
        total = wide_sum(total, vec2<u32>(sums[at], sums[at + 1u]));
    }
    return total;
}

var<workgroup> covered_low: atomic<u32>;
var<workgroup> covered_high: atomic<u32>;

@compute @workgroup_size(SCAN_THREADS)
fn integrate(@builtin(workgroup_id) group: vec3<u32>, lane: Lane) {
    let thread = place_of(lane);
    let row = row_of(group.x);
    if row >= end_of_rows() {
        return;
    }
    let count = u32(level.width + 2);
    let line = level.pixels + u32(row + 1) * u32(level.width + 3) * 4u;
    let segment = (count + SCAN_THREADS - 1u) / SCAN_THREADS;
    let first = min(thread * segment, count);
    let end = min(first + segment, count);
    var sum = vec4<i32>();
    for (var x = first; x < end; x += 1u) {
        let at = line + 4u * x;
        sum += vec4<i32>(vec4<u32>(sums[at], sums[at + 1u], sums[at + 2u], sums[at + 3u]));
    }
    sum = sum_before(lane, sum);
    var low = 0u;
    var high = 0;
    for (var x = first; x < end; x += 1u) {
        let at = line + 4u * x;
        sum += vec4<i32>(vec4<u32>(sums[at], sums[at + 1u], sums[at + 2u], sums[at + 3u]));
        low += u32(sum.w) & 0xFFFFu;
        high += sum.w >> 16u;
        if sum.w > frame.largest {
            atomicOr(&overflow, 1u);
        }
        let own = vec4<f32>(signed_float(sum.x), signed_float(sum.y), signed_float(sum.z), signed_float(sum.w)) * frame.quantum;
        lines[level.lines + u32(row + 1) * count + x] = upsampled(i32(x) - 1, row) + own;
    }
    atomicAdd(&covered_low, low);
    atomicAdd(&covered_high, bitcast<u32>(high));
    workgroupBarrier();
    if thread == 0u {
        let upper = bitcast<i32>(atomicLoad(&covered_high));
        let covered = wide_sum(vec2<u32>(u32(upper) << 16u, u32(upper >> 16u)), vec2<u32>(atomicLoad(&covered_low), 0u));
        if any(covered != total_of(row)) {
            atomicOr(&overflow, 1u);
        }
    }
}

var<workgroup> wide_before: array<vec2<u32>, SCAN_THREADS>;
var<workgroup> all_bits: atomic<u32>;

fn wide_word(line: u32, x: u32, c: u32) -> vec2<u32> {
    let at = line + 8u * x + 2u * c;
    return vec2<u32>(sums[at], sums[at + 1u]);
}

fn is_above(a: vec2<u32>, b: vec2<u32>) -> bool {
    return i32(a.y) > i32(b.y) || (a.y == b.y && a.x > b.x);
}

// The sum of bright samples, added to the lines of the finest level.
@compute @workgroup_size(SCAN_THREADS)
fn integrate_wide(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let row = row_of(group.x);
    if row >= end_of_rows() {
        return;
    }
    let count = u32(level.width + 2);
    let line = level.pixels + u32(row + 1) * u32(level.width + 3) * 8u;
    let segment = (count + SCAN_THREADS - 1u) / SCAN_THREADS;
    // Few rows have any.
    var bits = 0u;
    for (var word = thread; word < 8u * count; word += SCAN_THREADS) {
        bits |= sums[line + word];
    }
    atomicOr(&all_bits, bits);
    workgroupBarrier();
    let is_dark = atomicLoad(&all_bits) == 0u;
    let first = min(thread * segment, count);
    let end = select(min(first + segment, count), first, is_dark);
    for (var c = 0u; c < 4u; c += 1u) {
        var sum = vec2<u32>();
        for (var x = first; x < end; x += 1u) {
            sum = wide_sum(sum, wide_word(line, x, c));
        }
        let own = sum;
        workgroupBarrier();
        wide_before[thread] = sum;
        for (var step = 1u; step < SCAN_THREADS; step *= 2u) {
            workgroupBarrier();
            var more = vec2<u32>();
            if thread >= step {
                more = wide_before[thread - step];
            }
            workgroupBarrier();
            wide_before[thread] = wide_sum(wide_before[thread], more);
        }
        sum = wide_sum(wide_before[thread], wide_negative(own));
        var covered = vec2<u32>();
        for (var x = first; x < end; x += 1u) {
            sum = wide_sum(sum, wide_word(line, x, c));
            if c == 3u {
                covered = wide_sum(covered, sum);
                if is_above(sum, frame.wide_largest) {
                    atomicOr(&overflow, 1u);
                }
            } else {
                let at = level.lines + u32(row + 1) * count + x;
                lines[at][c] += exact(wide_float(sum) * frame.wide_quantum);
            }
        }
        if c == 3u {
            workgroupBarrier();
            wide_before[thread] = covered;
            workgroupBarrier();
            if thread == 0u {
                var all = vec2<u32>();
                for (var k = 0u; k < SCAN_THREADS; k += 1u) {
                    all = wide_sum(all, wide_before[k]);
                }
                if any(all != total_of(row)) {
                    atomicOr(&overflow, 1u);
                }
            }
        }
    }
}

// Shares and the picture.

@group(0) @binding(5) var<storage, read> free_lines: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> sharing_lines: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> shares: array<vec2<f32>>;
@group(0) @binding(8) var<storage, read_write> picture: array<vec4<f32>>;

fn fixed_of(covered: f32) -> u32 {
    return u32(clamp(covered * f32(COVERAGE_ONE), 0.0, MAX_QUANTA));
}

fn share_of(open: f32, partial: f32) -> vec2<f32> {
    var share = 1.0;
    if partial >= MIN_PARTIAL {
        let left = COVERAGE_ONE - min(fixed_of(open), COVERAGE_ONE);
        share = f32(ratio(left, fixed_of(partial), LARGEST_SHARE) >> 3u) / 2097152.0;
    }
    let covered = open + exact(share * partial);
    var even = 1.0;
    if abs(covered - 1.0) <= RIPPLE {
        even = f32(ratio(COVERAGE_ONE, fixed_of(covered), 2u) >> 1u) / 8388608.0;
    }
    return vec2<f32>(share, even);
}

@compute @workgroup_size(THREADS)
fn finish(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = i32(id.x);
    let y = frame.first + i32(id.y);
    if x >= frame.width || y >= frame.end {
        return;
    }
    let from_line = level.lines + u32((y + 1) * (level.width + 2) + x + 1);
    let free = free_lines[from_line];
    let sharing = sharing_lines[from_line];
    let at = u32(y * frame.width + x);
    if frame.is_sharing != 0u {
        shares[at] = share_of(free.w, sharing.w);
        return;
    }
    let share = shares[at];
    let shared_light = exact_all(share.x * sharing);
    if frame.is_evened != 0u {
        let light = share.y * (free + shared_light);
        picture[at] = light * gain_of(x, y, ALL);
    } else {
        let scaled = exact_all(shared_light * gain_of(x, y, SHARING)) * rest();
        picture[at] = free + exact_all(scaled);
    }
}

// Gains: how light that sharing and evening take is given back.

// Of every knot: red, green, blue and coverage of sharing samples before and after they share, of all before and after it
// is evened out.
@group(0) @binding(9) var<storage, read_write> knots: array<vec4<f32>>;
// Of every knot: of sharing samples, of all. The last is the rest.
@group(0) @binding(10) var<storage, read> gains: array<vec4<f32>>;

fn exact_all(x: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(exact(x.x), exact(x.y), exact(x.z), exact(x.w));
}

// The weight at a pixel of the knot behind it.
fn behind(pixel: i32) -> f32 {
    return (f32(pixel % SPACING) + 0.5) * KNOT_STEP;
}

fn mix_of_gains(a: vec4<f32>, b: vec4<f32>, weight: f32) -> vec4<f32> {
    return exact_all((1.0 - weight) * a) + exact_all(weight * b);
}

fn knot_columns() -> i32 {
    return (frame.width + SPACING - 1) / SPACING + 1;
}

fn gain_of(x: i32, y: i32, kind: i32) -> vec4<f32> {
    let columns = knot_columns();
    let at = 2 * ((y / SPACING) * columns + x / SPACING) + kind;
    let left = mix_of_gains(gains[at], gains[at + 2 * columns], behind(y));
    let right = mix_of_gains(gains[at + 2], gains[at + 2 * columns + 2], behind(y));
    return mix_of_gains(left, right, behind(x));
}

// What all that shares is scaled by beside its gains.
fn rest() -> vec4<f32> {
    return gains[arrayLength(&gains) - 1u];
}

// Rows that a knot's tent reaches.
const ROWS: u32 = 2u * u32(SPACING);

var<workgroup> of_rows: array<array<vec4<f32>, 4>, ROWS>;

// The sums of a knot, a thread for each row.
@compute @workgroup_size(ROWS)
fn balance(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let knot = vec2<i32>(group.xy);
    let y = (knot.y - 1) * SPACING + i32(thread);
    var sums: array<vec4<f32>, 4>;
    if y >= 0 && y < level.height {
        // Of the span before the knot and of the one behind it.
        for (var span = knot.x - 1; span <= knot.x; span += 1) {
            var of_span: array<vec4<f32>, 4>;
            // The sums of all sums so far: a pixel is in them as often as there are pixels from it to the span's end.
            var ramps: array<vec4<f32>, 4>;
            for (var x = span * SPACING; x < (span + 1) * SPACING; x += 1) {
                if x >= 0 && x < frame.width {
                    let from_line = level.lines + u32((y + 1) * (level.width + 2) + x + 1);
                    let free = free_lines[from_line];
                    let sharing = sharing_lines[from_line];
                    let share = shares[u32(y * frame.width + x)];
                    let shared_light = exact_all(share.x * sharing);
                    of_span[0] += sharing;
                    of_span[1] += shared_light;
                    of_span[2] += free + sharing;
                    of_span[3] += exact_all(share.y * (free + shared_light));
                }
                for (var k = 0u; k < 4u; k += 1u) {
                    ramps[k] += of_span[k];
                }
            }
            for (var k = 0u; k < 4u; k += 1u) {
                let before = (ramps[k] - 0.5 * of_span[k]) * KNOT_STEP;
                sums[k] += select(before, of_span[k] - before, span < knot.x);
            }
        }
        let weight = select(1.0 - behind(y), behind(y), y < knot.y * SPACING);
        for (var k = 0u; k < 4u; k += 1u) {
            sums[k] = exact_all(weight * sums[k]);
        }
    }
    of_rows[thread] = sums;
    workgroupBarrier();
    if thread < 4u {
        var total = vec4<f32>();
        for (var row = 0u; row < ROWS; row += 1u) {
            total += of_rows[row][thread];
        }
        knots[4u * (group.y * u32(knot_columns()) + group.x) + thread] = total;
    }
}

// The sums of a cell of a painted picture, a thread for each row: of sharing samples before and after they share and are
// scaled by their gains.
@compute @workgroup_size(SPACING)
fn share(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let y = i32(group.y) * SPACING + i32(thread);
    var turns: array<array<vec4<f32>, 2>, 2>;
    if y < level.height {
        let first = i32(group.x) * SPACING;
        for (var x = first; x < min(first + SPACING, frame.width); x += 1) {
            let sharing = sharing_lines[level.lines + u32((y + 1) * (level.width + 2) + x + 1)];
            let shared_light = exact_all(shares[u32(y * frame.width + x)].x * sharing);
            turns[x & 1][0] += sharing;
            turns[x & 1][1] += exact_all(shared_light * gain_of(x, y, SHARING));
        }
    }
    for (var k = 0u; k < 2u; k += 1u) {
        of_rows[thread][k] = turns[0][k] + turns[1][k];
    }
    workgroupBarrier();
    if thread < 2u {
        var total = vec4<f32>();
        for (var row = 0u; row < u32(SPACING); row += 1u) {
            total += of_rows[row][thread];
        }
        knots[2u * (group.y * u32(knot_columns() - 1) + group.x) + thread] = total;
    }
}
