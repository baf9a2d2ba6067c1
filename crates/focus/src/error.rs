//! Errors of this crate.

/// Why a focus cannot be used or painted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FocusError {
    /// The scene has no such material or node.
    #[error("no {kind} is called \"{name}\" ({hint})")]
    UnknownName {
        /// "material" or "node".
        kind: &'static str,
        /// The name in the recipe.
        name: String,
        /// Similar names, or some of the existing ones.
        hint: String,
    },
    /// A map on a part without texture coordinates.
    #[error(
        "{entry}: {part} has no texture coordinates to place a map with (give it a TEXCOORD_0, or a constant t)"
    )]
    NoTextureCoordinates {
        /// The recipe's entry.
        entry: String,
        /// The node and material of the part.
        part: String,
    },
    /// The background cannot have a map.
    #[error(
        "background: a map needs texture coordinates, which the background does not have (give it a constant t)"
    )]
    BackgroundMap,
    /// A number that cannot be used.
    #[error("{entry}: t must be finite, anchor and gloss in [0, 1]")]
    BadValue {
        /// The recipe's entry.
        entry: String,
    },
    /// A brush with invalid settings.
    #[error("brush: {problem}")]
    BadBrush {
        /// What is invalid.
        problem: &'static str,
    },
    /// A change of the layers that is not possible.
    #[error("layers: {problem}")]
    BadLayerEdit {
        /// What is wrong with it.
        problem: &'static str,
    },
    /// The stack already has the maximum number of layers.
    #[error("layers: there are {limit} already (remove one first)")]
    TooManyLayers {
        /// The maximum number.
        limit: usize,
    },
    /// The map belongs to another atlas.
    #[error("the focus map has {}×{} texels, the atlas {}×{} (bake the focus again for this atlas)", map[0], map[1], canvas[0], canvas[1])]
    SizesDiffer {
        /// Columns and rows of the map.
        map: [u32; 2],
        /// Columns and rows of the canvas.
        canvas: [u32; 2],
    },
}
