//! The names that options take as values.

use clap::ValueEnum;

/// Kinds of captures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum KindName {
    /// Photographs with cameras, and a mesh
    Photographs,
    /// Views of one place from points of an aperture
    Lightfield,
    /// A picture and its depth
    Depth,
}

impl KindName {
    /// As projects have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Photographs => "photographs",
            Self::Lightfield => "lightfield",
            Self::Depth => "depth",
        }
    }
}

/// How progress is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProgressName {
    /// Bars on a terminal, else plain lines
    Text,
    /// A line of JSON a step
    Json,
}

/// Forms of stereo pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StereoName {
    /// The left eye's picture on the left
    #[value(name = "sidebyside")]
    SideBySide,
    /// Red and cyan
    Anaglyph,
}

impl From<StereoName> for session::StereoForm {
    fn from(name: StereoName) -> Self {
        match name {
            StereoName::SideBySide => Self::SideBySide,
            StereoName::Anaglyph => Self::Anaglyph,
        }
    }
}

/// Where rays of the ground truth start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EstimatorName {
    /// At the sensor.
    Sensor,
    /// At the surfaces.
    Surface,
}

/// What the ground truth's samples are drawn from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SamplerName {
    /// Owen-scrambled Sobol' points.
    LowDiscrepancy,
    /// Independent random numbers.
    Independent,
}

/// Where the splat runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BackendName {
    /// The best there is.
    Auto,
    /// The graphics processor.
    Gpu,
    /// The processor.
    Cpu,
}

impl From<BackendName> for splat::BackendChoice {
    fn from(name: BackendName) -> Self {
        match name {
            BackendName::Auto => Self::Auto,
            BackendName::Gpu => Self::Gpu,
            BackendName::Cpu => Self::Cpu,
        }
    }
}

/// How the sum becomes the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ExposureName {
    /// The model as it is.
    Conserve,
    /// Divided by coverage.
    Normalise,
}
