//! A scene with a camera, rendered by the splat and by the ground truth.

use focus::Focus;
use lens::{Camera, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use salf::{BakeOptions, Salf, bake};
use scene::{Scene, SurfaceField, World};
use slf::{Transport, TransportOptions};
use splat::{SplatError, Splatter};
use std::sync::Arc;
use trace::Tracer;
use trace::truth::{self, Estimator, TruthOptions};

/// A scene and a camera.
pub struct Shot {
    pub tracer: Arc<Tracer>,
    pub camera: Camera,
    radiance: Arc<Transport>,
}

impl Shot {
    /// A shot of `scene` with `camera`.
    pub fn new(scene: Arc<Scene>, camera: Camera) -> Self {
        let tracer = Arc::new(Tracer::new(scene));
        let background = camera.background.map(|background| glam::DVec3::from(background).as_vec3());
        let world = World::from_scene(tracer.scene(), background);
        let radiance = Arc::new(Transport::new(tracer.clone(), world, TransportOptions::default()));
        Self { tracer, camera, radiance }
    }

    /// The same scene with another camera.
    pub fn with_camera(&self, camera: Camera) -> Self {
        Self { tracer: self.tracer.clone(), camera, radiance: self.radiance.clone() }
    }

    /// A constant focus.
    pub fn focus(&self, offset: FocusOffset) -> Focus {
        Focus::constant(self.tracer.scene().clone(), offset)
    }

    /// The light field, with the margin that `offset` needs.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn salf(&self, offset: FocusOffset, progress: &dyn Progress) -> Result<Salf, Cancelled> {
        self.salf_for(&self.focus(offset), progress)
    }

    /// The splatted picture.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn splat(&self, offset: FocusOffset, progress: &dyn Progress) -> Result<Picture, Cancelled> {
        self.splat_with(&self.focus(offset), progress)
    }

    /// The splatted picture with the given focus.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn splat_with(&self, focus: &Focus, progress: &dyn Progress) -> Result<Picture, Cancelled> {
        picture_of(self.salf_for(focus, progress)?, focus, progress)
    }

    /// The ray-traced picture with `samples` rays per pixel.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn truth(
        &self,
        offset: FocusOffset,
        samples: u32,
        progress: &dyn Progress,
    ) -> Result<Picture, Cancelled> {
        self.truth_with(&self.focus(offset), samples, 1, progress)
    }

    /// The ray-traced picture, with rays that start at the surfaces.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn truth_from_surfaces(
        &self,
        offset: FocusOffset,
        samples: u32,
        progress: &dyn Progress,
    ) -> Result<Picture, Cancelled> {
        let estimator = Estimator::Surface;
        let options = TruthOptions { samples_per_pixel: samples, estimator, ..TruthOptions::default() };
        let focus = self.focus(offset);
        let rendered =
            truth::render(&self.tracer, &*self.radiance, &focus, &self.camera, &options, progress)?;
        Ok(rendered.picture)
    }

    /// The ray-traced picture with the given focus and seed.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn truth_with(
        &self,
        focus: &Focus,
        samples: u32,
        seed: u32,
        progress: &dyn Progress,
    ) -> Result<Picture, Cancelled> {
        let options = TruthOptions { samples_per_pixel: samples, seed, ..TruthOptions::default() };
        let rendered = truth::render(&self.tracer, &*self.radiance, focus, &self.camera, &options, progress)?;
        Ok(rendered.picture)
    }

    fn salf_for(&self, focus: &Focus, progress: &dyn Progress) -> Result<Salf, Cancelled> {
        let options = BakeOptions::for_focus(&self.tracer, &self.camera, focus);
        bake(&self.tracer, &*self.radiance, &self.camera, &options, progress)
    }
}

/// The picture of a light field; all NaN, which fails every check, if it is rejected as too bright.
///
/// # Errors
/// [`Cancelled`] if `progress` is cancelled.
pub fn picture_of(
    salf: Salf,
    focus: &dyn SurfaceField<FocusOffset>,
    progress: &dyn Progress,
) -> Result<Picture, Cancelled> {
    picture_by(Splatter::new(Arc::new(salf)), focus, progress)
}

/// The picture of a splatter; all NaN if it is rejected as too bright.
///
/// # Errors
/// [`Cancelled`] if `progress` is cancelled.
pub fn picture_by(
    mut splatter: Splatter,
    focus: &dyn SurfaceField<FocusOffset>,
    progress: &dyn Progress,
) -> Result<Picture, Cancelled> {
    let camera = splatter.salf().camera.clone();
    match splatter.render(&camera, focus, progress) {
        Ok(()) => Ok(splatter.picture().clone()),
        Err(SplatError::Cancelled) => Err(Cancelled),
        Err(_) => {
            let mut refused = Picture::black(camera.width, camera.height);
            refused.radiance.fill([f32::NAN; 3]);
            refused.coverage.fill(f32::NAN);
            Ok(refused)
        }
    }
}
