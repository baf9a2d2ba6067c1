// The scene's surface in the false colour of its focus, in two passes. The geometry pass writes the visible surface of every
// pixel; it stays valid during painting. The color pass is repeated where the paint changed. Rust twin of the structs:
// surface_renderer.rs.

struct Frame {
    clip_from_scene: mat4x4<f32>,
    // Scene coordinates are world coordinates minus the scene's centre.
    eye: vec4<f32>,
    // Depth in the shot camera of a point p: dot(shot_axis.xyz, p) + shot_axis.w.
    shot_axis: vec4<f32>,
    // 1/s, 1/d, signed circle of confusion (px) per unit of kappa, ln(1 + largest circle).
    optics: vec4<f32>,
    // Share of false colour, 1 with contour lines, atlas width and height.
    appearance: vec4<f32>,
    stops: array<vec4<f32>, 7>,
}

struct Material {
    base_color: vec4<f32>,
    emissive: vec4<f32>,
    // 1 for unlit; the alpha cutoff; 1 if single-sided.
    kind: vec4<f32>,
}

@group(0) @binding(0) var<uniform> frame: Frame;
// Input of the color pass: encoded colour and cosine to the eye; atlas position in texels, depth in the shot camera, and 1
// where there is a surface.
@group(0) @binding(1) var focus_map: texture_2d<f32>;
@group(0) @binding(2) var visible_color: texture_2d<f32>;
@group(0) @binding(3) var visible_position: texture_2d<f32>;

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

// Added to the anchor of frozen texels. Twin of focus_texture.rs.
const FROZEN: f32 = 2.0;

// t, anchor and 1 if frozen, of a texel.
fn texel_at(at: vec2<i32>) -> vec3<f32> {
    let texel = textureLoad(focus_map, at, 0).xy;
    let frozen = step(0.75 * FROZEN, texel.y);
    return vec3(texel.x, texel.y - FROZEN * frozen, frozen);
}

// t, anchor and frozen share at an atlas position in texels, bilinear between texel centres.
fn focus_at(position: vec2<f32>) -> vec3<f32> {
    let at = position - 0.5;
    let corner = floor(at);
    let share = at - corner;
    let last = vec2<i32>(frame.appearance.zw) - 1;
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

// 1 on the contour line |circle| = `level`, about 1.5 pixels wide.
fn contour(circle_px: f32, width: f32, level: f32) -> f32 {
    return 1.0 - smoothstep(0.7, 1.5, abs(abs(circle_px) - level) / max(width, 1e-6));
}

fn encoded(linear: vec3<f32>) -> vec3<f32> {
    let clamped = clamp(linear, vec3(0.0), vec3(1.0));
    let low = clamped * 12.92;
    let high = 1.055 * pow(clamped, vec3(1.0 / 2.4)) - 0.055;
    return select(high, low, clamped <= vec3(0.0031308));
}

struct GBuffer {
    @location(0) color: vec4<f32>,
    @location(1) place: vec4<f32>,
}

// Geometry pass.
@fragment
fn geometry_fragment(in: Fragment, @builtin(front_facing) is_front: bool) -> GBuffer {
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
    return GBuffer(vec4(encoded(base.rgb * shade + emitted), facing), vec4(in.atlas, depth, 1.0));
}

@vertex
fn screen_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2(f32(index & 1u), f32(index >> 1u));
    return vec4(4.0 * corner.x - 1.0, 4.0 * corner.y - 1.0, 0.0, 1.0);
}

// Encoded grey of the background: darker than the panels, so that the scene stands out.
const BACKGROUND: vec3<f32> = vec3(0.125);

// Color pass.
@fragment
fn color_fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(at.xy);
    let visible = textureLoad(visible_color, pixel, 0);
    let place = textureLoad(visible_position, pixel, 0);
    let surface = visible.rgb;
    let facing = visible.a;
    let depth = place.z;
    let focus = focus_at(place.xy);
    let circle_px = frame.optics.z * kappa(1.0 / max(depth, 1e-9), focus.xy);
    let circle_width = fwidth(circle_px);

    // Surfaces behind the shot camera have no circle of confusion: they are grey.
    let in_front = select(0.0, 1.0, depth > 0.0);
    let relief = 0.62 + 0.38 * facing;
    let luma = dot(surface, vec3(0.2126, 0.7152, 0.0722));
    var focus_color = mix(vec3(0.35), false_color(circle_px), in_front) * relief * (0.78 + 0.3 * luma);
    let lines = max(max(contour(circle_px, circle_width, 1.0), contour(circle_px, circle_width, 4.0)),
        contour(circle_px, circle_width, 16.0));
    focus_color = mix(focus_color, vec3(0.05), 0.75 * lines * frame.appearance.y * in_front);
    let color = mix(surface, focus_color, frame.appearance.x);
    // Frozen surfaces are darker, and striped.
    let stripe = step(4.0, f32((u32(at.x) + u32(at.y)) % 8u));
    return vec4(select(BACKGROUND, color * mix(1.0, mix(0.45, 0.7, stripe), focus.z), place.w > 0.0), 1.0);
}
