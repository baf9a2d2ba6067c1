// A running sum over the threads of a workgroup, by doubling steps: any card's. The twin of scan_subgroups.wgsl.

struct Lane {
    @builtin(local_invocation_index) thread: u32,
}

var<workgroup> before: array<vec4<i32>, SCAN_THREADS>;

// Its place among the threads.
fn place_of(lane: Lane) -> u32 {
    return lane.thread;
}

// The sum of what all threads before this one have.
fn sum_before(lane: Lane, own: vec4<i32>) -> vec4<i32> {
    before[lane.thread] = own;
    for (var step = 1u; step < SCAN_THREADS; step *= 2u) {
        workgroupBarrier();
        var more = vec4<i32>();
        if lane.thread >= step {
            more = before[lane.thread - step];
        }
        workgroupBarrier();
        before[lane.thread] += more;
    }
    return before[lane.thread] - own;
}
