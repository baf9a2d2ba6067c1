//! The cloud itself.

use super::axes::Axes;
use super::harmonics;
use super::left_out::LeftOut;
use super::splat::Splat;
use glam::{Quat, Vec3};
use half::f16;
use std::sync::Arc;

/// What the colours of a cloud mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorSpace {
    /// Display-referred sRGB with the primaries of Rec. 709: the blended sum of a ray is what a photograph shows, and has to be decoded.
    #[default]
    Srgb,
    /// Linear, with the primaries of Rec. 709: the sum of a ray is light.
    Linear,
}

/// What holds for all splats of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CloudTraits {
    /// What the colours mean.
    pub color_space: ColorSpace,
    /// Whether the cloud was trained with its low-pass compensated in opacity (Mip-Splatting): a small splat fades instead of growing.
    pub is_antialiased: bool,
    /// Where the axes of the file point.
    pub axes: Axes,
}

impl Default for CloudTraits {
    /// Those of 3DGS: sRGB, no compensation, right-down-forward.
    fn default() -> Self {
        Self { color_space: ColorSpace::Srgb, is_antialiased: false, axes: Axes::RIGHT_DOWN_FORWARD }
    }
}

/// 3D Gaussian splats in the axes and units of their file. Made by [`CloudBuilder`](super::CloudBuilder).
///
/// All numbers are finite (but for the scale of a flat axis, see [`Splat::log_scale`]). A splat of degree 3 takes 146 bytes: colour
/// coefficients beyond degree 0 are 16-bit floats, which clones share.
#[derive(Clone, Debug, PartialEq)]
pub struct GaussianCloud {
    pub(super) traits: CloudTraits,
    pub(super) degree: u32,
    pub(super) means: Vec<Vec3>,
    pub(super) rotations: Vec<Quat>,
    pub(super) log_scales: Vec<Vec3>,
    pub(super) opacities: Vec<f32>,
    pub(super) base_colors: Vec<Vec3>,
    /// For each splat, coefficient by coefficient, red, green and blue of each beside each other.
    pub(super) coefficients: Arc<Vec<f16>>,
    pub(super) left_out: LeftOut,
    /// Whether each splat is hidden; empty: none is.
    pub(super) hidden: Vec<bool>,
}

impl GaussianCloud {
    /// The number of splats.
    pub fn len(&self) -> usize {
        self.means.len()
    }

    /// Whether there is no splat.
    pub fn is_empty(&self) -> bool {
        self.means.is_empty()
    }

    /// What holds for all splats.
    pub fn traits(&self) -> CloudTraits {
        self.traits
    }

    /// The same splats with other traits: where a file does not say, or says wrong, what its axes or colours are.
    pub fn with_traits(self, traits: CloudTraits) -> Self {
        Self { traits, ..self }
    }

    /// The highest degree of the spherical harmonics, 0 to [`harmonics::MAX_DEGREE`].
    pub fn degree(&self) -> u32 {
        self.degree
    }

    /// The rows of the file that are not in the cloud.
    pub fn left_out(&self) -> &LeftOut {
        &self.left_out
    }

    /// The number of splats that the file has, those left out included.
    pub fn file_rows(&self) -> usize {
        self.len() + self.left_out.rows().len()
    }

    /// The means, in the axes of the file.
    pub fn means(&self) -> &[Vec3] {
        &self.means
    }

    /// Hides splats, and shows all others: what is hidden keeps its number and its place, but no ray meets it. An empty list shows all.
    ///
    /// # Panics
    /// The list is neither empty nor as long as the cloud.
    pub fn hide(&mut self, hidden: Vec<bool>) {
        assert!(hidden.is_empty() || hidden.len() == self.len());
        self.hidden = if hidden.contains(&true) { hidden } else { Vec::new() };
    }

    /// Whether a splat is hidden.
    pub fn is_hidden(&self, index: usize) -> bool {
        self.hidden.get(index).copied().unwrap_or(false)
    }

    /// The number of splats that are hidden.
    pub fn hidden_count(&self) -> usize {
        self.hidden.iter().filter(|is_hidden| **is_hidden).count()
    }

    /// A splat without its coefficients. The opacity of one that is hidden is 0.
    ///
    /// # Panics
    /// There is no splat `index`.
    pub fn splat(&self, index: usize) -> Splat {
        Splat {
            mean: self.means[index],
            rotation: self.rotations[index],
            log_scale: self.log_scales[index],
            opacity: if self.is_hidden(index) { 0.0 } else { self.opacities[index] },
            base_color: self.base_colors[index],
        }
    }

    /// The coefficients of a splat beyond degree 0: coefficient by coefficient, red, green and blue of each beside each other.
    ///
    /// # Panics
    /// There is no splat `index`.
    pub fn coefficients(&self, index: usize) -> &[f16] {
        let each = 3 * harmonics::coefficient_count(self.degree);
        &self.coefficients[index * each..(index + 1) * each]
    }

    /// The colour of a splat in the cloud's [`ColorSpace`], each channel 0 or more, viewed along the unit vector `direction` (from the eye to
    /// the mean, in the axes of the file).
    ///
    /// # Panics
    /// There is no splat `index`.
    pub fn color(&self, index: usize, direction: Vec3) -> Vec3 {
        let mut color = 0.5 + harmonics::BASE * self.base_colors[index];
        let basis = harmonics::harmonics(direction, self.degree);
        for (y, rgb) in basis.iter().zip(self.coefficients(index).chunks_exact(3)) {
            color += *y * Vec3::new(rgb[0].to_f32(), rgb[1].to_f32(), rgb[2].to_f32());
        }
        color.max(Vec3::ZERO)
    }

    /// Passes all numbers that decide how the cloud looks to `add`, as bytes: for checksums.
    pub fn each_byte_string(&self, mut add: impl FnMut(&[u8])) {
        add(format!("{:?} {}", self.traits, self.degree).as_bytes());
        add(bytemuck::cast_slice(&self.means));
        add(bytemuck::cast_slice(&self.rotations));
        add(bytemuck::cast_slice(&self.log_scales));
        add(bytemuck::cast_slice(&self.opacities));
        add(bytemuck::cast_slice(&self.base_colors));
        if !self.hidden.is_empty() {
            add(&self.hidden.iter().map(|is_hidden| u8::from(*is_hidden)).collect::<Vec<_>>());
        }
        self.coefficients.chunks(1 << 16).for_each(|part| {
            let bits: Vec<u16> = part.iter().map(|x| x.to_bits()).collect();
            add(bytemuck::cast_slice(&bits));
        });
    }

    /// The bytes that the cloud takes in memory.
    pub fn bytes(&self) -> u64 {
        Self::bytes_of(self.degree, self.len() as u64)
    }

    /// The bytes that `count` splats of a degree take in memory.
    pub fn bytes_of(degree: u32, count: u64) -> u64 {
        let splat = 3 * size_of::<Vec3>() + size_of::<Quat>() + size_of::<f32>();
        let each = splat + 3 * harmonics::coefficient_count(degree) * size_of::<f16>();
        count.saturating_mul(each as u64)
    }
}
