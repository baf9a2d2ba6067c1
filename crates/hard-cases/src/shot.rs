//! A scene before a camera, rendered by the splat and by the ground truth.

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
    pub fn new(scene: Arc<Scene>, camera: Camera) -> Self {
        let tracer = Arc::new(Tracer::new(scene));
        let background = camera.background.map(|background| glam::DVec3::from(background).as_vec3());
        let world = World::from_scene(tracer.scene(), background);
        let radiance = Arc::new(Transport::new(tracer.clone(), world, TransportOptions::default()));
        Self { tracer, camera, radiance }
    }

    /// The same scene before another camera.
    pub fn with_camera(&self, camera: Camera) -> Self {
        Self { tracer: self.tracer.clone(), camera, radiance: self.radiance.clone() }
    }

    /// One focus for everything.
    pub fn focus(&self, offset: FocusOffset) -> Focus {
        Focus::constant(self.tracer.scene().clone(), offset)
    }

    /// The light field, sampled as far outside the frame as `offset` needs.
    pub fn salf(&self, offset: FocusOffset, progress: &dyn Progress) -> Result<Salf, Cancelled> {
        self.salf_for(&self.focus(offset), progress)
    }

    /// The splatted picture.
    pub fn splat(&self, offset: FocusOffset, progress: &dyn Progress) -> Result<Picture, Cancelled> {
        self.splat_with(&self.focus(offset), progress)
    }

    /// The same with a focus of its own for every point.
    pub fn splat_with(&self, focus: &Focus, progress: &dyn Progress) -> Result<Picture, Cancelled> {
        picture_of(self.salf_for(focus, progress)?, focus, progress)
    }

    /// The ray-traced picture, of `samples` rays a pixel.
    pub fn truth(
        &self,
        offset: FocusOffset,
        samples: u32,
        progress: &dyn Progress,
    ) -> Result<Picture, Cancelled> {
        self.truth_with(&self.focus(offset), samples, 1, progress)
    }

    /// The same by rays that start at the surfaces.
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

    /// The ray-traced picture with a focus of its own for every point, and chosen random numbers.
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

/// A light field's picture. One that was refused as too bright is all NaN, which no check lets pass.
pub fn picture_of(
    salf: Salf,
    focus: &dyn SurfaceField<FocusOffset>,
    progress: &dyn Progress,
) -> Result<Picture, Cancelled> {
    picture_by(Splatter::new(Arc::new(salf)), focus, progress)
}

/// The same by a splatter.
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
