//! The layers of focus, bottom to top, and what they make together.

use crate::focus_map::to_texel;
use crate::tile_grid::{TILE_TEXELS, Tile, TileGrid, blank, is_blank};
use crate::{BlendMode, Canvas, ChangedTexels, FocusLayer, FocusMap};
use lens::{Camera, FocusOffset};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The layers of a document, bottom to top; there is always one at least, and all have one size. Beneath the lowest
/// lies the ordinary lens. A clone is a cheap snapshot.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerStack {
    layers: Vec<FocusLayer>,
    active: usize,
}

/// What the first layer of a document is called.
const BASE_LAYER_NAME: &str = "Paint";

impl LayerStack {
    /// Layers that a document may have.
    pub const MAX_LAYERS: usize = 64;

    /// A document's first layer.
    pub fn from_map(map: FocusMap) -> Self {
        Self { layers: vec![FocusLayer::from_map(BASE_LAYER_NAME, map)], active: 0 }
    }

    /// Layers from a file. `None` where there are none, too many, unusable ones, or sizes differ; an `active` that
    /// is not there is the topmost.
    pub fn new(layers: Vec<FocusLayer>, active: usize) -> Option<Self> {
        let size = layers.first()?.map.size();
        let fits = |layer: &FocusLayer| layer.map.size() == size && layer.is_valid();
        let usable = layers.len() <= Self::MAX_LAYERS && layers.iter().all(fits);
        let active = active.min(layers.len() - 1);
        usable.then_some(Self { layers, active })
    }

    /// The layers, bottom to top.
    pub fn layers(&self) -> &[FocusLayer] {
        &self.layers
    }

    /// Which layer is painted on.
    pub fn active_index(&self) -> usize {
        self.active
    }

    /// The layer that is painted on.
    pub fn active(&self) -> &FocusLayer {
        &self.layers[self.active]
    }

    /// A layer, to be changed.
    pub fn layer_mut(&mut self, index: usize) -> Option<&mut FocusLayer> {
        self.layers.get_mut(index)
    }

    /// The layer that is painted on, to be changed.
    pub fn active_mut(&mut self) -> &mut FocusLayer {
        &mut self.layers[self.active]
    }

    /// Paints on another layer from now on.
    pub fn activate(&mut self, index: usize) {
        self.active = index.min(self.layers.len() - 1);
    }

    /// Columns and rows of every layer.
    pub fn size(&self) -> [u32; 2] {
        self.layers[0].map.size()
    }

    /// Whether there is nothing but one plain layer, as in a document that never had another.
    pub fn is_single_painted_layer(&self) -> bool {
        let only = &self.layers[0];
        self.layers.len() == 1 && only.is_plain() && only.adjustment.is_none() && only.motion.is_empty()
    }

    /// Puts a layer above the active one and makes it active. False where there are too many already.
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

    /// Takes a layer away; the last one stays. Whether there was one to take.
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

    /// Moves a layer to another place; the active one stays the same layer.
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

    /// Whether any layer depends on where the shot camera stands.
    pub fn follows_camera(&self) -> bool {
        self.layers.iter().any(|layer| layer.adjustment.is_some())
    }

    /// Whether any layer counts for more or less over time.
    pub fn is_animated(&self) -> bool {
        self.layers.iter().any(|layer| !layer.motion.is_empty())
    }

    /// Whether what the layers make depends on where the surface is before the camera.
    pub fn depends_on_depth(&self) -> bool {
        self.follows_camera() || self.layers.iter().any(|layer| !layer.motion.mask.is_empty())
    }

    /// The layers as they are at a time, without motion. What follows depth is evaluated for `camera` and the surface where `canvas` says
    /// it is; it stays as it was where there is no canvas, which only [`Self::depends_on_depth`] needs.
    pub fn at_time(&self, seconds: f64, canvas: Option<&Canvas>, camera: &Camera) -> Self {
        let layers = self.layers.iter().map(|layer| layer.at_time(seconds, canvas, camera)).collect();
        Self { layers, active: self.active }
    }

    /// The same with nothing in adjustment layers but their rules and masks: what is small, and says all.
    /// [`Self::evaluate`] brings the values back.
    pub fn without_adjusted_values(&self) -> Self {
        let [width, height] = self.size();
        let mut stack = self.clone();
        for layer in stack.layers.iter_mut().filter(|layer| layer.adjustment.is_some()) {
            layer.map.texels = FocusMap::new(width, height, FocusOffset::STANDARD).texels;
        }
        stack
    }

    /// Takes the values of all adjustment layers for a shot camera.
    pub fn evaluate(&mut self, canvas: &Canvas, camera: &Camera) {
        self.layers.iter_mut().for_each(|layer| layer.evaluate(canvas, camera));
    }

    /// What the layers make together: a map without mask.
    pub fn composite(&self) -> FocusMap {
        let [width, height] = self.size();
        let mut map = FocusMap::new(width, height, FocusOffset::STANDARD);
        self.composite_tiles(&mut map, None);
        map
    }

    /// Brings a composite up to date after texels of any layer have changed. Returns what changed in it; the
    /// background is brought up to date as well.
    pub fn recomposite(&self, map: &mut FocusMap, changed: &ChangedTexels) -> ChangedTexels {
        let tiles: BTreeSet<usize> = changed.texels.iter().map(|&texel| map.texels.tile_of(texel)).collect();
        self.composite_tiles(map, Some(tiles.into_iter().collect()))
    }

    /// Brings a composite up to date, whatever has changed. Returns what changed in it.
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

    /// A tile of the composite. What a plain layer hides is not looked at; its own tile is shared.
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

    /// The same of gloss; blank where no layer that counts has any.
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

    /// The topmost layer that hides all beneath it, if any does, and those above it, bottom to top.
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

    /// Memory that the difference to a newer state keeps alive, in bytes: tiles that are not shared.
    pub fn unshared_bytes(&self, other: &Self) -> usize {
        let mut shared = BTreeSet::new();
        for layer in &other.layers {
            shared.extend(layer.map.texels.tiles().iter().map(|tile| Arc::as_ptr(tile) as usize));
            shared.extend(share_tiles(layer).map(|tile| Arc::as_ptr(tile) as usize));
        }
        shared.insert(Arc::as_ptr(&blank()) as usize);
        let mut bytes = 0;
        for layer in &self.layers {
            let unshared = |pointer: usize, bytes: usize| if shared.contains(&pointer) { 0 } else { bytes };
            let mut counted = BTreeSet::new();
            for tile in layer.map.texels.tiles() {
                let pointer = Arc::as_ptr(tile) as usize;
                bytes += if counted.insert(pointer) { unshared(pointer, size_of_val(&**tile)) } else { 0 };
            }
            for tile in share_tiles(layer) {
                let pointer = Arc::as_ptr(tile) as usize;
                bytes += if counted.insert(pointer) { unshared(pointer, size_of_val(&**tile)) } else { 0 };
            }
            bytes += size_of::<FocusLayer>() + 2 * layer.map.texels.tiles().len() * size_of::<usize>();
        }
        bytes
    }
}

/// The tiles of mask and gloss.
fn share_tiles(layer: &FocusLayer) -> impl Iterator<Item = &Arc<Tile<f32>>> {
    layer.map.mask.iter().chain([&layer.map.gloss]).flat_map(TileGrid::tiles)
}
