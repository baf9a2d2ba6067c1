// Exposes, tone maps and encodes a picture in GPU memory for the screen. Twin of `Tone` and `ToneCurve` in Rust.

struct Tone {
    width: u32,
    // 1 if radiance is divided by coverage.
    normalises: u32,
    // Index into `ToneCurve::ALL`.
    curve: u32,
    gain: f32,
}

// Red, green, blue and coverage of each pixel.
@group(0) @binding(0) var<storage, read> picture: array<vec4<f32>>;
@group(0) @binding(1) var<uniform> tone: Tone;

@vertex
fn develop_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn develop(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = picture[u32(at.y) * tone.width + u32(at.x)];
    var scale = tone.gain;
    if tone.normalises != 0u {
        scale = select(0.0, tone.gain / pixel.w, pixel.w > 0.0);
    }
    return vec4<f32>(encoded(mapped(pixel.rgb * scale)), 1.0);
}

fn encoded(linear: vec3<f32>) -> vec3<f32> {
    let light = clamp(linear, vec3<f32>(0.0), vec3<f32>(1.0));
    let high = 1.055 * pow(light, vec3<f32>(1.0 / 2.4)) - 0.055;
    return select(high, 12.92 * light, light <= vec3<f32>(0.0031308));
}

fn mapped(rgb: vec3<f32>) -> vec3<f32> {
    switch tone.curve {
        case 1u: {
            return neutral(max(rgb, vec3<f32>(0.0)));
        }
        case 2u: {
            return agx(max(rgb, vec3<f32>(0.0)));
        }
        default: {
            return rgb;
        }
    }
}

fn neutral(rgb: vec3<f32>) -> vec3<f32> {
    let start = 0.8 - 0.04;
    let least = min(min(rgb.r, rgb.g), rgb.b);
    let color = rgb - select(0.04, least - 6.25 * least * least, least < 0.08);
    let peak = max(max(color.r, color.g), color.b);
    if peak < start {
        return color;
    }
    let d = 1.0 - start;
    let new_peak = 1.0 - d * d / (peak + d - start);
    let share = 1.0 - 1.0 / (0.15 * (peak - new_peak) + 1.0);
    return mix(color * new_peak / peak, vec3<f32>(new_peak), share);
}

fn agx(rgb: vec3<f32>) -> vec3<f32> {
    let inset = mat3x3<f32>(
        vec3<f32>(0.84247906, 0.042328242, 0.042375654),
        vec3<f32>(0.0784336, 0.87846864, 0.0784336),
        vec3<f32>(0.079223745, 0.07916613, 0.879143),
    );
    let outset = mat3x3<f32>(
        vec3<f32>(1.196879, -0.05289685, -0.052971635),
        vec3<f32>(-0.09802088, 1.1519031, -0.09804345),
        vec3<f32>(-0.09902974, -0.09896118, 1.1510737),
    );
    let least_ev = -12.47393;
    let most_ev = 4.026069;
    // Values below the minimum are clamped to it.
    let light = max(inset * rgb, vec3<f32>(1e-5));
    let x = (clamp(log2(light), vec3<f32>(least_ev), vec3<f32>(most_ev)) - least_ev) / (most_ev - least_ev);
    let x2 = x * x;
    let x4 = x2 * x2;
    let curve = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
    return pow(clamp(outset * curve, vec3<f32>(1e-10), vec3<f32>(1.0)), vec3<f32>(2.2));
}
