//! Why a page cannot be made.

/// Why a page cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WebPageError {
    /// The picture has no pixel, or more than WebP allows on a side.
    #[error("a picture of {0} × {1} px does not fit a web page (each side: 1 to {MAX_SIDE_PX} px)")]
    Size(u32, u32),
    /// The encoder refused a picture or other data, usually for lack of memory.
    #[error("a picture cannot be encoded for the page: {0} (free some memory, or export a smaller picture)")]
    Encoder(String),
    /// The slices need more bytes than are allowed.
    #[error("the slices take more bytes than the page may have")]
    TooLarge,
    /// The template and the values for its holes do not match: a bug.
    #[error("the template of the page has no hole {0:?}, or no value for it (please report this)")]
    Template(String),
    /// Data of the page contradict each other: a bug.
    #[error("the data of the page contradict each other: {0} (please report this)")]
    Inconsistent(&'static str),
}

/// The largest side of a WebP picture, px.
pub const MAX_SIDE_PX: u32 = 16383;
