//! The type of light fields.

use super::arrangement::ViewLayout;
use super::optics::Optics;
use crate::Remark;
use crate::depth_map::DepthMap;
use crate::pictures::picture_source::PictureSource;
use glam::DVec2;
use std::path::PathBuf;

/// One view of a light field: the picture through one point of the aperture.
#[derive(Clone, Debug)]
pub struct SubAperture {
    /// Its file's name, or `row_column` in a mosaic.
    pub name: String,
    /// Column and row according to its name, from 0, for a grid.
    pub cell: Option<[u32; 2]>,
    /// The position in the aperture relative to the reference view: x right, y down, in steps between neighbouring views. The
    /// point that the reference shows at pixel p with disparity d is at p − d·position here.
    pub position: DVec2,
    /// Its pixels.
    pub picture: PictureSource,
}

/// A disparity map that came with the views.
#[derive(Clone, Debug)]
pub struct ViewDisparity {
    /// The map.
    pub map: DepthMap,
    /// The view that it belongs to, an index of [`LightField::views`].
    pub view: usize,
    /// Its file.
    pub file: PathBuf,
}

/// Pictures of one place from points of one plane, all looking in the same direction.
#[derive(Clone, Debug)]
pub struct LightField {
    /// The name of its folder or file.
    pub name: String,
    /// The folder of the views, or the mosaic.
    pub path: PathBuf,
    /// The arrangement of the views.
    pub layout: ViewLayout,
    /// The views, row by row according to their names; at least two.
    pub views: Vec<SubAperture>,
    /// Columns and rows of each picture.
    pub size: [u32; 2],
    /// Columns and rows of the grid, including missing views; `None` for a hexagon or a list.
    pub grid: Option<[u32; 2]>,
    /// The middle view, an index of [`Self::views`]; its position is 0.
    pub reference: usize,
    /// The disparity map that came with the views.
    pub disparity: Option<ViewDisparity>,
    /// A map of the reference's disparities that is coded by colour; the code has to be inferred from the views.
    pub coded_disparity: Option<PictureSource>,
    /// The camera parameters in the files.
    pub optics: Optics,
    /// What is incomplete, or good to know.
    pub remarks: Vec<Remark>,
}

impl LightField {
    /// The index of the view with this name; `None` if there is none.
    pub fn view(&self, name: &str) -> Option<usize> {
        self.views.iter().position(|view| view.name == name)
    }
}
