//! The layout of tiles, and splitting a tile into pieces.

use splat::Crop;
use std::str::FromStr;

/// A grid of tiles.
///
/// ```
/// let grid: render::TileGrid = "4x2".parse()?;
/// let tiles = grid.tiles([1920, 1080])?;
/// assert_eq!((tiles.len(), tiles[0].corner), (8, [0, 0]));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TileGrid {
    /// Number of columns.
    pub columns: u32,
    /// Number of rows.
    pub rows: u32,
}

impl TileGrid {
    /// Maximum number of columns, and of rows.
    const MAX_SIDE: u32 = 512;

    /// The number of tiles.
    pub fn count(self) -> u32 {
        self.columns * self.rows
    }

    /// The tiles of a picture of this width and height in pixels, row by row. Tiles begin and end on block boundaries and have about equal
    /// numbers of blocks.
    ///
    /// # Errors
    /// The picture is too small for that many tiles.
    pub fn tiles(self, [width, height]: [u32; 2]) -> Result<Vec<Crop>, String> {
        let sides = |size: u32, count: u32, what: &str| {
            let blocks = size.div_ceil(Crop::ALIGNMENT);
            if count > blocks {
                let block = Crop::ALIGNMENT;
                return Err(format!(
                    "{size} px allow at most {blocks} {what} of tiles (tiles are made of blocks of {block} px)"
                ));
            }
            let start = |index: u32| (index * blocks / count * Crop::ALIGNMENT).min(size);
            Ok((0..count).map(|index| (start(index), start(index + 1) - start(index))).collect::<Vec<_>>())
        };
        let (columns, rows) = (sides(width, self.columns, "columns")?, sides(height, self.rows, "rows")?);
        let of_row = |&(y, height): &(u32, u32)| {
            columns.iter().map(move |&(x, width)| Crop { corner: [x, y], size: [width, height] })
        };
        Ok(rows.iter().flat_map(of_row).collect())
    }
}

impl FromStr for TileGrid {
    type Err = String;

    /// Parses `CxR`, columns × rows.
    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once(['x', 'X', '×']);
        let parts = parts.and_then(|(c, r)| Some((c.trim().parse().ok()?, r.trim().parse().ok()?)));
        let valid = 1..=Self::MAX_SIDE;
        match parts {
            Some((columns, rows)) if valid.contains(&columns) && valid.contains(&rows) => {
                Ok(Self { columns, rows })
            }
            _ => Err(format!("expected CxR with columns and rows from 1 to {}, as in 4x4", Self::MAX_SIDE)),
        }
    }
}

/// Splits a tile by repeated halving into pieces of at most `max_px` pixels (but at least one block), on block boundaries.
pub(crate) fn split_into_pieces(tile: Crop, max_px: u64) -> Vec<Crop> {
    let [width, height] = tile.size;
    let longer = usize::from(height > width);
    let blocks = tile.size[longer].div_ceil(Crop::ALIGNMENT);
    if u64::from(width) * u64::from(height) <= max_px || blocks < 2 {
        return vec![tile];
    }
    let (mut first, mut second) = (tile, tile);
    first.size[longer] = blocks / 2 * Crop::ALIGNMENT;
    second.corner[longer] += first.size[longer];
    second.size[longer] -= first.size[longer];
    [first, second].into_iter().flat_map(|half| split_into_pieces(half, max_px)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covers(parts: &[Crop], whole: Crop) {
        let area = |crop: &Crop| u64::from(crop.size[0]) * u64::from(crop.size[1]);
        assert_eq!(parts.iter().map(area).sum::<u64>(), area(&whole));
        for crop in parts {
            for axis in 0..2 {
                assert!(crop.size[axis] > 0 && crop.corner[axis].is_multiple_of(Crop::ALIGNMENT));
                let end = crop.corner[axis] + crop.size[axis];
                let last = whole.corner[axis] + whole.size[axis];
                assert!(end.is_multiple_of(Crop::ALIGNMENT) || end == last, "{crop:?}");
            }
        }
    }

    #[test]
    fn tiles_cover_the_picture_once() {
        for (grid, size) in [("4x4", [8192, 4608]), ("3x2", [100, 70]), ("1x1", [1, 1]), ("4x3", [97, 65])] {
            let grid: TileGrid = grid.parse().unwrap();
            let tiles = grid.tiles(size).unwrap();
            assert_eq!(tiles.len() as u32, grid.count());
            covers(&tiles, Crop { corner: [0, 0], size });
        }
        let error = "5x1".parse::<TileGrid>().unwrap().tiles([128, 128]).unwrap_err();
        assert!(error.contains("at most 4 columns"), "{error}");
        for wrong in ["4", "0x4", "4x0", "axb", "4x4x4", "-1x2", "513x1"] {
            assert!(wrong.parse::<TileGrid>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn pieces_cover_the_tile_once() {
        let tile = Crop { corner: [2048, 1152], size: [2048, 1147] };
        for most in [u64::MAX, 1 << 20, 5000, 1] {
            let pieces = split_into_pieces(tile, most);
            covers(&pieces, tile);
            let blocks = u64::from(Crop::ALIGNMENT.pow(2));
            let area = |crop: &Crop| u64::from(crop.size[0]) * u64::from(crop.size[1]);
            assert!(pieces.iter().all(|piece| area(piece) <= most.max(blocks)));
        }
    }
}
