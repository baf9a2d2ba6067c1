//! Correspondence of the triangles of an animated scene to those of the scene at rest, to which atlas and paint
//! belong.
//!
//! A part is identified by its node, instance and primitive, a triangle by its number in the primitive. An animated
//! scene may show less than at rest (a node is hidden, a position is NaN) and more (a node is shown that was hidden):
//! the latter has no counterpart.

use crate::{PartSource, Scene};
use std::collections::HashMap;

/// A scene at a time of an animation.
#[derive(Clone, Debug)]
pub struct PosedScene {
    /// The scene.
    pub scene: Scene,
    /// For each of its triangles, the triangle at rest; `None` if it is hidden at rest.
    pub rest_triangles: Vec<Option<RestTriangle>>,
}

/// A triangle of the scene at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RestTriangle {
    /// Its index.
    pub triangle: u32,
    /// Whether its second and third corner are swapped in the animated scene: mirroring transforms do that.
    pub is_flipped: bool,
}

impl PosedScene {
    /// Whether every triangle corresponds to the one of the same index at rest.
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
    /// The numbers of its triangles in the primitive, ascending; `None` if it has them all.
    triangles: Option<Vec<u32>>,
}

impl RestParts {
    /// The parts of a scene with their origins in the file.
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

    /// For each triangle of an animated scene, the triangle at rest. `None` if a part has more triangles than its
    /// primitive.
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
