//! Snapshots of a picture that changes in few rows at a time: what was shown before is brought up to date where it
//! changed, instead of copied anew.

use focus::rectangle_union;
use lens::Picture;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Columns and rows.
pub(crate) type Rectangle = [Range<u32>; 2];

/// Snapshots that are kept: the newest, the one that is looked at, and one to write.
const SNAPSHOTS: usize = 3;

/// Snapshots of one picture, the newest last.
///
/// A better picture may be laid over the one that is followed ([`Self::overlay`]): what changes afterwards is shown as it is
/// followed, the rest stays as good as it was.
#[derive(Default)]
pub(crate) struct PictureRing {
    snapshots: Vec<Snapshot>,
    /// The picture that is followed, where another one lies over it.
    base: Option<Arc<Picture>>,
}

struct Snapshot {
    picture: Arc<Picture>,
    /// Where the newest one differs from it.
    stale: Option<Rectangle>,
}

impl PictureRing {
    /// A snapshot of what is shown once `picture` has taken the place of the last one that was followed, from which it
    /// differs within `window` at most; and where it differs from that, `None` where in nothing.
    pub fn follow(&mut self, picture: &Picture, window: &Rectangle) -> (Arc<Picture>, Option<Rectangle>) {
        let Some(followed) = self.followed().filter(|followed| same_size(followed, picture)) else {
            return (self.begin(picture), Some(whole(picture)));
        };
        let changed = difference(&followed, picture, window);
        drop(followed);
        if let (Some(base), Some(changed)) = (&mut self.base, &changed) {
            copy(Arc::make_mut(base), picture, changed);
        }
        (self.show(picture, changed.as_ref()), changed)
    }

    /// Lays a better picture over the one that is followed; where it differs from what was shown.
    pub fn overlay(&mut self, picture: &Picture) -> (Arc<Picture>, Option<Rectangle>) {
        let Some(followed) = self.followed().filter(|followed| same_size(followed, picture)) else {
            return (self.begin(picture), Some(whole(picture)));
        };
        self.base = Some(followed);
        let shown = self.snapshots.last().map(|snapshot| &snapshot.picture);
        let changed = shown.and_then(|shown| difference(shown, picture, &whole(picture)));
        (self.show(picture, changed.as_ref()), changed)
    }

    /// The picture that changes are made to; `None` before the first.
    pub fn followed(&self) -> Option<Arc<Picture>> {
        self.base.as_ref().or(self.snapshots.last().map(|snapshot| &snapshot.picture)).cloned()
    }

    /// A snapshot of what was shown last, with a rectangle of `picture`, which is of the same size.
    fn show(&mut self, picture: &Picture, changed: Option<&Rectangle>) -> Arc<Picture> {
        let Some((last, older)) = self.snapshots.split_last_mut() else { return self.begin(picture) };
        let newest = last.picture.clone();
        let Some(changed) = changed else { return newest };
        // One that nobody looks at any more is written; else a new one is made.
        let free = older.iter_mut().position(|snapshot| Arc::get_mut(&mut snapshot.picture).is_some());
        for snapshot in &mut self.snapshots {
            let stale =
                snapshot.stale.as_ref().map_or(changed.clone(), |stale| rectangle_union(stale, changed));
            snapshot.stale = Some(stale);
        }
        let mut next = match free.map(|index| self.snapshots.remove(index)) {
            Some(Snapshot { mut picture, stale }) => {
                if let (Some(old), Some(stale)) = (Arc::get_mut(&mut picture), stale) {
                    copy(old, &newest, &stale);
                }
                picture
            }
            None => Arc::new((*newest).clone()),
        };
        copy(Arc::make_mut(&mut next), picture, changed);
        self.snapshots.push(Snapshot { picture: next.clone(), stale: None });
        if self.snapshots.len() > SNAPSHOTS {
            self.snapshots.remove(0);
        }
        next
    }

    /// A snapshot of a picture that has nothing to do with those of before.
    pub fn begin(&mut self, picture: &Picture) -> Arc<Picture> {
        let snapshot = Arc::new(picture.clone());
        self.base = None;
        self.snapshots = vec![Snapshot { picture: snapshot.clone(), stale: None }];
        snapshot
    }

    /// Makes the snapshots now that the next pictures will be written to.
    pub fn make_room(&mut self) {
        let Some(newest) = self.snapshots.last().map(|snapshot| snapshot.picture.clone()) else { return };
        while self.snapshots.len() < SNAPSHOTS {
            self.snapshots.insert(0, Snapshot { picture: Arc::new((*newest).clone()), stale: None });
        }
    }
}

fn same_size(a: &Picture, b: &Picture) -> bool {
    (a.width, a.height) == (b.width, b.height)
}

/// All of a picture.
pub(crate) fn whole(picture: &Picture) -> Rectangle {
    [0..picture.width, 0..picture.height]
}

/// The least rectangle within a `window` that holds all pixels in which two pictures of one size differ, to the bit.
fn difference(a: &Picture, b: &Picture, [columns, rows]: &Rectangle) -> Option<Rectangle> {
    let width = a.width as usize;
    let differs = |k: usize| {
        a.radiance[k].map(f32::to_bits) != b.radiance[k].map(f32::to_bits)
            || a.coverage[k].to_bits() != b.coverage[k].to_bits()
    };
    let row_difference = |row: u32| {
        let first = row as usize * width;
        let start = columns.clone().find(|x| differs(first + *x as usize))?;
        let end = columns.clone().rev().find(|x| differs(first + *x as usize))? + 1;
        Some([start..end, row..row + 1])
    };
    let differing = rows.clone().into_par_iter().with_min_len(8).filter_map(row_difference);
    differing.reduce_with(|a, b| rectangle_union(&a, &b))
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
        let (first, changed) = ring.follow(&picture, &[0..90, 0..40]);
        assert_eq!(changed, Some([0..90, 0..40]));
        let mut held = vec![(first, picture.clone())];
        for k in 0..40u32 {
            let [x, y] = [(k * 37) % 90, (k * 11) % 40];
            picture.coverage[(y * 90 + x) as usize] = k as f32 + 1.0;
            let (next, changed) = ring.follow(
                &picture,
                &[x.saturating_sub(5)..(x + 9).min(90), y.saturating_sub(3)..(y + 3).min(40)],
            );
            assert_eq!(changed, Some([x..x + 1, y..y + 1]));
            // As a window does: now and then the newest is taken, and those of before are let go.
            if k % 3 == 0 {
                held.remove(0);
                held.push((next.clone(), picture.clone()));
            }
            assert_eq!(*next, picture);
            assert!(held.iter().all(|(snapshot, was)| **snapshot == *was), "what is looked at stays");
        }
        let (_, changed) = ring.follow(&picture, &[0..90, 0..40]);
        assert_eq!(changed, None);
        let (_, changed) = ring.follow(&Picture::black(4, 4), &[0..0, 0..0]);
        assert_eq!(changed, Some([0..4, 0..4]), "another size is another picture");
    }

    #[test]
    fn room_is_made_ahead_and_does_not_show() {
        let mut ring = PictureRing::default();
        ring.make_room();
        let mut picture = Picture::black(30, 20);
        let held = ring.begin(&picture);
        ring.make_room();
        let room: Vec<_> = ring.snapshots.iter().map(|snapshot| Arc::as_ptr(&snapshot.picture)).collect();
        assert_eq!(room.len(), SNAPSHOTS);
        for k in 0..2 {
            picture.coverage[40 + k] = 2.0;
            let (next, _) = ring.follow(&picture, &[0..30, 0..20]);
            assert_eq!(*next, picture);
            assert!(room.contains(&Arc::as_ptr(&next)), "no other snapshot is made");
        }
        assert_eq!(*held, Picture::black(30, 20));
    }

    #[test]
    fn a_better_picture_stays_where_nothing_changes() {
        let mut ring = PictureRing::default();
        let mut followed = Picture::black(60, 30);
        followed.coverage.fill(1.0);
        ring.begin(&followed);
        let mut exact = followed.clone();
        exact.coverage.iter_mut().step_by(7).for_each(|coverage| *coverage = 1.25);
        let (shown, changed) = ring.overlay(&exact);
        assert_eq!((&*shown, changed.map(|[columns, _]| columns)), (&exact, Some(0..60)));
        assert_eq!(*ring.followed().unwrap(), followed);
        let mut expected = exact.clone();
        for k in 0..20 {
            // A stroke changes what is followed: that shows, and the rest stays.
            let [x, y] = [(k * 13) % 60, (k * 7) % 30];
            followed.coverage[y * 60 + x] = 2.0 + k as f32;
            expected.coverage[y * 60 + x] = 2.0 + k as f32;
            let (shown, changed) = ring.follow(&followed, &[0..60, 0..30]);
            let at = |k: usize| k as u32..k as u32 + 1;
            assert_eq!(changed, Some([at(x), at(y)]));
            assert_eq!(*shown, expected);
        }
        let mut again = exact.clone();
        again.coverage[5] = 9.0;
        let (shown, changed) = ring.overlay(&again);
        assert_eq!(*shown, again);
        assert!(changed.is_some_and(|[columns, rows]| columns.contains(&5) && rows.contains(&0)));
        assert_eq!(*ring.followed().unwrap(), followed);
        let (shown, _) = ring.overlay(&again);
        assert_eq!(*shown, again, "nothing is left to change");
        assert_eq!(*ring.begin(&followed), followed);
        assert_eq!(*ring.followed().unwrap(), followed, "nothing lies over it");
    }
}
