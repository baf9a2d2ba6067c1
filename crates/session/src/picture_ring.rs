//! Snapshots of a picture that changes in few rows at a time: what was shown before is brought up to date where it
//! changed, instead of copied anew.

use focus::union;
use lens::Picture;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Columns and rows.
pub(crate) type Rectangle = [Range<u32>; 2];

/// Snapshots that are kept: the newest, the one that is looked at, and one to write.
const SNAPSHOTS: usize = 3;

/// Snapshots of one picture, the newest last.
#[derive(Default)]
pub(crate) struct PictureRing {
    snapshots: Vec<Snapshot>,
}

struct Snapshot {
    picture: Arc<Picture>,
    /// Where the newest one differs from it.
    stale: Option<Rectangle>,
}

impl PictureRing {
    /// A snapshot of `picture`, which differs from the last one in these rows at most, and where it differs from that;
    /// `None` where in nothing.
    pub fn follow(&mut self, picture: &Picture, rows: Range<u32>) -> (Arc<Picture>, Option<Rectangle>) {
        let size = (picture.width, picture.height);
        let newest = self.snapshots.last().map(|snapshot| &snapshot.picture);
        let Some(newest) = newest.filter(|newest| (newest.width, newest.height) == size) else {
            return (self.begin(picture), Some(whole(picture)));
        };
        let Some(changed) = difference(newest, picture, rows) else { return (newest.clone(), None) };
        for snapshot in &mut self.snapshots {
            let stale = snapshot.stale.as_ref().map_or(changed.clone(), |stale| union(stale, &changed));
            snapshot.stale = Some(stale);
        }
        // One that nobody looks at any more is written; else a new one is made.
        let free =
            self.snapshots.iter_mut().position(|snapshot| Arc::get_mut(&mut snapshot.picture).is_some());
        let next = match free.map(|index| self.snapshots.remove(index)) {
            Some(mut snapshot) => {
                if let (Some(old), Some(stale)) = (Arc::get_mut(&mut snapshot.picture), snapshot.stale.take())
                {
                    copy(old, picture, &stale);
                }
                snapshot.picture
            }
            None => Arc::new(picture.clone()),
        };
        self.snapshots.push(Snapshot { picture: next.clone(), stale: None });
        if self.snapshots.len() > SNAPSHOTS {
            self.snapshots.remove(0);
        }
        (next, Some(changed))
    }

    /// A snapshot of a picture that has nothing to do with those of before.
    pub fn begin(&mut self, picture: &Picture) -> Arc<Picture> {
        let snapshot = Arc::new(picture.clone());
        self.snapshots = vec![Snapshot { picture: snapshot.clone(), stale: None }];
        snapshot
    }
}

/// All of a picture.
pub(crate) fn whole(picture: &Picture) -> Rectangle {
    [0..picture.width, 0..picture.height]
}

/// The least rectangle within `rows` that holds all pixels in which two pictures of one size differ, to the bit.
fn difference(a: &Picture, b: &Picture, rows: Range<u32>) -> Option<Rectangle> {
    let width = a.width as usize;
    let differs = |k: usize| {
        a.radiance[k].map(f32::to_bits) != b.radiance[k].map(f32::to_bits)
            || a.coverage[k].to_bits() != b.coverage[k].to_bits()
    };
    let of_row = |row: u32| {
        let first = row as usize * width;
        let start = (0..width).find(|x| differs(first + x))? as u32;
        let end = (0..width).rev().find(|x| differs(first + x))? as u32 + 1;
        Some([start..end, row..row + 1])
    };
    let differing = rows.into_par_iter().with_min_len(8).filter_map(of_row);
    differing.reduce_with(|a, b| union(&a, &b))
}

/// Makes a rectangle of `to` that of `from`.
fn copy(to: &mut Picture, from: &Picture, [columns, rows]: &Rectangle) {
    for row in rows.clone() {
        let first = row as usize * from.width as usize;
        let span = first + columns.start as usize..first + columns.end as usize;
        to.radiance[span.clone()].copy_from_slice(&from.radiance[span.clone()]);
        to.coverage[span.clone()].copy_from_slice(&from.coverage[span]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snapshots_stay_and_the_newest_is_the_picture() {
        let mut ring = PictureRing::default();
        let mut picture = Picture::black(90, 40);
        let (first, changed) = ring.follow(&picture, 0..40);
        assert_eq!(changed, Some([0..90, 0..40]));
        let mut held = vec![(first, picture.clone())];
        for k in 0..40u32 {
            let [x, y] = [(k * 37) % 90, (k * 11) % 40];
            picture.coverage[(y * 90 + x) as usize] = k as f32 + 1.0;
            let (next, changed) = ring.follow(&picture, y.saturating_sub(3)..(y + 3).min(40));
            assert_eq!(changed, Some([x..x + 1, y..y + 1]));
            // As a window does: now and then the newest is taken, and those of before are let go.
            if k % 3 == 0 {
                held.remove(0);
                held.push((next.clone(), picture.clone()));
            }
            assert_eq!(*next, picture);
            assert!(held.iter().all(|(snapshot, was)| **snapshot == *was), "what is looked at stays");
        }
        let (_, changed) = ring.follow(&picture, 0..40);
        assert_eq!(changed, None);
        let (_, changed) = ring.follow(&Picture::black(4, 4), 0..0);
        assert_eq!(changed, Some([0..4, 0..4]), "another size is another picture");
    }
}
