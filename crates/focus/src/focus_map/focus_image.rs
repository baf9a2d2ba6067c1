//! A focus map in a mesh's own texture coordinates.

use crate::focus_map::{bilinear, bounds};
use glam::{DVec2, Vec2};
use lens::FocusOffset;
use scene::Wrap;

/// A focus map in a mesh's own UV set, as used by recipes.
#[derive(Clone, Debug, PartialEq)]
pub struct FocusImage {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// [t, anchor] of each texel, row 0 on top.
    pub texels: Vec<[f32; 2]>,
    /// The gloss of each texel, in the same order; `None` if all of it is 0.
    pub gloss: Option<Vec<f32>>,
}

impl FocusImage {
    /// The value at glTF texture coordinates (origin upper left, v down), bilinear between texel centres at (i +
    /// ½)/width. Between equal texels it is exactly their value.
    pub fn sample(&self, uv: DVec2, wrap: [Wrap; 2]) -> FocusOffset {
        let p = uv * DVec2::new(self.width as f64, self.height as f64) - DVec2::splat(0.5);
        let low = p.floor();
        let [x0, x1] = [low.x, low.x + 1.0].map(|x| wrap_index(x, self.width, wrap[0]));
        let [y0, y1] = [low.y, low.y + 1.0].map(|y| wrap_index(y, self.height, wrap[1]));
        let corners = [[x0, y0], [x1, y0], [x0, y1], [x1, y1]].map(|[x, y]| y * self.width as usize + x);
        let [t, anchor] = bilinear(corners.map(|index| self.texels[index]), p - low);
        let gloss =
            self.gloss.as_ref().map(|gloss| bilinear(corners.map(|index| [gloss[index]]), p - low)[0]);
        FocusOffset { t, anchor, gloss: gloss.unwrap_or(0.0) }
    }

    /// The minimum and maximum of t, anchor and gloss over a box of texels, given by its first and last column and
    /// row (whole numbers) on the picture continued as `wrap` says.
    pub fn bounds(&self, box_texels: [DVec2; 2], wrap: [Wrap; 2]) -> [FocusOffset; 2] {
        let indices = |axis: usize, count: u32| {
            let [first, last] = box_texels.map(|corner| corner[axis]);
            // Two periods contain every texel, however the picture continues; NaN may stand for any texel.
            let is_partial = last - first < 2.0 * f64::from(count);
            let (start, steps) =
                if is_partial { (first, (last - first) as u32 + 1) } else { (0.0, 2 * count) };
            (0..steps).map(move |k| wrap_index(start + f64::from(k), count, wrap[axis]))
        };
        let columns: Vec<usize> = indices(0, self.width).collect();
        let rows = indices(1, self.height);
        bounds(rows.flat_map(|y| columns.iter().map(move |x| self.offset_at(y * self.width as usize + x))))
    }

    /// The value of a texel.
    fn offset_at(&self, index: usize) -> FocusOffset {
        let [t, anchor] = self.texels[index].map(f64::from);
        FocusOffset { t, anchor, gloss: self.gloss.as_ref().map_or(0.0, |gloss| f64::from(gloss[index])) }
    }

    /// The smallest and the largest focus offset t of all texels.
    pub fn offset_range(&self) -> [f32; 2] {
        let start = [f32::INFINITY, f32::NEG_INFINITY];
        self.texels.iter().fold(start, |[low, high], [t, _]| [low.min(*t), high.max(*t)])
    }
}

/// The texel shown for texel `i` (a whole number) of `count`.
fn wrap_index(i: f64, count: u32, wrap: Wrap) -> usize {
    let n = count as f64;
    let folded = match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Clamp => i,
        Wrap::Mirror => {
            let twice = i.rem_euclid(2.0 * n);
            if twice >= n { 2.0 * n - 1.0 - twice } else { twice }
        }
    };
    folded.clamp(0.0, n - 1.0) as usize
}

/// The texture coordinates of a point with these corner weights.
pub(crate) fn interpolate_uv(corners: [Vec2; 3], [wa, wb, wc]: [f64; 3]) -> DVec2 {
    let [a, b, c] = corners.map(Vec2::as_dvec2);
    a * wa + b * wb + c * wc
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> FocusImage {
        // t: 0 1 2 3 / 10 11 12 13
        let texels = (0..8).map(|i| [(i % 4) as f32 + 10.0 * (i / 4) as f32, (i / 4) as f32]).collect();
        FocusImage { width: 4, height: 2, texels, gloss: None }
    }

    #[test]
    fn lookup_by_hand() {
        let repeat = [Wrap::Repeat; 2];
        // The centre of texel (1, 0).
        assert_eq!(ramp().sample(DVec2::new(1.5 / 4.0, 0.25), repeat), FocusOffset::new(1.0, 0.0));
        // Halfway between texels 1 and 2, a quarter of the way from row 0 to row 1: 1.5 + 10/4.
        assert_eq!(ramp().sample(DVec2::new(0.5, 0.375), repeat), FocusOffset::new(4.0, 0.25));
        // At u = 0 repeat mixes the last and the first column; clamp and mirror keep the first.
        let v = 0.25;
        assert_eq!(ramp().sample(DVec2::new(0.0, v), repeat).t, 1.5);
        assert_eq!(ramp().sample(DVec2::new(0.0, v), [Wrap::Clamp, Wrap::Repeat]).t, 0.0);
        assert_eq!(ramp().sample(DVec2::new(0.0, v), [Wrap::Mirror, Wrap::Repeat]).t, 0.0);
        // One picture on: repeat starts over, mirror runs back, clamp stays.
        let u = 1.0 + 0.5 / 4.0;
        assert_eq!(ramp().sample(DVec2::new(u, v), repeat).t, 0.0);
        assert_eq!(ramp().sample(DVec2::new(u, v), [Wrap::Mirror, Wrap::Repeat]).t, 3.0);
        assert_eq!(ramp().sample(DVec2::new(u, v), [Wrap::Clamp, Wrap::Repeat]).t, 3.0);
        assert_eq!(ramp().sample(DVec2::new(-0.5 / 4.0, v), [Wrap::Mirror, Wrap::Repeat]).t, 0.0);
    }

    #[test]
    fn bounds_hold_what_is_sampled() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let [low, high] = ramp().bounds([at(1.0, 0.0), at(2.0, 0.0)], [Wrap::Repeat; 2]);
        assert_eq!((low, high), (FocusOffset::new(1.0, 0.0), FocusOffset::new(2.0, 0.0)));
        // Over the border: the last column and the first, and what clamping makes of it.
        let [low, high] = ramp().bounds([at(3.0, 0.0), at(4.0, 0.0)], [Wrap::Repeat; 2]);
        assert_eq!((low.t, high.t), (0.0, 3.0));
        let [low, high] = ramp().bounds([at(3.0, 0.0), at(4.0, 0.0)], [Wrap::Clamp; 2]);
        assert_eq!((low.t, high.t), (3.0, 3.0));
        for far in [1e300, f64::NAN, f64::INFINITY] {
            let [low, high] = ramp().bounds([at(-far, -1.0), at(far, 1e9)], [Wrap::Mirror; 2]);
            assert_eq!((low, high), (FocusOffset::new(0.0, 0.0), FocusOffset::new(13.0, 1.0)), "{far}");
        }
    }

    #[test]
    fn far_and_broken_coordinates_stay_inside() {
        for u in [1e300, -1e300, f64::NAN, f64::INFINITY] {
            for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
                ramp().sample(DVec2::new(u, u), [wrap; 2]);
            }
        }
    }
}
