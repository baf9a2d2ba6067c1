//! How the own light of a point changes over the aperture.

use crate::baker::outgoing::aperture_parts::{ApertureCells, AperturePart, MAX_CELLS};
use crate::baker::outgoing::{ALIKE, LightComponent, RadianceQuery, cells_of_lobe};
use crate::sample::Visibility;
use glam::{DVec2, Vec3};
use surface::SurfacePoint;

/// By cell of the aperture, how much more own light a point sends there than to the middle.
pub struct OwnLightChange {
    side: usize,
    more: Vec<Vec3>,
}

impl OwnLightChange {
    /// For a point of inverse depth `inverse_depth`; `None` where it sends the same toward all of the aperture. Surfaces in focus are
    /// sampled as finely: views through a part of the aperture show the change there, too.
    pub fn sample(query: &RadianceQuery, point: SurfacePoint, inverse_depth: f64) -> Option<Self> {
        let RadianceQuery { view, radiance, .. } = *query;
        let cells = cells_of_lobe(view, inverse_depth, radiance.own_lobe_width(point)?);
        if cells <= 1.0 {
            return None;
        }
        let side = (cells.min(MAX_CELLS as f64).ceil() as usize).next_power_of_two();
        let middle = query.outgoing(point, view.eye, 0, 1).own;
        let more = |cell: usize| {
            let at = DVec2::new((cell % side) as f64 + 0.5, (cell / side) as f64 + 0.5);
            let eye = view.aperture_point(at * (2.0 / side as f64) - 1.0);
            query.outgoing(point, eye, 0, 1).own - middle
        };
        Some(Self { side, more: (0..side * side).map(more).collect() })
    }

    /// The own light `sent` to the aperture's middle, as it is sent toward each part of the aperture.
    pub fn parts(&self, sent: &LightComponent) -> Vec<LightComponent> {
        let light = |more: &Vec3| (sent.radiance + *more / sent.share).max(Vec3::ZERO);
        let light: Vec<Vec3> = self.more.iter().map(light).collect();
        let mean = light.iter().sum::<Vec3>() / light.len() as f32;
        let noisy = vec![sent.noisy; light.len()];
        let cells = ApertureCells { side: self.side, light: &light, noisy: &noisy };
        let parts = cells.parts(ALIKE * mean.max_element()).into_iter();
        let part = |AperturePart { light, cells, .. }| LightComponent {
            radiance: light,
            toward: Visibility::from_words(&[cells]),
            ..sent.clone()
        };
        parts.map(part).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::View;
    use glam::DVec3;
    use lens::Camera;
    use trace::{OutgoingRadiance, Radiance};

    /// Sends more toward the right.
    struct Glossy;

    impl Radiance for Glossy {
        fn outgoing(&self, _point: SurfacePoint, eye: DVec3) -> OutgoingRadiance {
            OutgoingRadiance::from_own(Vec3::splat(0.5 + eye.x as f32))
        }
        fn environment(&self, _direction: DVec3) -> Vec3 {
            Vec3::ZERO
        }
        fn own_lobe_width(&self, point: SurfacePoint) -> Option<f64> {
            (point.triangle == 0).then_some(0.1)
        }
    }

    #[test]
    fn own_light_is_told_on_parts_of_the_aperture_and_keeps_its_mean() {
        let camera = Camera { width: 64, height: 64, aperture_radius: 0.25, ..Camera::default() };
        let view = View::new(&camera, 2.0);
        let change_of = |triangle: u32, view: &View| {
            let point = SurfacePoint { triangle, barycentric: DVec2::ZERO };
            let of = RadianceQuery {
                radiance: &Glossy,
                view,
                seed: [3, 5],
                incident: None,
                own_only: false,
                blurred: 1,
            };
            OwnLightChange::sample(&of, point, 0.5)
        };
        let sent = LightComponent {
            radiance: Vec3::splat(0.6),
            share: 1.0,
            is_carried: false,
            noisy: Vec3::ZERO,
            toward: Visibility::Open,
        };
        let parts = change_of(0, &view).unwrap().parts(&sent);
        let (mut seen, mut sum) = (0, 0.0);
        for part in &parts {
            let Visibility::Cells { words } = &part.toward else { panic!("a part: {part:?}") };
            assert_eq!(seen & words[0], 0, "parts do not overlap");
            seen |= words[0];
            sum += part.radiance.x * words[0].count_ones() as f32 / 64.0;
            let column = (0..64).filter(|bit| words[0] >> bit & 1 == 1).map(|bit| bit % 8).sum::<u32>()
                as f32
                / words[0].count_ones() as f32;
            let expected = 0.6 + 0.25 * ((column + 0.5) / 4.0 - 1.0);
            assert!((part.radiance.x - expected).abs() < 1e-5 && !part.is_carried, "{part:?}");
        }
        assert!(seen == u64::MAX && (sum - 0.6).abs() < 1e-6 && parts.len() > 4, "{sum} {}", parts.len());
        // Of another point, and through a pinhole, nothing is change_of.
        assert!(change_of(1, &view).is_none());
        let pinhole = Camera { aperture_radius: 0.0, ..camera.clone() };
        assert!(change_of(0, &View::new(&pinhole, 2.0)).is_none());
    }
}
