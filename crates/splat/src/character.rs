//! The character of a lens as the splat draws it: discs that are cut and weighed, colours that are focused and sized unlike.
//!
//! A node's image is drawn in the forms of a plain lens; where rims cut the aperture, or edges weigh it, each of its rows is
//! ended and weighed by formula ([`node_shape`]), and boxes have the light, the mean and the spread of the cut aperture
//! ([`moment_table`]). A picture of several focuses is three pictures, one a colour, each with a lens of its own.

pub mod magnification;
pub mod moment_table;
pub mod node_shape;
pub mod shaper;
