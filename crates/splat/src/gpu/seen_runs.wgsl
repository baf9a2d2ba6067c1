// What of a pixel row the occluders let through: the twin of ../draw/seen_runs.rs, read after draw.wgsl.

struct SeenRuns {
    pixel: i32,
    reach: i32,
    per_reach: Divisor,
    is_turned: bool,
    // Where the cells lie in `cells`; OPEN for all.
    cells: u32,
}

fn seen_runs_of(image: ptr<function, Image>, cells: u32) -> SeenRuns {
    let radius = u32(abs((*image).radius));
    let wide = wide_right(wide_product(radius, pen.per_stop), 14u);
    let reach = clamp(select(wide.x, LARGEST_REACH, wide.y > 0u), SMALLEST_REACH, LARGEST_REACH);
    let pixel = i32(min((1u << 26u) / max(radius, 1u), TALLEST_ROW));
    return SeenRuns(pixel, i32(reach), divisor_of(reach), (*image).radius < 0, cells);
}

fn part_of(x: i32, factor: i32, shift: u32) -> i32 {
    return (x >> shift) * factor + (((x & ((1 << shift) - 1)) * factor) >> shift);
}

fn edge(seen: SeenRuns, center: i32, cell: u32) -> i32 {
    if cell == 0u {
        return i32(-2147483647 - 1);
    }
    if cell == 16u {
        return 2147483647;
    }
    return center + part_of(seen.reach, i32(cell) - 8, 3u);
}

// Adds what is let through of a row's span; with `is_found` only finds how much it is, times 2²⁴ over 2^`finer`.
fn seen_row(
    image: ptr<function, Image>, seen: SeenRuns, row: i32, v: i32, span: vec2<i32>, height: u32, shift: u32, finer: u32, is_found: bool,
) -> u32 {
    let node = (*image).node;
    let center = (*image).center;
    let from_center = bitcast<u32>(row - (center.y >> POSITION_BITS));
    let jitter = i32(((*image).dither + from_center * 0x9E3779B1u) >> 18u);
    let jittered = v + ((seen.pixel * (jitter - ONE / 2)) >> 14u);
    let of_baked = (jittered * pen.stop) >> 14u;
    let cell_row = u32(clamp((of_baked + ONE) >> 11u, 0, 15));
    var bits = 0xFFFFu;
    if seen.cells != OPEN {
        bits = (cells[seen.cells + cell_row / 2u] >> (16u * (cell_row % 2u))) & 0xFFFFu;
    }
    if seen.is_turned {
        bits = reverseBits(bits) >> 16u;
    }
    let is_even = abs(node.tilt.x) + abs(node.tilt.y) <= pen.even_seen_tilt && node.base == ONE;
    let base = node.base + ((node.tilt.y * ((v * pen.stop) >> 14u)) >> 14u);
    let toward = select(node.tilt.x, -node.tilt.x, seen.is_turned);
    let steep = abs(node.tilt.x);
    let halvings = select(select(2u, 1u, steep < ONE / 3), 0u, steep < ONE / 10);
    var passing = 0u;
    while bits != 0u {
        let start = countTrailingZeros(bits);
        let end = start + countTrailingZeros(~(bits >> start));
        bits &= 0xFFFFFFFFu << end;
        let begins = max(edge(seen, center.x, start), span.x);
        let ends = min(edge(seen, center.x, end), span.y);
        if begins >= ends {
            continue;
        }
        let shift_of_part = select(halvings, 0u, is_even);
        let width = ends - begins;
        for (var at = 0; at < (1 << shift_of_part); at += 1) {
            var from_x = begins + part_of(width, at, shift_of_part);
            var to_x = begins + part_of(width, at + 1, shift_of_part);
            var weight = ONE;
            if !is_even {
                let middle = divide(seen.per_reach, (from_x >> 1u) + (to_x >> 1u) - center.x);
                let half = divide(seen.per_reach, (to_x - from_x) >> 1u);
                weight = base + ((toward * middle) >> 14u);
                if weight <= 0 {
                    continue;
                }
                let leaning = clamp(toward * ((half * half) >> 14u) / (3 * weight), -half, half);
                let moved = signed_mul_shift(seen.reach, leaning, 14u);
                from_x += moved;
                to_x += moved;
            }
            let weighted = mul_shift(height, u32(weight), 14u);
            if is_found {
                passing += mul_shift(u32(to_x - from_x), weighted, finer);
            } else {
                let value = value_of(image, weighted, (*image).share, shift, row);
                add_run(image, row, clamped(image, from_x), clamped(image, to_x), value);
            }
        }
    }
    return passing;
}
