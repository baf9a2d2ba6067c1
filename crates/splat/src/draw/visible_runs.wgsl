// The part of a pixel row that occluders let through: the twin of visible_runs.rs, read after draw.wgsl.

struct VisibleRuns {
    height: i32,
    reach: i32,
    per_reach: Divisor,
    is_turned: bool,
    is_even: bool,
    // Where the cells lie in `cells`; OPEN for all.
    cells: u32,
}

// A pixel row, its light where the aperture is clear, and whether visible light is added to the sum or only counted.
struct VisibleRow {
    row: i32,
    v: i32,
    span: vec2<i32>,
    height: u32,
    shift: u32,
    finer: u32,
    is_counted: bool,
}

fn visible_runs_of(image: ptr<function, Image>, cells: u32) -> VisibleRuns {
    let node = (*image).node;
    let radius = u32(abs((*image).radius));
    let wide = wide_right(wide_product(radius, pen.per_stop), 14u);
    let reach = clamp(select(wide.x, LARGEST_REACH, wide.y > 0u), SMALLEST_REACH, LARGEST_REACH);
    let pixel = i32(min((1u << 26u) / max(radius, 1u), TALLEST_ROW));
    let height = clamp((pixel * (pen.stop >> 2u)) >> 12u, 1, 2 * ONE);
    let is_even = abs(node.tilt.x) + abs(node.tilt.y) <= pen.even_partial_tilt && node.base == ONE;
    return VisibleRuns(height, i32(reach), divisor_of(reach), (*image).radius < 0, is_even, cells);
}

fn takes_all_rows(image: ptr<function, Image>) -> bool {
    return u32(abs((*image).radius)) < pen.all_rows_radius;
}

fn scaled_floor(x: i32, factor: i32, shift: u32) -> i32 {
    return (x >> shift) * factor + (((x & ((1 << shift) - 1)) * factor) >> shift);
}

fn cells_of_row(runs: VisibleRuns, row: u32) -> u32 {
    if runs.cells == OPEN {
        return 0xFFFFu;
    }
    return (cells[runs.cells + row / 2u] >> (16u * (row % 2u))) & 0xFFFFu;
}

// Adds what is let through of a row's span, or only finds how much it is, times 2²⁴ over 2^`finer`.
fn visible_row(image: ptr<function, Image>, runs: VisibleRuns, here: VisibleRow, takes_all: bool) -> u32 {
    let middle = ((here.v * pen.stop) >> 14u) + ONE;
    if takes_all {
        return visible_of_all_rows(image, runs, here, middle);
    }
    let from_center = bitcast<u32>(here.row - ((*image).center.y >> POSITION_BITS));
    let jitter = i32(((*image).dither + from_center * GOLDEN) >> 18u);
    let at = middle + ((runs.height * (jitter - ONE / 2)) >> 14u);
    return visible_of_bits(image, runs, here, cells_of_row(runs, u32(clamp(at >> CELL_BITS, 0, 15))), ONE);
}

fn visible_of_bits(image: ptr<function, Image>, runs: VisibleRuns, here: VisibleRow, row_of_cells: u32, share: i32) -> u32 {
    var bits = row_of_cells;
    var passing = 0u;
    while bits != 0u {
        let first = countTrailingZeros(bits);
        let end = first + countTrailingZeros(~(bits >> first));
        bits &= 0xFFFFFFFFu << end;
        passing += visible_run(image, runs, here, vec2<i32>(vec2<u32>(first, end) << vec2<u32>(COLUMN_BITS)), share);
    }
    return passing;
}

fn visible_of_all_rows(image: ptr<function, Image>, runs: VisibleRuns, here: VisibleRow, middle: i32) -> u32 {
    let lowest = middle - runs.height / 2;
    let bottom = clamp(lowest, 0, 2 * ONE - 1);
    let top = clamp(lowest + runs.height, bottom + 1, 2 * ONE);
    let all = top - bottom;
    let per_height = (1u << 28u) / u32(all);
    let most = (runs.height >> CELL_BITS) + 2;
    var passing = 0u;
    // The mean of runs: the sum of their shares, the first of them, how far the others are from there.
    var mean_share = 0;
    var mean_first = vec2<i32>(0);
    var apart = vec2<i32>(0);
    var at = bottom;
    while at < top {
        let start = at;
        let bits = cells_of_row(runs, u32(at >> CELL_BITS) & 15u);
        while at < top && cells_of_row(runs, u32(at >> CELL_BITS) & 15u) == bits {
            at = ((at >> CELL_BITS) + 1) << CELL_BITS;
        }
        let height = min(at, top) - start;
        let share = select(i32((u32(height) * per_height) >> 14u), ONE, height == all);
        let run = vec2<i32>(i32(countTrailingZeros(bits)), i32(32u - countLeadingZeros(bits)));
        if bits != 0u && i32(countOneBits(bits)) == run.y - run.x {
            let distance = abs(run - mean_first);
            if mean_share > 0 && (distance.x > most || distance.y > most) {
                passing += visible_run(image, runs, here, mean_columns(mean_first, apart, mean_share), mean_share);
                mean_share = 0;
            }
            if mean_share == 0 {
                mean_first = run;
                apart = vec2<i32>(0);
            }
            mean_share += share;
            apart += share * (run - mean_first);
        } else {
            passing += visible_of_bits(image, runs, here, bits, share);
        }
    }
    if mean_share > 0 {
        passing += visible_run(image, runs, here, mean_columns(mean_first, apart, mean_share), mean_share);
    }
    return passing;
}

fn mean_columns(first: vec2<i32>, apart: vec2<i32>, share: i32) -> vec2<i32> {
    return (first << vec2<u32>(COLUMN_BITS)) + (apart << vec2<u32>(COLUMN_BITS)) / vec2<i32>(share);
}

fn column_at(image: ptr<function, Image>, runs: VisibleRuns, column: i32) -> i32 {
    return (*image).center.x + scaled_floor(runs.reach, column - LAST_COLUMN / 2, COLUMN_BITS + 3u);
}

// A run of cells between two columns, in so large a share of the row.
fn visible_run(image: ptr<function, Image>, runs: VisibleRuns, here: VisibleRow, columns: vec2<i32>, share: i32) -> u32 {
    let node = (*image).node;
    let between = select(columns, LAST_COLUMN - columns.yx, runs.is_turned);
    let begins = select(max(column_at(image, runs, between.x), here.span.x), here.span.x, between.x == 0);
    let ends = select(min(column_at(image, runs, between.y), here.span.y), here.span.y, between.y == LAST_COLUMN);
    if begins >= ends {
        return 0u;
    }
    let base = node.base + ((node.tilt.y * ((here.v * pen.stop) >> 14u)) >> 14u);
    let toward = select(node.tilt.x, -node.tilt.x, runs.is_turned);
    let steep = abs(node.tilt.x);
    let halvings = select(select(2u, 1u, steep < ONE / 3), 0u, steep < ONE / 10 || runs.is_even);
    let width = ends - begins;
    var passing = 0u;
    for (var at = 0; at < (1 << halvings); at += 1) {
        var from_x = begins + scaled_floor(width, at, halvings);
        var to_x = begins + scaled_floor(width, at + 1, halvings);
        var weight = share;
        if !runs.is_even {
            let middle = divide(runs.per_reach, (from_x >> 1u) + (to_x >> 1u) - (*image).center.x);
            let half = divide(runs.per_reach, (to_x - from_x) >> 1u);
            weight = base + ((toward * middle) >> 14u);
            if weight <= 0 {
                continue;
            }
            let leaning = clamp(toward * ((half * half) >> 14u) / (3 * weight), -half, half);
            let moved = signed_mul_shift(runs.reach, leaning, 14u);
            from_x += moved;
            to_x += moved;
            weight = (weight * share) >> 14u;
        }
        let weighted = mul_shift(here.height, u32(weight), 14u);
        if here.is_counted {
            passing += mul_shift(u32(to_x - from_x), weighted, here.finer);
        } else {
            let value = value_of(image, weighted, (*image).share, here.shift, here.row);
            add_run(image, here.row, clamped(image, from_x), clamped(image, to_x), value);
        }
    }
    return passing;
}
