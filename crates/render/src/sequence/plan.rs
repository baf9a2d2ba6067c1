//! What the bytes of a frame depend on, as a checksum: a frame whose file was made by the same plan is finished.

use crate::picture::RenderOptions;
use crate::sequence::scene_in_time::SceneInTime;
use crate::sequence::take::FrameState;
use focus::{Focus, FocusMap, FocusSource};
use lens::Camera;
use light::LitScene;
use sha2::{Digest, Sha256};
use std::sync::Arc;

/// Changes whenever the same input may give other bytes.
const VERSION: &str = concat!("frame 1, ", env!("CARGO_PKG_VERSION"));

/// The plan of a picture of what is seen at an instant; `written` says in which form.
pub(crate) fn frame_plan(at: &FrameState, baked: &str, options: &RenderOptions, written: &str) -> [u8; 32] {
    let mut hash = Sha256::new();
    let mut add = |bytes: &[u8]| {
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    add(VERSION.as_bytes());
    add(&at.scene.hash);
    // Mattes are called after objects.
    at.scene.scene.nodes.iter().for_each(|node| add(node.name.as_bytes()));
    // Written out, numbers are as exact as they are.
    add(format!("{:?}", at.camera).as_bytes());
    add(baked.as_bytes());
    add_focus(&mut add, &at.focus);
    // Where it is summed makes no difference.
    let anywhere = RenderOptions { gpu: None, ..options.clone() };
    add(format!("{anywhere:?}").as_bytes());
    add(written.as_bytes());
    hash.finalize().into()
}

/// The plan of a picture of a scene that stands still.
pub(crate) fn still_frame_plan(
    lit: &Arc<LitScene>,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    written: &str,
) -> [u8; 32] {
    let scene = Arc::new(SceneInTime::at_rest(lit.clone()));
    let at = FrameState { scene, camera: camera.clone(), focus: focus.clone(), placed: camera.clone() };
    frame_plan(&at, "", options, written)
}

fn add_focus(add: &mut dyn FnMut(&[u8]), focus: &Focus) {
    add(format!("{:?}", focus.background).as_bytes());
    // One map is most often that of all parts.
    let mut last: Option<Arc<FocusMap>> = None;
    for source in &focus.parts {
        match source {
            FocusSource::Constant(value) => add(format!("{value:?}").as_bytes()),
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
