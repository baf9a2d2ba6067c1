// What of a pixel row the occluders let through: the twin of ../draw/seen_runs.rs, read after draw.wgsl.

const CELL_BITS: u32 = 11u;
const COLUMN_BITS: u32 = 12u;
const LAST_COLUMN: i32 = 65536;

struct SeenRuns {
    height: i32,
    reach: i32,
    per_reach: Divisor,
    is_turned: bool,
    is_even: bool,
    // Where the cells lie in `cells`; OPEN for all.
    cells: u32,
}

// A pixel row, what it has of light where it is clear, and what becomes of it: added, or only found.
struct SeenRow {
    row: i32,
    v: i32,
    span: vec2<i32>,
    height: u32,
    shift: u32,
    finer: u32,
    is_found: bool,
}

fn seen_runs_of(image: ptr<function, Image>, cells: u32) -> SeenRuns {
    let node = (*image).node;
    let radius = u32(abs((*image).radius));
    let wide = wide_right(wide_product(radius, pen.per_stop), 14u);
    let reach = clamp(select(wide.x, LARGEST_REACH, wide.y > 0u), SMALLEST_REACH, LARGEST_REACH);
    let pixel = i32(min((1u << 26u) / max(radius, 1u), TALLEST_ROW));
    let height = clamp((pixel * (pen.stop >> 2u)) >> 12u, 1, 2 * ONE);
    let is_even = abs(node.tilt.x) + abs(node.tilt.y) <= pen.even_seen_tilt && node.base == ONE;
    return SeenRuns(height, i32(reach), divisor_of(reach), (*image).radius < 0, is_even, cells);
}

fn takes_all_rows(image: ptr<function, Image>) -> bool {
    return u32(abs((*image).radius)) < pen.all_rows_radius;
}

fn part_of(x: i32, factor: i32, shift: u32) -> i32 {
    return (x >> shift) * factor + (((x & ((1 << shift) - 1)) * factor) >> shift);
}

fn cells_of_row(seen: SeenRuns, row: u32) -> u32 {
    if seen.cells == OPEN {
        return 0xFFFFu;
    }
    return (cells[seen.cells + row / 2u] >> (16u * (row % 2u))) & 0xFFFFu;
}

// Adds what is let through of a row's span, or only finds how much it is, times 2²⁴ over 2^`finer`.
fn seen_row(image: ptr<function, Image>, seen: SeenRuns, here: SeenRow, takes_all: bool) -> u32 {
    let middle = ((here.v * pen.stop) >> 14u) + ONE;
    if takes_all {
        return seen_of_all(image, seen, here, middle);
    }
    let from_center = bitcast<u32>(here.row - ((*image).center.y >> POSITION_BITS));
    let jitter = i32(((*image).dither + from_center * 0x9E3779B1u) >> 18u);
    let at = middle + ((seen.height * (jitter - ONE / 2)) >> 14u);
    return seen_of_bits(image, seen, here, cells_of_row(seen, u32(clamp(at >> CELL_BITS, 0, 15))), ONE);
}

fn seen_of_bits(image: ptr<function, Image>, seen: SeenRuns, here: SeenRow, row_of_cells: u32, share: i32) -> u32 {
    var bits = row_of_cells;
    var passing = 0u;
    while bits != 0u {
        let first = countTrailingZeros(bits);
        let end = first + countTrailingZeros(~(bits >> first));
        bits &= 0xFFFFFFFFu << end;
        passing += seen_run(image, seen, here, vec2<i32>(vec2<u32>(first, end) << vec2<u32>(COLUMN_BITS)), share);
    }
    return passing;
}

fn seen_of_all(image: ptr<function, Image>, seen: SeenRuns, here: SeenRow, middle: i32) -> u32 {
    let lowest = middle - seen.height / 2;
    let bottom = clamp(lowest, 0, 2 * ONE - 1);
    let top = clamp(lowest + seen.height, bottom + 1, 2 * ONE);
    let all = top - bottom;
    let per_height = (1u << 28u) / u32(all);
    let most = (seen.height >> CELL_BITS) + 2;
    var passing = 0u;
    // The mean of runs: the sum of their shares, the first of them, how far the others are from there.
    var mean_share = 0;
    var mean_first = vec2<i32>(0);
    var apart = vec2<i32>(0);
    var at = bottom;
    while at < top {
        let start = at;
        let bits = cells_of_row(seen, u32(at >> CELL_BITS) & 15u);
        while at < top && cells_of_row(seen, u32(at >> CELL_BITS) & 15u) == bits {
            at = ((at >> CELL_BITS) + 1) << CELL_BITS;
        }
        let height = min(at, top) - start;
        let share = select(i32((u32(height) * per_height) >> 14u), ONE, height == all);
        let run = vec2<i32>(i32(countTrailingZeros(bits)), i32(32u - countLeadingZeros(bits)));
        if bits != 0u && i32(countOneBits(bits)) == run.y - run.x {
            let distance = abs(run - mean_first);
            if mean_share > 0 && (distance.x > most || distance.y > most) {
                passing += seen_run(image, seen, here, mean_columns(mean_first, apart, mean_share), mean_share);
                mean_share = 0;
            }
            if mean_share == 0 {
                mean_first = run;
                apart = vec2<i32>(0);
            }
            mean_share += share;
            apart += share * (run - mean_first);
        } else {
            passing += seen_of_bits(image, seen, here, bits, share);
        }
    }
    if mean_share > 0 {
        passing += seen_run(image, seen, here, mean_columns(mean_first, apart, mean_share), mean_share);
    }
    return passing;
}

fn mean_columns(first: vec2<i32>, apart: vec2<i32>, share: i32) -> vec2<i32> {
    return (first << vec2<u32>(COLUMN_BITS)) + (apart << vec2<u32>(COLUMN_BITS)) / vec2<i32>(share);
}

fn column_at(image: ptr<function, Image>, seen: SeenRuns, column: i32) -> i32 {
    return (*image).center.x + part_of(seen.reach, column - LAST_COLUMN / 2, COLUMN_BITS + 3u);
}

// A run of cells between two columns, in so large a share of the row.
fn seen_run(image: ptr<function, Image>, seen: SeenRuns, here: SeenRow, columns: vec2<i32>, share: i32) -> u32 {
    let node = (*image).node;
    let between = select(columns, LAST_COLUMN - columns.yx, seen.is_turned);
    let begins = select(max(column_at(image, seen, between.x), here.span.x), here.span.x, between.x == 0);
    let ends = select(min(column_at(image, seen, between.y), here.span.y), here.span.y, between.y == LAST_COLUMN);
    if begins >= ends {
        return 0u;
    }
    let base = node.base + ((node.tilt.y * ((here.v * pen.stop) >> 14u)) >> 14u);
    let toward = select(node.tilt.x, -node.tilt.x, seen.is_turned);
    let steep = abs(node.tilt.x);
    let halvings = select(select(2u, 1u, steep < ONE / 3), 0u, steep < ONE / 10 || seen.is_even);
    let width = ends - begins;
    var passing = 0u;
    for (var at = 0; at < (1 << halvings); at += 1) {
        var from_x = begins + part_of(width, at, halvings);
        var to_x = begins + part_of(width, at + 1, halvings);
        var weight = share;
        if !seen.is_even {
            let middle = divide(seen.per_reach, (from_x >> 1u) + (to_x >> 1u) - (*image).center.x);
            let half = divide(seen.per_reach, (to_x - from_x) >> 1u);
            weight = base + ((toward * middle) >> 14u);
            if weight <= 0 {
                continue;
            }
            let leaning = clamp(toward * ((half * half) >> 14u) / (3 * weight), -half, half);
            let moved = signed_mul_shift(seen.reach, leaning, 14u);
            from_x += moved;
            to_x += moved;
            weight = (weight * share) >> 14u;
        }
        let weighted = mul_shift(here.height, u32(weight), 14u);
        if here.is_found {
            passing += mul_shift(u32(to_x - from_x), weighted, here.finer);
        } else {
            let value = value_of(image, weighted, (*image).share, here.shift, here.row);
            add_run(image, here.row, clamped(image, from_x), clamped(image, to_x), value);
        }
    }
    return passing;
}
