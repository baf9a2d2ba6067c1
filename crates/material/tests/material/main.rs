//! Energy conservation and sampling of materials.

mod energy;
mod lobes;
mod sampling;
