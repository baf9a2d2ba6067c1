use super::*;
use crate::domain::Cell;
use crate::jitter::jitter;
use crate::sample::{Sample, Visibility};
use glam::{DVec2, IVec2, Vec2, Vec3};
use half::f16;
use surface::SurfacePoint;

/// Cells of all sizes and parts of them, patches of surface and the background, in one block.
fn found(count: u32) -> Vec<BakedSample> {
    (0..count)
        .map(|k| {
            let [a, b, c] = jitter(k, 1, 2).map(|x| x as f32);
            let side = 1 << (k % 5);
            let corner = IVec2::new(32, -16) + IVec2::new(k as i32, k as i32 / 3) % (16 / side) * side;
            let cell = Cell { corner, side };
            let some = 1 | (u64::from(k) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            let sub_cells = match k % 3 {
                0 => u64::MAX,
                1 => some,
                _ => (some % (1 << 16)) << (16 * (k / 3 % 4)),
            };
            let (is_patch, is_background) = (k % 7 == 6, k % 11 == 5);
            let part = cell.part(sub_cells);
            let point = SurfacePoint { triangle: k / 4, barycentric: DVec2::new(a.into(), (1.0 - a).into()) };
            let word = u64::from(k).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            let visibility = match k % 4 {
                0 => Visibility::Open,
                1 => Visibility::Cells { words: [word].into() },
                _ => Visibility::Cells { words: [word, 0, u64::MAX, word >> 9].into() },
            };
            let weight = part.weight as f32;
            let mut sample = Sample {
                center: part.center.as_vec2(),
                half_size: part.half_size.as_vec2(),
                inverse_depth: b,
                weight,
                tilt: Vec2::new(b - 0.5, c) * weight,
                radiance: Vec3::new(a, b, c) * 3.0,
                surface: Some(point),
                is_carried: k % 5 == 2,
                visibility,
            };
            if is_patch {
                sample.center = corner.as_vec2() + Vec2::new(a, b);
                (sample.weight, sample.half_size) = (-0.1, Vec2::new(b + 0.1, 0.5));
            } else if is_background {
                (sample.surface, sample.tilt, sample.inverse_depth) = (None, Vec2::ZERO, 0.0);
            }
            BakedSample { sample, part_of: (!is_patch).then_some((cell, sub_cells)), noisy: Vec3::ZERO }
        })
        .collect()
}

fn packed(found: &[BakedSample]) -> Samples {
    let mut packer = Packer::new(IVec2::new(32, -16), 0..0);
    found.iter().for_each(|found| packer.push(found.clone()));
    packer.finish()
}

fn assert_alike(found: &Sample, expected: &Sample) {
    let scale = expected.weight.abs().max(expected.tilt.abs().max_element());
    let weights =
        Vec3::new(found.weight - expected.weight, 0.0, 0.0) + (found.tilt - expected.tilt).extend(0.0);
    assert!(weights.abs().max_element() <= 1e-3 * scale, "{found:?} for {expected:?}");
    assert!((found.inverse_depth - expected.inverse_depth).abs() <= 8e-6 * expected.inverse_depth);
    assert!((found.radiance - expected.radiance).abs().max_element() < 2e-3);
    assert!((found.center - expected.center).abs().max_element() <= 2.5e-4);
    assert!((found.half_size - expected.half_size).abs().max_element() <= 1.3e-4);
    assert_eq!(found.visibility, expected.visibility);
    match (found.surface, expected.surface) {
        (Some(a), Some(b)) => {
            assert_eq!(a.triangle, b.triangle);
            assert!((a.barycentric - b.barycentric).abs().max_element() < 1e-5);
        }
        (a, b) => assert_eq!(a, b),
    }
}

#[test]
fn packed_samples_are_what_they_were() {
    let found = found(3000);
    let samples = packed(&found);
    assert_eq!((samples.len(), samples.loose.len()), (3000, 0));
    assert_eq!(samples.check(3000), Ok(()));
    let mut addresses = samples.addresses();
    for (index, (sample, wanted)) in samples.iter().zip(&found).enumerate() {
        assert_alike(&sample, &wanted.sample);
        if wanted.part_of.is_some() {
            let exact = |s: &Sample| (s.center, s.half_size, s.weight);
            assert_eq!(exact(&sample), exact(&wanted.sample));
        }
        if index % 97 == 0 {
            assert_eq!(samples.get(index as u32), sample);
            assert_eq!(samples.location(index as u32), SampleLocation::from_sample(&sample));
        }
        assert_eq!(addresses.get(index as u32), SampleLocation::from_sample(&sample).address);
    }
    let spots: Vec<_> = samples.runs().flat_map(|run| run.locations()).collect();
    assert!(spots.into_iter().eq(samples.iter().map(|sample| SampleLocation::from_sample(&sample))));
}

#[test]
fn what_cannot_be_packed_stays_as_it_is() {
    let mut odd: Vec<BakedSample> = found(6);
    odd[0].sample.radiance.y = 1e30;
    odd[1].sample.inverse_depth = -1.0;
    odd[2].sample.tilt.x = 1e9;
    odd[3].part_of = None;
    odd[3].sample.half_size.x = 40.0;
    odd[4].part_of = Some((Cell { corner: IVec2::ZERO, side: 1 }, 1));
    let samples = packed(&odd);
    assert_eq!((samples.records.len(), samples.loose.len()), (1, 5));
    let kept: Vec<Sample> = samples.iter().skip(1).collect();
    assert!(kept.iter().eq(odd[..5].iter().map(|found| &found.sample)));
    assert_eq!(samples.get(3), kept[2]);
}

#[test]
fn more_planes_than_a_number_has_go_on_in_another_run() {
    let all: Vec<_> = found(70_000)
        .into_iter()
        .enumerate()
        .map(|(k, mut found)| {
            found.sample.surface = Some(SurfacePoint { triangle: k as u32, barycentric: DVec2::ZERO });
            found
        })
        .collect();
    let samples = packed(&all);
    assert_eq!((samples.run_count(), samples.len(), samples.loose.len()), (2, 70_000, 0));
    assert_eq!(samples.check(70_000), Ok(()));
    for index in [0, 65_534, 65_535, 65_536, 69_999] {
        assert_alike(&samples.get(index), &all[index as usize].sample);
    }
}

#[test]
fn what_refers_to_nothing_is_told() {
    let good = packed(&found(500));
    assert!(good.check(125).is_ok() && good.check(124).is_err());
    let spoilt = |spoil: fn(&mut Samples)| {
        let mut bad = good.clone();
        spoil(&mut bad);
        bad.check(125)
    };
    assert!(spoilt(|s| s.chunks.clear()).is_err());
    assert!(spoilt(|s| s.chunks[0].starts.planes = 1).is_err());
    assert!(spoilt(|s| s.chunks[0].corner.x = i32::MIN).is_err());
    assert!(spoilt(|s| s.chunks.push(Chunk { corner: IVec2::ZERO, starts: s.ends() })).is_ok());
    assert!(spoilt(|s| s.chunks.insert(0, Chunk { starts: s.ends(), ..s.chunks[0] })).is_err());
    assert!(spoilt(|s| s.records[3].plane = 40_000).is_err());
    assert!(spoilt(|s| s.sub_cells.fill(0)).is_err());
    assert!(spoilt(|s| s.sub_cells.truncate(3)).is_err());
    assert!(spoilt(|s| s.patches.truncate(3)).is_err());
    assert!(spoilt(|s| s.planes[5].weights[1] = f16::NAN.to_bits()).is_err());
    assert!(spoilt(|s| s.codes.truncate(3)).is_ok(), "it is read as other visibility");
}
