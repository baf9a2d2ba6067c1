//! Where the samples are: in the picture, and in the world.

use glam::{DVec2, DVec3, Vec2};
use lens::Camera;
use salf::Samples;
use std::ops::Range;

/// Side of a tile of the picture, px.
const TILE_PX: f32 = 16.0;

/// Places of the samples that lie on a surface and send light of their own, tile by tile of the picture.
pub struct SamplePlaces {
    /// Of the upper left tile: the picture's margin is sampled, too.
    first_tile: [i32; 2],
    /// Columns and rows of tiles.
    tiles: [usize; 2],
    /// By tile: where its samples begin; one more at the end.
    starts: Vec<u32>,
    places: Vec<SamplePlace>,
}

/// Where a sample is.
#[derive(Clone, Copy, Debug)]
pub struct SamplePlace {
    /// Its number.
    pub sample: u32,
    /// Centre of its footprint, px.
    pub center: Vec2,
    /// 1/z, above 0.
    pub inverse_depth: f32,
}

impl SamplePlace {
    /// Its position in the world.
    pub fn position(&self, camera: &Camera) -> DVec3 {
        world_point(camera, self.center.as_dvec2(), 1.0 / f64::from(self.inverse_depth))
    }
}

/// The point of the world that a pixel position shows at a depth.
pub fn world_point(camera: &Camera, pixel: DVec2, depth: f64) -> DVec3 {
    let tan_half_yfov = (camera.yfov / 2.0).tan();
    camera.world_from_camera((camera.q_from_pixel(pixel) * tan_half_yfov).extend(1.0) * depth)
}

impl SamplePlaces {
    pub fn new(samples: &Samples) -> Self {
        let located = samples.runs().flat_map(|run| run.indices.clone().zip(run.locations()));
        let paintable = located.filter(|(_, location)| {
            let is_on_surface = location.address.surface.is_some() && location.inverse_depth > 0.0;
            is_on_surface && !location.address.is_carried
        });
        let places: Vec<SamplePlace> = paintable
            .map(|(sample, location)| SamplePlace {
                sample,
                center: location.center,
                inverse_depth: location.inverse_depth,
            })
            .collect();
        let tile = |place: &SamplePlace| tile_of(place.center);
        let bound = |pick: fn(i32, i32) -> i32| {
            [0, 1].map(|axis| places.iter().map(|place| tile(place)[axis]).reduce(pick).unwrap_or(0))
        };
        let (first_tile, last_tile) = (bound(i32::min), bound(i32::max));
        let tiles = [0, 1].map(|axis| (last_tile[axis] - first_tile[axis]) as usize + 1);
        let index = |place: &SamplePlace| {
            let [column, row] = [0, 1].map(|axis| (tile(place)[axis] - first_tile[axis]) as usize);
            row * tiles[0] + column
        };
        let mut starts = vec![0; tiles[0] * tiles[1] + 1];
        places.iter().for_each(|place| starts[index(place) + 1] += 1);
        (1..starts.len()).for_each(|k| starts[k] += starts[k - 1]);
        let mut next = starts.clone();
        let mut sorted = places.clone();
        for place in &places {
            let next = &mut next[index(place)];
            sorted[*next as usize] = *place;
            *next += 1;
        }
        Self { first_tile, tiles, starts, places: sorted }
    }

    /// Those in a rectangle of the picture, px, and some around it.
    pub fn within(
        &self,
        [left, top]: [f32; 2],
        [right, bottom]: [f32; 2],
    ) -> impl Iterator<Item = &SamplePlace> {
        let [first, last] = [Vec2::new(left, top), Vec2::new(right, bottom)].map(tile_of);
        let span = |axis: usize| -> Range<usize> {
            let place = |tile: i32| (tile.saturating_sub(self.first_tile[axis])).max(0) as usize;
            place(first[axis]).min(self.tiles[axis])
                ..place(last[axis].saturating_add(1)).min(self.tiles[axis])
        };
        let columns = span(0);
        span(1).flat_map(move |row| {
            let [start, end] = [columns.start, columns.end.max(columns.start)]
                .map(|column| self.starts[row * self.tiles[0] + column] as usize);
            &self.places[start..end]
        })
    }
}

fn tile_of(pixel: Vec2) -> [i32; 2] {
    (pixel / TILE_PX).floor().to_array().map(|tile| tile as i32)
}
