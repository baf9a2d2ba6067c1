//! Names accepted as values of command-line options.

use clap::ValueEnum;

/// Kinds of captures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum KindName {
    /// Photographs with cameras, and a mesh
    Photographs,
    /// Views of one place from points of an aperture
    Lightfield,
    /// A picture with its depth
    Depth,
}

impl KindName {
    /// The name as written in project files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Photographs => "photographs",
            Self::Lightfield => "lightfield",
            Self::Depth => "depth",
        }
    }
}

/// Format of progress reports on stderr.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProgressName {
    /// Bars on a terminal, otherwise plain lines
    Text,
    /// One line of JSON per step
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

impl From<StereoName> for render::StereoForm {
    fn from(name: StereoName) -> Self {
        match name {
            StereoName::SideBySide => Self::SideBySide,
            StereoName::Anaglyph => Self::Anaglyph,
        }
    }
}

/// Where the rays of the ground truth start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EstimatorName {
    /// At the sensor.
    Sensor,
    /// At the surfaces.
    Surface,
}

/// Source of the ground truth's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SamplerName {
    /// Owen-scrambled Sobol' points.
    LowDiscrepancy,
    /// Independent random numbers.
    Independent,
}

/// Device that the splat runs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BackendName {
    /// The best available.
    Auto,
    /// The graphics processor.
    Gpu,
    /// The processor.
    Cpu,
}

/// Device that a light field is baked on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BakeDeviceName {
    /// The processor.
    Cpu,
    /// The graphics processor, also one in software.
    Gpu,
}

impl From<BackendName> for graphics_card::BackendChoice {
    fn from(name: BackendName) -> Self {
        match name {
            BackendName::Auto => Self::Auto,
            BackendName::Gpu => Self::Gpu,
            BackendName::Cpu => Self::Cpu,
        }
    }
}

/// How the splatted sum is normalised to a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ExposureName {
    /// The energy of the model, unchanged.
    Conserve,
    /// The sum divided by its coverage.
    Normalise,
}
