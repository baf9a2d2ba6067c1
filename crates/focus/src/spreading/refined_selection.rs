//! A selection whose outline is moved to the nearest edges of the surface.

use crate::spreading::surface_graph::SurfaceGraph;
use crate::{Canvas, Selection, SelectionResult, SpreadSettings};
use progress::Unwatched;
use spread::{GREATEST_REACH, Graph, SpreadError, WalkerField};

impl Selection {
    /// The selection with its outline moved to edges, by at most `width` texels: what is farther inside stays selected,
    /// what is farther outside does not become so, and each texel between goes to the side that a random walker from it
    /// meets first.
    ///
    /// # Errors
    /// None in practice: there are texels on both sides, or nothing is changed.
    pub fn refined(
        &self,
        graph: &SurfaceGraph,
        canvas: &Canvas,
        width: u32,
    ) -> Result<SelectionResult, SpreadError> {
        let graph = graph.with_contrast(SpreadSettings::default().contrast);
        let is_open = open_band(&graph, |texel| self.contains(texel), width);
        let side = |texel: usize| u8::from(!self.contains(texel));
        let seeds: Vec<_> = (0..graph.nodes())
            .filter(|texel| !is_open[*texel])
            .map(|texel| (texel as u32, side(texel)))
            .collect();
        let has_both_sides = [0, 1].iter().all(|side| seeds.iter().any(|(_, own)| own == side));
        if !has_both_sides {
            return Ok(SelectionResult::Some(self.clone()));
        }
        let field = WalkerField::solve(&graph, &seeds, 2, &Unwatched)?;
        let outcomes = field.at_reach(GREATEST_REACH);
        let is_inside = |texel: usize| {
            let [inside, outside] = [0, 1].map(|side| outcomes.probability(texel, side));
            if inside == outside { self.contains(texel) } else { inside > outside }
        };
        Ok(Self::from_indices(canvas, is_inside))
    }
}

/// Which nodes are within `width` links of the border between those that are selected and the others.
fn open_band(graph: &Graph, is_selected: impl Fn(usize) -> bool, width: u32) -> Vec<bool> {
    let mut is_open = vec![false; graph.nodes()];
    let is_on_border = |node: &usize| {
        graph.neighbours_of(*node).any(|(neighbour, _)| is_selected(neighbour) != is_selected(*node))
    };
    let mut rim: Vec<usize> = (0..graph.nodes()).filter(is_on_border).collect();
    for _ in 0..width {
        rim.iter().for_each(|node| is_open[*node] = true);
        let next = rim.iter().flat_map(|node| graph.neighbours_of(*node)).map(|(neighbour, _)| neighbour);
        let mut next: Vec<usize> = next.filter(|node| !is_open[*node]).collect();
        next.sort_unstable();
        next.dedup();
        rim = next;
    }
    is_open
}
