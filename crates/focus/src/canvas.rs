//! The surface behind the texels of a focus map, searchable by world position.

mod selection;
mod texel_tree;

pub use selection::{CombineMode, Selection, SelectionResult};

use crate::{ChangedTexels, FocusMap};
use atlas::{Atlas, AtlasTexel};
use glam::{DVec3, Vec3};
use lens::FocusOffset;
use rayon::prelude::*;
use scene::Scene;
use texel_tree::TexelTree;

/// A texel that covers some surface, with what painting needs of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CanvasTexel {
    /// Column in the map.
    pub x: u32,
    /// Row in the map.
    pub y: u32,
    /// World position of its centroid.
    pub position: DVec3,
    /// Unit geometric normal there; zero if the surface is degenerate.
    pub normal: Vec3,
    /// World area it covers.
    pub area: f64,
    /// Index of its part in the scene.
    pub part: u32,
    /// Index of its chart in the atlas.
    pub chart: u32,
}

/// What is stored of a texel beside its point in the tree. There are millions.
#[derive(Clone, Copy, Debug)]
struct StoredTexel {
    x: u16,
    y: u16,
    area: f32,
    /// Index of its face.
    face: u32,
}

/// What the texels of a triangle have in common.
#[derive(Clone, Copy, Debug)]
struct Face {
    normal: Vec3,
    part: u32,
    chart: u32,
}

/// All covered texels of an atlas in the order of a spatial tree, with the gutter texels that copy them.
///
/// A brush selects its texels here by distance in world space, so chart seams, mirrored texture coordinates and
/// instances do not matter to it.
#[derive(Clone, Debug)]
pub struct Canvas {
    size: [u32; 2],
    /// World position of the tree's origin; the tree's points are relative to it, in f32.
    origin: DVec3,
    tree: TexelTree,
    /// In the tree's order.
    texels: Vec<StoredTexel>,
    faces: Vec<Face>,
    /// Where each texel's gutters start in `gutters`; one entry more than there are texels.
    gutter_starts: Vec<u32>,
    gutters: Vec<[u32; 2]>,
    largest_texel: f32,
    /// Node and material of each part.
    part_owners: Vec<[u32; 2]>,
}

impl Canvas {
    /// The canvas of an atlas: its covered texels and, for each gutter texel, the covered texel that it copies (both
    /// as [x, y]).
    pub fn new(scene: &Scene, atlas: &Atlas, texels: &[AtlasTexel], gutters: &[[[u32; 2]; 2]]) -> Self {
        let face = |triangle: usize| Face {
            normal: scene.area_normal(triangle as u32).normalize_or_zero().as_vec3(),
            part: scene.triangles[triangle].part,
            chart: atlas.chart_of[triangle],
        };
        let placed_texel = |texel: &AtlasTexel| {
            let AtlasTexel { x, y, centroid, area } = *texel;
            (centroid.position(scene), StoredTexel::new([x, y], area, centroid.triangle))
        };
        Self::from_faces(
            [atlas.width, atlas.height],
            texels.iter().map(placed_texel),
            (0..scene.triangles.len()).map(face).collect(),
            gutters,
            part_owners(scene),
        )
    }

    /// A canvas of these texels. `gutters` pairs each gutter texel with the covered texel that it copies;
    /// `part_owners` holds node and material of each part.
    pub fn from_texels(
        size: [u32; 2],
        texels: Vec<CanvasTexel>,
        gutters: &[[[u32; 2]; 2]],
        part_owners: Vec<[u32; 2]>,
    ) -> Self {
        let face = |texel: &CanvasTexel| Face { normal: texel.normal, part: texel.part, chart: texel.chart };
        let faces = texels.iter().map(face).collect();
        let placed_texel = |(face, texel): (u32, &CanvasTexel)| {
            (texel.position, StoredTexel::new([texel.x, texel.y], texel.area, face))
        };
        let placed_texels = (0..).zip(&texels).map(placed_texel);
        Self::from_faces(size, placed_texels, faces, gutters, part_owners)
    }

    /// A canvas of texels with their positions, and their faces.
    fn from_faces(
        size: [u32; 2],
        placed_texels: impl Iterator<Item = (DVec3, StoredTexel)> + Clone,
        faces: Vec<Face>,
        gutters: &[[[u32; 2]; 2]],
        part_owners: Vec<[u32; 2]>,
    ) -> Self {
        let positions = placed_texels.clone().map(|(position, _)| position);
        let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) =
            positions.clone().fold(nothing, |(low, high), position| (low.min(position), high.max(position)));
        let origin = if low.x <= high.x { (low + high) / 2.0 } else { DVec3::ZERO };
        let points: Vec<Vec3> = positions.map(|position| (position - origin).as_vec3()).collect();
        let (tree, order) = TexelTree::new(&points);
        drop(points);
        let texels: Vec<StoredTexel> = placed_texels.map(|(_, texel)| texel).collect();
        let texels: Vec<StoredTexel> = order.iter().map(|&i| texels[i as usize]).collect();
        let (gutter_starts, gutters) = gutters_by_texel(size, &texels, gutters);
        let largest_texel = texels.iter().map(|texel| texel.area.sqrt()).fold(0.0, f32::max);
        Self { size, origin, tree, texels, faces, gutter_starts, gutters, largest_texel, part_owners }
    }

    /// The same surface with other materials. `scene` must have the triangles and parts that the canvas was made
    /// from.
    pub fn with_part_owners(&self, scene: &Scene) -> Self {
        Self { part_owners: part_owners(scene), ..self.clone() }
    }

    /// Columns and rows of texels of the focus map that it belongs to.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The covered texels, in tree order: neighbours in space are near each other.
    pub fn texels(&self) -> impl ExactSizeIterator<Item = CanvasTexel> {
        (0..self.texels.len()).map(|index| self.texel(index))
    }

    /// The same, by several threads.
    pub(crate) fn par_texels(&self) -> impl IndexedParallelIterator<Item = CanvasTexel> {
        (0..self.texels.len()).into_par_iter().map(|index| self.texel(index))
    }

    /// The texel with this index. Its position is stored in f32, relative to the middle of the surface.
    pub fn texel(&self, index: usize) -> CanvasTexel {
        let texel = self.texels[index];
        let [x, y] = texel.place();
        let Face { normal, part, chart } = self.faces[texel.face as usize];
        let position = self.origin + self.tree.points()[index].as_dvec3();
        CanvasTexel { x, y, position, normal, area: texel.area.into(), part, chart }
    }

    /// The index of the scene node that a texel belongs to.
    pub fn node_of(&self, texel: &CanvasTexel) -> u32 {
        self.part_owners[texel.part as usize][0]
    }

    /// The index of the material of a texel.
    pub fn material_of(&self, texel: &CanvasTexel) -> u32 {
        self.part_owners[texel.part as usize][1]
    }

    /// The gutter texels (column, row) that copy the texel with this index.
    pub fn gutters_of(&self, index: usize) -> &[[u32; 2]] {
        &self.gutters[self.gutter_starts[index] as usize..self.gutter_starts[index + 1] as usize]
    }

    /// A map with one value for each covered texel, in the canvas's order.
    pub(crate) fn map_from_values(&self, values: &[[f32; 2]], background: FocusOffset) -> FocusMap {
        let [width, height] = self.size();
        let mut map = FocusMap::new(width, height, FocusOffset::STANDARD);
        map.background = background;
        for (index, (texel, value)) in self.texels.iter().zip(values).enumerate() {
            let [x, y] = texel.place();
            map.set(x, y, *value);
            for &[x, y] in self.gutters_of(index) {
                map.set(x, y, *value);
            }
        }
        map
    }

    /// Calls `visit` with the index and distance of every texel whose centroid is at most `radius` from `center`.
    pub(crate) fn visit_within(&self, center: DVec3, radius: f64, mut visit: impl FnMut(usize, f32)) {
        let center = (center - self.origin).as_vec3();
        self.tree.visit_within(center, radius as f32, &mut |index, squared| visit(index, squared.sqrt()));
    }

    /// The texel nearest to `center` for which `accept` is true, if its centroid is no farther away than the texel's
    /// own size (the side of a square of its area).
    pub fn nearest(&self, center: DVec3, accept: impl Fn(&CanvasTexel) -> bool) -> Option<usize> {
        let reach = |texel: &CanvasTexel| texel.area.sqrt() as f32;
        self.nearest_where(center, self.largest_texel as f64, |texel, distance| {
            distance <= reach(texel) && accept(texel)
        })
    }

    /// The texel nearest to `center`, at most `radius` away. Searches growing spheres, the first of radius `guess`.
    pub(crate) fn nearest_within(&self, center: DVec3, guess: f64, radius: f64) -> Option<usize> {
        let mut reach = guess.max(radius * 1e-3).min(radius);
        loop {
            let nearest = self.nearest_where(center, reach, |_, _| true);
            if nearest.is_some() || reach >= radius {
                return nearest;
            }
            reach = (2.0 * reach).min(radius);
        }
    }

    fn nearest_where(
        &self,
        center: DVec3,
        radius: f64,
        accept: impl Fn(&CanvasTexel, f32) -> bool,
    ) -> Option<usize> {
        let mut best: Option<(f32, usize)> = None;
        self.visit_within(center, radius, |index, distance| {
            let nearer = best.is_none_or(|(least, _)| distance < least);
            if nearer && accept(&self.texel(index), distance) {
                best = Some((distance, index));
            }
        });
        best.map(|(_, index)| index)
    }

    /// The longest side of the box that holds all texels' centroids; 0 for fewer than two.
    pub(crate) fn extent(&self) -> f64 {
        let start = (glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY);
        let (low, high) = self.tree.points().iter().fold(start, |(l, h), p| (l.min(*p), h.max(*p)));
        f64::from((high - low).max_element().max(0.0))
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        self.tree.bytes()
            + size_of_val(&*self.texels)
            + size_of_val(&*self.faces)
            + size_of_val(&*self.gutter_starts)
            + size_of_val(&*self.gutters)
            + size_of_val(&*self.part_owners)
    }

    /// World-space offset of a texel from a point.
    pub(crate) fn offset_from(&self, index: usize, center: DVec3) -> Vec3 {
        self.tree.points()[index] - (center - self.origin).as_vec3()
    }

    /// [t, anchor, gloss, mask] of a texel.
    pub(crate) fn value(&self, map: &FocusMap, index: usize) -> [f32; 4] {
        let [x, y] = self.texels[index].place();
        let [t, anchor] = map.texel(x, y);
        [t, anchor, map.gloss_at(x, y), map.mask_at(x, y)]
    }

    /// Writes [t, anchor, gloss, mask] of a texel and of the gutters that copy it (a map without a mask ignores the
    /// mask), and appends the texels that changed to `changed`.
    pub(crate) fn write(
        &self,
        map: &mut FocusMap,
        index: usize,
        [t, anchor, gloss, share]: [f32; 4],
        changed: &mut Vec<[u32; 2]>,
    ) {
        for &[x, y] in [self.texels[index].place()].iter().chain(self.gutters_of(index)) {
            let mut differs = map.texel(x, y) != [t, anchor];
            if differs {
                map.set(x, y, [t, anchor]);
            }
            if map.gloss_at(x, y) != gloss {
                map.set_gloss(x, y, gloss);
                differs = true;
            }
            if let Some(mask) = map.mask.as_mut().filter(|mask| mask.at(x, y) != share) {
                mask.set(x, y, share);
                differs = true;
            }
            if differs {
                changed.push([x, y]);
            }
        }
    }

    /// Writes only the channels whose flag is set, and only if that changes anything.
    pub(crate) fn write_channels(
        &self,
        map: &mut FocusMap,
        index: usize,
        value: [f32; 4],
        touches: [bool; 4],
        changed: &mut Vec<[u32; 2]>,
    ) {
        let now = self.value(map, index);
        let merged = [0, 1, 2, 3].map(|k| if touches[k] { value[k] } else { now[k] });
        if merged != now {
            self.write(map, index, merged, changed);
        }
    }

    /// Copies every covered texel into its gutters. Returns the texels that changed.
    pub fn dilate(&self, map: &mut FocusMap) -> ChangedTexels {
        let mut changed = Vec::new();
        for index in 0..self.texels.len() {
            let value = self.value(map, index);
            self.write(map, index, value, &mut changed);
        }
        ChangedTexels::new(changed)
    }
}

impl StoredTexel {
    /// A texel in this column and row, which are below [`atlas::MAX_SIDE`], of a world area.
    fn new([x, y]: [u32; 2], area: f64, face: u32) -> Self {
        const { assert!(atlas::MAX_SIDE <= u16::MAX as u32) };
        Self { x: x as u16, y: y as u16, area: area as f32, face }
    }

    /// Column and row.
    fn place(self) -> [u32; 2] {
        [self.x.into(), self.y.into()]
    }
}

/// Node and material of each part.
fn part_owners(scene: &Scene) -> Vec<[u32; 2]> {
    scene.parts.iter().map(|part| [part.node, part.material]).collect()
}

/// The gutters sorted by the texel that they copy, and where each texel's gutters start. Gutters of uncovered texels
/// are dropped.
fn gutters_by_texel(
    [width, height]: [u32; 2],
    texels: &[StoredTexel],
    gutters: &[[[u32; 2]; 2]],
) -> (Vec<u32>, Vec<[u32; 2]>) {
    const NOT_COVERED: u32 = u32::MAX;
    let address = |[x, y]: [u32; 2]| y as usize * width as usize + x as usize;
    let mut index_at = vec![NOT_COVERED; width as usize * height as usize];
    for (index, texel) in (0..).zip(texels) {
        index_at[address(texel.place())] = index;
    }
    let covered_gutter = |&[gutter, source]: &[[u32; 2]; 2]| {
        let index = index_at[address(source)];
        (index != NOT_COVERED).then_some((index, gutter))
    };
    let mut sorted: Vec<(u32, [u32; 2])> = gutters.iter().filter_map(covered_gutter).collect();
    sorted.sort_unstable();
    let mut starts = vec![0; texels.len() + 1];
    for (index, _) in &sorted {
        starts[*index as usize + 1] += 1;
    }
    for index in 0..texels.len() {
        starts[index + 1] += starts[index];
    }
    (starts, sorted.into_iter().map(|entry| entry.1).collect())
}
