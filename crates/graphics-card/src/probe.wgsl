// How a card rounds: the float operations of draw_list.wgsl and resolve.wgsl, to compare with the processor's. Each thread has
// three numbers.

@group(0) @binding(0) var<storage, read> numbers: array<f32>;
@group(0) @binding(1) var<storage, read_write> results: array<u32>;
// Always 0; unknown to the compiler.
@group(0) @binding(2) var<uniform> zero: vec4<u32>;

fn exact(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ zero.x);
}

@compute @workgroup_size(THREADS)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    let a = numbers[3u * id.x];
    let b = numbers[3u * id.x + 1u];
    let c = numbers[3u * id.x + 2u];
    results[3u * id.x] = bitcast<u32>(exact(a * b) + c);
    results[3u * id.x + 1u] = bitcast<u32>(a - exact(b * c));
    results[3u * id.x + 2u] = bitcast<u32>(i32(round(clamp(c, -LARGEST_ROUNDED, LARGEST_ROUNDED))));
}
