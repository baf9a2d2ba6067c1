//! Which samples of the light field a patch of paint moves: atlas tile → samples.

use atlas::Atlas;
use glam::DVec2;
use salf::{Address, Salf};
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

/// Side of a tile, texels: a tile's texels are the bits of a u64.
const TILE: u32 = 8;

/// The samples of a light field by where in the atlas they lie. Those of carried light, which most paint does not move, are
/// sorted when they are asked for first.
pub(crate) struct SampleIndex {
    salf: Arc<Salf>,
    atlas: Arc<Atlas>,
    own: Arc<Tiles>,
    carried: OnceLock<Tiles>,
    /// The memory of the samples, bytes.
    sample_bytes: usize,
}

impl SampleIndex {
    /// The index of the samples of `salf` by the texels of `atlas`.
    pub fn new(salf: Arc<Salf>, atlas: Arc<Atlas>) -> Self {
        let own = Arc::new(Tiles::from_samples(&salf, &atlas, |address| !address.is_carried));
        let sample_bytes = salf.statistics().bytes;
        Self { salf, atlas, own, carried: OnceLock::new(), sample_bytes }
    }

    /// The index of `salf`, whose samples are at the same places.
    pub fn of_same_places(&self, salf: Arc<Salf>) -> Self {
        let (atlas, own) = (self.atlas.clone(), self.own.clone());
        Self { salf, atlas, own, carried: OnceLock::new(), sample_bytes: self.sample_bytes }
    }

    /// The memory that it takes with the samples, in bytes.
    pub fn bytes_with_samples(&self) -> usize {
        self.sample_bytes + self.own.bytes() + self.carried.get().map_or(0, Tiles::bytes)
    }

    /// The samples of own light whose bilinear lookup may read one of `texels` (column and row), each once, in no order.
    pub fn samples_reading(&self, texels: &[[u32; 2]]) -> Vec<u32> {
        self.own.samples_reading(texels)
    }

    /// The numbers of the samples of carried light on these texels (column, row).
    pub fn carried_reading(&self, texels: &[[u32; 2]]) -> Vec<u32> {
        let carried = self
            .carried
            .get_or_init(|| Tiles::from_samples(&self.salf, &self.atlas, |address| address.is_carried));
        carried.samples_reading(texels)
    }
}

/// The samples of every tile of the atlas, with where they lie.
struct Tiles {
    tiles_across: u32,
    /// Where each tile's entries start; one more than there are tiles.
    starts: Vec<u32>,
    /// Sample, and the bit of its texel within the tile; tile by tile.
    entries: Vec<(u32, u8)>,
    size: [u32; 2],
}

impl Tiles {
    fn bytes(&self) -> usize {
        size_of_val(&*self.starts) + size_of_val(&*self.entries)
    }

    /// Sorts the samples of `salf` that `wanted` chooses into the tiles of `atlas`.
    fn from_samples(salf: &Salf, atlas: &Atlas, selects: impl Fn(&Address) -> bool) -> Self {
        let mut addresses = salf.samples.addresses();
        let count = salf.samples.len() as u32;
        let positions = (0..count).map(|index| {
            let address = addresses.get(index);
            Some(atlas.position_of(address.surface.filter(|_| selects(&address))?))
        });
        Self::from_positions([atlas.width, atlas.height], positions)
    }

    /// Sorts samples by their positions in texel coordinates; those without one are never found.
    fn from_positions(size: [u32; 2], positions: impl Iterator<Item = Option<DVec2>>) -> Self {
        let [across, down] = size.map(|side| side.div_ceil(TILE).max(1));
        let placed = positions.enumerate().filter_map(|(index, position)| {
            let texel =
                |k: usize| (position.map(|p| p[k].max(0.0) as u32)).map(|t| t.min(size[k].max(1) - 1));
            let (tile, bit) = tile_and_bit(texel(0)?, texel(1)?, across);
            Some((tile, index as u32, bit))
        });
        let placed: Vec<_> = placed.collect();
        let mut starts = vec![0u32; (across * down) as usize + 1];
        for (tile, ..) in &placed {
            starts[*tile as usize + 1] += 1;
        }
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        let mut next = starts.clone();
        let mut entries = vec![(0, 0); placed.len()];
        for (tile, index, bit) in placed {
            entries[next[tile as usize] as usize] = (index, bit);
            next[tile as usize] += 1;
        }
        Self { tiles_across: across, starts, entries, size }
    }

    /// A lookup at p reads the texels whose centres lie within 1 of p in x and y: p's own and its neighbours.
    fn samples_reading(&self, texels: &[[u32; 2]]) -> Vec<u32> {
        // A dab's texels come tile by tile.
        let mut own: HashMap<u32, u64> = HashMap::new();
        let mut last = (u32::MAX, 0);
        for &[x, y] in texels {
            let (tile, bit) = tile_and_bit(x, y, self.tiles_across);
            if tile != last.0 {
                *own.entry(last.0).or_default() |= last.1;
                last = (tile, 0);
            }
            last.1 |= 1 << bit;
        }
        *own.entry(last.0).or_default() |= last.1;
        own.remove(&u32::MAX);
        let read = self.with_neighbours(&own);
        let mut samples = Vec::new();
        for (tile, bits) in read {
            let entries = self.starts[tile as usize] as usize..self.starts[tile as usize + 1] as usize;
            let matches = self.entries[entries].iter().filter(|(_, bit)| bits >> bit & 1 == 1);
            samples.extend(matches.map(|(sample, _)| sample));
        }
        samples
    }
}

impl Tiles {
    /// The same texels, and all that touch one of them.
    fn with_neighbours(&self, own: &HashMap<u32, u64>) -> HashMap<u32, u64> {
        let [across, down] = self.size.map(|side| side.div_ceil(TILE).max(1));
        let mut read: HashMap<u32, u64> = HashMap::with_capacity(own.len() + own.len() / 2);
        for (&tile, &bits) in own {
            // Wider within the tile, and what of that goes over into the tiles on its left and right.
            let wide = bits | (bits & !LAST_COLUMN) << 1 | (bits & !FIRST_COLUMN) >> 1;
            let left = (bits & FIRST_COLUMN) << (TILE - 1);
            let right = (bits & LAST_COLUMN) >> (TILE - 1);
            let [column, row] = [tile % across, tile / across];
            for (step, bits) in [(-1, left), (0, wide), (1, right)] {
                let Some(column) = column.checked_add_signed(step).filter(|column| *column < across) else {
                    continue;
                };
                let high = bits | bits << TILE | bits >> TILE;
                let (above, below) = (bits << (TILE * (TILE - 1)), bits >> (TILE * (TILE - 1)));
                for (step, bits) in [(-1, above), (0, high), (1, below)] {
                    let row = row.checked_add_signed(step).filter(|row| *row < down && bits != 0);
                    if let Some(row) = row {
                        *read.entry(row * across + column).or_default() |= bits;
                    }
                }
            }
        }
        read
    }
}

/// The texels of a tile's first and last columns.
const FIRST_COLUMN: u64 = 0x0101_0101_0101_0101;
const LAST_COLUMN: u64 = FIRST_COLUMN << (TILE - 1);

/// The tile of a texel, and its bit in it.
fn tile_and_bit(x: u32, y: u32, tiles_across: u32) -> (u32, u8) {
    (y / TILE * tiles_across + x / TILE, (y % TILE * TILE + x % TILE) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_texel_moves_exactly_the_samples_that_read_it() {
        let position = |k: u32| DVec2::new((k % 40) as f64 * 0.5 + 0.1, (k / 40) as f64 * 0.5 + 0.3);
        let index = Tiles::from_positions([20, 20], (0..1600).map(|k| Some(position(k))));
        let texel = [8, 7];
        let expected: Vec<u32> = (0..1600)
            .filter(|&k| {
                let from_centre = position(k) - DVec2::new(8.5, 7.5);
                from_centre.abs().max_element() < 1.0
            })
            .collect();
        let samples = index.samples_reading(&[texel, texel]);
        assert!(expected.iter().all(|sample| samples.contains(sample)), "none is missed");
        assert!(samples.len() <= 36, "and few are found in vain: {}", samples.len());
        assert!(index.samples_reading(&[]).is_empty());
    }

    #[test]
    fn positions_on_the_border_and_the_background_do_no_harm() {
        let positions = [Some(DVec2::new(20.0, 20.0)), None, Some(DVec2::new(-0.0, 0.0))];
        let index = Tiles::from_positions([20, 20], positions.into_iter());
        assert_eq!(index.samples_reading(&[[19, 19]]), [0]);
        assert_eq!(index.samples_reading(&[[0, 0]]), [2]);
    }
}
