//! Plans: hashes of everything that the bytes of a frame depend on. A frame whose file has the same plan is finished.

use crate::picture::RenderOptions;
use crate::sequence::scene_in_time::SceneInTime;
use crate::sequence::take::FrameState;
use focus::{Focus, FocusMap, FocusSource};
use lens::Camera;
use light::LitScene;
use salf::BakedOn;
use sha2::{Digest, Sha256};
use std::sync::Arc;

/// Must change whenever the same input may give different bytes.
const VERSION: &str = concat!("frame 1, ", env!("CARGO_PKG_VERSION"));

/// The plan of a frame. `written` describes the output format, `baked` the light field.
pub(crate) fn frame_plan(
    state: &FrameState,
    baked: &str,
    options: &RenderOptions,
    written: &str,
) -> [u8; 32] {
    let mut hash = Sha256::new();
    let mut add = |bytes: &[u8]| {
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    add(VERSION.as_bytes());
    add(&state.scene.hash);
    // Mattes are named after objects.
    state.scene.scene.nodes.iter().for_each(|node| add(node.name.as_bytes()));
    // `Debug` output of floats is exact.
    add(format!("{:?}", state.camera).as_bytes());
    add(baked.as_bytes());
    add_focus(&mut add, &state.focus);
    // The device that sums does not change the result; that which bakes does, by the last bits of floats, whichever card it is.
    let anywhere = RenderOptions { gpu: None, bake_on: None, ..options.clone() };
    add(format!("{anywhere:?}").as_bytes());
    if options.bake_on.is_some() {
        add(BakedOn::Card.name().as_bytes());
    }
    add(written.as_bytes());
    hash.finalize().into()
}

/// The plan of a picture of a scene at rest.
pub(crate) fn still_frame_plan(
    lit: &Arc<LitScene>,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    written: &str,
) -> [u8; 32] {
    let scene = Arc::new(SceneInTime::at_rest(lit.clone()));
    let state =
        FrameState { scene, camera: camera.clone(), focus: focus.clone(), base_camera: camera.clone() };
    frame_plan(&state, "", options, written)
}

fn add_focus(add: &mut dyn FnMut(&[u8]), focus: &Focus) {
    add(format!("{:?}", focus.background).as_bytes());
    // All parts usually share one map, or the values of triangles.
    let mut last: Option<Arc<FocusMap>> = None;
    let mut last_values = None;
    for source in &focus.parts {
        match source {
            FocusSource::Constant(value) => add(format!("{value:?}").as_bytes()),
            FocusSource::Triangles(values) if last_values == Some(values.as_ptr()) => add(b"the same values"),
            FocusSource::Triangles(values) => {
                add(format!("{values:?}").as_bytes());
                last_values = Some(values.as_ptr());
            }
            FocusSource::Uv { image, wrap } => {
                add(format!("{} {} {wrap:?}", image.width, image.height).as_bytes());
                add(bytemuck::cast_slice(&image.texels));
                add(bytemuck::cast_slice(image.gloss.as_deref().unwrap_or_default()));
            }
            FocusSource::Atlas { map, .. } if last.as_ref().is_some_and(|last| Arc::ptr_eq(last, map)) => {
                add(b"the same map");
            }
            FocusSource::Atlas { atlas, map } => {
                add(atlas.hash.as_bytes());
                add(bytemuck::cast_slice(&map.to_rows()));
                add(bytemuck::cast_slice(&map.gloss_rows().unwrap_or_default()));
                last = Some(map.clone());
            }
        }
    }
}
