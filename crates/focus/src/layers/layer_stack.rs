//! The layers of focus, bottom to top, and their composite.

use crate::focus_map::tile_grid::{TILE_TEXELS, Tile, TileGrid, blank, is_blank};
use crate::focus_map::to_texel;
use crate::{BlendMode, Canvas, ChangedTexels, FocusLayer, FocusMap};
use lens::{Camera, FocusOffset};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The layers of a document, bottom to top; there is always at least one, and all have one size. Below the lowest
/// lies the ordinary lens. A clone is a cheap snapshot.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerStack {
    layers: Vec<FocusLayer>,
    active: usize,
}

/// Name of a document's first layer.
const BASE_LAYER_NAME: &str = "Paint";

impl LayerStack {
    /// Maximum number of layers of a document.
    pub const MAX_LAYERS: usize = 64;

    /// A stack with one painted layer, which has the values of `map`.
    pub fn from_map(map: FocusMap) -> Self {
        Self { layers: vec![FocusLayer::from_map(BASE_LAYER_NAME, map)], active: 0 }
    }

    /// Layers read from a file. `None` if there are none, too many, invalid ones, or if sizes differ; an `active` out
    /// of range selects the topmost.
    pub fn new(layers: Vec<FocusLayer>, active: usize) -> Option<Self> {
        let size = layers.first()?.map.size();
        let fits = |layer: &FocusLayer| layer.map.size() == size && layer.is_valid();
        let usable = layers.len() <= Self::MAX_LAYERS && layers.iter().all(fits);
        let active = active.min(layers.len() - 1);
        usable.then_some(Self { layers, active })
    }

    /// The layers, from bottom to top.
    pub fn layers(&self) -> &[FocusLayer] {
        &self.layers
    }

    /// The index of the layer that is painted on, 0 at the bottom.
    pub fn active_index(&self) -> usize {
        self.active
    }

    /// The layer that is painted on.
    pub fn active(&self) -> &FocusLayer {
        &self.layers[self.active]
    }

    /// Mutable access to the layer with this index, 0 at the bottom; `None` if there is none.
    pub fn layer_mut(&mut self, index: usize) -> Option<&mut FocusLayer> {
        self.layers.get_mut(index)
    }

    /// Mutable access to the layer that is painted on.
    pub fn active_mut(&mut self) -> &mut FocusLayer {
        &mut self.layers[self.active]
    }

    /// Makes the layer with this index, 0 at the bottom, the one that is painted on; at most the top one.
    pub fn activate(&mut self, index: usize) {
        self.active = index.min(self.layers.len() - 1);
    }

    /// Adds rows at the bottom of all maps ([`FocusMap::extend_rows`]).
    pub fn extend_rows(&mut self, height: u32) {
        for layer in &mut self.layers {
            layer.map.extend_rows(height);
            if let Some(spread) = &mut layer.spread {
                spread.strokes.extend_rows(height);
            }
        }
    }

    /// Columns and rows of texels of every layer.
    pub fn size(&self) -> [u32; 2] {
        self.layers[0].map.size()
    }

    /// Whether there is only one plain painted layer, as in a document that never had another.
    pub fn is_single_painted_layer(&self) -> bool {
        let only = &self.layers[0];
        self.layers.len() == 1
            && only.is_plain()
            && only.adjustment.is_none()
            && only.spread.is_none()
            && only.motion.is_empty()
    }

    /// Inserts a layer above the active one and makes it active. False if the stack is full.
    #[must_use]
    pub fn insert(&mut self, layer: FocusLayer) -> bool {
        debug_assert_eq!(layer.map.size(), self.size());
        if self.layers.len() >= Self::MAX_LAYERS {
            return false;
        }
        self.active += 1;
        self.layers.insert(self.active, layer);
        true
    }

    /// Removes a layer; the last one cannot be removed. Returns whether it was removed.
    pub fn remove(&mut self, index: usize) -> bool {
        if self.layers.len() < 2 || index >= self.layers.len() {
            return false;
        }
        self.layers.remove(index);
        if self.active > index || self.active == self.layers.len() {
            self.active -= 1;
        }
        true
    }

    /// Moves a layer to another index, 0 at the bottom; the active layer stays the same one. Nothing happens if
    /// either is out of range.
    pub fn move_layer(&mut self, from: usize, to: usize) {
        if from.max(to) >= self.layers.len() {
            return;
        }
        let layer = self.layers.remove(from);
        self.layers.insert(to, layer);
        self.active = match self.active {
            active if active == from => to,
            active if from < active && active <= to => active - 1,
            active if to <= active && active < from => active + 1,
            active => active,
        };
    }

    /// Whether any layer depends on the pose of the shot camera.
    pub fn follows_camera(&self) -> bool {
        self.layers.iter().any(|layer| layer.adjustment.is_some())
    }

    /// Whether any layer's weight changes over time.
    pub fn is_animated(&self) -> bool {
        self.layers.iter().any(|layer| !layer.motion.is_empty())
    }

    /// Whether the composite depends on the depth of the surface.
    pub fn depends_on_depth(&self) -> bool {
        self.follows_camera() || self.layers.iter().any(|layer| !layer.motion.mask.is_empty())
    }

    /// The layers as they are at a time, without motion. Values that follow depth are evaluated for `camera` and the
    /// surface positions of `canvas`; without a canvas, which only stacks with [`Self::depends_on_depth`] need, they
    /// stay as they are.
    pub fn at_time(&self, seconds: f64, canvas: Option<&Canvas>, camera: &Camera) -> Self {
        let layers = self.layers.iter().map(|layer| layer.at_time(seconds, canvas, camera)).collect();
        Self { layers, active: self.active }
    }

    /// The same without the values of adjustment layers, keeping their rules and masks: small, and complete, since
    /// [`Self::evaluate`] restores the values.
    pub fn without_adjusted_values(&self) -> Self {
        let [width, height] = self.size();
        let mut stack = self.clone();
        for layer in stack.layers.iter_mut().filter(|layer| layer.adjustment.is_some()) {
            layer.map.texels = FocusMap::new(width, height, FocusOffset::STANDARD).texels;
        }
        stack
    }

    /// Computes the values of all adjustment layers anew, for a shot camera.
    pub fn evaluate(&mut self, canvas: &Canvas, camera: &Camera) {
        self.layers.iter_mut().for_each(|layer| layer.evaluate(canvas, camera));
    }

    /// The composite of all layers: a map without a mask.
    pub fn composite(&self) -> FocusMap {
        let [width, height] = self.size();
        let mut map = FocusMap::new(width, height, FocusOffset::STANDARD);
        self.composite_tiles(&mut map, None);
        map
    }

    /// Updates a composite after texels of any layer have changed, its background included. Returns the texels of the
    /// composite that changed.
    pub fn recomposite(&self, map: &mut FocusMap, changed: &ChangedTexels) -> ChangedTexels {
        let tiles: BTreeSet<usize> = changed.texels.iter().map(|&texel| map.texels.tile_of(texel)).collect();
        self.composite_tiles(map, Some(tiles.into_iter().collect()))
    }

    /// Sets `map` to the composite of all layers. Returns the texels that changed.
    pub fn recomposite_all(&self, map: &mut FocusMap) -> ChangedTexels {
        self.composite_tiles(map, None)
    }

    fn composite_tiles(&self, map: &mut FocusMap, tiles: Option<Vec<usize>>) -> ChangedTexels {
        map.background = self.background();
        let tiles = tiles.unwrap_or_else(|| (0..map.texels.tiles().len()).collect());
        let beneath = Arc::new([to_texel(FocusOffset::STANDARD); TILE_TEXELS]);
        let composite =
            |&index: &usize| (index, self.composite_tile(index, &beneath), self.composite_gloss(index));
        let tiles: Vec<_> = tiles.par_iter().map(composite).collect();
        let mut changed = Vec::new();
        for (index, tile, gloss) in tiles {
            changed.extend(map.texels.differing_texels(index, &map.texels.tiles()[index], &tile));
            map.texels.set_tile(index, tile);
            changed.extend(map.gloss.differing_texels(index, &map.gloss.tiles()[index], &gloss));
            map.gloss.set_tile(index, gloss);
        }
        ChangedTexels::new(changed)
    }

    /// A tile of the composite. Tiles hidden by a plain layer are not read; that layer's own tile is shared.
    fn composite_tile(&self, index: usize, beneath: &Arc<Tile<[f32; 2]>>) -> Arc<Tile<[f32; 2]>> {
        let (hiding, above) = self.visible_layers();
        let mut tile =
            hiding.map_or_else(|| beneath.clone(), |layer| layer.map.texels.tiles()[index].clone());
        for (layer, share) in above.iter().filter_map(|layer| Some((layer, layer.tile_shares(index)?))) {
            let values = &layer.map.texels.tiles()[index];
            let joined = Arc::make_mut(&mut tile);
            for (k, value) in joined.iter_mut().enumerate() {
                *value = layer.blend.blend(*value, values[k], share(k));
            }
        }
        tile
    }

    /// The same for gloss; blank if no visible layer has any.
    fn composite_gloss(&self, index: usize) -> Arc<Tile<f32>> {
        let (hiding, above) = self.visible_layers();
        let gloss_tile = |layer: &FocusLayer| layer.map.gloss.tiles()[index].clone();
        let mut tile = hiding.map_or_else(blank, gloss_tile);
        for (layer, share) in above.iter().filter_map(|layer| Some((layer, layer.tile_shares(index)?))) {
            let values = &layer.map.gloss.tiles()[index];
            if is_blank(&tile) && is_blank(values) {
                continue;
            }
            let joined = Arc::make_mut(&mut tile);
            for (k, value) in joined.iter_mut().enumerate() {
                *value = layer.blend.blend_gloss(*value, values[k], share(k));
            }
        }
        tile
    }

    /// The topmost layer that hides all below it, if any, and the layers above it, bottom to top.
    fn visible_layers(&self) -> (Option<&FocusLayer>, &[FocusLayer]) {
        match self.layers.iter().rposition(FocusLayer::is_plain) {
            Some(index) => (Some(&self.layers[index]), &self.layers[index + 1..]),
            None => (None, &self.layers),
        }
    }

    fn background(&self) -> FocusOffset {
        let visible = self.layers.iter().filter(|layer| layer.is_visible);
        visible.fold(FocusOffset::STANDARD, |beneath, layer| {
            let share = layer.opacity as f32 * layer.map.background_mask;
            if layer.blend == BlendMode::Set && share == 1.0 {
                return layer.map.background;
            }
            let own = layer.map.background;
            let [t, anchor] = layer.blend.blend(to_texel(beneath), to_texel(own), share);
            let gloss = layer.blend.blend_gloss(beneath.gloss as f32, own.gloss as f32, share);
            FocusOffset::new(t as f64, anchor as f64).with_gloss(gloss as f64)
        })
    }

    /// The memory, in bytes, of the tiles that are not shared with `other`, a newer state.
    pub fn unshared_bytes(&self, other: &Self) -> usize {
        let mut shared: TileSet =
            other.layers.iter().flat_map(FocusLayer::maps).flat_map(FocusMap::tile_sizes).collect();
        shared.insert(blank_tile());
        let own = self.layers.iter().map(|layer| {
            let tiles: TileSet = layer.maps().flat_map(FocusMap::tile_sizes).collect();
            let unshared: usize = tiles.difference(&shared).map(|(_, bytes)| bytes).sum();
            unshared + size_of::<FocusLayer>() + 2 * layer.map.texels.tiles().len() * size_of::<usize>()
        });
        own.sum()
    }

    /// The memory, in bytes, of the tiles of all layers and of `map`, their composite: shared ones once.
    pub fn bytes_with(&self, map: &FocusMap) -> usize {
        let maps = self.layers.iter().flat_map(FocusLayer::maps).chain([map]);
        let tiles: TileSet = maps.flat_map(FocusMap::tile_sizes).collect();
        tiles.iter().map(|(_, bytes)| bytes).sum()
    }
}

/// Tiles by address, with their sizes in bytes.
type TileSet = BTreeSet<(usize, usize)>;

/// The tile that all blank maps share.
fn blank_tile() -> (usize, usize) {
    let tile = blank();
    (Arc::as_ptr(&tile) as usize, size_of_val(&*tile))
}

impl FocusMap {
    /// The addresses of all tiles, with their sizes in bytes.
    fn tile_sizes(&self) -> impl Iterator<Item = (usize, usize)> {
        fn sizes<T: Copy + PartialEq>(grid: &TileGrid<T>) -> impl Iterator<Item = (usize, usize)> {
            grid.tiles().iter().map(|tile| (Arc::as_ptr(tile) as usize, size_of_val(&**tile)))
        }
        sizes(&self.texels).chain(self.mask.iter().chain([&self.gloss]).flat_map(sizes))
    }
}
