//! Aperture masks without light, with a single open texel, and with very many texels.

use super::sampling::mask;
use crate::case::{Case, Effort, NOT_COMPUTED, Verdict};
use crate::support::light_field::{offset_of, picture_of_stars, star};
use crate::support::measure::{energy, largest_difference, worst};
use glam::DVec2;
use lens::{Aperture, ApertureShape, Camera, Picture};
use progress::{Cancelled, Progress};

pub const CASES: &[Case] = &[
    Case {
        name: "aperture mask all black",
        reason: "No light passes, and the exposure divides by the open area: such a mask is rejected, with \
                 its name.",
        control: "a check of only the range of the transmissions",
        check: black,
    },
    Case {
        name: "aperture mask of one texel",
        reason: "The splat of a single open texel is the sharp picture, displaced by κ·R times the position \
                 of the texel; up in the mask is up in the picture for far blur. A mask of 1 × 1 is the \
                 square.",
        control: "the mask read from the bottom row upward",
        check: one_texel,
    },
    Case {
        name: "aperture mask of 4096²",
        reason: "A checkerboard of single texels passes half of the light, at any resolution it is reduced to.",
        control: "the mask sampled at the centre of each of 128² cells",
        check: many_texels,
    },
];

fn black(_: Effort, _: &dyn Progress) -> Result<Verdict, Cancelled> {
    let masks = [1, 2, 64].map(|side| Aperture::from(mask(side, |_| 0.0)));
    let accepted =
        |refuses: &dyn Fn(&Aperture) -> bool| masks.iter().filter(|mask| !refuses(mask)).count() as f64;
    let by_name = |aperture: &Aperture| {
        let camera = Camera { aperture: aperture.clone(), ..Camera::default() };
        camera.validate().is_err_and(|error| error.field == "aperture mask")
    };
    let by_range = |aperture: &Aperture| match &aperture.shape {
        ApertureShape::Mask(mask) => !mask.transmission.iter().all(|t| (0.0..=1.0).contains(t)),
        _ => false,
    };
    Ok(Verdict::new(
        "refused, naming the mask",
        [("accepted", 0.0)],
        [accepted(&by_name)],
        [accepted(&by_range)],
    ))
}

const FRAME_PX: u32 = 97;

/// Mass, and centroid relative to the centre of the frame, px, y up.
fn centroid(picture: &Picture) -> (f64, DVec2) {
    let middle = f64::from(FRAME_PX - 1) / 2.0;
    let mass = energy(picture);
    let place = |k: usize| {
        DVec2::new((k % FRAME_PX as usize) as f64 - middle, middle - (k / FRAME_PX as usize) as f64)
    };
    let moment: DVec2 =
        picture.radiance.iter().enumerate().map(|(k, rgb)| place(k) * f64::from(rgb[1])).sum();
    (mass, moment / mass)
}

fn camera_with(aperture: Aperture) -> Camera {
    Camera {
        width: FRAME_PX,
        height: FRAME_PX,
        yfov: 0.48,
        aperture_radius: 10.0,
        aperture,
        ..Camera::default()
    }
}

fn one_texel(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let side = effort.choose(512, 128);
    let half_texel = 1.0 / f64::from(side);
    // A texel in the upper right, not symmetric in any coarser grid.
    let open = DVec2::new(0.4, 0.7);
    let is_open = move |u: DVec2| f32::from((u - open).abs().max_element() < half_texel);
    let upright = mask(side, is_open);
    let turned = mask(side, move |u| is_open(DVec2::new(u.x, -u.y)));
    let error = |shape: ApertureShape| -> Result<[f64; 2], Cancelled> {
        let camera = camera_with(shape.into());
        let (mut masses, mut places) = (Vec::new(), Vec::new());
        for radius_px in [-40.0, -5.0, -0.3, 0.0, 0.3, 1.0, 5.0, 17.0, 40.0] {
            let kappa = radius_px / camera.optics().splat_radius_px(1.0);
            let samples = vec![star(DVec2::splat(f64::from(FRAME_PX) / 2.0), 0.5, 1.0)];
            let picture = picture_of_stars(&camera, samples, offset_of(kappa, &camera), progress)?;
            let (mass, center) = centroid(&picture);
            masses.push(mass - 1.0);
            places.push(center.distance(open * radius_px) / (f64::abs(radius_px) / 128.0 + 0.02));
        }
        Ok([worst(masses), worst(places)])
    };
    let expected = format!(
        "mass 1 ± 1e-6, centre at κRu to half of one of the 128² cells that masks are cut to, radii \
                           −40 … 40 px, one of {side}² texels"
    );
    // 1 × 1.
    let picture_with = |shape: ApertureShape| {
        let camera = camera_with(shape.into());
        let samples = vec![star(DVec2::splat(f64::from(FRAME_PX) / 2.0), 0.5, 1.0)];
        let kappa = 11.0 / camera.optics().splat_radius_px(1.0);
        picture_of_stars(&camera, samples, offset_of(kappa, &camera), progress)
    };
    let all_open = picture_with(mask(1, |_| 1.0))?;
    let to_square = largest_difference(&all_open, &picture_with(ApertureShape::Square)?);
    let limits = [("mass", 1e-6), ("centre, half cells", 1.0), ("1 × 1 − square", 1e-8)];
    let ([mass, place], [_, turned]) = (error(upright)?, error(turned)?);
    Ok(Verdict::new(expected, limits, [mass, place, to_square], [NOT_COMPUTED, turned, NOT_COMPUTED]))
}

fn many_texels(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let side = effort.choose(4096, 512);
    let texel = |u: f64| ((u + 1.0) / 2.0 * f64::from(side)) as u32;
    let aperture = Aperture::from(mask(side, |u| f32::from((texel(u.x) + texel(u.y)).is_multiple_of(2))));
    let areas = [8, 128].map(|rows| aperture.rows(rows).open_area() / 2.0 - 1.0);
    progress.check()?;
    let camera = camera_with(aperture.clone());
    let samples = vec![star(DVec2::splat(f64::from(FRAME_PX) / 2.0), 0.5, 1.0)];
    let kappa = 20.0 / camera.optics().splat_radius_px(1.0);
    let picture = picture_of_stars(&camera, samples, offset_of(kappa, &camera), progress)?;
    let (mass, center) = centroid(&picture);
    let center_transmission = |k: u32| {
        let u = DVec2::new(f64::from(k % 128) + 0.5, f64::from(k / 128) + 0.5) / 64.0 - 1.0;
        aperture.transmission(u)
    };
    let sampled_area = (0..128 * 128).map(center_transmission).sum::<f64>() / f64::from(64 * 64) / 2.0 - 1.0;
    let limits = [("area", 1e-6), ("mass", 1e-5), ("centre", 0.02)];
    let right = [worst(areas), mass - 1.0, center.length()].map(f64::abs);
    let expected = format!("{side}² texels: open area 2 to 1e-6; mass 1 to 1e-5; centred to 0.02 px");
    Ok(Verdict::new(expected, limits, right, [sampled_area.abs(), NOT_COMPUTED, NOT_COMPUTED]))
}
