//! The type of depth maps.

use image::metadata::Orientation;
use std::fmt;

/// The meaning of the numbers of a depth map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthMeaning {
    /// Distances along the camera's axis, > 0, in metres or in the unit of the file; `+∞`: the background.
    Distance,
    /// Pixels by which a point moves between views one step apart, of a light field: the view at (x, y) shows at p − d·(x, y), x right, y down,
    /// what the middle one shows at p. Linear in the inverse of the distance, of unknown scale and offset; larger is nearer.
    Disparity,
    /// Relative inverse depth: 1 for the nearest possible, 0 for the farthest possible point. Linear in the inverse of the distance, of
    /// unknown scale and offset.
    Relative,
}

/// A depth or disparity map.
#[derive(Clone, PartialEq)]
pub struct DepthMap {
    /// Columns; a map may be coarser than the picture, which it covers as a whole.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// A number per pixel, row 0 on top; NaN where it is unknown.
    pub values: Vec<f32>,
    /// What the numbers are.
    pub meaning: DepthMeaning,
}

impl DepthMap {
    /// The least and the greatest of the finite numbers; maps that were read have at least one.
    pub fn range(&self) -> Option<[f32; 2]> {
        let finite = self.values.iter().copied().filter(|value| value.is_finite());
        finite.fold(None, |range, value| match range {
            None => Some([value; 2]),
            Some([low, high]) => Some([value.min(low), value.max(high)]),
        })
    }

    /// A number per pixel that is linear in the inverse of the distance and larger where it is nearer: 1/distance (0 where it is infinite), the
    /// disparity, or the relative inverse depth. NaN where it is unknown.
    pub fn inverse_depth(&self) -> Vec<f32> {
        match self.meaning {
            DepthMeaning::Distance => self.values.iter().map(|value| value.recip()).collect(),
            DepthMeaning::Disparity | DepthMeaning::Relative => self.values.clone(),
        }
    }

    /// The share of pixels whose depth is unknown, in [0, 1].
    pub fn unknown_share(&self) -> f64 {
        let unknown = self.values.iter().filter(|value| value.is_nan()).count();
        unknown as f64 / self.values.len().max(1) as f64
    }

    /// Rotated and flipped by an EXIF orientation (1: unchanged).
    pub(crate) fn turned(self, orientation: u8) -> Self {
        let turn = Orientation::from_exif(orientation).unwrap_or(Orientation::NoTransforms);
        if turn == Orientation::NoTransforms {
            return self;
        }
        let [width, height] = [self.width, self.height];
        // From 5 on width and height are swapped.
        let [new_width, new_height] = if orientation >= 5 { [height, width] } else { [width, height] };
        let [right, bottom] = [width - 1, height - 1];
        let from = |x: u32, y: u32| match turn {
            Orientation::NoTransforms => [x, y],
            Orientation::FlipHorizontal => [right - x, y],
            Orientation::Rotate180 => [right - x, bottom - y],
            Orientation::FlipVertical => [x, bottom - y],
            Orientation::Rotate90FlipH => [y, x],
            Orientation::Rotate90 => [y, bottom - x],
            Orientation::Rotate270FlipH => [right - y, bottom - x],
            Orientation::Rotate270 => [right - y, x],
        };
        let places = (0..new_height).flat_map(|y| (0..new_width).map(move |x| (x, y)));
        let values = places.map(|(x, y)| {
            let [x, y] = from(x, y);
            self.values[y as usize * width as usize + x as usize]
        });
        Self { width: new_width, height: new_height, values: values.collect(), meaning: self.meaning }
    }
}

impl fmt::Debug for DepthMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { width, height, meaning, .. } = self;
        write!(f, "DepthMap({meaning:?}, {width} × {height}, {:?})", self.range())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{DynamicImage, GrayImage, Luma};

    #[test]
    fn maps_turn_as_pictures_do() {
        let values: Vec<f32> = (0..6).map(|v| v as f32).collect();
        for orientation in 1..=8 {
            let picture = GrayImage::from_fn(3, 2, |x, y| Luma([(y * 3 + x) as u8]));
            let mut picture = DynamicImage::from(picture);
            picture.apply_orientation(Orientation::from_exif(orientation).unwrap());
            let expected: Vec<f32> = picture.to_luma8().into_raw().into_iter().map(f32::from).collect();
            let map =
                DepthMap { width: 3, height: 2, values: values.clone(), meaning: DepthMeaning::Relative };
            let turned = map.turned(orientation);
            assert_eq!([turned.width, turned.height], [picture.width(), picture.height()]);
            assert_eq!(turned.values, expected, "{orientation}");
        }
    }

    #[test]
    fn inverse_depth_is_larger_where_it_is_nearer() {
        let map =
            |meaning| DepthMap { width: 3, height: 1, values: vec![0.5, f32::INFINITY, f32::NAN], meaning };
        let inverse = map(DepthMeaning::Distance).inverse_depth();
        assert_eq!(inverse[..2], [2.0, 0.0]);
        assert!(inverse[2].is_nan());
        assert_eq!(map(DepthMeaning::Distance).range(), Some([0.5, 0.5]));
        assert!((map(DepthMeaning::Distance).unknown_share() - 1.0 / 3.0).abs() < 1e-12);
    }
}
