//! Colour-coded maps: several palettes, compressed, decoded with noisy samples; and pictures that are no such map.

use crate::still_life::StillLife;
use disparity::colour_coded::{Sample, decode};
use disparity::{DisparityError, Picture};
use progress::Unwatched;

const SIZE: usize = 160;

/// Pseudo-random numbers in [0, 1).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn normal(&mut self) -> f32 {
        (0..12).map(|_| self.roll()).sum::<f32>() - 6.0
    }
}

fn hue(h: f32) -> [f32; 3] {
    [0.0, 4.0, 2.0].map(|k| ((h * 6.0 + k).rem_euclid(6.0) - 3.0).abs().clamp(1.0, 2.0) - 1.0)
}

fn jet(t: f32) -> [f32; 3] {
    [3.0, 2.0, 1.0].map(|k| (1.5 - (4.0 * t - k).abs()).clamp(0.0, 1.0))
}

fn viridis(t: f32) -> [f32; 3] {
    let stops =
        [[0.27, 0.0, 0.33], [0.23, 0.32, 0.55], [0.13, 0.57, 0.55], [0.37, 0.79, 0.38], [0.99, 0.91, 0.14]];
    let k = ((t * 4.0) as usize).min(3);
    std::array::from_fn(|c| stops[k][c] + (4.0 * t - k as f32) * (stops[k + 1][c] - stops[k][c]))
}

/// The picture after JPEG of quality 85.
fn compressed(rgb: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let bytes: Vec<u8> = rgb.iter().flatten().map(|v| (v.clamp(0.0, 1.0) * 255.0).round() as u8).collect();
    let mut file = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut file, 85)
        .encode(&bytes, SIZE as u32, SIZE as u32, image::ExtendedColorType::Rgb8)
        .expect("a picture");
    let read = image::load_from_memory(&file).expect("the same picture").to_rgb8();
    read.pixels().map(|p| p.0.map(|v| f32::from(v) / 255.0)).collect()
}

/// True disparities, and their range.
fn truth() -> (Vec<f32>, f32, f32) {
    let disparity =
        StillLife { size: SIZE, parallax: 1.0, noise: 0.0, samples: 1 }.photograph([0.0, 0.0]).disparity;
    let (low, high) = disparity.iter().fold((f32::MAX, f32::MIN), |(a, b), d| (a.min(*d), b.max(*d)));
    (disparity, low, high)
}

/// 600 samples with noise of 2 % of the range, 15 % of them random.
fn samples(truth: &[f32], low: f32, high: f32) -> Vec<Sample> {
    let mut dice = Dice(7);
    (0..600)
        .map(|_| {
            let (x, y) = ((dice.roll() * SIZE as f32) as usize, (dice.roll() * SIZE as f32) as usize);
            let wrong = dice.roll() < 0.15;
            let noisy = truth[y * SIZE + x] + 0.02 * (high - low) * dice.normal();
            Sample { x, y, disparity: if wrong { low + dice.roll() * (high - low) } else { noisy } }
        })
        .collect()
}

fn picture(rgb: &[[f32; 3]]) -> Picture<'_> {
    Picture { width: SIZE, height: SIZE, rgb }
}

#[test]
fn palettes_of_unknown_order_and_scale_are_decoded() {
    let (truth, low, high) = truth();
    let samples = samples(&truth, low, high);
    type Code = fn(f32) -> [f32; 3];
    let codes: [(&str, Code); 7] = [
        ("jet", jet),
        ("jet reversed", |t| jet(1.0 - t)),
        ("hues, red to blue", |t| hue(0.66 * t)),
        ("hues, warped", |t| hue(0.9 - 0.8 * t.powf(2.2))),
        ("viridis", viridis),
        ("viridis, warped", |t| viridis(t.powf(0.45))),
        ("grey", |t| [t; 3]),
    ];
    for (name, code) in codes {
        let coded: Vec<_> = truth.iter().map(|d| code((d - low) / (high - low))).collect();
        let coded = compressed(&coded);
        let read = decode(&picture(&coded), &samples, &Unwatched).unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut errors: Vec<f32> =
            read.disparity.iter().zip(&truth).map(|(a, b)| (a - b).abs() / (high - low)).collect();
        errors.sort_unstable_by(f32::total_cmp);
        let at = |share: f32| 100.0 * errors[(share * (errors.len() - 1) as f32) as usize];
        let rms = 100.0 * (errors.iter().map(|e| e * e).sum::<f32>() / errors.len() as f32).sqrt();
        eprintln!(
            "{name}: median {:.2} %, 90 % within {:.2} %, 95 % within {:.2} %, rms {rms:.2} %; residual {:.2} %, {:.0} % agree",
            at(0.5),
            at(0.9),
            at(0.95),
            100.0 * read.residual,
            100.0 * read.agreeing
        );
        assert!(at(0.5) < 1.0 && at(0.9) < 3.0, "{name}");
        assert!(read.residual < 0.03 && read.agreeing > 0.75, "{name}");
    }
}

#[test]
fn a_photograph_noise_and_another_places_map_are_refused() {
    let (truth, low, high) = truth();
    let samples = samples(&truth, low, high);
    let photograph =
        StillLife { size: SIZE, parallax: 1.0, noise: 0.01, samples: 2 }.photograph([0.0, 0.0]).rgb;
    let mut dice = Dice(3);
    let noise: Vec<[f32; 3]> = (0..SIZE * SIZE).map(|_| std::array::from_fn(|_| dice.roll())).collect();
    let other: Vec<[f32; 3]> =
        (0..SIZE * SIZE).map(|i| jet(((i % 47) as f32 / 46.0 + (i / SIZE) as f32 / 320.0).fract())).collect();
    let flat = vec![[0.3, 0.5, 0.7]; SIZE * SIZE];
    for (name, rgb) in [("photograph", photograph), ("noise", noise), ("another map", other), ("flat", flat)]
    {
        match decode(&picture(&rgb), &samples, &Unwatched) {
            Err(refusal @ DisparityError::NotColourCoded { .. }) => eprintln!("{name}: {refusal}"),
            other => panic!("{name}: {:?}", other.map(|read| read.residual)),
        }
    }
}

#[test]
fn unusable_samples_are_refused() {
    let rgb = vec![[0.5; 3]; SIZE * SIZE];
    let sample = Sample { x: 3, y: 4, disparity: 0.5 };
    let refusal = |samples: &[Sample]| decode(&picture(&rgb), samples, &Unwatched).unwrap_err();
    assert_eq!(refusal(&[sample; 5]), DisparityError::TooFewSamples { samples: 5 });
    let mut samples = vec![sample; 50];
    samples[20].x = SIZE;
    assert_eq!(refusal(&samples), DisparityError::SampleOutside { sample: 20 });
    samples[20] = Sample { disparity: f32::NAN, ..sample };
    assert_eq!(refusal(&samples), DisparityError::SampleOutside { sample: 20 });
}
