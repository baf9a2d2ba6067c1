//! What a file holds, triangles or not.

use crate::Animation;
use serde::Serialize;

/// Counts of a glTF file, for `info`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Inspection {
    /// What wrote the file, as it says.
    pub generator: Option<String>,
    /// Nodes of the file.
    pub nodes: usize,
    /// Nodes of the shown scene that KHR_node_visibility hides, those below included.
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
    /// What they are.
    pub animation_list: Vec<Animation>,
    /// Triangles that the scene shows, instances counted each.
    pub triangles: usize,
    /// Extensions that the file uses.
    pub extensions_used: Vec<String>,
    /// Extensions that the file requires.
    pub extensions_required: Vec<String>,
    /// What is wrong but does no harm.
    pub warnings: Vec<String>,
}
