//! Cases of light transport and of light fields: energy, scattering, transparency, ranges.

pub mod chance;
pub mod energy;
pub mod furnace;
pub mod glass;
pub mod lobes;
pub mod mirrors;
pub mod panes;
pub mod ranges;
pub mod rooms;
pub mod white;
