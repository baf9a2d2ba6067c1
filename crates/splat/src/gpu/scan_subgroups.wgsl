// A running sum over the threads of a workgroup, where cards add within subgroups by themselves: two steps instead of
// eight. Integers, so the same bits as scan.wgsl's.

struct Lane {
    @builtin(subgroup_id) subgroup: u32,
    @builtin(subgroup_size) size: u32,
    @builtin(subgroup_invocation_id) lane: u32,
}

// Of each subgroup; none has fewer than four threads.
var<workgroup> of_subgroups: array<vec4<i32>, SCAN_THREADS / 4u>;

// Its place among the threads.
fn place_of(lane: Lane) -> u32 {
    return lane.subgroup * lane.size + lane.lane;
}

// The sum of what all threads before this one have.
fn sum_before(lane: Lane, own: vec4<i32>) -> vec4<i32> {
    var sum = subgroupExclusiveAdd(own);
    if lane.lane == lane.size - 1u {
        of_subgroups[lane.subgroup] = sum + own;
    }
    workgroupBarrier();
    for (var k = 0u; k < lane.subgroup; k += 1u) {
        sum += of_subgroups[k];
    }
    return sum;
}
