//! What a light field is.

use super::arrangement::ViewLayout;
use super::optics::Optics;
use crate::Remark;
use crate::depth_map::DepthMap;
use crate::picture_source::PictureSource;
use glam::DVec2;
use std::path::PathBuf;

/// One view of a light field: the picture through one point of the aperture.
#[derive(Clone, Debug)]
pub struct SubAperture {
    /// What it is called: its file's name, or `row_column` of a mosaic.
    pub name: String,
    /// Column and row as it is named, from 0, of a grid.
    pub cell: Option<[u32; 2]>,
    /// Where in the aperture it was taken from, relative to the reference view: x right, y down, in steps between neighbouring views. The
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
    /// The view whose pixels it is of, an index of [`LightField::views`].
    pub view: usize,
    /// Its file.
    pub file: PathBuf,
}

/// Pictures of one place from points of one plane, all looking the same way.
#[derive(Clone, Debug)]
pub struct LightField {
    /// What it is called: its folder's or file's name.
    pub name: String,
    /// The folder of the views, or the mosaic.
    pub path: PathBuf,
    /// How they are arranged.
    pub layout: ViewLayout,
    /// The views, row by row as they are named; at least two.
    pub views: Vec<SubAperture>,
    /// Columns and rows of each picture.
    pub size: [u32; 2],
    /// Columns and rows of the grid, with what is missing; none of a hexagon or a list.
    pub grid: Option<[u32; 2]>,
    /// The middle view, an index of [`Self::views`]; its position is 0.
    pub reference: usize,
    /// The disparity map that came with them.
    pub disparity: Option<ViewDisparity>,
    /// A map of the reference's disparities that is coded by colour, and what the code is has to be found out from the views.
    pub coded_disparity: Option<PictureSource>,
    /// What the files say of the camera.
    pub optics: Optics,
    /// What is incomplete, or good to know.
    pub remarks: Vec<Remark>,
}

impl LightField {
    /// The view of a name.
    pub fn view(&self, name: &str) -> Option<usize> {
        self.views.iter().position(|view| view.name == name)
    }
}
