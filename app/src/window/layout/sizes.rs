//! Panels that can be closed keep their size in points when the window is resized; the views take the rest.

use super::pane::Pane;
use egui_tiles::{Container, LinearDir, Tile, TileId, Tiles, Tree};

/// Width and height for which the shares of the initial layout are made, points.
pub const NOMINAL_SIZE: [f32; 2] = [1280.0, 640.0];

/// Largest share of a row or column for panels of fixed size.
const LARGEST_SHARE: f32 = 0.5;

/// Smaller changes are ignored, points.
const MIN_CHANGE: f32 = 0.5;

/// Adapts the layout to a new `size` of the whole, points, and stores it in `previous_size`.
pub fn fit_to_size(tree: &mut Tree<Pane>, previous_size: &mut [f32; 2], size: [f32; 2]) {
    let growth = [0, 1].map(|axis| size[axis] / previous_size[axis]);
    let has_changed = [0, 1].map(|axis| (size[axis] - previous_size[axis]).abs() > MIN_CHANGE);
    if !(has_changed[0] || has_changed[1]) || size.iter().any(|side| *side < 1.0) {
        return;
    }
    *previous_size = size;
    let ids: Vec<TileId> = tree.tiles.tile_ids().collect();
    for id in ids {
        let Some(Tile::Container(Container::Linear(linear))) = tree.tiles.get(id) else { continue };
        let axis = usize::from(linear.dir == LinearDir::Vertical);
        let is_fixed = |child: &TileId| keeps_size(&tree.tiles, *child);
        let shares = linear.children.iter().map(|child| (linear.shares[*child], is_fixed(child)));
        let new = rescaled(&shares.collect::<Vec<_>>(), growth[axis]);
        if let Some(Tile::Container(Container::Linear(linear))) = tree.tiles.get_mut(id) {
            for (child, share) in linear.children.clone().into_iter().zip(new) {
                linear.shares.set_share(child, share);
            }
        }
    }
}

/// Whether all panels of a tile can be closed.
fn keeps_size(tiles: &Tiles<Pane>, tile: TileId) -> bool {
    match tiles.get(tile) {
        Some(Tile::Pane(pane)) => pane.is_foldable(),
        Some(Tile::Container(container)) => container.children().all(|child| keeps_size(tiles, *child)),
        None => false,
    }
}

/// The shares of a row after it grew: fixed panels get a smaller share, the others a larger one.
fn rescaled(shares: &[(f32, bool)], growth: f32) -> Vec<f32> {
    let total: f32 = shares.iter().map(|(share, _)| share).sum();
    let fixed: f32 = shares.iter().filter(|(_, is_fixed)| *is_fixed).map(|(share, _)| share).sum();
    let rest = total - fixed;
    if fixed <= 0.0 || rest <= 0.0 || growth <= 0.0 {
        return shares.iter().map(|(share, _)| *share).collect();
    }
    let fixed_after = (fixed / total / growth).min(LARGEST_SHARE.max(fixed / total));
    let after = |(share, is_fixed): &(f32, bool)| {
        if *is_fixed { share / fixed * fixed_after } else { share / rest * (1.0 - fixed_after) }
    };
    shares.iter().map(after).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::layout::Layout;

    #[test]
    fn fixed_panels_keep_their_points_and_views_take_the_rest() {
        let before = [(0.5, false), (0.25, false), (0.25, true)];
        let wider = rescaled(&before, 2.0);
        // A row of 1000 points that comes to have 2000.
        let points: Vec<f32> = wider.iter().map(|share| share * 2000.0).collect();
        assert!((points[2] - 250.0).abs() < 1e-3, "{points:?}");
        assert!((points[0] / points[1] - 2.0).abs() < 1e-5);
        let narrow = rescaled(&before, 0.1);
        assert!((narrow[2] - LARGEST_SHARE).abs() < 1e-6, "something is left for the views: {narrow:?}");
        assert_eq!(rescaled(&[(1.0, false), (2.0, false)], 3.0), [1.0, 2.0]);
        assert_eq!(rescaled(&[(1.0, true)], 3.0), [1.0]);
    }

    #[test]
    fn the_inspector_is_as_wide_whatever_the_windows_size() {
        let mut layout = Layout::default();
        let width = |layout: &Layout| {
            let tile = layout.tile_with(Pane::Inspector).unwrap();
            let root = layout.tree.root().and_then(|root| layout.tree.tiles.get_container(root));
            let Some(Container::Linear(linear)) = root else { panic!("a row") };
            let total: f32 = linear.children.iter().map(|child| linear.shares[*child]).sum();
            linear.shares[tile] / total * layout.size[0]
        };
        for size in [[1440.0, 800.0], [800.0, 450.0], [1920.0, 1000.0]] {
            fit_to_size(&mut layout.tree, &mut layout.size, size);
            assert!((width(&layout) - 300.0).abs() < 0.1, "{} at {size:?}", width(&layout));
        }
    }
}
