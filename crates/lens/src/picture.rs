//! What a camera makes: radiance and coverage a pixel.

/// How the model's sum becomes what is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Exposure {
    /// The model as it is: radiance is conserved, and a uniform wall is not uniform where its paint steps.
    Conserve,
    /// Radiance over coverage: a white scene stays white.
    #[default]
    Normalise,
}

/// The sum of the model over a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width, px.
    pub width: u32,
    /// Height, px.
    pub height: u32,
    /// Linear RGB a pixel, row 0 on top, conserved (not divided by coverage).
    pub radiance: Vec<[f32; 3]>,
    /// The same sum for a scene of radiance 1: 1 everywhere in a standard picture.
    pub coverage: Vec<f32>,
}

impl Picture {
    /// A black picture that nothing covers.
    pub fn black(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self { width, height, radiance: vec![[0.0; 3]; pixels], coverage: vec![0.0; pixels] }
    }

    /// The picture under `exposure`. A pixel that nothing covers is black.
    pub fn exposed(&self, exposure: Exposure) -> Vec<[f32; 3]> {
        match exposure {
            Exposure::Conserve => self.radiance.clone(),
            Exposure::Normalise => self
                .radiance
                .iter()
                .zip(&self.coverage)
                .map(|(rgb, &coverage)| if coverage > 0.0 { rgb.map(|c| c / coverage) } else { [0.0; 3] })
                .collect(),
        }
    }
}
