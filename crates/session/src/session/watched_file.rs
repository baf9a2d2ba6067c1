//! A file that another program may write again.

use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

/// What a bridge writes beside a scene.
const MANIFEST: &str = "focus-brush.json";

/// When a file was written, and its length.
type Stamp = (SystemTime, u64);

/// The file that is watched.
pub(super) struct WatchedFile {
    path: PathBuf,
    /// As it was read.
    read_stamp: Option<Stamp>,
    /// As it was seen last, where that is another.
    pending_stamp: Option<Stamp>,
    pub last_check: Instant,
}

impl WatchedFile {
    /// Watches the file at `scene`, if a bridge wrote it; otherwise `None`.
    pub fn for_bridged_scene(scene: &Path) -> Option<Self> {
        let is_bridged = scene.parent()?.join(MANIFEST).is_file();
        is_bridged.then(|| Self {
            path: scene.into(),
            read_stamp: file_stamp(scene),
            pending_stamp: None,
            last_check: Instant::now(),
        })
    }

    /// Whether it has changed, and stayed so from one look to the next.
    pub fn has_changed(&mut self) -> bool {
        let now = file_stamp(&self.path);
        self.last_check = Instant::now();
        if now.is_none() || now == self.read_stamp {
            self.pending_stamp = None;
            return false;
        }
        if self.pending_stamp != now {
            self.pending_stamp = now;
            return false;
        }
        (self.read_stamp, self.pending_stamp) = (now, None);
        true
    }
}

fn file_stamp(file: &Path) -> Option<Stamp> {
    let metadata = std::fs::metadata(file).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}
