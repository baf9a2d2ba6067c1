//! The size of patches by part: a small part beside a large one has patches of its own size.

/// The side of the lattice cells of each part: that of the whole scene, halved as often as the part needs.
#[derive(Debug)]
pub(super) struct PatchSizes {
    /// Side of the cells of level 0, scene units.
    coarsest: f64,
    /// By part: how often it is halved.
    levels: Vec<u8>,
    /// By part: its lit area, square scene units.
    areas: Vec<f64>,
}

/// Number of patches that a part has at least, if the scene's patches suffice for it.
const MIN_PATCHES_OF_PART: f64 = 64.0;

/// Share of the scene's patches that parts get for being small.
const SHARE_FOR_SMALL_PARTS: f64 = 0.5;

/// The most that a part is finer than the coarsest: 1 : 4096.
const MAX_LEVEL: u8 = 12;

impl PatchSizes {
    /// The sizes for parts of these lit areas (square scene units; 0 if unlit), with cells of side `coarsest` for parts large
    /// enough, in a scene of about `target_count` patches.
    pub fn new(coarsest: f64, part_areas: &[f64], target_count: u32) -> Self {
        let is_lit = |area: &f64| *area > 0.0 && area.is_finite();
        let lit_parts = part_areas.iter().filter(|area| is_lit(area)).count().max(1);
        // A level too many, as rounding up takes, has four times the patches.
        let affordable = SHARE_FOR_SMALL_PARTS / 4.0 * f64::from(target_count) / lit_parts as f64;
        let min_patches = MIN_PATCHES_OF_PART.min(affordable);
        let level = |area: &f64| {
            let finest = (area / min_patches).sqrt();
            let halvings = (coarsest / finest).log2().ceil();
            // As integers saturate; NaN for what is unlit.
            if is_lit(area) { (halvings as u8).min(MAX_LEVEL) } else { 0 }
        };
        Self { coarsest, levels: part_areas.iter().map(level).collect(), areas: part_areas.to_vec() }
    }

    /// The level of a part's cells: 0 for the coarsest.
    pub fn level(&self, part: u32) -> u8 {
        self.levels[part as usize]
    }

    /// The finest level that a part has.
    pub fn max_level(&self) -> u8 {
        self.levels.iter().copied().max().unwrap_or(0)
    }

    /// The side of a level's cells, scene units.
    pub fn of_level(&self, level: u8) -> f64 {
        self.coarsest * 0.5_f64.powi(i32::from(level))
    }

    /// How many cells a part's lit area would fill.
    pub fn cells_of_part(&self, part: u32) -> f64 {
        self.areas[part as usize] / self.of_part(part).powi(2)
    }

    /// The side of a part's cells, scene units.
    pub fn of_part(&self, part: u32) -> f64 {
        self.of_level(self.level(part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_parts_get_their_patches_and_large_ones_stay() {
        // 100 × 100 beside 1 × 1, a speck, and a part that is not lit.
        let areas = [1e4, 1.0, 1e-12, 0.0];
        let coarsest = (1e4_f64 / 10_000.0).sqrt();
        let sizes = PatchSizes::new(coarsest, &areas, 10_000);
        assert_eq!((sizes.level(0), sizes.level(2), sizes.level(3)), (0, MAX_LEVEL, 0));
        let patches = areas[1] / sizes.of_part(1).powi(2);
        assert!((MIN_PATCHES_OF_PART..=4.0 * MIN_PATCHES_OF_PART).contains(&patches), "{patches}");
        assert_eq!(sizes.of_part(0), coarsest);
    }

    #[test]
    fn many_small_parts_do_not_exceed_their_share() {
        let areas = vec![1.0; 100_000];
        let sizes = PatchSizes::new(100.0, &areas, 24_000);
        let patches: f64 = (0..100_000).map(|part| 1.0 / sizes.of_part(part).powi(2)).sum();
        assert!(patches <= SHARE_FOR_SMALL_PARTS * 24_000.0 + 1.0, "{patches}");
    }
}
