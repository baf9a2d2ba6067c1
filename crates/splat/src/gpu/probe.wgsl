// How a card rounds: what list.wgsl and resolve.wgsl make of floats, to be compared with the processor's. Each thread has
// three numbers.

@group(0) @binding(0) var<storage, read> numbers: array<f32>;
@group(0) @binding(1) var<storage, read_write> results: array<u32>;
// Always 0, which no compiler knows.
@group(0) @binding(2) var<uniform> zero: vec4<u32>;

fn exact(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ zero.x);
}

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    let a = numbers[3u * id.x];
    let b = numbers[3u * id.x + 1u];
    let c = numbers[3u * id.x + 2u];
    results[3u * id.x] = bitcast<u32>(exact(a * b) + c);
    results[3u * id.x + 1u] = bitcast<u32>(a - exact(b * c));
    results[3u * id.x + 2u] = bitcast<u32>(i32(round(clamp(c, -536870912.0, 536870912.0))));
}
