//! Gloss that moves between views: fitted where there is some, and nowhere else.

use progress::Unwatched;
use relief::{Gloss, OtherView, Relief, ReliefOptions};
use std::convert::Infallible;

const SIZE: [usize; 2] = [48, 32];
/// Disparity of the whole surface, px per step.
const DISPARITY: f64 = 0.4;

/// A highlight whose position moves with the view, only on the left half.
fn gloss(x: f64, y: f64, [u, v]: [f64; 2]) -> f64 {
    let (x, y) = (x - 12.0 - 1.5 * u, y - 16.0 - 1.5 * v);
    if x < 14.0 { 0.4 * (-(x * x + y * y) / 50.0).exp() } else { 0.0 }
}

/// The picture of a view, with noise of 8 bits, times `bright`.
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

/// The surface from 5 × 5 views; all but the middle one are multiplied by `bright`.
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

/// The gloss of a block at a position in the aperture, in [−1, 1].
fn added(gloss: &Gloss, block: usize, [x, y]: [f64; 2]) -> f64 {
    let number = gloss.numbers[block];
    if number == Gloss::NONE {
        return 0.0;
    }
    let mut terms = (1..=4).flat_map(|degree| (0..=degree).map(move |k| x.powi(degree - k) * y.powi(k)));
    let coefficients = &gloss.polynomials[number as usize];
    coefficients.iter().map(|coefficient| f64::from(coefficient[0]) * terms.next().unwrap()).sum()
}

#[test]
fn a_moving_highlight_is_fitted_and_matte_surfaces_are_not() {
    let relief = made(1.0, 1.0);
    let fitted = relief.gloss.expect("the left half is glossy");
    assert_eq!((fitted.blocks, fitted.reach), (SIZE, [2.0; 2]));
    // Views at the rim, evaluated in the middle of each block.
    let (mut with, mut without) = (0.0, 0.0);
    for (block, number) in fitted.numbers.iter().enumerate() {
        let (x, y) = ((block % SIZE[0]) as f64 + 0.5, (block / SIZE[0]) as f64 + 0.5);
        if x > 30.0 {
            assert_eq!(*number, Gloss::NONE, "nothing at {x}, {y}");
            continue;
        }
        for at in [[1.0, 0.0], [-1.0, 1.0], [0.5, -0.5]] {
            let expected = gloss(x, y, at.map(|at| 2.0 * at)) - gloss(x, y, [0.0; 2]);
            without += expected * expected;
            with += (expected - added(&fitted, block, at)).powi(2);
        }
    }
    assert!(with < 0.05 * without, "{with} of {without}");
}

#[test]
fn noise_and_darker_views_are_no_gloss() {
    assert_eq!(made(0.0, 1.0).gloss, None, "noise");
    assert_eq!(made(0.0, 0.8).gloss, None, "views beside the middle one are darker");
}
