//! The compute passes of the sum, and what they are bound to.

use crate::gpu::formats::{KINDS, LANES, SCAN_THREADS};
use crate::gpu::shader_source;
use graphics_card::{Bound, Gpu, Pass, bind_group_layout as layout, shader_module};
use std::sync::Arc;
use wgpu::{BindGroupLayout, Device};

/// All passes.
pub struct Passes {
    /// Listing what is drawn: counting, then writing.
    pub list: [Pass; 2],
    pub list_layout: BindGroupLayout,
    /// Drawing, by kind of record: onto ordinary accumulators, then onto wide ones. By a thread a record, and by [`LANES`] threads.
    pub draw: [[[Pass; 2]; KINDS]; 2],
    pub draw_layout: BindGroupLayout,
    pub integrate: Pass,
    pub integrate_wide: Pass,
    pub integrate_layout: BindGroupLayout,
    pub finish: Pass,
    pub balance: Pass,
    pub share: Pass,
    pub finish_layout: BindGroupLayout,
}

impl Passes {
    /// The passes of a card.
    pub fn of(gpu: &Gpu) -> Arc<Self> {
        gpu.cached(Self::new)
    }

    /// Loads the shaders of all passes.
    fn new(device: &Device) -> Self {
        use Bound::{Read, Uniform, Write};
        let module = |name: &'static str, source: String| shader_module(device, name, source);
        let (list, draw) = (module("list", shader_source::list()), module("draw", shader_source::draw()));
        let resolve = module("resolve", shader_source::resolve(has_whole_subgroups(device)));
        let list_layout = layout(
            device,
            [(0, Read), (1, Read), (2, Read), (3, Read), (4, Write), (5, Write), (6, Uniform)],
        );
        let reads = (0..6).map(|binding| (binding, Read));
        let draw_layout = layout(device, reads.chain([(6, Write), (7, Write), (8, Uniform)]));
        let integrate_layout =
            layout(device, [(0, Read), (1, Write), (2, Uniform), (3, Uniform), (4, Write)]);
        let finish_layout = layout(
            device,
            [
                (2, Uniform),
                (3, Uniform),
                (5, Read),
                (6, Read),
                (7, Write),
                (8, Write),
                (9, Write),
                (10, Read),
            ],
        );
        let of_kind = |is_wide: f64, kind: usize| {
            [1, LANES].map(|lanes| {
                let constants = [("IS_WIDE", is_wide), ("KIND", kind as f64), ("LANES", lanes.into())];
                Pass::new(&draw, &draw_layout, "draw", &constants)
            })
        };
        Self {
            list: [1.0, 0.0]
                .map(|is_counting| Pass::new(&list, &list_layout, "list", &[("IS_COUNTING", is_counting)])),
            list_layout: list_layout.clone(),
            draw: [0.0, 1.0].map(|is_wide| std::array::from_fn(|kind| of_kind(is_wide, kind))),
            draw_layout: draw_layout.clone(),
            integrate: Pass::new(&resolve, &integrate_layout, "integrate", &[]),
            integrate_wide: Pass::new(&resolve, &integrate_layout, "integrate_wide", &[]),
            integrate_layout: integrate_layout.clone(),
            finish: Pass::new(&resolve, &finish_layout, "finish", &[]),
            balance: Pass::new(&resolve, &finish_layout, "balance", &[]),
            share: Pass::new(&resolve, &finish_layout, "share", &[]),
            finish_layout: finish_layout.clone(),
        }
    }
}

/// Whether a workgroup falls into subgroups of one size, whole ones.
fn has_whole_subgroups(device: &Device) -> bool {
    let info = device.adapter_info();
    let size = info.subgroup_min_size;
    device.features().contains(wgpu::Features::SUBGROUP)
        && size == info.subgroup_max_size
        && size >= 4
        && SCAN_THREADS.is_multiple_of(size)
}
