//! The hierarchy and its triangles as plain numbers, for devices that trace on their own.

use super::Tracer;
use crate::local_space::LocalSpace;
use glam::{DVec3, Vec3};
use scene::Scene;
use std::sync::Arc;

/// A position of local space, [−1, 1]³ within the scene, as the sum of two floats: to some 2⁻⁴⁸.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplitPosition {
    /// The nearest floats.
    pub high: Vec3,
    /// What they lack.
    pub low: Vec3,
}

impl From<DVec3> for SplitPosition {
    fn from(position: DVec3) -> Self {
        let high = position.as_vec3();
        Self { high, low: (position - high.as_dvec3()).as_vec3() }
    }
}

/// Four boxes and what they hold.
#[derive(Clone, Copy, Debug)]
pub struct FlatNode {
    /// By axis, the low and the high sides of the four boxes, local space. An absent child has a box turned inside out.
    pub sides: [[[f32; 4]; 2]; 3],
    /// A node, or the first triangle of a leaf.
    pub first: [u32; 4],
    /// Triangles of a leaf; 0 for a node.
    pub count: [u32; 4],
}

/// A triangle of a leaf.
#[derive(Clone, Copy, Debug)]
pub struct FlatTriangle {
    /// Its corners.
    pub corners: [SplitPosition; 3],
    /// Its number in the scene.
    pub index: u32,
    /// Whether points of it may let light pass.
    pub may_be_transparent: bool,
    /// Whether the eye sees through its back.
    pub culls_back: bool,
}

/// A view of a tracer's hierarchy.
#[derive(Clone, Copy)]
pub struct FlatHierarchy<'a>(&'a Tracer);

impl FlatHierarchy<'_> {
    /// The scene that it is of.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.0.scene
    }

    /// The number of nodes, and of triangles.
    pub fn counts(&self) -> [usize; 2] {
        [self.0.hierarchy.nodes().len(), self.0.triangles.len()]
    }

    /// The nodes; the first is the root.
    pub fn nodes(&self) -> impl Iterator<Item = FlatNode> {
        self.0.hierarchy.nodes().iter().map(|node| {
            let (first, count) = node.children();
            FlatNode { sides: node.sides.map(|of_axis| of_axis.map(|side| side.to_array())), first, count }
        })
    }

    /// The triangles, in the order of the leaves.
    pub fn triangles(&self) -> impl Iterator<Item = FlatTriangle> {
        self.0.triangles.iter().map(|triangle| FlatTriangle {
            corners: triangle.corners.map(|corner| self.space().position(corner)),
            index: triangle.index,
            may_be_transparent: triangle.may_be_transparent,
            culls_back: triangle.culls_back,
        })
    }

    /// The space that they are in.
    pub fn space(&self) -> FlatSpace {
        FlatSpace(self.0.space)
    }
}

/// World to the local space of a hierarchy.
#[derive(Clone, Copy, Debug)]
pub struct FlatSpace(LocalSpace);

impl FlatSpace {
    /// A world position in local space.
    pub fn position(&self, world: DVec3) -> SplitPosition {
        self.0.position(world).into()
    }

    /// A difference of world positions in local space.
    pub fn direction(&self, world: DVec3) -> DVec3 {
        self.0.direction(world)
    }
}

impl Tracer {
    /// Its hierarchy as plain numbers.
    pub fn flat(&self) -> FlatHierarchy<'_> {
        FlatHierarchy(self)
    }
}
