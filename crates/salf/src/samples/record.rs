//! What a packed sample is made of.

use crate::domain::Cell;
use crate::samples::numbers::{Float24, Rgb40};
use glam::{DVec2, IVec2, Vec2};
use half::f16;

/// What all packed samples have: 16 bytes.
///
/// A Gaussian splat has no plane and no place in its triangle: its weight takes the place of the one, as a half float, and the number of its triangle that
/// of the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Record {
    /// Position in the chunk's block and kind of sample: see [`Kind`].
    place: u16,
    /// Which of the chunk's planes it lies on; [`Record::BACKGROUND`] for none.
    pub plane: u16,
    /// Barycentrics in its triangle, in 1/65535.
    pub barycentric: [u16; 2],
    /// 1/z.
    pub inverse_depth: Float24,
    /// Radiance.
    pub radiance: Rgb40,
}

/// Which part of the block a sample is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A whole cell.
    WholeCell,
    /// Some sub-cells of a cell, listed beside the record in four words.
    PartOfCell,
    /// Some sub-cells of this quadrant of a cell of one pixel, listed beside the record in a word.
    PartOfQuadrant(u8),
    /// A patch of surface, whose size is stored beside the record as a [`Patch`].
    Patch,
    /// A Gaussian splat, as wide as a cell of one pixel.
    Splat,
}

impl Shape {
    /// The number of 16-bit words beside the record that list its sub-cells.
    pub fn words(self) -> usize {
        match self {
            Self::WholeCell | Self::Patch | Self::Splat => 0,
            Self::PartOfCell => 4,
            Self::PartOfQuadrant(_) => 1,
        }
    }
}

/// The decoded place of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// The pixel in its block: of the cell's corner, or of the patch's centre.
    pub pixel: IVec2,
    /// The cell's side is 2 to this, px.
    pub level: u8,
    /// Which part of the cell the sample is.
    pub shape: Shape,
    /// Cells per side of its visibility; `None` if it sees the whole aperture.
    pub cells: Option<u8>,
    /// Whether it sends carried light; otherwise own.
    pub is_carried: bool,
}

/// The level of a whole cell that says that it is a splat.
const SPLAT_LEVEL: u8 = 7;

impl Kind {
    /// In 16 bits: x and y 4 each, level or quadrant 3, shape 2, visibility 2, carried 1.
    fn place(self) -> u16 {
        let (shape, level) = match self.shape {
            Shape::WholeCell => (0, self.level),
            Shape::PartOfCell => (1, self.level),
            Shape::Patch => (2, self.level),
            Shape::PartOfQuadrant(quadrant) => (3, quadrant),
            Shape::Splat => (0, SPLAT_LEVEL),
        };
        let cells = match self.cells {
            None => 0,
            Some(8) => 1,
            Some(_) => 2,
        };
        let of_place = self.pixel.x | self.pixel.y << 4 | i32::from(level) << 8;
        (of_place | shape << 11 | cells << 13 | i32::from(self.is_carried) << 15) as u16
    }

    /// `None` if it makes no sense.
    fn from_place(place: u16) -> Option<Self> {
        let bits = |at: u32, count: u32| i32::from(place >> at & ((1 << count) - 1));
        let level = bits(8, 3) as u8;
        let (shape, level, most) = match bits(11, 2) {
            0 if level == SPLAT_LEVEL => (Shape::Splat, 0, i32::from(SPLAT_LEVEL)),
            0 => (Shape::WholeCell, level, 4),
            1 => (Shape::PartOfCell, level, 4),
            2 => (Shape::Patch, level, 4),
            _ => (Shape::PartOfQuadrant(level), 0, 3),
        };
        let cells = match bits(13, 2) {
            0 => None,
            1 => Some(8),
            2 => Some(16),
            _ => return None,
        };
        (bits(8, 3) <= most).then_some(Self {
            pixel: IVec2::new(bits(0, 4), bits(4, 4)),
            level,
            shape,
            cells,
            is_carried: bits(15, 1) == 1,
        })
    }

    /// The cell that the sample is all or part of, in a block whose upper left corner is `corner`, px.
    pub fn cell(&self, corner: IVec2) -> Cell {
        Cell { corner: corner + self.pixel, side: 1 << self.level }
    }
}

impl Record {
    pub const BYTES: usize = size_of::<Self>();
    pub const BACKGROUND: u16 = u16::MAX;

    /// A record of a sample: its kind, the number of its plane, its place in the triangle as barycentric weights in
    /// [0, 1] (rounded to 1/65535), its inverse depth and its radiance.
    pub fn new(kind: Kind, plane: u16, barycentric: DVec2, depth: Float24, radiance: Rgb40) -> Self {
        // Rounding may put it beside its triangle by 1/65535 of it.
        let barycentric = barycentric.to_array().map(|b| (b * 65535.0).round() as u16);
        Self { place: kind.place(), plane, barycentric, inverse_depth: depth, radiance }
    }

    /// A record of a splat, whose `kind` says that it is one: its weight, px², its triangle, its inverse depth and its radiance.
    pub fn of_splat(kind: Kind, weight: f16, triangle: u32, depth: Float24, radiance: Rgb40) -> Self {
        let barycentric = [triangle as u16, (triangle >> 16) as u16];
        Self { place: kind.place(), plane: weight.to_bits(), barycentric, inverse_depth: depth, radiance }
    }

    /// Whether it is that of a splat.
    #[inline]
    pub fn is_splat(&self) -> bool {
        self.place >> 8 & 0x1F == u16::from(SPLAT_LEVEL)
    }

    /// The triangle and the weight, px², of a splat.
    #[inline]
    pub fn splat(&self) -> Option<(u32, f32)> {
        let [low, high] = self.barycentric.map(u32::from);
        self.is_splat().then(|| (low | high << 16, f16::from_bits(self.plane).to_f32()))
    }

    /// The kind of sample.
    ///
    /// # Panics
    /// On a record that was not checked when it was read.
    #[inline]
    pub fn kind(&self) -> Kind {
        Kind::from_place(self.place).expect("a record that was read was checked")
    }

    /// Whether it sees only part of the aperture.
    #[inline]
    pub fn is_partial(&self) -> bool {
        self.place >> 13 & 3 != 0
    }

    /// See [`crate::Sample::is_carried`].
    #[inline]
    pub fn is_carried(&self) -> bool {
        self.place >> 15 != 0
    }

    /// The barycentric weights of the second and the third corner of its triangle, in [0, 1].
    pub fn barycentric(&self) -> DVec2 {
        DVec2::from_array(self.barycentric.map(|b| f64::from(b) / 65535.0))
    }

    /// See [`super::Samples::trimmed`].
    pub fn trimmed(self) -> Self {
        let (inverse_depth, radiance) = (self.inverse_depth.coarser(4), self.radiance.coarser(8));
        Self { barycentric: [0; 2], inverse_depth, radiance, ..self }
    }

    /// Whether its kind of sample exists and its inverse depth is finite.
    pub fn is_sound(&self) -> bool {
        Kind::from_place(self.place).is_some() && self.inverse_depth.get().is_finite()
    }

    /// The record as stored in a file, little endian.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        for (k, word) in [self.place, self.plane, self.barycentric[0], self.barycentric[1]].iter().enumerate()
        {
            bytes[2 * k..][..2].copy_from_slice(&word.to_le_bytes());
        }
        bytes[8..11].copy_from_slice(&self.inverse_depth.0);
        bytes[11..].copy_from_slice(&self.radiance.0);
        bytes
    }

    /// The record from its bytes in a file; the inverse of [`Self::to_bytes`].
    pub fn from_bytes(bytes: [u8; Self::BYTES]) -> Self {
        let word = |k: usize| u16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]]);
        let byte = |k: usize| bytes[k];
        Self {
            place: word(0),
            plane: word(1),
            barycentric: [word(2), word(3)],
            inverse_depth: Float24([8, 9, 10].map(byte)),
            radiance: Rgb40([11, 12, 13, 14, 15].map(byte)),
        }
    }
}

/// Size and place of a patch of surface: 10 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patch {
    /// Centre in its pixel, x and y, in 1/4096 px: 12 bits each.
    fraction: [u8; 3],
    /// Half the sides, in 1/4096 px.
    half_size: [[u8; 2]; 2],
    /// Its largest weight, or change of it, px².
    pub largest: Float24,
}

impl Patch {
    pub const BYTES: usize = size_of::<Self>();

    /// A patch, with lengths rounded to 1/4096 px. `None` if one is out of range.
    pub fn new(fraction: Vec2, half_size: Vec2, largest: Float24) -> Option<Self> {
        let fixed = |px: f32| (px * 4096.0).round();
        let [x, y] = fraction.to_array().map(|px| fixed(px).clamp(0.0, 4095.0) as u32);
        let half_size = half_size.to_array().map(fixed);
        let fits = half_size.iter().all(|half| (1.0..=65535.0).contains(half));
        let [a, b, c, _] = (x | y << 12).to_le_bytes();
        let half_size = half_size.map(|half| (half as u16).to_le_bytes());
        fits.then_some(Self { fraction: [a, b, c], half_size, largest })
    }

    /// Its position in its pixel, in [0, 1)².
    pub fn fraction(&self) -> Vec2 {
        let [a, b, c] = self.fraction;
        let bits = u32::from_le_bytes([a, b, c, 0]);
        Vec2::new((bits & 0xFFF) as f32, (bits >> 12) as f32) / 4096.0
    }

    /// Half its width and height, px.
    pub fn half_size(&self) -> Vec2 {
        Vec2::from_array(self.half_size.map(|half| f32::from(u16::from_le_bytes(half)) / 4096.0))
    }

    /// The patch as stored in a file, little endian.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let [[h0, h1], [h2, h3]] = self.half_size;
        let ([f0, f1, f2], [l0, l1, l2]) = (self.fraction, self.largest.0);
        [f0, f1, f2, h0, h1, h2, h3, l0, l1, l2]
    }

    /// The patch from its bytes in a file; the inverse of [`Self::to_bytes`].
    pub fn from_bytes([f0, f1, f2, h0, h1, h2, h3, l0, l1, l2]: [u8; Self::BYTES]) -> Self {
        Self { fraction: [f0, f1, f2], half_size: [[h0, h1], [h2, h3]], largest: Float24([l0, l1, l2]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn records_and_patches_keep_to_their_bytes() {
        assert_eq!((Record::BYTES, Patch::BYTES), (16, 10));
        for shape in
            [Shape::WholeCell, Shape::PartOfCell, Shape::Patch, Shape::PartOfQuadrant(2), Shape::Splat]
        {
            for cells in [None, Some(8), Some(16)] {
                let is_of_pixel = matches!(shape, Shape::PartOfQuadrant(_) | Shape::Splat);
                let levels = if is_of_pixel { 0..1 } else { 0..5 };
                for level in levels {
                    let is_carried = level % 2 == 1;
                    let kind = Kind { pixel: IVec2::new(3, 14), level, shape, cells, is_carried };
                    let depth = Float24::new(0.3).unwrap();
                    let radiance = Rgb40::new(Vec3::new(0.1, 2.0, 0.7), [0.5; 3]).unwrap();
                    let record = match shape {
                        Shape::Splat => {
                            Record::of_splat(kind, f16::from_f32(0.75), 0x1234_5678, depth, radiance)
                        }
                        _ => Record::new(kind, 17, DVec2::new(0.0, 1.0), depth, radiance),
                    };
                    assert_eq!(record.kind(), kind);
                    assert_eq!(record.is_partial(), cells.is_some());
                    match record.splat() {
                        Some(splat) => assert_eq!((shape, splat), (Shape::Splat, (0x1234_5678, 0.75))),
                        None => assert_eq!(record.barycentric(), DVec2::Y),
                    }
                    assert_eq!(Record::from_bytes(record.to_bytes()), record);
                }
            }
        }
        let largest = Float24::new(1.25).unwrap();
        let patch = Patch::new(Vec2::new(0.25, 0.999999), Vec2::new(0.5, 8.0), largest).unwrap();
        assert_eq!(patch.fraction(), Vec2::new(0.25, 4095.0 / 4096.0));
        assert_eq!(patch.half_size(), Vec2::new(0.5, 8.0));
        assert_eq!(Patch::from_bytes(patch.to_bytes()), patch);
        assert!(Patch::new(Vec2::ZERO, Vec2::new(16.0, 1.0), largest).is_none());
        assert!(Patch::new(Vec2::ZERO, Vec2::new(1e-5, 1.0), largest).is_none());
    }

    #[test]
    fn places_that_make_no_sense_are_told() {
        let sound = (0..=u16::MAX).filter(|&place| Kind::from_place(place).is_some());
        assert_eq!(sound.count(), 256 * (5 * 3 + 4 + 1) * 3 * 2);
    }
}
