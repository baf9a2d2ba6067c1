//! Furnace test: a scene of radiance 1 gives a picture of 1.

use crate::case::{Case, Effort, NOT_COMPUTED, Verdict};
use crate::optics::sampling::{every_shape, mask};
use crate::support::light_field::offset_of;
use crate::support::measure::{farthest_from, worst};
use crate::support::shot::Shot;
use glam::DVec2;
use lens::Camera;
use progress::{Cancelled, Progress};
use splat::Splatter;
use std::sync::Arc;
use test_scenes::{Mesh, unlit_scene_of};

pub const CASES: &[Case] = &[Case {
    name: "furnace",
    reason: "At a uniform κ all rays are displaced alike, so a scene of radiance 1 is 1 everywhere, for any \
             aperture.",
    control: "weights with the cos⁴ falloff of a lens without the 1/z³",
    check: furnace,
}];

fn furnace(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let (width, height) = effort.choose((32, 24), (20, 15));
    let camera =
        Camera { width, height, yfov: 0.6, aperture_radius: 0.1, focus_distance: 3.0, ..Camera::default() };
    let shot = Shot::new(unlit_scene_of([(&Mesh::wall(3.0, 100.0), [1.0; 3])]), camera.clone());
    let per_kappa = camera.optics().splat_radius_px(1.0);
    let offset = |radius_px: f64| offset_of(radius_px / per_kappa, &camera);
    let every: &[f64] = &[-20.0, -7.3, -1.5, -0.6, -0.2, -1e-6, 0.0, 0.1, 0.37, 0.8, 2.0, 4.5, 11.0, 20.0];
    let radii = effort.choose(every, &[-7.3, -0.2, 0.0, 4.5]);

    // Baked once for the widest blur and the whole square; every aperture and focus is splatted from it.
    let salf = shot.salf(offset(20.0), progress)?;
    let optics = camera.optics();
    let fall_off = |sample: &mut salf::Sample| {
        let q = camera.q_from_pixel(sample.center.as_dvec2()) * optics.tan_half_yfov;
        sample.weight *= (1.0 / (1.0 + q.length_squared()).powi(2)) as f32;
    };
    let fallen = salf::Salf { samples: salf.samples.changed(fall_off), ..salf.clone() };
    let mut splatter = Splatter::new(Arc::new(salf));
    let mut vignetted = Splatter::new(Arc::new(fallen));
    let (mut splatted, mut traced, mut wrong) = (Vec::new(), Vec::new(), f64::INFINITY);
    let mut apertures: Vec<_> = every_shape();
    let letter = mask(5, |u| f32::from(u.x < -0.5 || u.y > 0.5 || u.distance(DVec2::new(0.0, 0.1)) < 0.3));
    apertures.push(("letter", letter.into()));
    for (index, (_, aperture)) in apertures.into_iter().enumerate() {
        let camera = Camera { aperture, ..camera.clone() };
        let with_aperture = shot.with_camera(camera.clone());
        for &radius in radii {
            let focus = shot.focus(offset(radius));
            let splat = |splatter: &mut Splatter| match splatter.render(&camera, &focus, progress) {
                Ok(()) => Ok(farthest_from(splatter.picture(), 1.0)),
                Err(splat::SplatError::Cancelled) => Err(Cancelled),
                Err(_) => Ok(f64::NAN),
            };
            splatted.push(splat(&mut splatter)?);
            if radius == radii[0] {
                wrong = wrong.min(splat(&mut vignetted)?);
            }
        }
        for radius in effort.choose(&[-7.3, 2.0][..], if index % 5 == 0 { &[4.5] } else { &[] }) {
            traced.push(farthest_from(&with_aperture.truth(offset(*radius), 8, progress)?, 1.0));
        }
    }
    let expected = format!(
        "1 ± 0.1 %, {} pictures splatted and {} traced, radii −20 … 20 px",
        splatted.len(),
        traced.len()
    );
    let limits = [("splat", 1e-3), ("truth", 1e-3)];
    Ok(Verdict::new(expected, limits, [worst(splatted), worst(traced)], [wrong, NOT_COMPUTED]))
}
