//! Crops join to the whole picture, bit for bit.

use super::*;
use crate::Splatter;
use crate::lens_in_use::Tolerance;
use glam::{DVec2, Vec2, Vec3};
use lens::{Camera, FocusOffset, Picture};
use progress::Unwatched;
use salf::{Salf, Sample, Visibility};
use std::sync::Arc;
use surface::{SurfaceField, SurfacePoint};

const SIZE: [u32; 2] = [150, 90];

/// Some of the surface is painted, in the upper left.
struct Corner(Option<FocusOffset>);

impl SurfaceField<FocusOffset> for Corner {
    fn at(&self, point: SurfacePoint) -> FocusOffset {
        let (x, y) = (point.triangle % SIZE[0], point.triangle / SIZE[0]);
        self.0.filter(|_| x < 40 && y < 25).unwrap_or(FocusOffset::STANDARD)
    }
    fn at_infinity(&self) -> FocusOffset {
        FocusOffset::STANDARD
    }
}

fn camera() -> Camera {
    Camera {
        width: SIZE[0],
        height: SIZE[1],
        focus_distance: 2.0,
        aperture_radius: 0.09,
        ..Camera::default()
    }
}

/// Some large blocks of one depth, half of them partly hidden; a highlight, and one that is very bright.
fn samples() -> Vec<Sample> {
    let sample = |index: u32| {
        let (x, y) = (index % SIZE[0], index / SIZE[0]);
        let mixed = (x / 24 + 7 * (y / 20)).wrapping_mul(2654435761) >> 8;
        let visibility = match mixed % 2 {
            0 => Visibility::Cells { words: Box::new([0x0123_4567_89AB_CDEF ^ u64::from(mixed)]) },
            _ => Visibility::Open,
        };
        let radiance = match index {
            1234 => Vec3::splat(30.0),
            9876 => Vec3::splat(1e5),
            _ => Vec3::new(1e-3 * x as f32, 0.5, (mixed % 3) as f32 + 0.01 * y as f32),
        };
        Sample {
            center: Vec2::new(x as f32 + 0.5, y as f32 + 0.5),
            half_size: Vec2::splat(0.5),
            inverse_depth: 0.3 + (mixed % 10) as f32 * 0.06,
            weight: 1.0,
            tilt: Vec2::new((mixed % 7) as f32 * 0.03, (mixed % 5) as f32 * -0.04),
            radiance,
            surface: Some(SurfacePoint { triangle: index, barycentric: DVec2::ZERO }),
            is_carried: false,
            visibility,
        }
    };
    (0..SIZE[0] * SIZE[1]).map(sample).collect()
}

/// The light field of some of its samples.
fn salf(samples: impl Iterator<Item = Sample>) -> Salf {
    let samples = samples.collect::<Vec<_>>().into();
    Salf::with_samples(camera(), samples)
}

/// In strips of blocks, the last first.
fn parts() -> Vec<Salf> {
    let strip = |sample: &Sample| sample.center.x as u32 / 48;
    let part = |which: u32| salf(samples().into_iter().filter(|sample| strip(sample) == which));
    (0..4).rev().map(part).collect()
}

fn crops() -> Vec<Crop> {
    let sides = |size: u32| (0..size).step_by(32).map(move |first| (first, 32.min(size - first)));
    sides(SIZE[1])
        .flat_map(|(y, height)| {
            sides(SIZE[0]).map(move |(x, width)| Crop { corner: [x, y], size: [width, height] })
        })
        .collect()
}

fn whole(focus: &Corner, tolerance: Tolerance) -> Splatter {
    let mut splatter = Splatter::new(Arc::new(salf(samples().into_iter())));
    splatter.set_tolerance(tolerance);
    splatter.render(&camera(), focus, &Unwatched).unwrap();
    splatter
}

/// Which samples are in which set.
fn sets(salf: &Salf) -> impl Fn(u32) -> [bool; 3] + Sync + use<> {
    let mut addresses = Vec::new();
    for run in salf.samples.runs() {
        addresses.extend(run.locations().map(|spot| spot.address.surface.map_or(0, |point| point.triangle)));
    }
    move |sample| {
        let triangle = addresses[sample as usize];
        [triangle % SIZE[0] < 60, triangle % 5 == 0, triangle / SIZE[0] > 44]
    }
}

/// The picture, and the matte of all sets, joined from crops.
fn joined(
    focus: &Corner,
    tolerance: Tolerance,
    may_be_painted: bool,
    integers: Integers,
) -> (Picture, Picture, Vec<CropFacts>) {
    let (camera, parts) = (camera(), parts());
    let mut matte = Picture::black(SIZE[0], SIZE[1]);
    let made: Vec<(Crop, CropPicture)> = crops()
        .into_iter()
        .map(|crop| {
            let options =
                CropOptions { camera: &camera, crop, tolerance, integers, may_be_painted, mattes: 1 };
            let mut sums = CropSums::new(options);
            for part in &parts {
                sums.add(part, focus, None, &[&sets(part)], &Unwatched).unwrap();
            }
            let made = sums.picture().unwrap();
            let of_crop = sums.matte(0).unwrap();
            for (k, (rgb, coverage)) in of_crop.radiance.iter().zip(&of_crop.coverage).enumerate() {
                let (x, y) = (k as u32 % crop.size[0], k as u32 / crop.size[0]);
                let at = ((crop.corner[1] + y) * SIZE[0] + crop.corner[0] + x) as usize;
                (matte.radiance[at], matte.coverage[at]) = (*rgb, *coverage);
            }
            (crop, made)
        })
        .collect();
    let is_painted = made.iter().any(|(_, made)| made.facts.is_painted);
    let mut joining = CropJoiner::new(SIZE, is_painted);
    let across = |y: u32| {
        made.iter().filter(move |(crop, _)| (crop.corner[1]..crop.corner[1] + crop.size[1]).contains(&y))
    };
    let row_of = |numbers: &[f32], length: usize, row: u32| -> Vec<f32> {
        numbers[row as usize * length..][..length].to_vec()
    };
    for y in 0..SIZE[1] {
        let crops: Vec<_> = across(y)
            .map(|(crop, made)| {
                let length = CropJoiner::knot_columns(crop.size[0]) * KNOT_NUMBERS;
                (crop.corner[0], row_of(&made.knots, length, y - crop.corner[1]))
            })
            .collect();
        joining.add_knots(y, crops.iter().map(|(first, numbers)| (*first, numbers.as_slice())));
    }
    joining.find_gains();
    let read = |y: u32| {
        let mut row = CropRow::black(SIZE[0] as usize);
        for (crop, made) in across(y) {
            let length = crop.size[0] as usize * made.form.numbers();
            let numbers = row_of(&made.numbers, length, y - crop.corner[1]);
            row.set(crop.corner[0] as usize, made.form, &numbers);
        }
        row
    };
    if is_painted {
        (0..SIZE[1]).for_each(|y| joining.add_shared(y, &mut read(y)));
        joining.find_rest();
    }
    let mut picture = Picture { radiance: Vec::new(), coverage: Vec::new(), ..matte.clone() };
    for y in 0..SIZE[1] {
        let mut row = read(y);
        joining.join(y, made[0].1.form, &mut row);
        picture.radiance.extend(row.radiance);
        picture.coverage.extend(row.coverage);
    }
    (picture, matte, made.into_iter().map(|(_, made)| made.facts).collect())
}

#[test]
fn crops_join_to_the_whole_picture() {
    let painted = Some(FocusOffset::new(0.9, 0.3));
    for (offset, tolerance, may_be_painted) in [
        (None, Tolerance::NONE, false),
        (None, Tolerance::NONE, true),
        (painted, Tolerance::NONE, true),
        (None, Tolerance::VIEWING, false),
        (painted, Tolerance::VIEWING, true),
    ] {
        let focus = Corner(offset);
        let splatter = whole(&focus, tolerance);
        let (picture, matte, facts) = joined(&focus, tolerance, may_be_painted, Integers::default());
        assert!(picture == *splatter.picture(), "{offset:?} {tolerance:?} {may_be_painted}");
        let mut mattes = splatter.into_mattes();
        let all = salf(samples().into_iter());
        assert!(matte == mattes.draw(&sets(&all), &Unwatched).unwrap(), "{offset:?} {tolerance:?}");
        let painted = facts.iter().filter(|facts| facts.is_painted).count();
        assert_eq!(painted > 0, offset.is_some());
    }
}

/// Light of what is partly hidden and edge-on leans beyond its image: a crop beside has what the whole has of it.
#[test]
fn what_leans_beyond_its_image_is_not_cut_off_where_crops_meet() {
    let camera = Camera { width: 640, height: 320, aperture_radius: 0.4, ..camera() };
    let mut far = 0;
    for trial in 0..60u32 {
        let mixed = |k: u32| (trial * 8 + k).wrapping_mul(2654435761) >> 8;
        let random = |k: u32| (mixed(k) % 1000) as f32 / 1000.0;
        let sample = Sample {
            center: Vec2::new(250.0 + 140.0 * random(0), 100.0 + 120.0 * random(1)),
            half_size: Vec2::splat(0.5),
            inverse_depth: 0.5 + (random(2) - 0.5),
            weight: 0.2 * random(3),
            tilt: Vec2::new(2.0 * random(4) - 1.0, 2.0 * random(5) - 1.0),
            radiance: Vec3::splat(2.0),
            surface: Some(SurfacePoint { triangle: 0, barycentric: DVec2::ZERO }),
            is_carried: false,
            visibility: Visibility::Cells { words: Box::new([u64::MAX << (trial % 20)]) },
        };
        let samples = vec![sample].into();
        let salf = Salf::with_samples(camera.clone(), samples);
        let mut splatter = Splatter::new(Arc::new(salf.clone()));
        splatter.set_live(true);
        splatter.render(&camera, &Corner(None), &Unwatched).unwrap();
        let picture = splatter.picture();
        for x in (0..camera.width).step_by(32) {
            let crop = Crop { corner: [x, 0], size: [32, camera.height] };
            let mut sums = CropSums::new(CropOptions {
                camera: &camera,
                crop,
                tolerance: Tolerance::NONE,
                integers: Integers::default(),
                may_be_painted: true,
                mattes: 0,
            });
            sums.add(&salf, &Corner(None), None, &[], &Unwatched).unwrap();
            let made = sums.picture().unwrap();
            for (k, numbers) in made.numbers.chunks(made.form.numbers()).enumerate() {
                let at = (k as u32 / 32 * camera.width + x + k as u32 % 32) as usize;
                // Live, what shares the rest is scaled by its share.
                let evened = numbers[3] + numbers[7] * numbers[8];
                assert_eq!(evened, picture.coverage[at], "{trial}: {x}");
                far += u32::from(evened != 0.0);
            }
        }
    }
    assert!(far > 10_000, "{far}");
}

/// The light of everything else lands where a little is: integers must be coarser, and are so in all crops.
#[test]
fn integers_are_as_fine_as_the_whole_picture_has_them() {
    let focus = Corner(None);
    let finest = Integers::default();
    let coarser = finest.coarser(Kind::Standard).unwrap();
    let (picture, _, facts) = joined(&focus, Tolerance::NONE, false, coarser);
    let (finer, ..) = joined(&focus, Tolerance::NONE, false, finest);
    assert_ne!(picture, finer, "the control");
    assert!(facts.iter().all(|facts| facts.integers == coarser));
    let brightest = facts.iter().map(|facts| facts.brightest).fold(1.0, f64::max);
    assert_eq!(brightest, 1e5);
    for facts in &facts {
        assert!(facts.largest[0][0] > 0);
        assert!(coarser.can_hold(Kind::Standard, facts.largest[0], brightest));
        assert!(!coarser.can_hold(Kind::Standard, [i64::MAX / 2; 2], brightest));
    }
    assert!(finest.are_valid() && coarser.are_valid());
    assert!(!Integers { standard: 21, ..finest }.are_valid());
}
