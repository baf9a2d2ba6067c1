//! What shapes the discs of a lens: rims and edges, by node.

use super::moment_table::{EdgeMoments, MomentTable, Moments};
use super::node_shape::{Disc, NodeEdges, NodeShape};
use crate::aperture::shape::Shape;
use crate::canvas::PIXEL;
use crate::fixed::ONE;
use crate::nodes::{Cells, SplatNode};
use glam::DVec2;
use lens::{ApertureShape, Camera, CharacterOptics, Rim};

/// Rims and edges of a lens over a picture.
pub struct Shaper {
    rims: [Option<Rim>; 2],
    edges: Option<LensEdges>,
    /// Where the axis is, 1/4096 px.
    axis: [f32; 2],
    /// Half-heights for each 1/4096 px.
    per_position: f32,
    tan_half_yfov: f32,
    /// 1/R; 0 for a pinhole.
    per_radius: f32,
    /// How far from its centre the aperture reaches, in radii.
    reach: f32,
    table: MomentTable,
    cells: CellLight,
}

/// Edges, by the radius of an image.
struct LensEdges {
    strength: f32,
    /// σ for each 1/4096 px.
    per_image_radius: f32,
    of_node: NodeEdges,
}

/// Cells of the baked aperture along a side.
const CELLS: usize = 16;

/// The light of each cell of the baked aperture.
struct CellLight {
    rows: Vec<CellRow>,
    /// Half a cell's side, in the lens's radii.
    half: f32,
    /// The lens's radius as a share of the baked one.
    stop: f32,
}

/// A row of cells: the share and the mean aperture point of each.
struct CellRow {
    share: [f32; CELLS],
    x: [f32; CELLS],
    y: [f32; CELLS],
    /// The height of the row's middle, where rims cut it, 1/16384.
    v: i32,
}

impl CellLight {
    /// Of an aperture's shape, for a lens whose radius is `stop` of the baked one.
    fn new(shape: &Shape, stop: f64) -> Self {
        let cells = shape.cells(1.0 / stop);
        let row = |row: usize| {
            let of = |value: fn(&(f64, DVec2)) -> f64| {
                std::array::from_fn(|column| value(&cells[row * CELLS + column]) as f32)
            };
            let middle = ((row as f64 + 0.5) / 8.0 - 1.0) / stop;
            CellRow {
                share: of(|(share, _)| *share),
                x: of(|(_, mean)| mean.x),
                y: of(|(_, mean)| mean.y),
                v: fixed(middle as f32),
            }
        };
        Self { rows: (0..CELLS).map(row).collect(), half: (1.0 / (16.0 * stop)) as f32, stop: stop as f32 }
    }
}

/// Discs farther from the aperture's centre are drawn as if they were so far, with the same near edge: next to straight.
const FARTHEST: f32 = 6.0;

/// Rims nearer to a node than this share of its depth are taken as so near: at the rim itself all rays pass or none.
const NEAREST: f32 = 1e-3;

impl Shaper {
    /// The shaper of a camera's lens; `None` if its discs are those of a plain lens. `stop` is its radius as a share of the baked one's,
    /// `size` how much larger than green's its colour's picture is (1 + m), and no node is nearer than 1/`largest_inverse_depth`.
    pub fn new(
        camera: &Camera,
        shape: &Shape,
        stop: f64,
        size: f64,
        largest_inverse_depth: f32,
    ) -> Option<Self> {
        if !camera.character.shapes_discs() {
            return None;
        }
        let optics = camera.character_optics();
        let plain = &optics.optics;
        let half_height = plain.half_height_px * f64::from(PIXEL) * size;
        let is_round = matches!(camera.aperture.shape, ApertureShape::Disc | ApertureShape::Polygon { .. });
        let axis = camera.principal_point_px() * f64::from(PIXEL);
        // A pinhole sees what its chief ray sees.
        let stop = stop.max(1e-3);
        Some(Self {
            rims: camera.character.rims,
            edges: LensEdges::new(&optics, half_height),
            axis: axis.as_vec2().to_array(),
            per_position: (1.0 / half_height) as f32,
            tan_half_yfov: plain.tan_half_yfov as f32,
            per_radius: if plain.aperture_radius > 0.0 { (1.0 / plain.aperture_radius) as f32 } else { 0.0 },
            reach: if is_round { 1.0 } else { std::f32::consts::SQRT_2 },
            table: MomentTable::new(&optics, &camera.aperture, frame(camera), largest_inverse_depth.into()),
            cells: CellLight::new(shape, stop),
        })
    }

    /// How the light of a node passes whose image has this radius, 1/4096 px.
    #[inline]
    pub fn node_shape(&self, node: &SplatNode, radius: i32) -> NodeShape {
        let [x, y] = self.place(node).map(|q| q * self.tan_half_yfov);
        let disc = |rim: Rim| self.disc(rim, [x, y], node.inverse_depth);
        NodeShape {
            discs: self.rims.map(|rim| rim.and_then(disc)),
            edges: self.edges.as_ref().and_then(|edges| edges.of_image(radius)),
        }
    }

    /// The moments of the light of a node, over the aperture.
    pub fn moments(&self, node: &SplatNode, shape: &NodeShape) -> Moments {
        self.table_at(node).at(steepness(shape))
    }

    fn table_at(&self, node: &SplatNode) -> EdgeMoments {
        self.table.at(self.place(node), node.inverse_depth)
    }

    /// Where a node's chief ray meets the picture, half-heights from the axis, y up.
    #[inline]
    fn place(&self, node: &SplatNode) -> [f32; 2] {
        let [x, y] = [0, 1].map(|k| (node.center[k] as f32 - self.axis[k]) * self.per_position);
        [x, -y]
    }

    /// What a rim leaves for a point at `slope` (x, y)/z; `None` if it is all.
    #[inline]
    fn disc(&self, rim: Rim, slope: [f32; 2], inverse_depth: f32) -> Option<Disc> {
        let (distance, radius) = (rim.distance as f32, rim.radius as f32);
        let offset = slope.map(|slope| distance * slope);
        let away = offset[0].hypot(offset[1]);
        if self.per_radius == 0.0 {
            return (away > radius).then_some(Disc { center: [0; 2], radius: 0 });
        }
        let scale = 1.0 - distance * inverse_depth;
        let scale = if scale.abs() < NEAREST { NEAREST.copysign(scale) } else { scale };
        let per_scale = self.per_radius / scale;
        let [away, radius] = [away, radius].map(|length| length * per_scale.abs());
        if radius >= away + self.reach {
            return None;
        }
        let nearer = (FARTHEST / away).min(1.0);
        let center = offset.map(|offset| fixed(-offset * per_scale * nearer));
        Some(Disc { center, radius: fixed((radius - away * (1.0 - nearer)).max(0.0)) })
    }

    /// The moments of the light that a partly occluded node sends through its cells, of which `base` and `tilt` (1/16384) are the
    /// weight.
    #[inline(always)]
    pub fn moments_of_cells(&self, node: &SplatNode, cells: &Cells, shape: &NodeShape) -> Moments {
        let CellLight { rows, half, stop } = &self.cells;
        let one = ONE as f32;
        let [across, up] = node.tilt.map(|tilt| f32::from(tilt) * stop / one);
        let base = f32::from(node.base) / one;
        let per_side = 0.5 / half;
        let mut sums = [[0.0f32; CELLS]; 5];
        for (row, &bits) in rows.iter().zip(cells) {
            if bits == 0 {
                continue;
            }
            let Some([from, to]) = shape.chord(row.v) else { continue };
            let [from, to] = [from as f32 / one, to as f32 / one];
            for (k, ((&x, &y), &share)) in row.x.iter().zip(&row.y).zip(&row.share).enumerate() {
                let is_seen = if bits >> k & 1 == 1 { share } else { 0.0 };
                let passing = ((to.min(x + half) - from.max(x - half)) * per_side).clamp(0.0, 1.0);
                let weight = (base + across * x + up * y).max(0.0) * shape.weight(x * x + y * y);
                let light = is_seen * passing * weight;
                sums[0][k] += light;
                sums[1][k] += light * x;
                sums[2][k] += light * y;
                sums[3][k] += light * x * x;
                sums[4][k] += light * y * y;
            }
        }
        let [light, x, y, xx, yy] = sums.map(|lanes| lanes.iter().sum::<f32>());
        // Within a cell.
        let within = half * half / 3.0 * light;
        [light, x, y, xx + within, yy + within]
    }
}

impl LensEdges {
    fn new(optics: &CharacterOptics, half_height: f64) -> Option<Self> {
        let edges = &optics.edges;
        let radius = optics.optics.aperture_radius;
        let of_node = NodeEdges {
            steepness: 1.0,
            stop_square: (radius * radius * edges.per_square) as f32,
            mean: edges.mean as f32,
            per_extent: (2.0 / edges.extent) as f32,
        };
        let per_image_radius = (1.0 / (lens::FULL_EDGE * half_height)) as f32;
        (edges.strength != 0.0).then_some(Self { strength: edges.strength as f32, per_image_radius, of_node })
    }

    #[inline]
    fn of_image(&self, radius: i32) -> Option<NodeEdges> {
        let steepness = self.strength * (radius as f32 * self.per_image_radius).clamp(-1.0, 1.0);
        (steepness != 0.0).then_some(NodeEdges { steepness, ..self.of_node })
    }
}

/// b·σ(κ) of a node.
fn steepness(shape: &NodeShape) -> f32 {
    shape.edges.map_or(0.0, |edges| edges.steepness)
}

/// The picture and a little around it, half-heights from the axis.
fn frame(camera: &Camera) -> [DVec2; 2] {
    let [middle, half] = camera.frame_q();
    [middle, half + 0.25]
}

/// In 1/16384.
fn fixed(u: f32) -> i32 {
    (u * ONE as f32).round_ties_even() as i32
}
