//! A summary of a file's content, with or without triangles.

use crate::Animation;
use serde::Serialize;

/// Counts of a glTF file, for `info`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Inspection {
    /// The program that wrote the file, if it says so.
    pub generator: Option<String>,
    /// Nodes of the file.
    pub nodes: usize,
    /// Nodes of the shown scene that KHR_node_visibility hides, including descendants.
    pub hidden_nodes: usize,
    /// Meshes of the file.
    pub meshes: usize,
    /// Primitives of the file by mode: points, lines, line loops, line strips, triangles, strips, fans.
    pub primitives: [usize; 7],
    /// Materials of the file.
    pub materials: usize,
    /// Names of its variants (KHR_materials_variants).
    pub variants: Vec<String>,
    /// Images of the file.
    pub images: usize,
    /// Cameras of the file.
    pub cameras: usize,
    /// Lights of the file.
    pub lights: usize,
    /// Skins of the file.
    pub skins: usize,
    /// Animations of the file.
    pub animations: usize,
    /// Their names and durations.
    pub animation_list: Vec<Animation>,
    /// Triangles that the scene shows, counting each instance.
    pub triangles: usize,
    /// Gaussian splats that are shown (KHR_gaussian_splatting).
    pub splats: usize,
    /// Extensions that the file uses.
    pub extensions_used: Vec<String>,
    /// Extensions that the file requires.
    pub extensions_required: Vec<String>,
    /// Harmless defects, a sentence each.
    pub warnings: Vec<String>,
}
