//! Gloss that moves between views: kept where there is some, and nowhere else.

use progress::Unwatched;
use relief::{Gloss, OtherView, Relief, ReliefOptions};
use std::convert::Infallible;

const SIZE: [usize; 2] = [48, 32];
/// Of the whole surface, px a step.
const DISPARITY: f64 = 0.4;

/// A highlight that is seen brightest at a place that moves with the view, and only on the left half.
fn gloss(x: f64, y: f64, [u, v]: [f64; 2]) -> f64 {
    let (x, y) = (x - 12.0 - 1.5 * u, y - 16.0 - 1.5 * v);
    if x < 14.0 { 0.4 * (-(x * x + y * y) / 50.0).exp() } else { 0.0 }
}

/// What a view shows, with noise of 8 bits, times `bright`.
fn view(at: [f64; 2], strength: f64, bright: f64) -> Vec<[f32; 3]> {
    let pixel = |cell: usize| {
        let (column, row) = ((cell % SIZE[0]) as f64 + 0.5, (cell / SIZE[0]) as f64 + 0.5);
        let (x, y) = (column + DISPARITY * at[0], row + DISPARITY * at[1]);
        let seed = (column * 12.9898 + row * 78.233 + at[0] * 37.719 + at[1] * 4.581).sin() * 43758.5453;
        let noise = (seed - seed.floor() - 0.5) / 255.0;
        let matte = 0.3 + 0.15 * (0.5 * x).sin() * (0.4 * y).cos();
        let light = bright * (matte + strength * gloss(x, y, at)) + noise;
        [light as f32, (0.9 * light) as f32, (0.8 * light) as f32]
    };
    (0..SIZE[0] * SIZE[1]).map(pixel).collect()
}

/// The surface from 5 × 5 views; those beside the middle one are times `bright`.
fn made(strength: f64, bright: f64) -> Relief {
    let places = (0..25).map(|k| [f64::from(k % 5 - 2), f64::from(k / 5 - 2)]).filter(|at| *at != [0.0; 2]);
    let views: Vec<OtherView<'_, Infallible>> = places
        .map(|at| OtherView {
            offset: at.map(|steps| steps as f32),
            read: Box::new(move || Ok(view(at, strength, bright))),
        })
        .collect();
    let disparity = vec![DISPARITY as f32; SIZE[0] * SIZE[1]];
    let options = ReliefOptions { reach: 2.0, ..ReliefOptions::default() };
    Relief::build(SIZE, &disparity, &view([0.0; 2], strength, 1.0), &views, &options, &Unwatched).unwrap()
}

/// What is added in the middle of a block toward a place in the aperture, in [−1, 1].
fn added(gloss: &Gloss, block: usize, [x, y]: [f64; 2]) -> f64 {
    let number = gloss.numbers[block];
    if number == Gloss::NONE {
        return 0.0;
    }
    let mut terms = (1..=4).flat_map(|degree| (0..=degree).map(move |k| x.powi(degree - k) * y.powi(k)));
    let of = &gloss.polynomials[number as usize];
    of.iter().map(|by| f64::from(by[0]) * terms.next().unwrap()).sum()
}

#[test]
fn a_highlight_that_moves_is_told_and_what_is_matte_is_not() {
    let relief = made(1.0, 1.0);
    let gloss_found = relief.gloss.expect("the left half is glossy");
    assert_eq!((gloss_found.blocks, gloss_found.reach), (SIZE, [2.0; 2]));
    // Views at the rim, told in the middle of each block.
    let (mut with, mut without) = (0.0, 0.0);
    for (block, number) in gloss_found.numbers.iter().enumerate() {
        let (x, y) = ((block % SIZE[0]) as f64 + 0.5, (block / SIZE[0]) as f64 + 0.5);
        if x > 30.0 {
            assert_eq!(*number, Gloss::NONE, "nothing at {x}, {y}");
            continue;
        }
        for at in [[1.0, 0.0], [-1.0, 1.0], [0.5, -0.5]] {
            let expected = gloss(x, y, at.map(|at| 2.0 * at)) - gloss(x, y, [0.0; 2]);
            without += expected * expected;
            with += (expected - added(&gloss_found, block, at)).powi(2);
        }
    }
    assert!(with < 0.05 * without, "{with} of {without}");
}

#[test]
fn noise_and_darker_views_are_no_gloss() {
    assert_eq!(made(0.0, 1.0).gloss, None, "noise");
    assert_eq!(made(0.0, 0.8).gloss, None, "views beside the middle one are darker");
}
