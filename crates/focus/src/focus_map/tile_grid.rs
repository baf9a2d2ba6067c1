//! One value for each texel, in tiles that clones share until one of them is written.

use std::sync::{Arc, LazyLock};

/// Rows and columns of a tile: the unit of copying, of undo and of comparison.
pub const TILE_SIDE: u32 = 64;

/// Texels of a tile.
pub(crate) const TILE_TEXELS: usize = (TILE_SIDE * TILE_SIDE) as usize;

/// A square of texels, row by row. Tiles at the right and lower border extend beyond it.
pub(crate) type Tile<T> = [T; TILE_TEXELS];

/// One value for each texel. A clone costs a pointer per tile: tiles are copied when written.
#[derive(Clone)]
pub(crate) struct TileGrid<T> {
    width: u32,
    height: u32,
    tiles: Vec<Arc<Tile<T>>>,
}

impl<T: Copy + PartialEq> TileGrid<T> {
    /// A grid of `width` × `height` texels (above 0) that all have one value.
    pub fn new(width: u32, height: u32, value: T) -> Self {
        let tile = Arc::new([value; TILE_TEXELS]);
        Self { width, height, tiles: vec![tile; Self::tile_count(width, height)] }
    }

    fn tile_count(width: u32, height: u32) -> usize {
        width.div_ceil(TILE_SIDE) as usize * height.div_ceil(TILE_SIDE) as usize
    }

    /// A grid of these texels, row 0 on top; texels beyond the border hold `padding`. `None` unless there are width ×
    /// height.
    pub fn from_rows(width: u32, height: u32, texels: &[T], padding: T) -> Option<Self> {
        if texels.len() as u64 != width as u64 * height as u64 {
            return None;
        }
        let tiles_across = width.div_ceil(TILE_SIDE);
        let tile_count = tiles_across * height.div_ceil(TILE_SIDE);
        let tiles = (0..tile_count).map(|index| {
            let [x0, y0] = [index % tiles_across * TILE_SIDE, index / tiles_across * TILE_SIDE];
            let mut tile = [padding; TILE_TEXELS];
            for y in y0..(y0 + TILE_SIDE).min(height) {
                let columns = (x0 + TILE_SIDE).min(width) - x0;
                let from = y as usize * width as usize + x0 as usize;
                let to = ((y - y0) * TILE_SIDE) as usize;
                tile[to..to + columns as usize].copy_from_slice(&texels[from..from + columns as usize]);
            }
            Arc::new(tile)
        });
        Some(Self { width, height, tiles: tiles.collect() })
    }

    /// Adds rows at the bottom, down to a height that is not below the present one, with one value.
    pub fn extend_rows(&mut self, height: u32, value: T) {
        let from = std::mem::replace(&mut self.height, height);
        let tile = Arc::new([value; TILE_TEXELS]);
        self.tiles.resize(Self::tile_count(self.width, height), tile);
        // What the last tiles hold below the rows that there were is of no meaning.
        for y in from..from.next_multiple_of(TILE_SIDE).min(height) {
            (0..self.width).for_each(|x| self.set(x, y, value));
        }
    }

    /// The values of all texels, row by row from the top. Inverse of [`Self::from_rows`].
    pub fn to_rows(&self) -> Vec<T> {
        let mut rows = Vec::with_capacity(self.width as usize * self.height as usize);
        for y in 0..self.height {
            rows.extend((0..self.width).map(|x| self.at(x, y)));
        }
        rows
    }

    /// Columns and rows of texels.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// The value of the texel in column `x` and row `y`, which must lie in the grid.
    pub fn at(&self, x: u32, y: u32) -> T {
        let (tile, within) = self.tile_and_texel(x, y);
        self.tiles[tile][within]
    }

    /// Sets a texel, which must lie in the grid. Copies its tile if a clone shares it.
    pub fn set(&mut self, x: u32, y: u32, value: T) {
        let (tile, within) = self.tile_and_texel(x, y);
        Arc::make_mut(&mut self.tiles[tile])[within] = value;
    }

    /// The tiles, row by row from the top.
    pub fn tiles(&self) -> &[Arc<Tile<T>>] {
        &self.tiles
    }

    /// Whether all tiles are shared in memory with another grid of the same size.
    pub fn shares_tiles_with(&self, other: &Self) -> bool {
        self.tiles.iter().zip(&other.tiles).all(|(a, b)| Arc::ptr_eq(a, b))
    }

    /// Replaces the tile with this index.
    pub fn set_tile(&mut self, index: usize, tile: Arc<Tile<T>>) {
        self.tiles[index] = tile;
    }

    /// Column and row in the grid of texel `texel` of tile `tile`; `None` beyond the grid.
    pub fn position(&self, tile: usize, texel: usize) -> Option<[u32; 2]> {
        let across = self.width.div_ceil(TILE_SIDE);
        let x = tile as u32 % across * TILE_SIDE + texel as u32 % TILE_SIDE;
        let y = tile as u32 / across * TILE_SIDE + texel as u32 / TILE_SIDE;
        (x < self.width && y < self.height).then_some([x, y])
    }

    /// The index of the tile that holds the texel in this column and row.
    pub fn tile_of(&self, [x, y]: [u32; 2]) -> usize {
        self.tile_and_texel(x, y).0
    }

    /// The texels (column, row) of the grid where two tiles of index `index` differ.
    pub fn differing_texels(&self, index: usize, a: &Arc<Tile<T>>, b: &Arc<Tile<T>>) -> Vec<[u32; 2]> {
        if Arc::ptr_eq(a, b) {
            return Vec::new();
        }
        let differing = (0..TILE_TEXELS).filter(|&k| a[k] != b[k]);
        differing.filter_map(|k| self.position(index, k)).collect()
    }

    /// The index of the tile that holds a texel, and the texel's index in it.
    fn tile_and_texel(&self, x: u32, y: u32) -> (usize, usize) {
        debug_assert!(x < self.width && y < self.height);
        let tile = y / TILE_SIDE * self.width.div_ceil(TILE_SIDE) + x / TILE_SIDE;
        (tile as usize, (y % TILE_SIDE * TILE_SIDE + x % TILE_SIDE) as usize)
    }
}

/// The shared tile of zeros: what was never written costs a pointer, by which it is also recognised.
static BLANK: LazyLock<Arc<Tile<f32>>> = LazyLock::new(|| Arc::new([0.0; TILE_TEXELS]));

impl TileGrid<f32> {
    /// A grid of `width` × `height` zeros (both above 0), which share one tile.
    pub fn blank(width: u32, height: u32) -> Self {
        let count = Self::tile_count(width, height);
        Self { width, height, tiles: vec![BLANK.clone(); count] }
    }

    /// The same values, with the shared blank tile wherever a whole tile is 0.
    pub fn with_blank_tiles(mut self) -> Self {
        for tile in self.tiles.iter_mut().filter(|tile| tile.iter().all(|value| *value == 0.0)) {
            *tile = BLANK.clone();
        }
        self
    }

    /// Whether all tiles are the shared blank one, that is, were never written.
    pub fn is_blank(&self) -> bool {
        self.tiles.iter().all(is_blank)
    }

    /// Whether the tiles of all these texels (column, row) are blank.
    pub fn is_blank_at(&self, mut texels: impl Iterator<Item = [u32; 2]>) -> bool {
        texels.all(|texel| is_blank(&self.tiles[self.tile_of(texel)]))
    }
}

/// The shared tile of zeros.
pub(crate) fn blank() -> Arc<Tile<f32>> {
    BLANK.clone()
}

/// Whether a tile is the shared tile of zeros.
pub(crate) fn is_blank(tile: &Arc<Tile<f32>>) -> bool {
    Arc::ptr_eq(tile, &BLANK)
}

impl<T> std::fmt::Debug for TileGrid<T> {
    /// Only its size: there may be a million texels.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} × {} texels", self.width, self.height)
    }
}

impl<T: Copy + PartialEq> PartialEq for TileGrid<T> {
    /// Same size and texels, ignoring what extends beyond the border.
    fn eq(&self, other: &Self) -> bool {
        self.size() == other.size()
            && self.tiles.iter().zip(&other.tiles).enumerate().all(|(tile, (a, b))| {
                let inside = |within: usize| self.position(tile, within).is_some();
                Arc::ptr_eq(a, b) || (0..TILE_TEXELS).all(|k| a[k] == b[k] || !inside(k))
            })
    }
}
