//! Placement of the labels of marks: beside their mark, without overlap.

/// Font size of labels in the page's style, px.
const HEIGHT: f64 = 11.0;
/// Mean width of a letter at that size.
const LETTER: f64 = 6.0;
/// Distance from the centre of a mark to its label, px.
const STEP: f64 = 7.0;

/// The boxes of the placed labels: left, top, right, bottom.
pub struct Labels {
    left: f64,
    right: f64,
    taken: Vec<[f64; 4]>,
}

/// Position of a label: the start or the end of its baseline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// px.
    pub x: f64,
    /// px.
    pub y: f64,
    /// The `text-anchor` attribute: which end of the text is at `x`.
    pub anchor: &'static str,
}

impl Labels {
    /// No labels yet; all will lie between `left` and `right`, px.
    pub fn new(left: f64, right: f64) -> Self {
        Self { left, right, taken: Vec::new() }
    }

    /// Reserves a box, where no label is placed.
    pub fn reserve(&mut self, taken: [f64; 4]) {
        self.taken.push(taken);
    }

    /// Places a text beside the mark at (`x`, `y`): at the first free position of right and left, above before
    /// below. `None` if there is no room.
    pub fn place_label(&mut self, x: f64, y: f64, text: &str) -> Option<Place> {
        let width = text.chars().count() as f64 * LETTER;
        let sides = [(-6.0, "start"), (-6.0, "end"), (14.0, "start"), (14.0, "end")];
        sides.into_iter().find_map(|(down, anchor)| {
            let (end, left) =
                if anchor == "start" { (x + STEP, x + STEP) } else { (x - STEP, x - STEP - width) };
            let baseline = y + down;
            let taken = [left, baseline - HEIGHT, left + width, baseline];
            let is_inside = left >= self.left && left + width <= self.right;
            let is_free = self.taken.iter().all(|other| !overlap(other, &taken));
            (is_inside && is_free).then(|| {
                self.taken.push(taken);
                Place { x: end, y: baseline, anchor }
            })
        })
    }
}

fn overlap(a: &[f64; 4], b: &[f64; 4]) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_one_place_go_around_it_and_then_are_left_out() {
        let mut labels = Labels::new(0.0, 200.0);
        let places: Vec<_> = (0..5).map(|_| labels.place_label(100.0, 50.0, "64 spp")).collect();
        let anchors: Vec<_> = places.iter().flatten().map(|place| (place.anchor, place.y < 50.0)).collect();
        assert_eq!(anchors, [("start", true), ("end", true), ("start", false), ("end", false)]);
        assert_eq!(places[4], None);
        assert!(labels.place_label(100.0, 90.0, "64 spp").is_some(), "elsewhere there is room");
    }

    #[test]
    fn labels_stay_inside_and_off_what_is_kept_free() {
        let mut labels = Labels::new(0.0, 200.0);
        assert_eq!(labels.place_label(190.0, 50.0, "64 spp").unwrap().anchor, "end");
        assert_eq!(labels.place_label(3.0, 90.0, "64 spp").unwrap().anchor, "start");
        labels.reserve([0.0, 100.0, 200.0, 200.0]);
        assert_eq!(labels.place_label(100.0, 150.0, "64 spp"), None);
    }
}
