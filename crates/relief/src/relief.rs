//! The surface itself.

use crate::depth_map::rounding;
use crate::edges::covers::MattedLayer;
use crate::edges::matte::{MixedPixel, unmix};
use crate::edges::{jumps, matte, outline};
use crate::error::ReliefError;
use crate::frame::Frame;
use crate::gloss::{Gloss, fit_gloss};
use crate::hidden::{HiddenLayer, continue_hidden};
use crate::mesh::cells::{Cells, Grid, Links};
use crate::mesh::corners::Corner;
use crate::mesh::triangulation::{Metric, Triangulation};
use crate::other_view::OtherView;
use crate::resampling::{FrontLayer, TexelQuery};
use crate::snapping::snap_edges;
use crate::texture::{Texture, build_texture};
use glam::Vec2;
use progress::{Progress, Stage};
use std::collections::HashMap;

/// How a surface is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReliefOptions {
    /// The radius of the aperture that the surface is for, in steps of the views: disparity times it is a parallax,
    /// px. > 0.
    pub reach: f32,
    /// The factor by which one may look farther behind occluders, ≥ 1: the hidden layer is made for that.
    pub beyond: f32,
    /// The largest error of the surface, as a parallax, and of its texture, px.
    pub tolerance_px: f32,
    /// The offset that makes disparities proportional to inverse depth. Where it is infinite, or does not make all of them positive, depth is
    /// unknown, and only parallax counts.
    pub offset: f32,
    /// Steps of a larger parallax between pixels are jumps of depth, px.
    pub jump_px: f32,
    /// How far the surface extends beyond the picture, px: what the aperture sees from beside it.
    pub margin_px: usize,
}

impl Default for ReliefOptions {
    /// For one step either way.
    fn default() -> Self {
        Self { reach: 1.0, beyond: 1.0, tolerance_px: 0.1, offset: f32::INFINITY, jump_px: 1.0, margin_px: 0 }
    }
}

/// A point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReliefVertex {
    /// Its position in the picture, pixels from the upper left corner.
    pub place: Vec2,
    /// Its disparity.
    pub disparity: f32,
    /// The layer of the texture from which it has its colour: 0 the picture, 1 the hidden layer.
    pub layer: u8,
}

/// A surface in a picture's space, and its texture.
#[derive(Clone, Debug)]
pub struct Relief {
    /// Columns and rows of each layer of the texture: of the picture and the margin around it.
    pub size: [usize; 2],
    /// How far the surface extends beyond the picture, px.
    pub margin: usize,
    /// Points; each belongs to one layer.
    pub vertices: Vec<ReliefVertex>,
    /// Corner indices, counter-clockwise as the picture shows them.
    pub triangles: Vec<[u32; 3]>,
    /// The triangles of translucent cells.
    pub translucent: Vec<[u32; 3]>,
    /// Linear RGB of both layers, row by row, the picture first.
    pub texture: Vec<[f32; 3]>,
    /// By texel of the first layer, its opacity in (0, 1]: less than 1 beneath translucent triangles.
    pub opacity: Vec<f32>,
    /// By texel of the first layer, whether the picture also shows the background there: its colour is not the
    /// picture's.
    pub is_matted: Vec<bool>,
    /// By texel of both layers, whether some picture shows it; the others were invented.
    pub is_observed: Vec<bool>,
    /// How the first layer's colour changes over the aperture; `None` if other views show no gloss.
    pub gloss: Option<Gloss>,
}

/// Layers of the texture.
pub const TEXTURE_LAYERS: usize = crate::mesh::cells::LAYERS;

impl Relief {
    /// Makes the surface of a picture (linear RGB) from its disparities, larger ones nearer; pixels whose disparity is NaN have none.
    /// Deterministic.
    ///
    /// # Errors
    /// [`ReliefError::View`] if a view cannot be read, [`ReliefError::Cancelled`] if `progress` cancels.
    ///
    /// # Panics
    /// If picture or disparities are not of the size.
    pub fn build<E: Send>(
        size: [usize; 2],
        disparity: &[f32],
        picture: &[[f32; 3]],
        views: &[OtherView<'_, E>],
        options: &ReliefOptions,
        progress: &dyn Progress,
    ) -> Result<Self, ReliefError<E>> {
        assert!(disparity.len() == size[0] * size[1] && picture.len() == disparity.len());
        let frame = Frame::new(size, options.margin_px);
        let grid = frame.grid;
        let jump = options.jump_px / options.reach;
        let (mut front, shown) = (frame.continued(disparity), frame.continued(picture));
        jumps::snap(grid, &mut front, &shown, jump);
        rounding::smooth_rounding(grid, &mut front, jump);
        let stage = Stage::new(progress, 0.0, 0.1);
        let (stays, links) = snap_edges(&frame, &mut front, &shown, views, jump, &stage)?;
        let reach = options.reach * options.beyond;
        let mut edges = matte::find_edges(grid, &front, &links, &shown, jump);
        edges.retain(|edge| !stays[edge.cell]);
        progress.check().map_err(ReliefError::Cancelled)?;

        // Which colours are needed from other views: beside the picture, behind it, and behind edges. They may move
        // by a cell.
        let behind = continue_hidden(grid, &front, &links, reach, 1.0, jump);
        let margin_cells = (0..grid.count()).filter(|&cell| !frame.is_in_picture(cell));
        let margin_queries = margin_cells.map(|cell| (cell, TexelQuery { cell, disparity: front[cell] }));
        let lies_open = |edge: &&MixedPixel| edge.is_beyond && behind.disparity[edge.cell].is_nan();
        let beyond = edges.iter().filter(lies_open).map(|edge| (edge.cell, front[edge.cell]));
        let behind = behind.order.iter().map(|&cell| (cell, behind.disparity[cell])).chain(beyond);
        let behind = behind.map(|(cell, disparity)| (grid.count() + cell, TexelQuery { cell, disparity }));
        let queries = margin_queries.chain(behind).filter(|(_, query)| !query.disparity.is_nan());
        let (places, queries): (Vec<usize>, Vec<TexelQuery>) = queries.unzip();
        let front_layer = FrontLayer { frame: &frame, front: &front, jump };
        let all: Vec<_> = views.iter().collect();
        let picture_matte = matte_from_picture(grid, &front, &links, &shown, &edges, jump);
        let color_stats = front_layer.collect_color_stats(
            &queries,
            picture_matte.layer(),
            &all,
            &Stage::new(progress, 0.1, 0.5),
        )?;
        let mut observed_colors = vec![None; TEXTURE_LAYERS * grid.count()];
        places.into_iter().zip(color_stats).for_each(|(place, stats)| observed_colors[place] = stats);

        let edges: Vec<MixedPixel> = edges
            .into_iter()
            .map(|edge| MixedPixel {
                behind: observed_colors[grid.count() + edge.cell].unwrap_or(edge.behind),
                ..edge
            })
            .collect();
        let (front, mixed) = matte::find_mixtures(grid, &front, &links, &shown, &edges, jump);
        let links = jumps::links(grid, &front, jump);
        let hidden = continue_hidden(grid, &front, &links, reach, 0.0, jump);
        progress.check().map_err(ReliefError::Cancelled)?;
        let is_in_picture = |cell| frame.is_in_picture(cell);
        let Texture { colors, is_observed, mut opacity } =
            build_texture(grid, shown, is_in_picture, &hidden, &mixed, &observed_colors);
        let whole: Vec<bool> =
            (0..grid.count()).map(|cell| frame.is_in_picture(cell) && opacity[cell] == 1.0).collect();
        let front_layer = FrontLayer { frame: &frame, front: &front, jump };
        let gloss = fit_gloss(&front_layer, &colors[0], &whole, views, &Stage::new(progress, 0.5, 0.9))?;
        let HiddenLayer { disparity: back, links: back_links, onward, .. } = hidden;
        let cells = Cells { grid, disparity: [front, back], links: [links, back_links], onward };
        let mut mesh = Mesh::new(grid);
        let metric = Metric { reach: options.reach, offset: options.offset };
        let is_matted: Vec<bool> = opacity.iter().map(|share| *share < 1.0).collect();
        for layer in 0..TEXTURE_LAYERS {
            let is_whole = |cell: usize| layer > 0 || !is_matted[cell];
            mesh.add(&cells, layer, metric, options.tolerance_px, &is_whole);
        }
        for (cell, outline) in outlines(&cells, &opacity, jump).collect::<Vec<_>>() {
            match outline {
                Some(outline) => {
                    mesh.add_part(&cells, cell, &outline);
                    opacity[cell] = 1.0;
                }
                None => mesh.add_translucent(&cells, cell),
            }
        }
        progress.report(1.0);
        let corner = Vec2::splat(frame.margin as f32);
        mesh.vertices.iter_mut().for_each(|vertex| vertex.place -= corner);
        Ok(Self {
            size: [grid.width, grid.height],
            margin: frame.margin,
            vertices: mesh.vertices,
            triangles: mesh.triangles,
            translucent: mesh.translucent,
            texture: colors.concat(),
            opacity,
            is_matted,
            is_observed,
            gloss,
        })
    }

    /// The number of triangles in layers behind the front one.
    pub fn hidden_triangles(&self) -> usize {
        self.triangles.iter().filter(|corners| self.vertices[corners[0] as usize].layer > 0).count()
    }
}

/// The first layer with its edges matted from the picture alone.
struct PictureMatte {
    disparity: Vec<f32>,
    opacity: Vec<f32>,
    colors: Vec<[f32; 3]>,
}

impl PictureMatte {
    fn layer(&self) -> MattedLayer<'_> {
        MattedLayer { disparity: &self.disparity, opacity: &self.opacity, colors: &self.colors }
    }
}

fn matte_from_picture(
    grid: Grid,
    front: &[f32],
    links: &Links,
    shown: &[[f32; 3]],
    edges: &[MixedPixel],
    jump: f32,
) -> PictureMatte {
    let (disparity, mixed) = matte::find_mixtures(grid, front, links, shown, edges, jump);
    let (mut opacity, mut colors) = (vec![1.0; grid.count()], shown.to_vec());
    for mixed in mixed {
        let (share, [before, _]) = unmix(shown[mixed.cell], &mixed);
        (opacity[mixed.cell], colors[mixed.cell]) = (share, before);
    }
    PictureMatte { disparity, opacity, colors }
}

/// Triangles and the points that they share.
struct Mesh {
    vertices: Vec<ReliefVertex>,
    triangles: Vec<[u32; 3]>,
    translucent: Vec<[u32; 3]>,
    /// Corners in a row of the grid.
    row: usize,
    /// The first layer's first point at each corner of the grid; most corners have no other.
    first: Vec<u32>,
    others: HashMap<(u8, usize, u8), u32>,
}

/// No vertex.
const NONE: u32 = u32::MAX;

impl Mesh {
    fn new(grid: Grid) -> Self {
        let row = grid.width + 1;
        let first = vec![NONE; row * (grid.height + 1)];
        Self {
            vertices: Vec::new(),
            triangles: Vec::new(),
            translucent: Vec::new(),
            row,
            first,
            others: HashMap::new(),
        }
    }

    fn vertex(&mut self, layer: u8, corner: Corner) -> u32 {
        let at = corner.at[1] * self.row + corner.at[0];
        let index = match layer == 0 && corner.point == 0 {
            true => &mut self.first[at],
            false => self.others.entry((layer, at, corner.point)).or_insert(NONE),
        };
        if *index == NONE {
            *index = self.vertices.len() as u32;
            let place = Vec2::new(corner.at[0] as f32, corner.at[1] as f32);
            self.vertices.push(ReliefVertex { place, disparity: corner.disparity, layer });
        }
        *index
    }

    /// Adds a layer's triangles, except for cells that are not whole.
    fn add(
        &mut self,
        cells: &Cells,
        layer: usize,
        metric: Metric,
        tolerance: f32,
        is_whole: &(dyn Fn(usize) -> bool + Sync),
    ) {
        for triangle in Triangulation::new(cells, layer, metric, is_whole).triangles(tolerance) {
            // A triangle over a cell that is not whole is half of that cell.
            let least = [0, 1].map(|axis| triangle.corners.iter().map(|at| at[axis]).min().unwrap_or(0));
            if !is_whole(cells.grid.at(least[0], least[1])) {
                continue;
            }
            // Of the points at a corner it uses that of its own cell there: toward its middle.
            let sum = [0, 1].map(|axis| triangle.corners.iter().map(|at| at[axis]).sum::<usize>());
            let corners = triangle
                .corners
                .map(|at| cells.corner_at(layer, at, [3 * at[0] > sum[0], 3 * at[1] > sum[1]]));
            let [Some(a), Some(b), Some(c)] = corners else { continue };
            let corners = [a, b, c].map(|corner| self.vertex(layer as u8, corner));
            self.triangles.push(corners);
        }
    }

    /// Adds a translucent cell of the first layer.
    fn add_translucent(&mut self, cells: &Cells, cell: usize) {
        let corners = [[false, false], [false, true], [true, true], [true, false]];
        let [a, b, c, d] = corners.map(|at| self.vertex(0, cells.corner(0, cell, at)));
        self.translucent.extend([[a, b, c], [a, c, d]]);
    }

    /// Adds a part of a cell of the first layer: the outline, in it.
    fn add_part(&mut self, cells: &Cells, cell: usize, outline: &[Vec2]) {
        let grid = cells.grid;
        let corner = Vec2::new((cell % grid.width) as f32, (cell / grid.width) as f32);
        let around = [[false, false], [true, false], [false, true], [true, true]];
        let around = around.map(|at| cells.corner(0, cell, at));
        let vertices: Vec<u32> = outline
            .iter()
            .map(|place| {
                let is_at = |at: &&Corner| Vec2::new(at.at[0] as f32, at.at[1] as f32) == corner + *place;
                if let Some(&shared) = around.iter().find(is_at) {
                    return self.vertex(0, shared);
                }
                let [a, b, c, d] = around.map(|corner| corner.disparity);
                let (above, below) = (a + (b - a) * place.x, c + (d - c) * place.x);
                let disparity = above + (below - above) * place.y;
                self.vertices.push(ReliefVertex { place: corner + *place, disparity, layer: 0 });
                self.vertices.len() as u32 - 1
            })
            .collect();
        for pair in vertices[1..].windows(2) {
            self.triangles.push([vertices[0], pair[0], pair[1]]);
        }
    }
}

/// The translucent cells of the first layer, with the outline in each if its edge is a straight line.
fn outlines<'a>(
    cells: &'a Cells,
    opacity: &'a [f32],
    jump: f32,
) -> impl Iterator<Item = (usize, Option<Vec<Vec2>>)> + 'a {
    let (grid, front) = (cells.grid, &cells.disparity[0]);
    let shares = move |cell: usize| {
        let (x, y) = (cell % grid.width, cell / grid.width);
        let mut shares = [[0.0; 3]; 3];
        for (dy, row) in shares.iter_mut().enumerate() {
            for (dx, share) in row.iter_mut().enumerate() {
                // The border is extended.
                let x = (x + dx).saturating_sub(1).min(grid.width - 1);
                let y = (y + dy).saturating_sub(1).min(grid.height - 1);
                let step = front[grid.at(x, y)] - front[cell];
                *share = match step {
                    // An occluder hides the coverage there.
                    step if step > jump => return None,
                    step if step >= -jump => opacity[grid.at(x, y)],
                    _ => 0.0,
                };
            }
        }
        Some(shares)
    };
    let in_part = (0..grid.count()).filter(|&cell| opacity[cell] < 1.0);
    in_part.map(move |cell| (cell, shares(cell).and_then(|shares| outline::fit_outline(&shares))))
}
