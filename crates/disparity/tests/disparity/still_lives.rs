//! Small light fields with exact truth: grids of several forms, noise, vignetting, occlusion.

use crate::field::{Field, grid};
use crate::score::{Score, score, score_where};
use crate::still_life::StillLife;
use disparity::{DisparityMap, DisparityRequest, estimate_disparities};
use progress::Unwatched;

/// Width and height, pixels: seconds, not minutes.
const SIZE: usize = 112;

fn photographed(positions: Vec<[f64; 2]>, parallax: f32, noise: f32) -> (Field, Vec<Vec<f32>>) {
    let life = StillLife { size: SIZE, parallax, noise, samples: 3 };
    let photographs = positions.iter().map(|p| life.photograph(*p));
    let (pictures, truths) = photographs.map(|p| (p.rgb, p.disparity)).unzip();
    (Field { width: SIZE, height: SIZE, pictures, positions }, truths)
}

fn estimate(field: &Field, others: Vec<usize>, range: Option<(f32, f32)>) -> Vec<DisparityMap> {
    let request = DisparityRequest { reference: field.at([0.0, 0.0]), others, range };
    let maps = estimate_disparities(&field.views(), &request, &Unwatched).expect("disparities");
    for map in &maps {
        assert_eq!(map.disparity.len(), SIZE * SIZE);
        assert!(map.disparity.iter().all(|d| d.is_finite()));
        assert!(map.confidence.iter().all(|c| (0.0..=1.0).contains(c)));
    }
    maps
}

/// The score where limits are a parallax of 1 in the farthest view: maps of other baselines are scaled.
fn printed_score(name: &str, map: &DisparityMap, truth: &[f32], scale: f32) -> Score {
    let scaled = |values: &[f32]| values.iter().map(|v| v * scale).collect::<Vec<_>>();
    let score = score(&scaled(&map.disparity), &scaled(truth));
    eprintln!("{name}: {score}");
    score
}

#[test]
fn five_by_five_views_and_the_same_mirrored() {
    let (mut field, truths) = photographed(grid(2, 2), 1.0, 0.005);
    let middle = field.at([0.0, 0.0]);
    let score = printed_score("grid", &estimate(&field, Vec::new(), None)[0], &truths[middle], 1.0);
    assert!(score.bad_007 < 25.0 && score.bad_03 < 10.0, "{score}");
    // Mirrored positions: no disparity can be right.
    field.positions.iter_mut().for_each(|p| *p = p.map(|v| -v));
    let wrong = printed_score("mirrored", &estimate(&field, Vec::new(), None)[0], &truths[middle], 1.0);
    assert!(wrong.bad_007 > 60.0, "{wrong}");
}

#[test]
fn a_row_a_cross_and_a_hexagon() {
    let cross: Vec<_> = grid(3, 3).into_iter().filter(|p| p[0] == 0.0 || p[1] == 0.0).collect();
    let mut hexagon = vec![[0.0, 0.0]];
    hexagon.extend((0..6).map(|k| std::f64::consts::TAU * f64::from(k) / 6.0).map(|a| [a.cos(), a.sin()]));
    for (name, positions, parallax, scale) in
        [("row", grid(4, 0), 0.7, 1.0), ("cross", cross, 0.8, 1.0), ("hexagon", hexagon, 2.0, 0.5)]
    {
        let (field, truths) = photographed(positions, parallax, 0.003);
        let score =
            printed_score(name, &estimate(&field, Vec::new(), None)[0], &truths[field.at([0.0, 0.0])], scale);
        assert!(score.bad_007 < 30.0 && score.bad_03 < 12.0, "{name}: {score}");
    }
}

#[test]
fn three_by_three_views_far_apart() {
    let (field, truths) = photographed(grid(1, 1), 4.0, 0.003);
    let map = &estimate(&field, Vec::new(), None)[0];
    let score = printed_score("wide", map, &truths[4], 0.25);
    assert!(score.bad_007 < 30.0 && score.bad_03 < 12.0, "{score}");
    // The estimated range is about the true one; the ends are outliers within its margin.
    let ends = |values: &[f32]| {
        values.iter().fold((f32::MAX, f32::MIN), |(low, high), v| (low.min(*v), high.max(*v)))
    };
    let (own, truth) = (ends(&map.disparity), ends(&truths[4]));
    assert!((own.0 - truth.0).abs() < 2.5 && (own.1 - truth.1).abs() < 1.5, "{own:?} {truth:?}");
}

#[test]
fn dark_corners_of_outer_views_change_little() {
    let (mut field, truths) = photographed(grid(2, 2), 1.0, 0.003);
    let middle = field.at([0.0, 0.0]);
    let even =
        printed_score("even", &estimate(&field, Vec::new(), Some((-1.6, 1.5)))[0], &truths[middle], 1.0);
    for (rgb, position) in field.pictures.iter_mut().zip(&field.positions) {
        for (index, colour) in rgb.iter_mut().enumerate() {
            let at = |pixel: usize, place: f64| pixel as f64 / SIZE as f64 - 0.5 + 0.1 * place;
            let (x, y) = (at(index % SIZE, position[0]), at(index / SIZE, position[1]));
            let distance = position[0].hypot(position[1]);
            let gain = (1.0 - 0.08 * distance - 0.25 * distance * (x * x + y * y)) as f32;
            *colour = colour.map(|v| v * gain);
        }
    }
    let dark =
        printed_score("vignetted", &estimate(&field, Vec::new(), Some((-1.6, 1.5)))[0], &truths[middle], 1.0);
    assert!(dark.bad_007 < even.bad_007 + 3.0, "{dark} instead of {even}");
}

#[test]
fn outer_views_have_the_surface_of_the_middle_one_and_more() {
    let (field, truths) = photographed(grid(2, 2), 1.0, 0.003);
    let (middle, corner) = (field.at([0.0, 0.0]), field.at([-2.0, 2.0]));
    let maps = estimate(&field, vec![corner, middle], None);
    assert_eq!(maps.iter().map(|m| m.view).collect::<Vec<_>>(), [middle, corner, middle]);
    assert_eq!(maps[0], maps[2]);
    let (own, there) = (
        printed_score("middle", &maps[0], &truths[middle], 1.0),
        printed_score("corner", &maps[1], &truths[corner], 1.0),
    );
    assert!(there.bad_007 < own.bad_007 + 8.0, "{there}");
    // Hidden from the middle: points of the corner's view whose place there is occluded by something nearer.
    let hidden = |index: usize| {
        let d = truths[corner][index];
        let (x, y) = ((index % SIZE) as f32 + 2.0 * -d, (index / SIZE) as f32 + 2.0 * d);
        let (column, row) = (x.round(), y.round());
        let inside = column >= 0.0 && row >= 0.0 && column < SIZE as f32 && row < SIZE as f32;
        inside && truths[middle][row as usize * SIZE + column as usize] > d + 0.3
    };
    let count = (0..SIZE * SIZE).filter(|i| hidden(*i)).count();
    let score = score_where(&maps[1].disparity, &truths[corner], hidden);
    eprintln!("hidden from the middle: {count} pixels, {score}");
    assert!(count > 300 && score.bad_03 < 40.0, "{score}");
}

#[test]
fn confidence_is_low_where_errors_are() {
    let (field, truths) = photographed(grid(2, 2), 1.0, 0.005);
    let middle = field.at([0.0, 0.0]);
    let map = &estimate(&field, Vec::new(), None)[0];
    let mut order: Vec<usize> = (0..SIZE * SIZE).collect();
    order.sort_unstable_by(|a, b| map.confidence[*b].total_cmp(&map.confidence[*a]));
    let half = |indices: &[usize]| {
        let mut inside = vec![false; SIZE * SIZE];
        indices.iter().for_each(|i| inside[*i] = true);
        score_where(&map.disparity, &truths[middle], |i| inside[i])
    };
    let (sure, unsure) = (half(&order[..SIZE * SIZE / 2]), half(&order[SIZE * SIZE / 2..]));
    eprintln!("sure: {sure}\nunsure: {unsure}");
    assert!(2.0 * sure.bad_007 < unsure.bad_007, "{sure} / {unsure}");
}
