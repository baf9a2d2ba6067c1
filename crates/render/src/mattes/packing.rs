//! Deciding which things are drawn together: things whose light never lands in the same tile of the picture may share a color.

use std::ops::Range;

/// Side of a tile, px.
const TILE_PX: u32 = 32;

/// Marks a tile or thing without owner or color.
const NO_OWNER: u32 = u32::MAX;

/// For each thing, the tiles of a picture where its light may land.
pub(crate) struct Footprints {
    /// Columns and rows of tiles.
    tiles: [u32; 2],
    /// For each thing, one bit per tile.
    of_things: Vec<Vec<u64>>,
}

/// A graph coloring of things.
pub(crate) struct Packing {
    columns: u32,
    color_of_thing: Vec<u32>,
    /// For each color, the thing of that color in each tile.
    owners: Vec<Vec<u32>>,
}

impl Footprints {
    /// Empty footprints of this number of things, in a picture of this width and height, px.
    pub fn empty(things: usize, size: [u32; 2]) -> Self {
        let tiles = size.map(|side| side.div_ceil(TILE_PX));
        let words = (tiles[0] * tiles[1]).div_ceil(64) as usize;
        Self { tiles, of_things: vec![vec![0; words]; things] }
    }

    /// Adds the columns and rows of pixels where the light of a thing may land.
    pub fn add(&mut self, thing: u32, window: [Range<u32>; 2]) {
        let [columns, rows] = [0, 1].map(|axis: usize| {
            let range = &window[axis];
            range.start / TILE_PX..range.end.div_ceil(TILE_PX).min(self.tiles[axis])
        });
        let (of_thing, width) = (&mut self.of_things[thing as usize], self.tiles[0]);
        for tile in rows.flat_map(|row| columns.clone().map(move |column| row * width + column)) {
            of_thing[tile as usize / 64] |= 1 << (tile % 64);
        }
    }

    /// Colors the things greedily: the largest first, each with the first color that is free in all its tiles. Things with an empty
    /// footprint have no color.
    pub fn pack(self) -> Packing {
        let area = |thing: &usize| self.of_things[*thing].iter().map(|word| word.count_ones()).sum::<u32>();
        let mut order: Vec<usize> = (0..self.of_things.len()).filter(|thing| area(thing) > 0).collect();
        order.sort_by_key(|thing| std::cmp::Reverse(area(thing)));
        let tiles = (self.tiles[0] * self.tiles[1]) as usize;
        let mut taken: Vec<Vec<u64>> = Vec::new();
        let mut packing = Packing {
            columns: self.tiles[0],
            color_of_thing: vec![NO_OWNER; self.of_things.len()],
            owners: Vec::new(),
        };
        for thing in order {
            let own = &self.of_things[thing];
            let is_free = |taken: &Vec<u64>| taken.iter().zip(own).all(|(taken, own)| taken & own == 0);
            let color = taken.iter().position(is_free).unwrap_or_else(|| {
                taken.push(vec![0; own.len()]);
                packing.owners.push(vec![NO_OWNER; tiles]);
                taken.len() - 1
            });
            packing.color_of_thing[thing] = color as u32;
            taken[color].iter_mut().zip(own).for_each(|(taken, own)| *taken |= own);
            for tile in (0..tiles).filter(|tile| own[tile / 64] >> (tile % 64) & 1 == 1) {
                packing.owners[color][tile] = thing as u32;
            }
        }
        packing
    }
}

impl Packing {
    /// A separate color for each thing, because their light may land anywhere.
    pub fn separate(things: usize, size: [u32; 2]) -> Self {
        let mut footprints = Footprints::empty(things, size);
        (0..things as u32).for_each(|thing| footprints.add(thing, size.map(|side| 0..side)));
        footprints.pack()
    }

    /// The number of colours.
    pub fn colors(&self) -> usize {
        self.owners.len()
    }

    /// The color of a thing; at least [`Self::colors`] if it has none.
    pub fn color_of(&self, thing: u32) -> usize {
        self.color_of_thing[thing as usize] as usize
    }

    /// The thing of a colour whose light may land in the pixel in column `x` and row `y`; `None` if there is none.
    pub fn owner(&self, color: usize, x: usize, y: usize) -> Option<u32> {
        let tile = y / TILE_PX as usize * self.columns as usize + x / TILE_PX as usize;
        Some(self.owners[color][tile]).filter(|owner| *owner != NO_OWNER)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_meets_is_drawn_apart_and_each_pixel_knows_whose_it_is() {
        let mut footprints = Footprints::empty(5, [100, 70]);
        // A wall, a thing on the left and one on the right, one that meets both, and one that is nowhere.
        footprints.add(0, [0..100, 0..70]);
        footprints.add(1, [0..30, 5..20]);
        footprints.add(2, [70..90, 5..20]);
        footprints.add(3, [28..75, 0..10]);
        let packing = footprints.pack();
        let color = |thing| packing.color_of(thing);
        assert_eq!(packing.colors(), 3);
        assert!(color(1) == color(2) && color(3) != color(1) && color(0) != color(3));
        assert!(color(4) >= packing.colors());
        assert_eq!(packing.owner(color(1), 10, 10), Some(1));
        assert_eq!(packing.owner(color(1), 80, 10), Some(2));
        assert_eq!(packing.owner(color(1), 50, 10), None);
        assert_eq!(packing.owner(color(0), 99, 69), Some(0));
        assert_eq!(Packing::separate(4, [100, 70]).colors(), 4);
    }
}
