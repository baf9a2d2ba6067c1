//! Which triangle of a scene in motion is which of the scene at rest: atlas and paint belong to the surface at rest.
//!
//! A part is found again by its node, instance and primitive, a triangle of it by its number in the primitive. What is shown
//! at a moment may be less than at rest (a node is hidden, a position is no number) and more (a node is shown that was
//! hidden): that was nowhere at rest.

use crate::{PartSource, Scene};
use std::collections::HashMap;

/// A scene at a moment of an animation.
#[derive(Clone, Debug)]
pub struct PosedScene {
    /// The scene.
    pub scene: Scene,
    /// Of each of its triangles, which one it is at rest; none if it is hidden then.
    pub rest_triangles: Vec<Option<RestTriangle>>,
}

/// A triangle of the scene at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RestTriangle {
    /// Its index.
    pub triangle: u32,
    /// Whether its second and third corner are the third and second of the triangle in motion: a transform that mirrors turns them.
    pub is_flipped: bool,
}

impl PosedScene {
    /// Whether every triangle is that of the scene at rest with the same index.
    pub fn matches_rest(&self) -> bool {
        let mut number = 0..;
        self.rest_triangles
            .iter()
            .all(|rest| rest.is_some_and(|rest| Some(rest.triangle) == number.next() && !rest.is_flipped))
    }
}

/// Node, instance and primitive.
type PartName = [usize; 3];

fn part_name(source: &PartSource) -> PartName {
    [source.node, source.instance.map_or(0, |(instance, _)| instance), source.primitive]
}

/// The parts of a scene at rest, by name.
pub(crate) struct RestParts(HashMap<PartName, RestPart>);

struct RestPart {
    first_triangle: u32,
    triangle_count: u32,
    mirrored: bool,
    /// Which of the primitive's triangles it has, ascending; nothing where it has them all.
    triangles: Option<Vec<u32>>,
}

impl RestParts {
    /// Those of a scene whose parts stand there in its file.
    pub fn new(scene: &Scene, sources: &[PartSource]) -> Self {
        let part = |(part, source): (&crate::Part, &PartSource)| {
            let part = RestPart {
                first_triangle: part.triangles.start,
                triangle_count: part.triangles.len() as u32,
                mirrored: part.mirrored,
                triangles: source.triangles.clone(),
            };
            (part_name(source), part)
        };
        Self(scene.parts.iter().zip(sources).map(part).collect())
    }

    /// Of each triangle of a scene in motion, which one it is at rest. `None` if a part has other triangles than it can have.
    pub fn rest_triangles(&self, scene: &Scene, sources: &[PartSource]) -> Option<Vec<Option<RestTriangle>>> {
        let mut matches = Vec::with_capacity(scene.triangles.len());
        for (part, source) in scene.parts.iter().zip(sources) {
            let rest = self.0.get(&part_name(source));
            for at in 0..part.triangles.len() {
                let number = match &source.triangles {
                    Some(triangles) => *triangles.get(at)?,
                    None => at as u32,
                };
                let rest_triangle = |rest: &RestPart| {
                    let at = match &rest.triangles {
                        Some(triangles) => triangles.binary_search(&number).ok()? as u32,
                        None => number,
                    };
                    let is_turned = rest.mirrored != part.mirrored;
                    (at < rest.triangle_count)
                        .then_some(RestTriangle { triangle: rest.first_triangle + at, is_flipped: is_turned })
                };
                matches.push(rest.and_then(rest_triangle));
            }
        }
        (matches.len() == scene.triangles.len()).then_some(matches)
    }
}
