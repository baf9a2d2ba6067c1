//! Mattes: what each set of samples covers.

use super::*;

/// What the samples of each of five sets cover, by sets drawn together; and the coverage of all.
fn mattes(mut mattes: Mattes) -> (Vec<Vec<f32>>, Vec<f32>) {
    let mut found = Vec::new();
    let mut coverage = Vec::new();
    for first in [0, 3] {
        let in_sets = |sample: u32| [0, 1, 2].map(|set| sample as usize % 5 == first + set);
        let picture = mattes.draw(&in_sets, &Unwatched).unwrap();
        found.extend((0..SETS).map(|c| picture.radiance.iter().map(|rgb| rgb[c]).collect::<Vec<_>>()));
        coverage = picture.coverage;
    }
    (found, coverage)
}

#[test]
fn mattes_sum_to_the_pictures_coverage() {
    let painted =
        |index: u32| FocusOffset::new(0.9 + f64::from(index % 21) * 0.01, f64::from(index % 3) / 2.0);
    let half = |index: u32| if index % 7 < 3 { painted(index) } else { FocusOffset::STANDARD };
    let focuses = [
        standard(),
        ByTriangle((0..96 * 80).map(painted).collect()),
        ByTriangle((0..96 * 80).map(half).collect()),
    ];
    for focus in focuses {
        for tolerance in [Tolerance::NONE, Tolerance::VIEWING] {
            let mut splatter = Splatter::new(light_field());
            splatter.set_tolerance(tolerance);
            splatter.render(&camera(), &focus, &Unwatched).unwrap();
            let is_standard = splatter.paint.is_standard();
            let picture = splatter.picture().clone();
            let (found, coverage) = mattes(splatter.into_mattes());
            for (pixel, covered) in coverage.iter().enumerate() {
                let sum: f32 = found.iter().map(|matte| matte[pixel]).sum();
                assert!((sum - covered).abs() <= 5e-5 * covered.max(1.0), "{sum} {covered}");
                // The picture of an unpainted scene is evened out.
                assert!(is_standard || (covered - picture.coverage[pixel]).abs() <= 1e-6, "{covered}");
            }
            assert!(found[..5].iter().all(|matte| matte.iter().any(|share| *share > 0.1)));
            assert!(found[5].iter().all(|share| *share == 0.0), "a set without samples");
        }
    }
}

#[test]
fn mattes_reach_no_further_than_told() {
    let mut mattes = rendered(&standard()).into_mattes();
    let of_one = |sample: u32| [777, 4321].iter().position(|one| *one == sample);
    let in_sets = |sample: u32| [0, 1, 2].map(|set| of_one(sample) == Some(set));
    let picture = mattes.draw(&in_sets, &Unwatched).unwrap();
    let mut windows = [[0..0, 0..0], [0..0, 0..0]];
    mattes.reaches(|sample, window| {
        if let Some(set) = of_one(sample) {
            windows[set] = window;
        }
    });
    for (set, [columns, rows]) in windows.iter().enumerate() {
        let mut inside = 0.0;
        for (pixel, rgb) in picture.radiance.iter().enumerate() {
            let (x, y) = (pixel as u32 % 96, pixel as u32 / 96);
            let is_inside = columns.contains(&x) && rows.contains(&y);
            assert!(is_inside || rgb[set] == 0.0, "{set} at {x}, {y}");
            inside += rgb[set];
        }
        assert!((inside - 1.0).abs() < 0.5, "{inside}");
    }
}
