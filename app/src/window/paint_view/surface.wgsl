// The scene's surface with the false colour of its focus, in two passes: what is seen of the surface at every pixel, which
// stays while one paints; and its colours, which are made anew where the paint changed. Rust twin of the structs:
// surface_renderer.rs.

struct Frame {
    clip_from_scene: mat4x4<f32>,
    // Scene coordinates are world coordinates minus the scene's centre.
    eye: vec4<f32>,
    // Depth in the shot camera of a point p: dot(shot_axis.xyz, p) + shot_axis.w.
    shot_axis: vec4<f32>,
    // 1/s, 1/d, signed circle of confusion (px) for each unit of kappa, ln(1 + largest circle).
    optics: vec4<f32>,
    // Share of false colour, 1 with contour lines, atlas width and height.
    look: vec4<f32>,
    stops: array<vec4<f32>, 7>,
}

struct Material {
    base_color: vec4<f32>,
    emissive: vec4<f32>,
    // 1 for unlit; opacity below which nothing is there; 1 where it is seen from its front alone.
    kind: vec4<f32>,
}

@group(0) @binding(0) var<uniform> frame: Frame;
// What is seen, for the second pass: encoded colour and how much it faces the eye; atlas position in texels, depth in the
// shot camera, and 1 where there is a surface.
@group(0) @binding(1) var focus_map: texture_2d<f32>;
@group(0) @binding(2) var seen_color: texture_2d<f32>;
@group(0) @binding(3) var seen_place: texture_2d<f32>;

@group(1) @binding(0) var<uniform> material: Material;
@group(1) @binding(1) var base_texture: texture_2d<f32>;
@group(1) @binding(2) var base_sampler: sampler;
@group(1) @binding(3) var emissive_texture: texture_2d<f32>;
@group(1) @binding(4) var emissive_sampler: sampler;

struct Corner {
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) atlas: vec2<f32>,
    @location(3) base_uv: vec2<f32>,
    @location(4) emissive_uv: vec2<f32>,
    @location(5) color: vec4<f32>,
}

struct Fragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) atlas: vec2<f32>,
    @location(3) base_uv: vec2<f32>,
    @location(4) emissive_uv: vec2<f32>,
    @location(5) color: vec4<f32>,
}

@vertex
fn surface_vertex(corner: Corner) -> Fragment {
    var out: Fragment;
    out.clip = frame.clip_from_scene * vec4(corner.position, 1.0);
    out.position = corner.position;
    out.normal = corner.normal;
    out.atlas = corner.atlas;
    out.base_uv = corner.base_uv;
    out.emissive_uv = corner.emissive_uv;
    out.color = corner.color;
    return out;
}

// What is added to the anchor of what is frozen. Twin of focus_texture.rs.
const FROZEN: f32 = 2.0;

// t, anchor and 1 where frozen, of a texel.
fn texel_at(at: vec2<i32>) -> vec3<f32> {
    let texel = textureLoad(focus_map, at, 0).xy;
    let frozen = step(0.75 * FROZEN, texel.y);
    return vec3(texel.x, texel.y - FROZEN * frozen, frozen);
}

// t, anchor and how much is frozen at an atlas position in texels, bilinear between texel centres.
fn focus_at(position: vec2<f32>) -> vec3<f32> {
    let at = position - 0.5;
    let corner = floor(at);
    let share = at - corner;
    let last = vec2<i32>(frame.look.zw) - 1;
    let low = clamp(vec2<i32>(corner), vec2(0), last);
    let high = clamp(vec2<i32>(corner) + 1, vec2(0), last);
    let top = mix(texel_at(low), texel_at(vec2(high.x, low.y)), share.x);
    let bottom = mix(texel_at(vec2(low.x, high.y)), texel_at(high), share.x);
    return mix(top, bottom, share.y);
}

// kappa = (t - 1)/d + t (1 - a) (1/s - 1/z); twin of lens::Optics::kappa.
fn kappa(inverse_depth: f32, focus: vec2<f32>) -> f32 {
    let t = focus.x;
    let a = focus.y;
    return (t - 1.0) * frame.optics.y + t * (1.0 - a) * (frame.optics.x - inverse_depth);
}

// Twin of false_colour::position and color_at.
fn false_color(circle_px: f32) -> vec3<f32> {
    let place = sign(circle_px) * min(log(1.0 + abs(circle_px)) / frame.optics.w, 1.0);
    let at = (place + 1.0) * 3.0;
    let index = min(u32(at), 5u);
    return mix(frame.stops[index].rgb, frame.stops[index + 1u].rgb, at - f32(index));
}

// 1 on the line where |circle| is `level`, about a pixel and a half wide.
fn contour(circle_px: f32, width: f32, level: f32) -> f32 {
    return 1.0 - smoothstep(0.7, 1.5, abs(abs(circle_px) - level) / max(width, 1e-6));
}

fn encoded(linear: vec3<f32>) -> vec3<f32> {
    let clamped = clamp(linear, vec3(0.0), vec3(1.0));
    let low = clamped * 12.92;
    let high = 1.055 * pow(clamped, vec3(1.0 / 2.4)) - 0.055;
    return select(high, low, clamped <= vec3(0.0031308));
}

struct Seen {
    @location(0) color: vec4<f32>,
    @location(1) place: vec4<f32>,
}

// First pass: what is seen of the surface.
@fragment
fn seen_fragment(in: Fragment, @builtin(front_facing) is_front: bool) -> Seen {
    // Everything with derivatives comes before the opacity test.
    let base = material.base_color * in.color * textureSample(base_texture, base_sampler, in.base_uv);
    let emitted = material.emissive.rgb * textureSample(emissive_texture, emissive_sampler, in.emissive_uv).rgb;
    let facet = cross(dpdx(in.position), dpdy(in.position));
    if base.a < material.kind.y || (material.kind.z > 0.5 && !is_front) {
        discard;
    }

    // A light at the eye; unlit surfaces show their texture as it is.
    let to_eye = normalize(frame.eye.xyz - in.position);
    let normal = select(normalize(facet), normalize(in.normal), dot(in.normal, in.normal) > 0.0);
    let facing = abs(dot(normal, to_eye));
    let shade = mix(0.25 + 0.75 * facing, 1.0, material.kind.x);
    let depth = dot(frame.shot_axis.xyz, in.position) + frame.shot_axis.w;
    return Seen(vec4(encoded(base.rgb * shade + emitted), facing), vec4(in.atlas, depth, 1.0));
}

@vertex
fn screen_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2(f32(index & 1u), f32(index >> 1u));
    return vec4(4.0 * corner.x - 1.0, 4.0 * corner.y - 1.0, 0.0, 1.0);
}

// Encoded grey where no surface is: darker than the panels, so that the scene stands out.
const BACKGROUND: vec3<f32> = vec3(0.125);

// Second pass: its colours.
@fragment
fn color_fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(at.xy);
    let seen = textureLoad(seen_color, pixel, 0);
    let place = textureLoad(seen_place, pixel, 0);
    let surface = seen.rgb;
    let facing = seen.a;
    let depth = place.z;
    let focus = focus_at(place.xy);
    let circle_px = frame.optics.z * kappa(1.0 / max(depth, 1e-9), focus.xy);
    let circle_width = fwidth(circle_px);

    // What stands behind the shot camera has no circle of confusion: it stays grey.
    let in_front = select(0.0, 1.0, depth > 0.0);
    let relief = 0.62 + 0.38 * facing;
    let luma = dot(surface, vec3(0.2126, 0.7152, 0.0722));
    var focus_color = mix(vec3(0.35), false_color(circle_px), in_front) * relief * (0.78 + 0.3 * luma);
    let lines = max(max(contour(circle_px, circle_width, 1.0), contour(circle_px, circle_width, 4.0)),
        contour(circle_px, circle_width, 16.0));
    focus_color = mix(focus_color, vec3(0.05), 0.75 * lines * frame.look.y * in_front);
    let color = mix(surface, focus_color, frame.look.x);
    // What is frozen is darker, and striped.
    let stripe = step(4.0, f32((u32(at.x) + u32(at.y)) % 8u));
    return vec4(select(BACKGROUND, color * mix(1.0, mix(0.45, 0.7, stripe), focus.z), place.w > 0.0), 1.0);
}
