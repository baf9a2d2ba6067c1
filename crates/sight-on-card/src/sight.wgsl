// Which places of a square are hidden from a viewpoint: a thread a query. The twin of trace/src/visibility/shadow.rs and of the walk in
// trace/src/hierarchy.rs, in floats of 32 bits.
//
// Positions are sums of two floats; what is computed with are differences to the viewpoint, exact to a float's own digits. A place is
// hidden behind a triangle where the functions of its three edges are not negative, and that of its plane is positive: each is linear in
// the square's u and v. Whatever rounding leaves open, and whatever a texture decides, is left to the processor.

struct Node {
    low_x: vec4<f32>,
    high_x: vec4<f32>,
    low_y: vec4<f32>,
    high_y: vec4<f32>,
    low_z: vec4<f32>,
    high_z: vec4<f32>,
    first: vec4<u32>,
    count: vec4<u32>,
}

struct Triangle {
    a_high: vec3<f32>,
    index: u32,
    a_low: vec3<f32>,
    flags: u32,
    b_high: vec3<f32>,
    padding_b: u32,
    b_low: vec3<f32>,
    padding_c: u32,
    c_high: vec3<f32>,
    padding_d: u32,
    c_low: vec3<f32>,
    padding_e: u32,
}

struct Query {
    // A position; of a viewpoint at infinity its direction.
    eye_high: vec3<f32>,
    // The triangle that the viewpoint lies on, or none.
    skip: u32,
    eye_low: vec3<f32>,
    // The number of the targets, and IS_AT_INFINITY.
    target_and_flags: u32,
}

struct Answer {
    hidden: array<u32, POINT_WORDS>,
    // 1 where it is one.
    is_decided: u32,
}

struct Frame {
    center_high: vec3<f32>,
    count: u32,
    center_low: vec3<f32>,
    node_count: u32,
    right: vec3<f32>,
    padding_right: u32,
    up: vec3<f32>,
    padding_up: u32,
    axis: vec3<f32>,
    padding_axis: u32,
}

struct Target {
    // By fours, u and v.
    u: array<vec4<f32>, POINT_FOURS>,
    v: array<vec4<f32>, POINT_FOURS>,
    // The least and the greatest v of the points of each word.
    reach: array<vec2<f32>, POINT_WORDS>,
    // Bits of words that are no points.
    absent: array<u32, POINT_WORDS>,
    words: u32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

@group(0) @binding(0) var<storage, read> nodes: array<Node>;
@group(0) @binding(1) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(2) var<storage, read> targets: array<Target>;
@group(0) @binding(3) var<storage, read> queries: array<Query>;
@group(0) @binding(4) var<storage, read_write> answers: array<Answer>;
@group(0) @binding(5) var<uniform> frame: Frame;

// The space between the viewpoint and the square, relative to the origin: a point at infinity has the square's centre as one.
struct Shaft {
    origin_high: vec3<f32>,
    origin_low: vec3<f32>,
    to_square: vec3<f32>,
    // Unit normals, pointing inward, and offsets.
    planes: array<vec4<f32>, 5>,
    toward: vec3<f32>,
}

// The linear function a·u + b·v + c of the square's places, as a vector.
fn linear(normal: vec3<f32>, offset: f32, to_square: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(normal, frame.right), dot(normal, frame.up), dot(normal, to_square) + offset);
}

fn most_on_square(f: vec3<f32>) -> f32 {
    return abs(f.x) + abs(f.y) + f.z;
}

fn unit(v: vec3<f32>) -> vec3<f32> {
    let length = length(v);
    return select(vec3<f32>(0.0), v / length, length > 0.0);
}

fn shaft_of(query: Query) -> Shaft {
    let is_at_infinity = (query.target_and_flags & IS_AT_INFINITY) != 0u;
    var shaft: Shaft;
    shaft.origin_high = select(query.eye_high, frame.center_high, is_at_infinity);
    shaft.origin_low = select(query.eye_low, frame.center_low, is_at_infinity);
    shaft.to_square = (frame.center_high - shaft.origin_high) + (frame.center_low - shaft.origin_low);
    let away = select(shaft.to_square, -query.eye_high, is_at_infinity);
    let axis = select(frame.axis, -frame.axis, dot(frame.axis, away) < 0.0);
    var corner = shaft.to_square - frame.right - frame.up;
    var side = frame.right;
    var next_side = frame.up;
    for (var k = 0u; k < 4u; k += 1u) {
        let along = select(corner, query.eye_high, is_at_infinity);
        var normal = unit(cross(along, side));
        normal = select(normal, -normal, dot(normal, shaft.to_square - corner) < 0.0);
        shaft.planes[k] = vec4<f32>(normal, select(0.0, -dot(normal, corner), is_at_infinity));
        corner += 2.0 * side;
        let turned = -side;
        side = next_side;
        next_side = turned;
    }
    shaft.planes[4] = vec4<f32>(-axis, dot(axis, shaft.to_square));
    shaft.toward = axis;
    return shaft;
}

// The sides of four boxes along an axis.
struct Sides {
    low: vec4<f32>,
    high: vec4<f32>,
}

fn reaches(x: Sides, y: Sides, z: Sides, plane: vec4<f32>) -> vec4<bool> {
    let farthest = select(x.low, x.high, plane.x >= 0.0) * plane.x
        + select(y.low, y.high, plane.y >= 0.0) * plane.y
        + select(z.low, z.high, plane.z >= 0.0) * plane.z;
    return farthest >= vec4<f32>(-plane.w - SLACK * (2.0 + abs(plane.w)));
}

// A bit for each of a node's boxes that reaches into the shaft, generously.
fn reached(node: Node, shaft: Shaft) -> u32 {
    let high = shaft.origin_high;
    let low = shaft.origin_low;
    let low_x = (node.low_x - high.x) - low.x;
    let high_x = (node.high_x - high.x) - low.x;
    let low_y = (node.low_y - high.y) - low.y;
    let high_y = (node.high_y - high.y) - low.y;
    let low_z = (node.low_z - high.z) - low.z;
    let high_z = (node.high_z - high.z) - low.z;
    let x = Sides(low_x, high_x);
    let y = Sides(low_y, high_y);
    let z = Sides(low_z, high_z);
    let is_met = (node.low_x <= node.high_x)
        & reaches(x, y, z, shaft.planes[0])
        & reaches(x, y, z, shaft.planes[1])
        & reaches(x, y, z, shaft.planes[2])
        & reaches(x, y, z, shaft.planes[3])
        & reaches(x, y, z, shaft.planes[4]);
    return u32(is_met.x) | u32(is_met.y) << 1u | u32(is_met.z) << 2u | u32(is_met.w) << 3u;
}

// The functions of a triangle's shadow: three of its edges, then that of its plane.
struct Shadow {
    functions: array<vec3<f32>, 4>,
    casts: bool,
}

struct Corners {
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
    ab: vec3<f32>,
    bc: vec3<f32>,
    ca: vec3<f32>,
    normal: vec3<f32>,
    // n·a, by how much the viewpoint lies before the triangle's plane; of one at infinity n·d, d its direction.
    height: f32,
    // Below it the sign of the height is not known.
    least_height: f32,
}

fn corners_of(triangle: Triangle, query: Query, shaft: Shaft) -> Corners {
    var corners: Corners;
    corners.a = (triangle.a_high - shaft.origin_high) + (triangle.a_low - shaft.origin_low);
    corners.b = (triangle.b_high - shaft.origin_high) + (triangle.b_low - shaft.origin_low);
    corners.c = (triangle.c_high - shaft.origin_high) + (triangle.c_low - shaft.origin_low);
    corners.ab = (triangle.b_high - triangle.a_high) + (triangle.b_low - triangle.a_low);
    corners.bc = (triangle.c_high - triangle.b_high) + (triangle.c_low - triangle.b_low);
    corners.ca = (triangle.a_high - triangle.c_high) + (triangle.a_low - triangle.c_low);
    corners.normal = cross(corners.ab, -corners.ca);
    let spread = length(corners.ab) * length(corners.ca);
    if (query.target_and_flags & IS_AT_INFINITY) != 0u {
        corners.height = dot(corners.normal, query.eye_high);
        corners.least_height = ROUNDING * spread;
        return corners;
    }
    // From the nearest corner: it is the least wrong.
    let squares = vec3<f32>(dot(corners.a, corners.a), dot(corners.b, corners.b), dot(corners.c, corners.c));
    var nearest = corners.a;
    var square = squares.x;
    if squares.y < square {
        nearest = corners.b;
        square = squares.y;
    }
    if squares.z < square {
        nearest = corners.c;
        square = squares.z;
    }
    corners.height = dot(corners.normal, nearest);
    corners.least_height = ROUNDING * spread * sqrt(square);
    return corners;
}

// The shadow of a triangle whose height has this sign.
fn shadow_of(corners: Corners, query: Query, shaft: Shaft, sign: f32) -> Shadow {
    let is_at_infinity = (query.target_and_flags & IS_AT_INFINITY) != 0u;
    var shadow: Shadow;
    shadow.casts = false;
    if is_at_infinity {
        shadow.functions[3] = -sign * linear(corners.normal, -dot(corners.normal, corners.a), vec3<f32>(0.0));
    } else {
        shadow.functions[3] = sign * linear(corners.normal, -corners.height, shaft.to_square);
    }
    if most_on_square(shadow.functions[3]) <= 0.0 {
        return shadow;
    }
    shadow.functions[0] = sign * edge_function(corners.b, corners.bc, query, shaft);
    shadow.functions[1] = sign * edge_function(corners.c, corners.ca, query, shaft);
    shadow.functions[2] = sign * edge_function(corners.a, corners.ab, query, shaft);
    shadow.casts = most_on_square(shadow.functions[0]) >= 0.0
        && most_on_square(shadow.functions[1]) >= 0.0
        && most_on_square(shadow.functions[2]) >= 0.0;
    return shadow;
}

// The function of an edge that begins at a corner.
fn edge_function(corner: vec3<f32>, edge: vec3<f32>, query: Query, shaft: Shaft) -> vec3<f32> {
    if (query.target_and_flags & IS_AT_INFINITY) != 0u {
        let normal = cross(query.eye_high, edge);
        return linear(normal, -dot(normal, corner), vec3<f32>(0.0));
    }
    return linear(cross(corner, edge), 0.0, shaft.to_square);
}

// The places of a word of a target that lie in a shadow.
fn shadowed(shadow: Shadow, target_at: u32, word: u32) -> u32 {
    let reach = targets[target_at].reach[word];
    let most = vec4<f32>(
        most_in_rows(shadow.functions[0], reach),
        most_in_rows(shadow.functions[1], reach),
        most_in_rows(shadow.functions[2], reach),
        most_in_rows(shadow.functions[3], reach),
    );
    if any(most < vec4<f32>(0.0)) {
        return 0u;
    }
    let first = word * 8u;
    return shadowed_four(shadow, target_at, first)
        | shadowed_four(shadow, target_at, first + 1u) << 4u
        | shadowed_four(shadow, target_at, first + 2u) << 8u
        | shadowed_four(shadow, target_at, first + 3u) << 12u
        | shadowed_four(shadow, target_at, first + 4u) << 16u
        | shadowed_four(shadow, target_at, first + 5u) << 20u
        | shadowed_four(shadow, target_at, first + 6u) << 24u
        | shadowed_four(shadow, target_at, first + 7u) << 28u;
}

fn most_in_rows(f: vec3<f32>, reach: vec2<f32>) -> f32 {
    return abs(f.x) + max(f.y * reach.x, f.y * reach.y) + f.z;
}

// A bit for each of four places that lies in a shadow.
fn shadowed_four(shadow: Shadow, target_at: u32, four: u32) -> u32 {
    let u = targets[target_at].u[four];
    let v = targets[target_at].v[four];
    let is_within = (at_four(shadow.functions[0], u, v) >= vec4<f32>(0.0))
        & (at_four(shadow.functions[1], u, v) >= vec4<f32>(0.0))
        & (at_four(shadow.functions[2], u, v) >= vec4<f32>(0.0))
        & (at_four(shadow.functions[3], u, v) > vec4<f32>(0.0));
    return u32(is_within.x) | u32(is_within.y) << 1u | u32(is_within.z) << 2u | u32(is_within.w) << 3u;
}

fn at_four(f: vec3<f32>, u: vec4<f32>, v: vec4<f32>) -> vec4<f32> {
    return u * f.x + v * f.y + f.z;
}

@compute @workgroup_size(THREADS)
fn answer(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= frame.count {
        return;
    }
    let query = queries[id.x];
    let shaft = shaft_of(query);
    let target_at = query.target_and_flags & TARGET_MASK;
    let words = targets[target_at].words;
    var hidden = targets[target_at].absent;
    var is_decided = true;
    var steps = 0u;
    var waiting: array<u32, STACK>;
    var depth = 0u;
    if frame.node_count > 0u {
        waiting[0] = 0u;
        depth = 1u;
    }
    while depth > 0u && is_decided {
        depth -= 1u;
        let node = nodes[waiting[depth]];
        var left = reached(node, shaft);
        while left != 0u {
            steps += 1u;
            let child = firstTrailingBit(left);
            left &= left - 1u;
            let first = node.first[child];
            let count = node.count[child];
            if count == 0u {
                if depth == STACK {
                    is_decided = false;
                    break;
                }
                waiting[depth] = first;
                depth += 1u;
                continue;
            }
            for (var at = first; at < first + count; at += 1u) {
                let triangle = triangles[at];
                steps += 1u + words;
                if triangle.index == query.skip {
                    continue;
                }
                let corners = corners_of(triangle, query, shaft);
                let is_open = abs(corners.height) <= corners.least_height;
                // Seen from its culled back by the eye.
                if !is_open && (triangle.flags & CULLS_BACK) != 0u && is_culled(corners.height, query) {
                    continue;
                }
                // Where the sign is not known, whatever is hidden by either.
                let tries = select(1u, 2u, is_open);
                for (var k = 0u; k < tries; k += 1u) {
                    let sign = select(select(-1.0, 1.0, corners.height > 0.0), select(1.0, -1.0, k == 1u), is_open);
                    let shadow = shadow_of(corners, query, shaft, sign);
                    if !shadow.casts {
                        continue;
                    }
                    for (var word = 0u; word < words; word += 1u) {
                        if hidden[word] == 0xFFFFFFFFu {
                            continue;
                        }
                        let more = shadowed(shadow, target_at, word) & ~hidden[word];
                        if more != 0u && (is_open || (triangle.flags & MAY_BE_TRANSPARENT) != 0u) {
                            is_decided = false;
                        }
                        hidden[word] |= more;
                    }
                }
            }
        }
        let all = hidden[0] & hidden[1] & hidden[2] & hidden[3] & hidden[4] & hidden[5] & hidden[6] & hidden[7];
        if all == 0xFFFFFFFFu {
            break;
        }
        if steps > MOST_STEPS {
            is_decided = false;
        }
    }
    answers[id.x].hidden = hidden;
    answers[id.x].is_decided = select(0u, 1u, is_decided);
}

// Whether the viewpoint lies before a face with this height, and the square behind it.
fn is_culled(height: f32, query: Query) -> bool {
    if (query.target_and_flags & IS_AT_INFINITY) != 0u {
        return height > 0.0;
    }
    return height < 0.0;
}
