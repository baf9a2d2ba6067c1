//! The label of least cost, with a fraction of a step, and its lead over others.

use crate::matching::labels::Labels;

/// The label chosen for a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The disparity: the vertex of a parabola through the least cost and its neighbours.
    pub disparity: f32,
    /// How much more the best label costs that is no neighbour (two labels or more away).
    pub lead: i16,
}

/// Chooses a label for a pixel from the costs of all its labels: the cheapest, refined between its neighbours.
pub fn choose(costs: &[i16], labels: &Labels) -> Choice {
    let (mut best, mut least) = (0, i16::MAX);
    for (label, &cost) in costs.iter().enumerate() {
        if cost < least {
            (best, least) = (label, cost);
        }
    }
    let others = costs.iter().enumerate().filter(|(label, _)| label.abs_diff(best) > 1);
    let second = others.map(|(_, cost)| *cost).min().unwrap_or(least);
    let mut label = best as f32;
    if best > 0 && best + 1 < costs.len() {
        let (before, after) = (f32::from(costs[best - 1] - least), f32::from(costs[best + 1] - least));
        if before + after > 0.0 {
            label += 0.5 * (before - after) / (before + after);
        }
    }
    Choice { disparity: labels.disparity(label), lead: second - least }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_fitted_between_labels() {
        let labels = Labels { low: -1.0, step: 0.5, count: 6 };
        let costs: Vec<i16> = (0..6).map(|l| (100.0 * (l as f32 - 2.3) * (l as f32 - 2.3)) as i16).collect();
        let choice = choose(&costs, &labels);
        assert!((choice.disparity - labels.disparity(2.3)).abs() < 0.01, "{choice:?}");
        assert_eq!(choice.lead, costs[4] - costs[2]);
        // At the end of the range there is nothing to fit.
        assert_eq!(choose(&[0, 4, 9], &labels).disparity, -1.0);
    }
}
