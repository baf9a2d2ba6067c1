//! Drawing with wgpu outside the paint view: device choice, image blitting, and egui shapes on a software
//! adapter.

pub mod blit;
pub mod device;
pub mod soft_painter;
