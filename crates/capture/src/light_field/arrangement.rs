//! Which files are views, and the position of each in the aperture.

use glam::DVec2;
use std::path::PathBuf;

/// How the views of a light field are arranged, and how their files encode that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewLayout {
    /// A grid, numbered row by row: `input_Cam000.png` … of the 4D Light Field Benchmark.
    Numbered,
    /// A grid, named by row and column: `03_04.png` and the like.
    RowColumn,
    /// A grid, whose names have positions, too: `out_RR_CC_Y_X.png` of the Stanford archive.
    Positions,
    /// A centre view and six around it.
    Hexagon,
    /// Positions from `views.json`.
    Listed,
    /// The pixels of micro-images in one picture.
    MicroImages,
}

/// A view, before its file was opened.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub file: PathBuf,
    pub name: String,
    /// Column and row according to its name, for a grid.
    pub cell: Option<[u32; 2]>,
    /// x right, y down; a step between neighbours is 1.
    pub position: DVec2,
}

/// The views of a folder.
#[derive(Clone, Debug)]
pub(crate) struct Arrangement {
    pub layout: ViewLayout,
    /// The folder of the views.
    pub folder: PathBuf,
    pub views: Vec<Placed>,
    /// Columns and rows of the grid.
    pub grid: Option<[u32; 2]>,
    /// The number of the first view of a numbered grid; otherwise 0.
    pub first_number: u32,
    /// The view that a list declares as the middle one.
    pub reference: Option<usize>,
    /// The disparity map that a list names.
    pub disparity: Option<PathBuf>,
    /// Whether other pictures hardly ever have such names.
    pub is_certain: bool,
    /// Sentences about irregularities, without the folder, and the names they are about.
    pub notes: Vec<(String, Vec<String>)>,
}

impl Arrangement {
    /// The middle of the aperture, in the units of the views' positions.
    pub fn middle(&self) -> DVec2 {
        match (self.grid, self.layout) {
            (Some([columns, rows]), ViewLayout::Numbered | ViewLayout::RowColumn) => {
                DVec2::new(f64::from(columns - 1), f64::from(rows - 1)) * 0.5
            }
            _ => {
                let low = self.views.iter().fold(DVec2::INFINITY, |low, view| low.min(view.position));
                let high = self.views.iter().fold(DVec2::NEG_INFINITY, |high, view| high.max(view.position));
                (low + high) * 0.5
            }
        }
    }
}
