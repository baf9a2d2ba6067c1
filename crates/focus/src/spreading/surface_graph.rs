//! The surface as a graph: its texels, linked as strongly as they look alike.

use crate::Canvas;
use crate::spreading::surface_links::SurfaceLinks;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use spread::{Affinity, Graph, NodeAppearance, tolerances_from};

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
            (a, b, (link.conductance * affinity.between(from, to)).max(spread::LEAST_AFFINITY))
        });
        Graph::new(self.texels(), &weighted.collect::<Vec<_>>())
    }
}
