// Draws a picture without egui's own shader, which always filters in shader code as well: expensive on a software adapter.
// Rust twin: blit.rs.

// Texture coordinates of the upper left and lower right corners of the drawn part.
@group(0) @binding(0) var<uniform> place: vec4<f32>;
@group(0) @binding(1) var picture: texture_2d<f32>;
@group(0) @binding(2) var picture_sampler: sampler;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) at: vec2<f32>,
}

@vertex
fn blit_vertex(@builtin(vertex_index) index: u32) -> Corner {
    let corner = vec2(f32(index & 1u), f32(index >> 1u));
    return Corner(vec4(2.0 * corner.x - 1.0, 1.0 - 2.0 * corner.y, 0.0, 1.0), mix(place.xy, place.zw, corner));
}

// The picture is encoded like the screen.
@fragment
fn blit_encoded(in: Corner) -> @location(0) vec4<f32> {
    return vec4(textureSampleLevel(picture, picture_sampler, in.at, 0.0).rgb, 1.0);
}

// The screen encodes its input.
@fragment
fn blit_linear(in: Corner) -> @location(0) vec4<f32> {
    let encoded = textureSampleLevel(picture, picture_sampler, in.at, 0.0).rgb;
    let high = pow((encoded + 0.055) / 1.055, vec3(2.4));
    return vec4(select(high, encoded / 12.92, encoded <= vec3(0.04045)), 1.0);
}
