//! Which columns of a table of vertices make up a splat. They are found by their names, wherever they are and whatever else there is.

use super::super::reading::Reading;
use super::header::{DataType, Element, Header};
use crate::cloud::Splat;
use crate::cloud::harmonics::{coefficient_count, degree_of};
use crate::error::GaussianError;
use glam::{Quat, Vec3};

/// The columns of splats.
pub(super) struct Columns {
    mean: [usize; 3],
    scale: [usize; 2],
    /// The third scale, which 2D Gaussians have not.
    normal_scale: Option<usize>,
    /// w x y z.
    rotation: [usize; 4],
    opacity: usize,
    base: BaseColor,
    /// Coefficients beyond degree 0: all of red, then green, then blue.
    rest: Vec<usize>,
    pub degree: u32,
}

enum BaseColor {
    /// `f_dc_0` to `f_dc_2`.
    Harmonics([usize; 3]),
    /// `red`, `green`, `blue`, with the numbers that are full intensity.
    Rgb([(usize, f64); 3]),
}

/// How scales and opacities are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Activation {
    /// As logarithms and logits.
    Trained,
    /// As they are.
    Plain,
}

impl Columns {
    /// The columns of a file's vertices.
    ///
    /// # Errors
    /// They are no splats, or a column is missing or a list.
    pub fn new(reading: &Reading<'_>, header: &Header) -> Result<Self, GaussianError> {
        let vertices = header.vertices(reading)?;
        if !vertices.is_fixed() {
            return Err(reading.malformed("vertex", "has lists, which splats have not"));
        }
        if ["scale_0", "rot_0", "opacity"].iter().all(|name| vertices.column(name).is_none()) {
            let has_faces = header.elements.iter().any(|element| element.name == "face" && element.count > 0);
            let kind = if has_faces { "mesh" } else { "point cloud" };
            let what = format!("is a {kind} without splats: its vertices have no scale_0, rot_0 and opacity");
            return Err(GaussianError::no_splats(reading.file(), what));
        }
        let column = |name: &str| {
            let missing =
                || reading.malformed("vertex", format!("has no property {name}, which splats have"));
            vertices.column(name).ok_or_else(missing)
        };
        let rest: Vec<usize> = (0..).map_while(|k| vertices.column(&format!("f_rest_{k}"))).collect();
        let degree = degree_of(rest.len() / 3).filter(|_| rest.len().is_multiple_of(3)).ok_or_else(|| {
            let what =
                format!("has {} properties f_rest, where 0, 9, 24, 45 or 72 belong to a degree", rest.len());
            reading.malformed("vertex", what)
        })?;
        Ok(Self {
            mean: [column("x")?, column("y")?, column("z")?],
            scale: [column("scale_0")?, column("scale_1")?],
            normal_scale: vertices.column("scale_2"),
            rotation: [column("rot_0")?, column("rot_1")?, column("rot_2")?, column("rot_3")?],
            opacity: column("opacity")?,
            base: BaseColor::new(vertices).ok_or_else(|| {
                reading.malformed("vertex", "has neither f_dc_0 to f_dc_2 nor red, green and blue")
            })?,
            rest,
            degree,
        })
    }

    /// Whether the splats are flat by their kind: 2D Gaussians, which have two scales.
    pub fn is_flat(&self) -> bool {
        self.normal_scale.is_none()
    }

    /// Whether the rows have plain scales and opacities: all scales positive, all opacities from 0 to 1, as logits would be for no scene.
    pub fn activation(&self, rows: &[Vec<f64>]) -> Activation {
        /// Fewer rows might be so by chance.
        const MIN_ROWS: usize = 16;
        let is_plain = |row: &Vec<f64>| {
            let scales = self.scale.iter().chain(&self.normal_scale);
            scales.into_iter().all(|&column| row[column] > 0.0) && (0.0..=1.0).contains(&row[self.opacity])
        };
        if rows.len() >= MIN_ROWS && rows.iter().all(is_plain) {
            Activation::Plain
        } else {
            Activation::Trained
        }
    }

    /// The splat of a row; its coefficients beyond degree 0 go to `coefficients`, those of a colour beside each other.
    pub fn splat(&self, row: &[f64], activation: Activation, coefficients: &mut Vec<f32>) -> Splat {
        let count = coefficient_count(self.degree);
        coefficients.clear();
        coefficients.extend((0..3 * count).map(|k| row[self.rest[k % 3 * count + k / 3]] as f32));
        let log = |column: usize| match activation {
            Activation::Trained => row[column] as f32,
            Activation::Plain => row[column].ln() as f32,
        };
        let [w, x, y, z] = self.rotation.map(|column| row[column] as f32);
        Splat {
            mean: Vec3::from_array(self.mean.map(|column| row[column] as f32)),
            rotation: Quat::from_xyzw(x, y, z, w),
            log_scale: Vec3::new(
                log(self.scale[0]),
                log(self.scale[1]),
                self.normal_scale.map_or(f32::NEG_INFINITY, log),
            ),
            opacity: match activation {
                Activation::Trained => Splat::opacity_of_logit(row[self.opacity]),
                Activation::Plain => row[self.opacity] as f32,
            },
            base_color: self.base.coefficients(row),
        }
    }
}

impl BaseColor {
    fn new(vertices: &Element) -> Option<Self> {
        let columns = |names: [&str; 3]| {
            let [a, b, c] = names.map(|name| vertices.column(name));
            Some([a?, b?, c?])
        };
        if let Some(columns) = columns(["f_dc_0", "f_dc_1", "f_dc_2"]) {
            return Some(Self::Harmonics(columns));
        }
        let white = |column: usize| match vertices.properties[column].data_type {
            DataType::Scalar(scalar) => (column, scalar.white()),
            DataType::List { .. } => (column, 1.0),
        };
        Some(Self::Rgb(columns(["red", "green", "blue"])?.map(white)))
    }

    fn coefficients(&self, row: &[f64]) -> Vec3 {
        match self {
            Self::Harmonics(columns) => Vec3::from_array(columns.map(|column| row[column] as f32)),
            Self::Rgb(columns) => Vec3::from_array(
                columns.map(|(column, white)| Splat::base_of_color((row[column] / white) as f32)),
            ),
        }
    }
}
