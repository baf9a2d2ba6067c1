//! One focus offset for each texel of the atlas and, for a layer, its mask.

mod changed_texels;
mod edit;
mod edit_thumbnail;
pub(crate) mod focus_image;
pub(crate) mod tile_grid;

pub use changed_texels::{ChangedTexels, rectangle_union};
pub use edit::Edit;
pub use edit_thumbnail::{EditThumbnail, ThumbnailCell};
pub use focus_image::FocusImage;
pub use tile_grid::TILE_SIDE;

use glam::{DVec2, UVec2};
use lens::FocusOffset;
use std::sync::Arc;
use tile_grid::{Tile, TileGrid, is_blank};

/// The painted focus map: t, anchor and gloss over the atlas, and the background's focus. Texels that cover no
/// surface hold dilated values.
///
/// Gloss is seldom painted: where it never was, its tiles are one blank tile shared by all maps.
///
/// The map of a layer may have a *mask*: the weight of each of its texels, in [0, 1]. Without a mask all texels have
/// weight 1.
///
/// The texels lie in tiles that clones share until one of them is written: a clone is a snapshot that costs a pointer
/// per tile, so a renderer may hold one while painting goes on.
#[derive(Clone, Debug, PartialEq)]
pub struct FocusMap {
    pub(crate) texels: TileGrid<[f32; 2]>,
    pub(crate) gloss: TileGrid<f32>,
    pub(crate) mask: Option<TileGrid<f32>>,
    /// The focus of the background (at infinity).
    pub background: FocusOffset,
    /// The mask of the background, in [0, 1]; 1 in a map without a mask.
    pub background_mask: f32,
}

impl FocusMap {
    /// A map of one value, the background included. Width and height must be above 0.
    pub fn new(width: u32, height: u32, value: FocusOffset) -> Self {
        let texels = TileGrid::new(width, height, to_texel(value));
        let gloss = TileGrid::new(width, height, value.gloss as f32).with_blank_tiles();
        Self { texels, gloss, mask: None, background: value, background_mask: 1.0 }
    }

    /// A fully transparent map of `width` × `height` texels: the ordinary lens with a mask of 0 everywhere.
    pub fn transparent(width: u32, height: u32) -> Self {
        let mut map = Self::new(width, height, FocusOffset::STANDARD);
        map.mask = Some(TileGrid::new(width, height, 0.0));
        map.background_mask = 0.0;
        map
    }

    /// A map of these texels, [t, anchor] each and without gloss, row 0 on top. `None` unless there are width ×
    /// height.
    pub fn from_rows(width: u32, height: u32, texels: &[[f32; 2]], background: FocusOffset) -> Option<Self> {
        let texels = TileGrid::from_rows(width, height, texels, to_texel(FocusOffset::STANDARD))?;
        let gloss = TileGrid::blank(width, height);
        Some(Self { texels, gloss, mask: None, background, background_mask: 1.0 })
    }

    /// All texels, [t, anchor] each, row 0 on top. Inverse of [`Self::from_rows`].
    pub fn to_rows(&self) -> Vec<[f32; 2]> {
        self.texels.to_rows()
    }

    /// The gloss of all texels, in [0, 1], row 0 on top; `None` where all of it is 0.
    pub fn gloss_rows(&self) -> Option<Vec<f32>> {
        let is_some = |tile: &Arc<Tile<f32>>| !is_blank(tile) && tile.iter().any(|gloss| *gloss != 0.0);
        self.gloss.tiles().iter().any(is_some).then(|| self.gloss.to_rows())
    }

    /// Sets the gloss of all texels, row 0 on top. Returns false, and changes nothing, unless there are width ×
    /// height values.
    #[must_use]
    pub fn set_gloss_rows(&mut self, gloss: &[f32]) -> bool {
        let [width, height] = self.size();
        let grid = TileGrid::from_rows(width, height, gloss, 0.0).map(TileGrid::with_blank_tiles);
        grid.map(|grid| self.gloss = grid).is_some()
    }

    /// Whether gloss obeys the paint anywhere, the background included, or once did. Quick.
    pub fn has_gloss(&self) -> bool {
        self.background.gloss != 0.0 || !self.gloss.is_blank()
    }

    /// The mask of all texels, in [0, 1], row 0 on top; `None` if there is no mask, which counts as 1.
    pub fn mask_rows(&self) -> Option<Vec<f32>> {
        self.mask.as_ref().map(TileGrid::to_rows)
    }

    /// Whether the map has a mask.
    pub fn has_mask(&self) -> bool {
        self.mask.is_some()
    }

    /// Sets the mask, row 0 on top, or removes it. Returns false, and changes nothing, unless there are width ×
    /// height values.
    #[must_use]
    pub fn set_mask_rows(&mut self, mask: Option<&[f32]>) -> bool {
        let [width, height] = self.size();
        match mask.map(|rows| TileGrid::from_rows(width, height, rows, 0.0)) {
            Some(None) => return false,
            Some(Some(mask)) => self.mask = Some(mask),
            None => self.remove_mask(),
        }
        true
    }

    /// Adds a mask of 1 everywhere to a map without one, so that the mask can be painted.
    pub fn add_mask(&mut self) {
        let [width, height] = self.size();
        self.mask.get_or_insert_with(|| TileGrid::new(width, height, 1.0));
    }

    /// Removes the mask: every texel counts fully.
    pub fn remove_mask(&mut self) {
        (self.mask, self.background_mask) = (None, 1.0);
    }

    /// Replaces the mask m by 1 − m at every texel and the background; without a mask it was 1.
    pub fn invert_mask(&mut self) {
        let [width, height] = self.size();
        let inverted: Vec<f32> = match &self.mask {
            Some(mask) => mask.to_rows().into_iter().map(|m| 1.0 - m).collect(),
            None => vec![0.0; width as usize * height as usize],
        };
        self.mask = TileGrid::from_rows(width, height, &inverted, 0.0);
        self.background_mask = 1.0 - self.background_mask;
    }

    /// Adds rows at the bottom, down to a height that is not below the present one: the atlas got rows for another surface. They have the ordinary lens,
    /// and no weight in a map with a mask.
    pub fn extend_rows(&mut self, height: u32) {
        let standard = FocusOffset::STANDARD;
        self.texels.extend_rows(height, to_texel(standard));
        self.gloss.extend_rows(height, standard.gloss as f32);
        self.gloss = std::mem::replace(&mut self.gloss, TileGrid::blank(1, 1)).with_blank_tiles();
        if let Some(mask) = &mut self.mask {
            mask.extend_rows(height, 0.0);
        }
    }

    /// The number of columns of texels, that of the atlas.
    pub fn width(&self) -> u32 {
        self.size()[0]
    }

    /// The number of rows of texels, that of the atlas.
    pub fn height(&self) -> u32 {
        self.size()[1]
    }

    /// Columns and rows of texels.
    pub fn size(&self) -> [u32; 2] {
        self.texels.size()
    }

    /// The focus of the texel in column `x` and row `y`, which must lie in the map.
    pub fn at(&self, x: u32, y: u32) -> FocusOffset {
        let [t, anchor] = self.texel(x, y).map(f64::from);
        FocusOffset { t, anchor, gloss: f64::from(self.gloss_at(x, y)) }
    }

    /// [t, anchor] of the texel in column `x` and row `y`, which must lie in the map.
    pub fn texel(&self, x: u32, y: u32) -> [f32; 2] {
        self.texels.at(x, y)
    }

    /// How far gloss obeys the paint on a texel, in [0, 1]; it must lie in the map.
    pub fn gloss_at(&self, x: u32, y: u32) -> f32 {
        self.gloss.at(x, y)
    }

    /// How much the texel in column `x` and row `y` counts, in [0, 1]; 1 where there is no mask.
    pub fn mask_at(&self, x: u32, y: u32) -> f32 {
        self.mask.as_ref().map_or(1.0, |mask| mask.at(x, y))
    }

    /// Sets [t, anchor] of a texel, which must lie in the map. Copies its tile if a clone shares it.
    pub fn set(&mut self, x: u32, y: u32, value: [f32; 2]) {
        self.texels.set(x, y, value);
    }

    /// Sets how far gloss obeys the paint on a texel, which must lie in the map. Copies its tile if a clone shares
    /// it.
    pub fn set_gloss(&mut self, x: u32, y: u32, gloss: f32) {
        if self.gloss.at(x, y) != gloss {
            self.gloss.set(x, y, gloss);
        }
    }

    /// The value at a position in texel coordinates (x right, y down; texel (i, j) is centred at (i + ½, j + ½)),
    /// bilinear; outside the map its border continues. Between equal texels it is exactly their value.
    pub fn sample(&self, position: DVec2) -> FocusOffset {
        let (corners, share) = self.bilinear_corners(position);
        let [t, anchor] = bilinear(corners.map(|[x, y]| self.texel(x, y)), share);
        let gloss = match self.gloss.is_blank_at(corners.into_iter()) {
            true => 0.0,
            false => bilinear(corners.map(|[x, y]| [self.gloss_at(x, y)]), share)[0],
        };
        FocusOffset { t, anchor, gloss }
    }

    /// The mask at a position, sampled in the same way: the weight of the map as a layer, in [0, 1].
    pub fn sample_mask(&self, position: DVec2) -> f32 {
        let (corners, share) = self.bilinear_corners(position);
        bilinear(corners.map(|[x, y]| [self.mask_at(x, y)]), share)[0] as f32
    }

    /// The four texels around a position, and the position between them, in [0, 1]².
    fn bilinear_corners(&self, position: DVec2) -> ([[u32; 2]; 4], DVec2) {
        let last = UVec2::from(self.size()) - UVec2::ONE;
        let p = (position - DVec2::splat(0.5)).clamp(DVec2::ZERO, last.as_dvec2());
        let low = p.as_uvec2();
        let high = (low + UVec2::ONE).min(last);
        let corners = [[low.x, low.y], [high.x, low.y], [low.x, high.y], [high.x, high.y]];
        (corners, p - low.as_dvec2())
    }

    /// The minimum and maximum of t, anchor and gloss over a box of texels, given by its first and last column and
    /// row; outside the map its border continues.
    pub fn bounds(&self, box_texels: [DVec2; 2]) -> [FocusOffset; 2] {
        let texel_range = |axis: usize, count: u32| {
            let [first, last] = box_texels.map(|corner| corner[axis]);
            let greatest = f64::from(count - 1);
            // Not `clamp`, which keeps NaN: a NaN may stand for any texel.
            let first = if first > 0.0 { first.min(greatest) } else { 0.0 };
            let last = if last < greatest { last.max(0.0) } else { greatest };
            first as u32..=last as u32
        };
        let [width, height] = self.size();
        let columns = texel_range(0, width);
        bounds(texel_range(1, height).flat_map(|y| columns.clone().map(move |x| self.at(x, y))))
    }

    /// Whether one of the maps is a snapshot of the other and neither has been written since. Quick; false if both
    /// were written, even with the same values.
    pub fn shares_tiles_with(&self, other: &Self) -> bool {
        self.size() == other.size()
            && self.background == other.background
            && self.texels.shares_tiles_with(&other.texels)
            && self.gloss.shares_tiles_with(&other.gloss)
    }

    /// Whether all numbers are usable: t finite, anchor, gloss and mask in [0, 1].
    pub fn is_valid(&self) -> bool {
        let unit = 0.0..=1.0;
        let usable = |[t, a]: &[f32; 2]| t.is_finite() && unit.contains(a);
        self.background.is_valid()
            && unit.contains(&self.background_mask)
            && self.texels.tiles().iter().all(|tile| tile.iter().all(usable))
            && self.gloss.tiles().iter().all(|tile| is_blank(tile) || tile.iter().all(|g| unit.contains(g)))
            && self.mask.iter().flat_map(TileGrid::tiles).all(|tile| tile.iter().all(|m| unit.contains(m)))
    }
}

/// The minimum and maximum of t, anchor and gloss over some texels, at least one.
pub(crate) fn bounds(texels: impl Iterator<Item = FocusOffset>) -> [FocusOffset; 2] {
    let all = |number: f64| FocusOffset { t: number, anchor: number, gloss: number };
    let componentwise = |pick: fn(f64, f64) -> f64, a: FocusOffset, b: FocusOffset| FocusOffset {
        t: pick(a.t, b.t),
        anchor: pick(a.anchor, b.anchor),
        gloss: pick(a.gloss, b.gloss),
    };
    texels.fold([all(f64::INFINITY), all(f64::NEG_INFINITY)], |[least, greatest], texel| {
        [componentwise(f64::min, least, texel), componentwise(f64::max, greatest, texel)]
    })
}

/// [t, anchor] of a value, in the map's precision.
pub(crate) fn to_texel(value: FocusOffset) -> [f32; 2] {
    [value.t as f32, value.anchor as f32]
}

/// t, anchor and gloss of a value, in the map's precision.
pub(crate) fn to_numbers(value: FocusOffset) -> [f32; 3] {
    [value.t as f32, value.anchor as f32, value.gloss as f32]
}

/// The bilinear mean of upper left, upper right, lower left and lower right, `f` in [0, 1]². Written as
/// a + (b − a)·f, so that equal corners give exactly their value.
pub(crate) fn bilinear<const N: usize>([a, b, c, d]: [[f32; N]; 4], f: DVec2) -> [f64; N] {
    let lerp = |a: f64, b: f64, f: f64| a + (b - a) * f;
    std::array::from_fn(|k| {
        let upper = lerp(a[k] as f64, b[k] as f64, f.x);
        let lower = lerp(c[k] as f64, d[k] as f64, f.x);
        lerp(upper, lower, f.y)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_back_and_snapshots_stay() {
        let (w, h) = (130, 70);
        let rows: Vec<_> = (0..w * h).map(|i| [i as f32, (i % 7) as f32 / 7.0]).collect();
        let mut map = FocusMap::from_rows(w, h, &rows, FocusOffset::SHARP).unwrap();
        assert_eq!(map.to_rows(), rows);
        assert!(FocusMap::from_rows(w, h, &rows[1..], FocusOffset::SHARP).is_none());
        let snapshot = map.clone();
        map.set(129, 69, [5.0, 0.5]);
        assert_eq!(map.at(129, 69), FocusOffset::new(5.0, 0.5));
        assert_eq!(snapshot.to_rows(), rows);
        assert_ne!(map, snapshot);
        let shared =
            map.texels.tiles().iter().zip(snapshot.texels.tiles()).filter(|(a, b)| Arc::ptr_eq(a, b));
        assert_eq!(shared.count(), 3 * 2 - 1);
        assert!(map.shares_tiles_with(&map.clone()) && !map.shares_tiles_with(&snapshot));
    }

    #[test]
    fn bounds_hold_the_texels_of_a_box() {
        let mut map = FocusMap::new(100, 80, FocusOffset::STANDARD);
        map.set(70, 40, [3.0, 0.5]);
        let bounds =
            |x0: f64, y0: f64, x1: f64, y1: f64| map.bounds([DVec2::new(x0, y0), DVec2::new(x1, y1)]);
        assert_eq!(bounds(0.0, 0.0, 69.0, 79.0), [FocusOffset::STANDARD; 2]);
        assert_eq!(bounds(70.0, 40.0, 70.0, 40.0), [FocusOffset::new(3.0, 0.5); 2]);
        let all = [FocusOffset::new(1.0, 0.0), FocusOffset::new(3.0, 0.5)];
        assert_eq!(bounds(-5.0, -1e300, 1e9, f64::INFINITY), all);
        assert_eq!(bounds(f64::NAN, f64::NAN, f64::NAN, f64::NAN), all);
        assert_eq!(bounds(200.0, 40.0, 300.0, 40.0), [FocusOffset::STANDARD; 2]);
    }

    #[test]
    fn equal_texels_interpolate_to_exactly_their_value() {
        let standard = FocusMap::new(64, 64, FocusOffset::STANDARD);
        let odd = FocusMap::new(64, 64, FocusOffset::new(0.1, 0.3));
        for k in 0..1000 {
            let p = DVec2::new(k as f64 * 0.0713 - 2.0, k as f64 * 0.0377 + 30.0);
            assert_eq!(standard.sample(p), FocusOffset::STANDARD);
            assert_eq!(odd.sample(p), odd.at(0, 0));
        }
    }

    #[test]
    fn a_sample_lies_between_its_texels() {
        let mut map = FocusMap::new(4, 4, FocusOffset::STANDARD);
        map.set(2, 1, [3.0, 1.0]);
        assert_eq!(map.sample(DVec2::new(2.5, 1.5)), FocusOffset::new(3.0, 1.0));
        assert_eq!(map.sample(DVec2::new(2.25, 1.5)), FocusOffset::new(2.5, 0.75));
        assert_eq!(map.sample(DVec2::new(3.0, 2.0)), FocusOffset::new(1.5, 0.25));
    }
}
