//! How what shaders read lies in memory: the twins of the structs of `sight.wgsl`, and the module's constants.

use bytemuck::{Pod, Zeroable};
use graphics_card::constants;
use trace::{FlatNode, FlatTriangle, PointSet, SplitPosition, TargetPoints};

/// The most points of a target.
pub const POINTS: usize = PointSet::MAX;
/// Words of a bit a point.
pub const POINT_WORDS: usize = POINTS / 32;
/// Four points at a time.
pub const POINT_FOURS: usize = POINTS / 4;
/// Threads of a workgroup.
pub const THREADS: u32 = 64;
/// Nodes that a walk can have waiting; where more are, the processor answers.
pub const STACK: usize = 64;

/// Steps of a walk after which the rest is left to the processor: no card is held up by one query, and none in software, which ends loops
/// after 2¹⁶ rounds, answers half of it.
pub const MOST_STEPS: u32 = 1 << 15;

/// Flags of a triangle.
pub const MAY_BE_TRANSPARENT: u32 = 1;
pub const CULLS_BACK: u32 = 2;
/// A flag of a query, beside the number of its targets.
pub const IS_AT_INFINITY: u32 = 1 << 31;
pub const TARGET_MASK: u32 = !IS_AT_INFINITY;
/// No triangle.
pub const NONE: u32 = u32::MAX;

/// What floats of 32 bits may be wrong by in where a box lies beside a plane, in local space.
pub const SLACK: f32 = 1.0 / (1u32 << 19) as f32;

/// What they may be wrong by in a triangle's height over the viewpoint, as a share of the lengths that are multiplied.
///
/// Differences of positions have an error of 2⁻²⁴ of themselves, products and sums as much each: fewer than 16 in all.
pub const ROUNDING: f32 = 1.0 / (1u32 << 20) as f32;

/// The module's source.
pub fn source() -> String {
    let constants = constants!(
        POINTS,
        POINT_WORDS,
        POINT_FOURS,
        MOST_STEPS,
        THREADS,
        STACK,
        MAY_BE_TRANSPARENT,
        CULLS_BACK,
        IS_AT_INFINITY,
        TARGET_MASK,
        SLACK,
        ROUNDING,
    );
    [&constants, include_str!("sight.wgsl")].join("\n")
}

/// Four boxes and what they hold.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Node {
    sides: [[[f32; 4]; 2]; 3],
    first: [u32; 4],
    count: [u32; 4],
}

impl From<FlatNode> for Node {
    fn from(FlatNode { sides, first, count }: FlatNode) -> Self {
        Self { sides, first, count }
    }
}

/// A triangle of a leaf: each corner's parts, with a word behind each.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Triangle([[u32; 4]; 6]);

impl From<FlatTriangle> for Triangle {
    fn from(triangle: FlatTriangle) -> Self {
        let flag = |is_set: bool, flag: u32| if is_set { flag } else { 0 };
        let flags =
            flag(triangle.may_be_transparent, MAY_BE_TRANSPARENT) | flag(triangle.culls_back, CULLS_BACK);
        let words = |part: glam::Vec3, word: u32| {
            let [x, y, z] = part.to_array().map(f32::to_bits);
            [x, y, z, word]
        };
        let [a, b, c] = triangle.corners;
        Self([
            words(a.high, triangle.index),
            words(a.low, flags),
            words(b.high, 0),
            words(b.low, 0),
            words(c.high, 0),
            words(c.low, 0),
        ])
    }
}

/// Points that are asked for.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Target {
    /// u, then v.
    coordinates: [[f32; POINTS]; 2],
    reach: [[f32; 2]; POINT_WORDS],
    absent: [u32; POINT_WORDS],
    words: u32,
    padding: [u32; 3],
}

impl From<&TargetPoints> for Target {
    fn from(targets: &TargetPoints) -> Self {
        let count = targets.count();
        let coordinates: [[f32; POINTS]; 2] = [0, 1].map(|axis| {
            let at = |k: usize| targets.position(k.min(count.saturating_sub(1)))[axis] as f32;
            std::array::from_fn(at)
        });
        let reach = |word: usize| {
            let of_word = coordinates[1][32 * word..32 * (word + 1)].iter().copied();
            [of_word.clone().fold(f32::INFINITY, f32::min), of_word.fold(f32::NEG_INFINITY, f32::max)]
        };
        let absent = |word: usize| (0..32).filter(|k| 32 * word + k >= count).map(|k| 1u32 << k).sum();
        Self {
            reach: std::array::from_fn(reach),
            absent: std::array::from_fn(absent),
            words: count.div_ceil(32) as u32,
            padding: [0; 3],
            coordinates,
        }
    }
}

/// A question.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Query {
    eye_high: [f32; 3],
    skip: u32,
    eye_low: [f32; 3],
    target_and_flags: u32,
}

impl Query {
    /// From a point on the triangle `skip`.
    pub fn at(eye: SplitPosition, skip: u32, target: u32) -> Self {
        let SplitPosition { high, low } = eye;
        Self { eye_high: high.to_array(), skip, eye_low: low.to_array(), target_and_flags: target }
    }

    /// From infinitely far in a direction of length 1.
    pub fn toward(direction: glam::Vec3, target: u32) -> Self {
        let target_and_flags = target | IS_AT_INFINITY;
        Self { eye_high: direction.to_array(), skip: NONE, eye_low: [0.0; 3], target_and_flags }
    }
}

/// Words of an answer: the points that are hidden, and whether it is one.
pub const ANSWER_WORDS: usize = POINT_WORDS + 1;

/// The square, and how many queries there are.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Frame {
    pub center_high: [f32; 3],
    pub count: u32,
    pub center_low: [f32; 3],
    pub node_count: u32,
    pub right: [f32; 3],
    pub padding_right: u32,
    pub up: [f32; 3],
    pub padding_up: u32,
    pub axis: [f32; 3],
    pub padding_axis: u32,
}
