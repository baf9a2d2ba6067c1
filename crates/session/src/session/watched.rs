//! A file that another program may write again.

use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

/// What a bridge writes beside a scene.
const MANIFEST: &str = "focus-brush.json";

/// When a file was written, and its length.
type Stamp = (SystemTime, u64);

/// The file that is watched.
pub(super) struct Watched {
    scene: PathBuf,
    /// As it was read.
    read: Option<Stamp>,
    /// As it was seen last, where that is another.
    changed: Option<Stamp>,
    pub looked: Instant,
}

impl Watched {
    /// The file at `scene`, if a bridge wrote it.
    pub fn of(scene: &Path) -> Option<Self> {
        let is_bridged = scene.parent()?.join(MANIFEST).is_file();
        is_bridged.then(|| Self {
            scene: scene.into(),
            read: stamp(scene),
            changed: None,
            looked: Instant::now(),
        })
    }

    /// Whether it has changed, and stayed so from one look to the next.
    pub fn is_another(&mut self) -> bool {
        let now = stamp(&self.scene);
        self.looked = Instant::now();
        if now.is_none() || now == self.read {
            self.changed = None;
            return false;
        }
        if self.changed != now {
            self.changed = now;
            return false;
        }
        (self.read, self.changed) = (now, None);
        true
    }
}

fn stamp(file: &Path) -> Option<Stamp> {
    let found = std::fs::metadata(file).ok()?;
    Some((found.modified().ok()?, found.len()))
}
