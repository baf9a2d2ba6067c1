//! Reference pictures, to compare the live picture with.

use lens::{Camera, Picture};
use render::StereoForm;
use std::sync::Arc;

/// The kind of a reference picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ReferenceKind {
    /// The pinhole picture: everything sharp.
    Pinhole,
    /// The standard lens: without paint.
    Standard,
    /// The document, ray traced.
    Truth,
    /// The photograph that the camera looks through.
    Photograph,
    /// The document as a stereo pair.
    Stereo(StereoForm),
}

/// A reference picture, at the preview's size.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The kind.
    pub kind: ReferenceKind,
    /// The picture.
    pub picture: Arc<Picture>,
    /// The camera it was made with.
    pub camera: Camera,
    /// Rays per pixel if it is ray traced; otherwise 0.
    pub samples_per_pixel: u32,
    /// Time it took, s.
    pub seconds: f64,
    /// Revision of the document that it shows.
    pub(crate) revision: u64,
    /// Generation of the document that it shows.
    pub(crate) generation: u64,
}

impl Reference {
    /// Whether it is still valid for this camera and revision.
    pub(crate) fn shows(&self, camera: &Camera, revision: u64) -> bool {
        match self.kind {
            ReferenceKind::Pinhole | ReferenceKind::Photograph => {
                without_lens(&self.camera) == without_lens(camera)
            }
            ReferenceKind::Standard => self.camera == *camera,
            ReferenceKind::Truth | ReferenceKind::Stereo(_) => {
                self.camera == *camera && self.revision == revision
            }
        }
    }
}

/// The camera without the lens settings that a pinhole picture does not depend on.
fn without_lens(camera: &Camera) -> Camera {
    let Camera { focus_distance, aperture_radius, sensor_height, aperture, .. } = Camera::default();
    Camera { focus_distance, aperture_radius, sensor_height, aperture, ..camera.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_outlives_what_it_does_not_show() {
        let camera = Camera::default();
        let of = |kind| Reference {
            kind,
            picture: Arc::new(Picture::black(1, 1)),
            camera: camera.clone(),
            samples_per_pixel: 0,
            seconds: 0.0,
            revision: 7,
            generation: 1,
        };
        let focused = Camera { focus_distance: 9.0, ..camera.clone() };
        let wide = Camera { yfov: 1.0, ..camera.clone() };
        let shows = |kind| {
            let reference = of(kind);
            [(&camera, 7), (&camera, 8), (&focused, 7), (&wide, 7)].map(|(c, r)| reference.shows(c, r))
        };
        assert_eq!(shows(ReferenceKind::Pinhole), [true, true, true, false]);
        assert_eq!(shows(ReferenceKind::Standard), [true, true, false, false]);
        assert_eq!(shows(ReferenceKind::Truth), [true, false, false, false]);
        for form in [StereoForm::SideBySide, StereoForm::Anaglyph] {
            assert_eq!(shows(ReferenceKind::Stereo(form)), [true, false, false, false]);
        }
        assert_eq!(shows(ReferenceKind::Photograph), [true, true, true, false]);
    }
}
