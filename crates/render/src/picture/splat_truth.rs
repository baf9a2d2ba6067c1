//! The ground truth of scenes with Gaussian splats: from each of many aperture points a picture by rays, which surfaces end.

use crate::error::RenderError;
use crate::mattes::{MatteLight, MatteSource, Packing, SetsOfPart, Things};
use focus::Focus;
use gaussians::{
    Backdrop, EndLight, GaussianPicture, GaussianView, RayEnd, TruthOptions, render_truth_before,
};
use glam::{DVec2, DVec3, Vec3};
use lens::{Camera, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use salf::{BakeOptions, LARGEST_MARGIN_HEIGHTS};
use scene::{PlacedCloud, SurfaceField};
use trace::{Radiance, Ray, Tracer};

/// A picture of splats and surfaces to be rendered by rays.
pub(crate) struct SplatTruth<'a> {
    pub tracer: &'a Tracer,
    pub splats: &'a PlacedCloud,
    pub radiance: &'a dyn Radiance,
    pub focus: &'a Focus,
    pub camera: &'a Camera,
    /// Rays of a pixel.
    pub samples_per_pixel: u32,
    /// Splats are dilated instead of sending rays through the lens.
    pub dilation: Option<Dilation<'a>>,
}

/// The depth of field of other programs, to compare with.
pub(crate) struct Dilation<'a> {
    /// The camera with its lens.
    pub lens: &'a Camera,
    /// The standard deviation by which a splat grows, in radii of its circle of confusion.
    pub sigma_radii: f64,
}

impl<'a> SplatTruth<'a> {
    /// One ray a pixel of the splats of a scene.
    pub fn new(
        tracer: &'a Tracer,
        splats: &'a PlacedCloud,
        radiance: &'a dyn Radiance,
        focus: &'a Focus,
        camera: &'a Camera,
    ) -> Self {
        Self { tracer, splats, radiance, focus, camera, samples_per_pixel: 1, dilation: None }
    }

    /// Renders it: light from `radiance` for surfaces, and from splats their own.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn render(&self, progress: &dyn Progress) -> Result<GaussianPicture, Cancelled> {
        self.render_light(self.radiance, None, progress)
    }

    fn render_light(
        &self,
        radiance: &dyn Radiance,
        uniform_radiance: Option<Vec3>,
        progress: &dyn Progress,
    ) -> Result<GaussianPicture, Cancelled> {
        /// With as many rays a pixel its area is sampled by 2 × 2 of each aperture point's.
        const DENSE: u32 = 16;
        let rays_per_px = if self.samples_per_pixel >= DENSE { 2 } else { 1 };
        let options = TruthOptions {
            aperture_points: self.samples_per_pixel.div_ceil(rays_per_px * rays_per_px),
            rays_per_px,
            max_margin_px: (LARGEST_MARGIN_HEIGHTS * f64::from(self.camera.height)) as u32,
            uniform_radiance,
        };
        let PlacedCloud { cloud, placement, .. } = self.splats;
        let view = match &self.dilation {
            None => GaussianView::new(cloud, placement, self.camera),
            Some(Dilation { lens, sigma_radii }) => {
                let optics = lens.optics();
                let variance = |splat: u32, depth: f64| {
                    let focus = self.focus.at(self.splats.address(splat)).or_standard();
                    (sigma_radii * optics.splat_radius_px(optics.kappa(1.0 / depth, focus))).powi(2)
                };
                GaussianView::dilated(cloud, placement, self.camera, variance)
            }
        };
        let count = self.splats.cloud.len() as u32;
        let focus: Vec<FocusOffset> =
            (0..count).map(|splat| self.focus.at(self.splats.address(splat)).or_standard()).collect();
        let backdrop = Surfaces { truth: self, radiance, painted_reach_px: self.painted_reach_px() };
        render_truth_before(&view, Some(&focus), &backdrop, &options, progress)
    }

    /// How far paint moves light of surfaces and of what is infinitely far, px.
    fn painted_reach_px(&self) -> f64 {
        let optics = self.camera.optics();
        let at_infinity = self.focus.at_infinity().or_standard();
        let moved = (optics.kappa(0.0, at_infinity) - optics.standard_kappa(0.0)).abs();
        let of_surfaces = match self.tracer.scene().surface_triangles().is_empty() {
            true => 0.0,
            false => BakeOptions::for_focus(self.tracer, self.camera, self.focus).margin_px,
        };
        optics.splat_radius_px(moved).max(of_surfaces)
    }
}

/// The surfaces of meshes, and what is infinitely far.
struct Surfaces<'a> {
    truth: &'a SplatTruth<'a>,
    radiance: &'a dyn Radiance,
    painted_reach_px: f64,
}

impl Backdrop for Surfaces<'_> {
    fn end(&self, u: DVec2, direction: DVec3, _pixel: DVec2) -> RayEnd {
        let SplatTruth { tracer, focus, camera, .. } = self.truth;
        let origin = camera.world_from_camera(u.extend(0.0));
        let direction = camera.world_direction(direction);
        let ray = Ray { origin, direction, t_min: 0.0, t_max: f64::INFINITY, skip: None };
        let Some(hit) = tracer.first_hit(&ray) else {
            return RayEnd::at_infinity(
                self.radiance.environment(direction),
                focus.at_infinity().or_standard(),
            );
        };
        let sent = self.radiance.outgoing(hit.point, origin);
        let (painted, carried) = (focus.at(hit.point).or_standard(), f64::from(sent.carried_share));
        let own = EndLight { radiance: sent.own, share: 1.0 - carried, focus: painted };
        let of_carried = EndLight { radiance: sent.carried, share: carried, focus: painted.of_carried() };
        RayEnd { depth: hit.t, light: [own, of_carried] }
    }

    fn painted_reach_px(&self) -> f64 {
        self.painted_reach_px
    }
}

impl MatteSource for SplatTruth<'_> {
    fn draw(&mut self, sets: &SetsOfPart, progress: &dyn Progress) -> Result<Picture, RenderError> {
        let scene = self.tracer.scene();
        let light = MatteLight { scene, radiance: self.radiance, sets };
        let part = scene.triangles[self.splats.triangles().start as usize].part;
        let color = light.color_of_part(Some(part));
        Ok(self.render_light(&light, Some(color), progress)?.picture)
    }

    fn packing(&self, things: &Things, size: [u32; 2]) -> Packing {
        Packing::separate(things.names.len(), size)
    }
}
