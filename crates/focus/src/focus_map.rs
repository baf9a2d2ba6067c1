//! A focus offset a texel of the atlas.

use glam::DVec2;
use lens::FocusOffset;
use std::sync::Arc;

/// Rows and columns of a tile: the unit of copying, of undo and of comparing.
pub const TILE_SIDE: u32 = 64;

/// Texels of a tile.
pub(crate) const TILE_TEXELS: usize = (TILE_SIDE * TILE_SIDE) as usize;

/// A square of texels, [t, anchor] each, row by row. Tiles at the right and lower border hang over.
pub(crate) type Tile = [[f32; 2]; TILE_TEXELS];

/// The painted focus map: t and anchor over the atlas, and the background's focus. Texels that no surface
/// covers hold dilated values.
///
/// The texels lie in tiles that clones share until one of them is written: a clone is a snapshot that costs
/// a pointer a tile, so a renderer may hold one while painting goes on.
#[derive(Clone, Debug)]
pub struct FocusMap {
    width: u32,
    height: u32,
    tiles: Vec<Arc<Tile>>,
    /// The focus of what lies at infinity.
    pub background: FocusOffset,
}

impl FocusMap {
    /// A map of one value, the background included. Both sides must be above 0.
    pub fn new(width: u32, height: u32, value: FocusOffset) -> Self {
        let tile = Arc::new([texel_of(value); TILE_TEXELS]);
        let tiles = width.div_ceil(TILE_SIDE) as usize * height.div_ceil(TILE_SIDE) as usize;
        Self { width, height, tiles: vec![tile; tiles], background: value }
    }

    /// A map of the given texels, [t, anchor] each, row 0 on top. `None` unless there are width × height.
    pub fn from_rows(width: u32, height: u32, texels: &[[f32; 2]], background: FocusOffset) -> Option<Self> {
        if texels.len() as u64 != width as u64 * height as u64 {
            return None;
        }
        let tiles_across = width.div_ceil(TILE_SIDE);
        let tile_count = tiles_across * height.div_ceil(TILE_SIDE);
        let tiles = (0..tile_count).map(|index| {
            let [x0, y0] = [index % tiles_across * TILE_SIDE, index / tiles_across * TILE_SIDE];
            let mut tile = [texel_of(FocusOffset::STANDARD); TILE_TEXELS];
            for y in y0..(y0 + TILE_SIDE).min(height) {
                let columns = (x0 + TILE_SIDE).min(width) - x0;
                let from = y as usize * width as usize + x0 as usize;
                let to = ((y - y0) * TILE_SIDE) as usize;
                tile[to..to + columns as usize].copy_from_slice(&texels[from..from + columns as usize]);
            }
            Arc::new(tile)
        });
        Some(Self { width, height, tiles: tiles.collect(), background })
    }

    /// All texels, [t, anchor] each, row 0 on top. Inverse of [`Self::from_rows`].
    pub fn to_rows(&self) -> Vec<[f32; 2]> {
        let mut rows = Vec::with_capacity(self.width as usize * self.height as usize);
        for y in 0..self.height {
            rows.extend((0..self.width).map(|x| self.texel(x, y)));
        }
        rows
    }

    /// Columns, the atlas's.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows, the atlas's.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// The value of a texel, which must lie in the map.
    pub fn at(&self, x: u32, y: u32) -> FocusOffset {
        let [t, anchor] = self.texel(x, y);
        FocusOffset { t: t as f64, anchor: anchor as f64 }
    }

    /// [t, anchor] of a texel, which must lie in the map.
    pub fn texel(&self, x: u32, y: u32) -> [f32; 2] {
        let (tile, within) = self.place(x, y);
        self.tiles[tile][within]
    }

    /// Sets [t, anchor] of a texel, which must lie in the map. Copies its tile if a clone shares it.
    pub fn set(&mut self, x: u32, y: u32, value: [f32; 2]) {
        let (tile, within) = self.place(x, y);
        Arc::make_mut(&mut self.tiles[tile])[within] = value;
    }

    /// The value at a position in texel coordinates (x right, y down; texel (i, j) is centred at
    /// (i + ½, j + ½)), bilinear; outside the map its border goes on. Between equal texels it is exactly
    /// their value.
    pub fn sample(&self, position: DVec2) -> FocusOffset {
        let p = position - DVec2::splat(0.5);
        let low = p.floor();
        let f = p - low;
        let clamp = |i: f64, count: u32| i.clamp(0.0, (count - 1) as f64) as u32;
        let [x0, x1] = [low.x, low.x + 1.0].map(|x| clamp(x, self.width));
        let [y0, y1] = [low.y, low.y + 1.0].map(|y| clamp(y, self.height));
        let corners = [self.texel(x0, y0), self.texel(x1, y0), self.texel(x0, y1), self.texel(x1, y1)];
        bilinear(corners, f)
    }

    /// Whether all numbers are usable: t finite and anchor in [0, 1].
    pub fn is_valid(&self) -> bool {
        let usable = |[t, a]: &[f32; 2]| t.is_finite() && (0.0..=1.0).contains(a);
        self.background.is_valid() && self.tiles.iter().all(|tile| tile.iter().all(usable))
    }

    /// The tiles, row by row.
    pub(crate) fn tiles(&self) -> &[Arc<Tile>] {
        &self.tiles
    }

    /// Replaces a tile.
    pub(crate) fn set_tile(&mut self, index: usize, tile: Arc<Tile>) {
        self.tiles[index] = tile;
    }

    /// The map position of a place in a tile, if it lies in the map.
    pub(crate) fn position(&self, tile: usize, within: usize) -> Option<[u32; 2]> {
        let across = self.width.div_ceil(TILE_SIDE);
        let x = tile as u32 % across * TILE_SIDE + within as u32 % TILE_SIDE;
        let y = tile as u32 / across * TILE_SIDE + within as u32 / TILE_SIDE;
        (x < self.width && y < self.height).then_some([x, y])
    }

    /// The tile of a texel, and where in it.
    fn place(&self, x: u32, y: u32) -> (usize, usize) {
        debug_assert!(x < self.width && y < self.height);
        let tile = y / TILE_SIDE * self.width.div_ceil(TILE_SIDE) + x / TILE_SIDE;
        (tile as usize, (y % TILE_SIDE * TILE_SIDE + x % TILE_SIDE) as usize)
    }
}

impl PartialEq for FocusMap {
    /// Same size, background and texels.
    fn eq(&self, other: &Self) -> bool {
        self.size() == other.size()
            && self.background == other.background
            && self.tiles.iter().zip(&other.tiles).enumerate().all(|(tile, (a, b))| {
                let inside = |within: usize| self.position(tile, within).is_some();
                Arc::ptr_eq(a, b) || (0..TILE_TEXELS).all(|k| a[k] == b[k] || !inside(k))
            })
    }
}

/// [t, anchor] of a value, as the map holds it.
pub(crate) fn texel_of(value: FocusOffset) -> [f32; 2] {
    [value.t as f32, value.anchor as f32]
}

/// The bilinear mean of upper left, upper right, lower left and lower right, `f` in [0, 1]². Written as
/// a + (b − a)·f, so that equal corners give exactly their value.
pub(crate) fn bilinear([a, b, c, d]: [[f32; 2]; 4], f: DVec2) -> FocusOffset {
    let lerp = |a: f64, b: f64, f: f64| a + (b - a) * f;
    let channel = |k: usize| {
        let upper = lerp(a[k] as f64, b[k] as f64, f.x);
        let lower = lerp(c[k] as f64, d[k] as f64, f.x);
        lerp(upper, lower, f.y)
    };
    FocusOffset { t: channel(0), anchor: channel(1) }
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
        let shared = map.tiles().iter().zip(snapshot.tiles()).filter(|(a, b)| Arc::ptr_eq(a, b));
        assert_eq!(shared.count(), 3 * 2 - 1);
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
