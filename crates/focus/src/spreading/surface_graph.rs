//! The surface as a graph: its texels, linked as strongly as they look alike.

use crate::Canvas;
use crate::spreading::surface_links::SurfaceLinks;
use glam::{DVec3, Vec3};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use spread::{Affinity, Graph, NodeAppearance, tolerances_from};

/// What makes two texels alike, for a contiguous selection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Likeness {
    /// Their colour: the difference of the clicked texel's and another's, as a fraction of that from black to white.
    #[default]
    Color,
    /// Their direction: the angle between the normals, as a fraction of 180°.
    Normal,
    /// Their depth along an axis (unit vector, world), as a fraction of the longest extent of the surface.
    Depth(DVec3),
    /// Their part: 0 within one, 1 elsewhere.
    Part,
}

/// The texels of a canvas, their neighbours, and what they look like. It depends on the surface alone, not on a camera.
#[derive(Clone, Debug)]
pub struct SurfaceGraph {
    links: SurfaceLinks,
    appearances: Vec<NodeAppearance>,
}

impl SurfaceGraph {
    /// The graph of a canvas whose texels have these colours, in the canvas's order and encoded by sRGB's curve.
    /// Missing colours are black. Takes about a second for a million texels.
    ///
    /// # Errors
    /// `progress` was cancelled.
    pub fn new(canvas: &Canvas, colors: &[[f32; 3]], progress: &dyn Progress) -> Result<Self, Cancelled> {
        let links = SurfaceLinks::new(canvas, progress)?;
        let appearance = |(index, texel): (usize, crate::CanvasTexel)| NodeAppearance {
            color: colors.get(index).copied().unwrap_or_default(),
            normal: texel.normal.to_array(),
        };
        Ok(Self { links, appearances: canvas.par_texels().enumerate().map(appearance).collect() })
    }

    /// The number of texels.
    pub fn texels(&self) -> usize {
        self.appearances.len()
    }

    /// The graph with a conductance for each link, where a difference of colour of `contrast` counts as an edge.
    pub fn with_contrast(&self, contrast: f64) -> Graph {
        let affinity = Affinity { color_scale: contrast as f32, ..Affinity::default() };
        let weighted = self.links.links.par_iter().map(|link| {
            let [a, b] = link.texels;
            let [from, to] = link.texels.map(|texel| &self.appearances[texel as usize]);
            (a, b, link.conductance * affinity.between(from, to))
        });
        Graph::new(self.texels(), &weighted.collect::<Vec<_>>())
    }

    /// The least tolerance, in [0, 1], at which each texel is selected when the one of index `start` is clicked: texels
    /// that touch are selected one after the other, as long as each is as much like the clicked one as the tolerance
    /// demands. Infinite where nothing touches.
    pub fn tolerances(&self, canvas: &Canvas, start: usize, likeness: Likeness) -> Vec<f32> {
        let touching = self.links.links[..self.links.touching].iter();
        let pairs: Vec<_> = touching.map(|link| (link.texels[0], link.texels[1], 1.0)).collect();
        let graph = Graph::new(self.texels(), &pairs);
        if start >= self.texels() {
            return vec![f32::INFINITY; self.texels()];
        }
        let clicked = self.appearances[start];
        let (from, part) = (canvas.texel(start).position, canvas.texel(start).part);
        let extent = canvas.extent();
        let dissimilarity = |index: usize| match likeness {
            Likeness::Color => {
                let [a, b] = [clicked.color, self.appearances[index].color].map(Vec3::from_array);
                a.distance(b) / 3f32.sqrt()
            }
            Likeness::Normal => {
                let [a, b] = [clicked.normal, self.appearances[index].normal].map(Vec3::from_array);
                a.dot(b).clamp(-1.0, 1.0).acos() / std::f32::consts::PI
            }
            Likeness::Depth(axis) => {
                let depth = axis.dot(canvas.texel(index).position - from).abs();
                if depth > 0.0 { (depth / extent) as f32 } else { 0.0 }
            }
            Likeness::Part => f32::from(u8::from(canvas.texel(index).part != part)),
        };
        tolerances_from(&graph, start, dissimilarity)
    }
}
