//! Edges of depth: where they are, how much of a pixel lies before them, and what they hide in other views.

pub(crate) mod covers;
pub(crate) mod jumps;
pub(crate) mod matte;
pub(crate) mod outline;
