//! The brush of a page.

use lens::{FocusOffset, Optics};
use numerics::smooth_fraction;

/// How a stroke paints. A dab is a sphere, as those of the program's own brush, and reaches all sides of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PageBrush {
    /// Radius of the sphere, px of the picture at the surface where the stroke begins, > 0.
    pub radius_px: f64,
    /// Fraction of the radius within which a dab has its full strength, in [0, 1]; beyond it, it fades smoothly.
    pub hardness: f64,
    /// What it paints.
    pub paint: Paint,
}

/// What a stroke paints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Paint {
    /// Blur that stays the same wherever the lens is focused: the diameter of its circle of confusion at the widest aperture, px, as if it
    /// lay behind the focus; negative: before it; 0: sharp.
    Circle(f64),
    /// What the ordinary lens does.
    OrdinaryLens,
}

impl Paint {
    /// The focus that is painted, where `widest` are the optics of the light field.
    pub fn target(self, widest: &Optics) -> FocusOffset {
        match self {
            Self::OrdinaryLens => FocusOffset::STANDARD,
            Self::Circle(diameter_px) => {
                let kappa = widest.kappa_for_circle_px(diameter_px);
                let t = kappa.and_then(|kappa| widest.offset_for_kappa(kappa, 0.0, 1.0));
                FocusOffset::new(t.unwrap_or(1.0), 1.0)
            }
        }
    }
}

impl PageBrush {
    /// Fraction of a dab's strength at `distance` (a fraction of the radius), in [0, 1].
    pub fn falloff(&self, distance: f64) -> f64 {
        match distance {
            _ if distance > 1.0 => 0.0,
            _ if distance <= self.hardness => 1.0,
            _ => smooth_fraction((1.0 - distance) / (1.0 - self.hardness)),
        }
    }
}
