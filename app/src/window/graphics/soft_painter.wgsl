// Draws egui's text and plain colours without its filtering in shader code. Rust twin: soft_painter.rs.

@group(0) @binding(0) var text: texture_2d<f32>;
@group(0) @binding(1) var text_sampler: sampler;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) uv: vec2<f32>,
    // Encoded like the screen, premultiplied by alpha.
    @location(1) color: vec4<f32>,
}

@vertex
fn shape_vertex(
    @location(0) clip: vec2<f32>,
    @location(1) uv: vec2<f32>,
    @location(2) color: vec4<f32>,
) -> Corner {
    return Corner(vec4(clip, 0.0, 1.0), uv, color);
}

@fragment
fn shape_color(in: Corner) -> @location(0) vec4<f32> {
    return in.color * textureSampleLevel(text, text_sampler, in.uv, 0.0);
}
