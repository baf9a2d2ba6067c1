//! What of the aperture a point of a surface sees: a shadow ray a cell of the aperture, all of them at once.

use crate::jitter::{Net, jitter};
use crate::sample::Visibility;
use crate::view::View;
use glam::DVec2;
use trace::{PlaceSet, Places, Tracer, Viewpoint};

/// Cells a side for a point of inverse depth `inverse_depth`.
pub fn cells_a_side(view: &View, inverse_depth: f64) -> usize {
    let kappa = view.optics.standard_kappa(inverse_depth);
    if view.optics.circle_of_confusion_px(kappa) <= 2.0 * view.tolerance_px { 8 } else { 16 }
}

/// Where in each cell of the aperture its ray goes through: several patterns, so that neighbours do not share their errors.
pub struct Patterns {
    /// For 8 and for 16 cells a side, row by row.
    of_side: [Vec<Places>; 2],
}

impl Patterns {
    /// How many there are of each.
    const COUNT: usize = 64;

    pub fn new() -> Self {
        let of_side = |side: usize| (0..Self::COUNT).map(|k| Self::pattern(side, k as u32)).collect();
        Self { of_side: [of_side(8), of_side(16)] }
    }

    fn pattern(side: usize, number: u32) -> Places {
        let net = Net::new(side.ilog2(), [number, side as u32]);
        let place = |cell: usize| {
            let (row, column) = (cell / side, cell % side);
            let [u, v] = net.place(row, column);
            DVec2::new(column as f64 + u, row as f64 + v) * (2.0 / side as f64) - 1.0
        };
        Places::new(&(0..side * side).map(place).collect::<Vec<_>>())
    }

    fn of(&self, side: usize, number: usize) -> &Places {
        &self.of_side[usize::from(side == 16)][number % Self::COUNT]
    }
}

/// The cells of the aperture that a point sees: one jittered ray each. `None` if it sees none.
///
/// `is_on_side` tells which aperture points lie on the side of the surface that the point stands for.
pub fn visibility(
    tracer: &Tracer,
    view: &View,
    patterns: &Patterns,
    from: Viewpoint,
    side: usize,
    seed: [u32; 2],
    is_on_side: impl Fn(DVec2) -> bool,
) -> Option<Visibility> {
    let [pick, ..] = jitter(seed[0], seed[1], 0);
    let places = patterns.of(side, (pick * Patterns::COUNT as f64) as usize);
    let hidden = tracer.hidden_places(from, &view.aperture_square(), places);
    let seen = (places.all() - hidden).iter().filter(|&cell| is_on_side(places.at(cell)));
    let seen: PlaceSet = seen.collect();
    let words = &seen.words()[..side * side / 64];
    if words.iter().all(|&word| word == 0) {
        return None;
    }
    if words.iter().all(|&word| word == u64::MAX) {
        return Some(Visibility::Open);
    }
    Some(Visibility::Cells { words: words.into() })
}
