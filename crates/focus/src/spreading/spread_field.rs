//! The strokes of a layer, spread: values and mask of every texel, at any reach.

use crate::spreading::surface_graph::SurfaceGraph;
use crate::{Canvas, ChangedTexels, FocusMap, SpreadLabels, SpreadSettings};
use lens::FocusOffset;
use progress::Progress;
use rayon::prelude::*;
use spread::{MAX_LABELS, SpreadError, WalkerField};

/// The strokes of a layer, solved for: [`Self::write`] is quick at any reach and softness.
#[derive(Clone, Debug, PartialEq)]
pub struct SpreadField {
    /// [t, anchor, gloss] of each label; `None` keeps out.
    values: Vec<Option<[f32; 3]>>,
    walkers: WalkerField,
}

/// Texels that one thread computes at once.
const TEXELS_PER_TASK: usize = 1 << 14;

impl SpreadField {
    /// Solves for the strokes of a layer at every reach, where a difference of colour of `contrast` counts as an edge.
    ///
    /// # Errors
    /// Nothing is painted, or `progress` was cancelled.
    pub fn solve(
        graph: &SurfaceGraph,
        labels: &SpreadLabels,
        contrast: f64,
        progress: &dyn Progress,
    ) -> Result<Self, SpreadError> {
        let graph = graph.with_contrast(contrast);
        let walkers = WalkerField::solve(&graph, labels.seeds(), labels.values().len(), progress)?;
        Ok(Self { values: labels.values().to_vec(), walkers })
    }

    /// The same for one reach only, with the same bits: a quarter of the work.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solve_at_reach(
        graph: &SurfaceGraph,
        labels: &SpreadLabels,
        settings: &SpreadSettings,
        progress: &dyn Progress,
    ) -> Result<Self, SpreadError> {
        let graph = graph.with_contrast(settings.contrast);
        let (seeds, count) = (labels.seeds(), labels.values().len());
        let walkers = WalkerField::solve_at_reach(&graph, seeds, count, settings.reach, progress)?;
        Ok(Self { values: labels.values().to_vec(), walkers })
    }

    /// Whether [`Self::write`] can follow a reach.
    pub fn is_solved_at(&self, reach: f64) -> bool {
        self.walkers.is_solved_at(reach)
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        self.walkers.bytes()
    }

    /// Writes values and mask at a reach and softness into a map of the canvas's size, which gets a mask if it has
    /// none. Where nothing is spread to, mask is 0 and the value that of the ordinary lens. Returns the texels that
    /// changed.
    ///
    /// # Panics
    /// The reach is not solved for ([`Self::is_solved_at`]).
    pub fn write(&self, canvas: &Canvas, settings: &SpreadSettings, map: &mut FocusMap) -> ChangedTexels {
        map.add_mask();
        let texels = canvas.texels().len().min(self.walkers.nodes());
        let before = &*map;
        let changes: Vec<(usize, [f32; 4])> = (0..texels.div_ceil(TEXELS_PER_TASK))
            .into_par_iter()
            .flat_map_iter(|task| {
                let range = task * TEXELS_PER_TASK..((task + 1) * TEXELS_PER_TASK).min(texels);
                range.filter_map(|index| {
                    let value = self.value(index, settings);
                    (canvas.value(before, index) != value).then_some((index, value))
                })
            })
            .collect();
        let mut changed = Vec::new();
        for (index, value) in changes {
            canvas.write(map, index, value, &mut changed);
        }
        ChangedTexels::new(changed)
    }

    /// [t, anchor, gloss, mask] of a texel.
    fn value(&self, index: usize, settings: &SpreadSettings) -> [f32; 4] {
        const NOTHING: [f32; 4] =
            [FocusOffset::STANDARD.t as f32, FocusOffset::STANDARD.anchor as f32, 0.0, 0.0];
        let outcomes = self.walkers.at_reach(settings.reach);
        if settings.softness <= 0.0 {
            let value = outcomes.winner(index).and_then(|label| self.values[label]);
            return value.map_or(NOTHING, |[t, anchor, gloss]| [t, anchor, gloss, 1.0]);
        }
        let mut weights = [0.0; MAX_LABELS];
        let weights = &mut weights[..self.values.len()];
        outcomes.weights(index, settings.softness as f32, weights);
        let (mut sum, mut mask, mut greatest) = ([0.0; 3], 0.0, (0.0, None));
        for (weight, value) in weights.iter().zip(&self.values) {
            let Some(value) = value else { continue };
            (0..3).for_each(|k| sum[k] += weight * value[k]);
            mask += weight;
            if *weight > greatest.0 {
                greatest = (*weight, Some(*value));
            }
        }
        match greatest {
            // A single label has exactly its own value.
            (weight, Some([t, anchor, gloss])) if weight >= mask => [t, anchor, gloss, mask.min(1.0)],
            (_, Some(_)) => {
                let [t, anchor, gloss] = sum.map(|sum| sum / mask);
                [t, anchor.clamp(0.0, 1.0), gloss.clamp(0.0, 1.0), mask.min(1.0)]
            }
            (_, None) => NOTHING,
        }
    }
}
