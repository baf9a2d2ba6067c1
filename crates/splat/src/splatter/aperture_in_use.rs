//! The aperture that a picture is summed with.

use crate::aperture::moments::{ApertureMoments, aperture_moments};
use crate::aperture::shape::Shape;
use crate::aperture::stencil::Stencils;
use crate::draw::Pen;
use crate::draw_list::Scene;
use crate::lens_in_use::LensInUse;
use crate::nodes::Nodes;
use crate::paint::Paint;
use lens::{Aperture, Camera};

/// What depends on the aperture's shape, and on how far it is stopped down from the baked one.
pub struct ApertureInUse {
    /// The aperture.
    pub aperture: Aperture,
    /// The lens's aperture radius as a share of the baked one, in [0, 1].
    pub stop: f64,
    /// The images of the aperture, by size.
    pub stencils: Stencils,
    moments: Vec<ApertureMoments>,
}

impl ApertureInUse {
    /// An aperture, whose radius is `stop` times the baked one's; with its moments for the masks of `nodes`, if there
    /// are any.
    pub fn new(aperture: &Aperture, stop: f64, nodes: Option<&Nodes>) -> Self {
        let (shape, moments) = (Shape::new(aperture), Vec::new());
        let mut new = Self { aperture: aperture.clone(), stop, stencils: Stencils::new(shape), moments };
        if let Some(nodes) = nodes {
            new.set_nodes(nodes);
        }
        new
    }

    /// Computes the aperture moments anew for other nodes.
    pub fn set_nodes(&mut self, nodes: &Nodes) {
        // A pinhole sees what its chief ray sees.
        self.moments = aperture_moments(nodes, &self.stencils.shape, self.stop.max(1e-3));
    }

    /// The pen that draws `nodes` through this aperture.
    pub fn pen<'a>(&'a self, nodes: &'a Nodes, lens: &LensInUse) -> Pen<'a> {
        let pen = Pen::new(nodes, &self.stencils, &self.moments, self.stop, lens.detail);
        Pen { magnification: lens.magnification, ..pen }
    }

    /// What is to be summed for `camera`'s picture.
    pub fn scene<'a>(
        &'a self,
        nodes: &'a Nodes,
        lens: &'a LensInUse,
        paint: &'a Paint,
        camera: &Camera,
    ) -> Scene<'a> {
        let size = [camera.width, camera.height];
        Scene { pen: self.pen(nodes, lens), lens, paint, size }
    }
}
