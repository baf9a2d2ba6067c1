//! The aperture that a picture is summed with.

use crate::aperture::moments::MomentCache;
use crate::aperture::shape::Shape;
use crate::aperture::stencil::Stencils;
use crate::draw::Pen;
use crate::draw_list::Scene;
use crate::lens_in_use::LensInUse;
use crate::nodes::Nodes;
use crate::paint::Paint;
use lens::Aperture;
use std::sync::Arc;

/// What depends on the aperture's shape, and on how far it is stopped down from the baked one.
pub struct ApertureInUse {
    /// The aperture.
    pub aperture: Aperture,
    /// The lens's aperture radius as a share of the baked one, in [0, 1].
    pub stop: f64,
    /// The images of the aperture, by size.
    pub stencils: Arc<Stencils>,
    moments: MomentCache,
}

impl ApertureInUse {
    /// An aperture, whose radius is `stop` times the baked one's, for partly occluded ones of `nodes`, if there are any.
    pub fn new(aperture: &Aperture, stop: f64, nodes: Option<&Nodes>) -> Self {
        Self::with_stencils(aperture, Arc::new(Stencils::new(Shape::new(aperture))), stop, nodes)
    }

    /// The same with another aperture or stop: an aperture of the same shape keeps its images.
    pub fn changed(&self, aperture: &Aperture, stop: f64, nodes: Option<&Nodes>) -> Self {
        if *aperture != self.aperture {
            return Self::new(aperture, stop, nodes);
        }
        Self::with_stencils(aperture, self.stencils.clone(), stop, nodes)
    }

    fn with_stencils(aperture: &Aperture, stencils: Arc<Stencils>, stop: f64, nodes: Option<&Nodes>) -> Self {
        let moments = Self::moments(nodes, &stencils, stop);
        Self { aperture: aperture.clone(), stop, stencils, moments }
    }

    /// Forgets the aperture moments: the nodes are others now.
    pub fn set_nodes(&mut self, nodes: &Nodes) {
        self.moments = Self::moments(Some(nodes), &self.stencils, self.stop);
    }

    fn moments(nodes: Option<&Nodes>, stencils: &Stencils, stop: f64) -> MomentCache {
        // A pinhole sees what its chief ray sees.
        MomentCache::new(nodes, &stencils.shape, stop.max(1e-3))
    }

    /// The pen that draws `nodes` through this aperture.
    pub fn pen<'a>(&'a self, nodes: &'a Nodes, lens: &LensInUse) -> Pen<'a> {
        let pen = Pen::new(nodes, &self.stencils, &self.moments, self.stop, lens.detail);
        Pen { view: lens.view(), ..pen }
    }

    /// What is to be summed for a picture of `size` columns and rows.
    pub fn scene<'a>(
        &'a self,
        nodes: &'a Nodes,
        lens: &'a LensInUse,
        paint: &'a Paint,
        size: [u32; 2],
    ) -> Scene<'a> {
        Scene { pen: self.pen(nodes, lens), lens, paint, size }
    }
}
