//! Photographs of a capture as a strip shows them: small, and read one after the other when they are looked at.

use crate::error::SessionError;
use jobs::{Urgency, Waker, catch_panics, run_in_own_pool};
use lens::{Exposure, Picture};
use render::{ScreenPixel, Tone, to_screen};
use scene::{LoadOptions, Scene, View};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

/// The longer side of a small picture, px, at most.
const SIDE_PX: u32 = 192;

/// Small pictures of a scene's photographs: first those that its light is made from, then those left out.
pub struct Thumbnails {
    shared: Arc<Shared>,
    waker: Waker,
}

/// A photograph, small, as the screen has it.
#[derive(Debug, PartialEq)]
pub struct Thumbnail {
    /// Columns and rows.
    pub size: [usize; 2],
    /// Row by row.
    pub pixels: Vec<ScreenPixel>,
}

/// A small picture, or why there is none.
pub type ThumbnailResult = Result<Arc<Thumbnail>, Arc<str>>;

struct Shared {
    scene: Arc<Scene>,
    state: Mutex<ReadState>,
}

#[derive(Default)]
struct ReadState {
    /// The latest last: it is read first.
    pending: Vec<usize>,
    finished: HashMap<usize, ThumbnailResult>,
    is_reading: bool,
}

impl Thumbnails {
    /// Thumbnails of a scene, none of which is read yet. `waker` is called when one is there.
    pub fn new(scene: Arc<Scene>, waker: Waker) -> Self {
        Self { shared: Arc::new(Shared { scene, state: Mutex::default() }), waker }
    }

    /// Whether the thumbnails are those of this scene.
    pub fn is_for_scene(&self, scene: &Arc<Scene>) -> bool {
        Arc::ptr_eq(&self.shared.scene, scene)
    }

    /// The photograph of this number, if it was read; else it is read next.
    pub fn get(&self, number: usize) -> Option<ThumbnailResult> {
        let mut state = self.shared.lock_state();
        if let Some(finished) = state.finished.get(&number) {
            return Some(finished.clone());
        }
        state.pending.retain(|&pending| pending != number);
        state.pending.push(number);
        if !std::mem::replace(&mut state.is_reading, true) {
            let (shared, waker) = (Arc::downgrade(&self.shared), self.waker.clone());
            if std::thread::Builder::new()
                .name("photographs".into())
                .spawn(move || read(&shared, &waker))
                .is_err()
            {
                state.is_reading = false;
            }
        }
        None
    }
}

impl Shared {
    fn lock_state(&self) -> MutexGuard<'_, ReadState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Reads what is wanted until nothing is, or nobody is there who wanted it.
fn read(shared: &Weak<Shared>, waker: &Waker) {
    while let Some(shared) = shared.upgrade() {
        let next = {
            let mut state = shared.lock_state();
            let next = state.pending.pop();
            state.is_reading = next.is_some();
            next
        };
        let Some(number) = next else { return };
        let mut views = shared.scene.all_views();
        let Some(view) = views.nth(number) else { continue };
        let result = catch_panics("reading a photograph", || {
            run_in_own_pool(Urgency::Background, || load_thumbnail(view))
        });
        shared
            .lock_state()
            .finished
            .insert(number, result.map(Arc::new).map_err(|error| error.to_string().into()));
        waker();
    }
}

fn load_thumbnail(view: &View) -> Result<Thumbnail, SessionError> {
    let photograph = view.read_photograph(&LoadOptions::default());
    let photograph = photograph.map_err(|error| SessionError::BadInput(error.to_string()))?;
    let factor = photograph.width.max(photograph.height).div_ceil(SIDE_PX);
    let small = photograph.downsampled(factor);
    let coverage = vec![1.0; small.pixels.len()];
    let picture = Picture {
        width: small.width,
        height: small.height,
        radiance: small.pixels,
        coverage,
        colour_coverage: None,
    };
    let pixels = to_screen(&picture, Tone { exposure: Exposure::Conserve, ..Tone::default() });
    Ok(Thumbnail { size: [small.width as usize, small.height as usize], pixels })
}
