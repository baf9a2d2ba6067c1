//! Surfaces of synthetic disparities: complete, within tolerance, without skins.

use glam::Vec2;
use progress::Unwatched;
use relief::{OtherView, Relief, ReliefOptions};
use std::collections::HashMap;
use std::convert::Infallible;

const SIZE: [usize; 2] = [70, 45];

fn disparities(of: impl Fn(f32, f32) -> f32) -> Vec<f32> {
    let at = |cell: usize| of((cell % SIZE[0]) as f32 + 0.5, (cell / SIZE[0]) as f32 + 0.5);
    (0..SIZE[0] * SIZE[1]).map(at).collect()
}

fn surface(disparity: &[f32], options: &ReliefOptions) -> Relief {
    let picture = vec![[0.5; 3]; disparity.len()];
    Relief::build::<Infallible>(SIZE, disparity, &picture, &[], options, &Unwatched).unwrap()
}

/// A hill on a slope.
fn hill(x: f32, y: f32) -> f32 {
    0.01 * x + (-((x - 30.0).powi(2) + (y - 20.0).powi(2)) / 120.0).exp()
}

/// A card before a wall.
fn card(x: f32, y: f32) -> f32 {
    if (20.0..50.0).contains(&x) && (12.0..33.0).contains(&y) { 2.0 } else { 0.3 + 0.004 * y }
}

/// The disparity of the first layer at a position, and the number of triangles there.
fn first_layer(relief: &Relief, at: Vec2) -> (f32, usize) {
    layer_at(relief, 0, at)
}

/// The disparity of a layer at a position, and the number of triangles there.
fn layer_at(relief: &Relief, layer: u8, at: Vec2) -> (f32, usize) {
    let mut result = (f32::NAN, 0);
    for corners in relief.triangles.iter().chain(&relief.translucent) {
        let [a, b, c] = corners.map(|v| relief.vertices[v as usize]);
        if a.layer != layer {
            continue;
        }
        let area = (b.place - a.place).perp_dot(c.place - a.place);
        let of_a = (b.place - at).perp_dot(c.place - at) / area;
        let of_b = (c.place - at).perp_dot(a.place - at) / area;
        let of_c = 1.0 - of_a - of_b;
        if of_a >= 0.0 && of_b >= 0.0 && of_c >= 0.0 {
            result = (of_a * a.disparity + of_b * b.disparity + of_c * c.disparity, result.1 + 1);
        }
    }
    result
}

#[test]
fn it_stays_within_its_tolerance_with_few_triangles() {
    let options = ReliefOptions { reach: 4.0, ..ReliefOptions::default() };
    let relief = surface(&disparities(hill), &options);
    // Positions near the centres of cells, but on no diagonal.
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let (disparity, count) = first_layer(&relief, Vec2::new(x as f32 + 0.47, y as f32 + 0.56));
            assert_eq!(count, 1, "at {x} {y}");
            let off = (disparity - hill(x as f32 + 0.47, y as f32 + 0.56)).abs() * options.reach;
            // The tolerance, and the error of the mean of four cells at a corner.
            assert!(off < options.tolerance_px + 0.03, "{off} px at {x} {y}");
        }
    }
    let cells = 2 * SIZE[0] * SIZE[1];
    assert!(relief.triangles.len() < cells / 3, "{} of {cells}", relief.triangles.len());
    assert_eq!(relief.hidden_triangles(), 0);
    let coarse = surface(&disparities(hill), &ReliefOptions { tolerance_px: 10.0, ..options });
    assert!(coarse.triangles.len() < relief.triangles.len());
}

/// How many triangles each side belongs to.
fn sides(relief: &Relief) -> HashMap<[u32; 2], usize> {
    let mut sides: HashMap<[u32; 2], usize> = HashMap::new();
    for &[a, b, c] in &relief.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *sides.entry([from.min(to), from.max(to)]).or_default() += 1;
        }
    }
    sides
}

/// Checks that sides within a picture of `size` belong to two triangles, those at its border to one, and that all triangles cover it once.
fn assert_closed(relief: &Relief, size: [usize; 2]) {
    let mut area = 0.0;
    for &[a, b, c] in &relief.triangles {
        let [a, b, c] = [a, b, c].map(|v| relief.vertices[v as usize].place);
        area += 0.5 * (b - a).perp_dot(c - a);
    }
    assert_eq!(area.abs(), (size[0] * size[1]) as f32, "all lie the same way around");
    let on_border = |v: u32| {
        let place = relief.vertices[v as usize].place;
        [place.x == 0.0, place.y == 0.0, place.x == size[0] as f32, place.y == size[1] as f32]
    };
    for (&[a, b], &count) in &sides(relief) {
        let is_border = on_border(a).into_iter().zip(on_border(b)).any(|(a, b)| a && b);
        assert_eq!(count, if is_border { 1 } else { 2 }, "{a} {b}");
    }
}

#[test]
fn nothing_gapes_where_nothing_jumps() {
    let relief = surface(&disparities(hill), &ReliefOptions { reach: 4.0, ..ReliefOptions::default() });
    assert_closed(&relief, SIZE);
}

#[test]
fn elongated_pictures_are_as_closed_and_take_no_more_than_their_own_size() {
    let options = ReliefOptions { reach: 4.0, ..ReliefOptions::default() };
    for size in [[300, 9], [9, 300], [257, 1], [2, 70_000]] {
        let at = |cell: usize| {
            let [x, y] = [cell % size[0], cell / size[0]].map(|k| k as f32);
            0.2 * (0.07 * (x + y)).sin() + 0.3 + 0.01 * x.min(9.0)
        };
        let disparity: Vec<f32> = (0..size[0] * size[1]).map(at).collect();
        let picture = vec![[0.5; 3]; disparity.len()];
        let relief =
            Relief::build::<Infallible>(size, &disparity, &picture, &[], &options, &Unwatched).unwrap();
        assert_closed(&relief, size);
        assert!(relief.triangles.len() <= 2 * disparity.len(), "{size:?}");
    }
}

#[test]
fn only_cells_sides_gape_where_depth_jumps() {
    // A tilted disc before the hill.
    let disc = |x: f32, y: f32| match (x - 40.0).hypot(y - 22.0) < 14.0 {
        true => 3.0 + 0.02 * x - 0.01 * y,
        false => hill(x, y),
    };
    let relief = surface(&disparities(disc), &ReliefOptions { reach: 4.0, ..ReliefOptions::default() });
    assert!(relief.hidden_triangles() > 100);
    for (&[a, b], &count) in &sides(&relief) {
        let [a, b] = [a, b].map(|v| relief.vertices[v as usize].place);
        assert!(count == 2 || count == 1 && a.distance(b) == 1.0, "{count} at {a} {b}");
    }
}

#[test]
fn what_is_behind_is_joined_and_lies_beneath_the_same_cells() {
    let wall = |x: f32, y: f32| if card(x, y) == 2.0 { 2.0 } else { 0.3 };
    let relief = surface(&disparities(wall), &ReliefOptions { reach: 6.0, ..ReliefOptions::default() });
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            for (right, below) in [(0.47, 0.56), (0.1, 0.2), (0.9, 0.3), (0.2, 0.9), (0.8, 0.7)] {
                let at = Vec2::new(x as f32 + right, y as f32 + below);
                let (disparity, count) = layer_at(&relief, 1, at);
                assert_eq!(count, usize::from(wall(at.x, at.y) == 2.0), "{at}");
                assert!(count == 0 || (disparity - 0.3).abs() < 1e-5, "{disparity} at {at}");
            }
        }
    }
    let cells = 2 * 30 * 21;
    assert!(relief.hidden_triangles() < cells / 3, "{} of {cells}", relief.hidden_triangles());
}

#[test]
fn no_skin_spans_a_jump_and_the_wall_continues_behind_the_card() {
    let options = ReliefOptions { reach: 2.0, ..ReliefOptions::default() };
    let relief = surface(&disparities(card), &options);
    for corners in &relief.triangles {
        let all = corners.map(|v| relief.vertices[v as usize].disparity);
        let (low, high) = all.iter().fold((f32::MAX, f32::MIN), |(l, h), &d| (l.min(d), h.max(d)));
        assert!(high - low < 0.1, "{all:?}");
    }
    for (x, y) in [(19.2, 20.3), (20.8, 20.3), (49.7, 32.6), (50.3, 33.4)] {
        let (disparity, count) = first_layer(&relief, Vec2::new(x, y));
        assert_eq!(count, 1);
        assert!((disparity - card(x, y)).abs() < 0.02, "{disparity} at {x} {y}");
    }
    assert!(relief.hidden_triangles() > 100);
    // The hidden layer begins where the wall ends: at the same points.
    let points = |layer: u8| {
        let layer_at = relief.vertices.iter().filter(move |vertex| vertex.layer == layer);
        layer_at.map(|vertex| [vertex.place.x, vertex.place.y, vertex.disparity].map(f32::to_bits))
    };
    let first: Vec<_> = points(0).collect();
    let shared = points(1).filter(|point| first.contains(point)).count();
    assert!(shared >= 2 * (30 + 21), "{shared}");
    // No view shows the hidden layer: it is invented, with the wall's colour.
    let second = SIZE[0] * SIZE[1];
    assert!(
        relief.is_observed[..second].iter().all(|seen| *seen)
            && !relief.is_observed[second..].contains(&true)
    );
    assert_eq!(relief.texture[second + 20 * SIZE[0] + 20], [0.5; 3]);
}

#[test]
fn the_hidden_layer_has_the_colours_of_views_that_show_it() {
    // A striped wall; the view from the right sees behind the card's right side.
    let disparity = disparities(card);
    let wall = |x: f32| [0.5 + 0.4 * (0.7 * x).sin(); 3];
    let shown = |offset: f32| -> Vec<[f32; 3]> {
        let at = |cell: usize| {
            let (x, y) = ((cell % SIZE[0]) as f32 + 0.5, (cell / SIZE[0]) as f32 + 0.5);
            if card(x + 2.0 * offset, y) == 2.0 { [0.9; 3] } else { wall(x + (0.3 + 0.004 * y) * offset) }
        };
        (0..SIZE[0] * SIZE[1]).map(at).collect()
    };
    let picture = shown(0.0);
    let view = |offset: f32| OtherView::<Infallible> {
        offset: [offset, 0.0],
        read: Box::new(move || Ok(shown(offset))),
    };
    let options = ReliefOptions { reach: 2.0, ..ReliefOptions::default() };
    let relief =
        Relief::build(SIZE, &disparity, &picture, &[view(2.0), view(-2.0)], &options, &Unwatched).unwrap();
    let second = SIZE[0] * SIZE[1];
    for (x, y) in [(49, 20), (48, 24), (20, 20), (21, 15)] {
        let texel = second + y * SIZE[0] + x;
        assert!(relief.is_observed[texel], "{x} {y}");
        let off = relief.texture[texel][0] - wall(x as f32 + 0.5)[0];
        assert!(off.abs() < 0.03, "{off} at {x} {y}");
    }
    // Negative control: with the views exchanged the result differs.
    let wrong = |offset: f32| OtherView::<Infallible> { offset: [-offset, 0.0], ..view(offset) };
    let relief =
        Relief::build(SIZE, &disparity, &picture, &[wrong(2.0), wrong(-2.0)], &options, &Unwatched).unwrap();
    let off = |x: usize| (relief.texture[second + 20 * SIZE[0] + x][0] - wall(x as f32 + 0.5)[0]).abs();
    assert!((44..50).map(off).fold(0.0, f32::max) > 0.2);
}

#[test]
fn scale_and_offset_of_disparities_change_no_triangle() {
    let of = |scale: f32, offset: f32| {
        let moved: Vec<f32> = disparities(card).iter().map(|d| scale * d + offset).collect();
        surface(&moved, &ReliefOptions { reach: 2.0 / scale, ..ReliefOptions::default() })
    };
    let plain = of(1.0, 0.0);
    for (scale, offset) in [(0.1, 3.0), (10.0, -3.0)] {
        let moved = of(scale, offset);
        assert_eq!(moved.triangles.len(), plain.triangles.len());
        let pairs = plain.vertices.iter().zip(&moved.vertices);
        let off =
            pairs.map(|(a, b)| ((b.disparity - offset) / scale - a.disparity).abs()).fold(0.0, f32::max);
        assert!(off < 1e-4, "{off}");
    }
}

#[test]
fn where_there_is_no_disparity_there_is_no_surface() {
    let disparity = disparities(|x, y| if x < 30.0 { f32::NAN } else { hill(x, y) });
    let relief = surface(&disparity, &ReliefOptions { reach: 4.0, ..ReliefOptions::default() });
    assert_eq!(first_layer(&relief, Vec2::new(20.3, 20.6)).1, 0);
    assert_eq!(first_layer(&relief, Vec2::new(30.3, 20.6)).1, 1);
    assert!(relief.vertices.iter().all(|vertex| vertex.disparity.is_finite()));
    let nothing = surface(&vec![f32::NAN; SIZE[0] * SIZE[1]], &ReliefOptions::default());
    assert!(nothing.triangles.is_empty());
}

/// A card of one colour before a wall, whose left and right sides lie within pixels.
fn soft_card(left: f32, right: f32, card: [f32; 3], wall: impl Fn(f32) -> [f32; 3]) -> Vec<[f32; 3]> {
    let at = |cell: usize| {
        let (x, y) = ((cell % SIZE[0]) as f32, cell / SIZE[0]);
        let across = ((x + 1.0).min(right) - x.max(left)).clamp(0.0, 1.0);
        let share = if (12..33).contains(&y) { across } else { 0.0 };
        let wall = wall(x + 0.5);
        std::array::from_fn(|c| share * card[c] + (1.0 - share) * wall[c])
    };
    (0..SIZE[0] * SIZE[1]).map(at).collect()
}

/// The coverage of a pixel by the foreground.
fn share_of_card(relief: &Relief, x: usize, y: usize) -> f32 {
    let places = (0..400).map(|k| Vec2::new((k % 20) as f32, (k / 20) as f32) / 20.0 + 0.0251);
    let at = |place: Vec2| first_layer(relief, place + Vec2::new(x as f32, y as f32));
    let covered = places.filter(|place| at(*place).1 > 0).count();
    relief.opacity[y * SIZE[0] + x] * covered as f32 / 400.0
}

#[test]
fn pixels_that_show_both_sides_of_a_jump_are_translucent() {
    // 0.7 of the last pixel on the left, 0.3 of one beyond the last on the right.
    let (card, wall) = ([0.8, 0.1, 0.05], [0.05, 0.2, 0.6]);
    let picture = soft_card(20.3, 50.3, card, |_| wall);
    let disparity = disparities(card_at);
    let options = ReliefOptions { reach: 4.0, ..ReliefOptions::default() };
    let relief = Relief::build::<Infallible>(SIZE, &disparity, &picture, &[], &options, &Unwatched).unwrap();
    let second = SIZE[0] * SIZE[1];
    for y in 14..31 {
        for (x, share) in [(20, 0.7), (50, 0.3)] {
            let cell = y * SIZE[0] + x;
            let opacity = share_of_card(&relief, x, y);
            assert!((opacity - share).abs() < 0.03, "{opacity} at {x} {y}");
            for c in 0..3 {
                let (before, behind) = (relief.texture[cell][c], relief.texture[second + cell][c]);
                assert!(
                    (before - card[c]).abs() < 0.03 && (behind - wall[c]).abs() < 0.03,
                    "{before} {behind}"
                );
                let whole = opacity * before + (1.0 - opacity) * behind;
                assert!((whole - picture[cell][c]).abs() < 0.02, "in focus it is the picture");
            }
        }
    }
    assert!((first_layer(&relief, Vec2::new(50.1, 20.3)).0 - 2.0).abs() < 1e-3, "it is part of the card");
}

#[test]
fn whole_pixels_and_textures_are_there_as_a_whole() {
    let options = ReliefOptions { reach: 4.0, ..ReliefOptions::default() };
    let disparity = disparities(card_at);
    let relief = |picture: &[[f32; 3]]| {
        Relief::build::<Infallible>(SIZE, &disparity, picture, &[], &options, &Unwatched).unwrap()
    };
    let sharp = relief(&soft_card(20.0, 50.0, [0.8, 0.1, 0.05], |_| [0.05, 0.2, 0.6]));
    assert!(!sharp.is_matted.contains(&true));
    // Similar colours determine nothing.
    let alike = relief(&soft_card(20.5, 50.5, [0.3, 0.3, 0.3], |_| [0.3, 0.301, 0.3]));
    assert!(!alike.is_matted.contains(&true));
    // Neither do colours that vary as much as they differ.
    let grain = |x: usize, y: usize| ((x * 7919 + y * 104_729) % 101) as f32 / 101.0;
    let grain: Vec<[f32; 3]> =
        (0..SIZE[0] * SIZE[1]).map(|cell| [grain(cell % SIZE[0], cell / SIZE[0]); 3]).collect();
    let grainy = relief(&grain);
    let matted = grainy.is_matted.iter().filter(|is_matted| **is_matted).count();
    assert!(matted <= 4, "{matted}");
}

/// [`card`], with a wall of constant disparity.
fn card_at(x: f32, y: f32) -> f32 {
    if card(x, y) == 2.0 { 2.0 } else { 0.3 }
}

#[test]
fn the_background_in_other_views_determines_the_opacity_of_an_edge() {
    // The wall is bright only where the card hides it, except for its last pixel: the picture alone does not show that.
    let wall = |x: f32| if (25.0..50.0).contains(&x) { [0.1, 0.7, 0.2] } else { [0.05, 0.2, 0.6] };
    let card = [0.8, 0.1, 0.05];
    let shown = |offset: f32| {
        // The card is shifted by its disparity, the wall by its own.
        let (near, far) = (2.0 * offset, 0.3 * offset);
        soft_card(20.0 - near, 49.4 - near, card, |x| wall(x + far))
    };
    let disparity = disparities(card_at);
    let view = |offset: f32| OtherView::<Infallible> {
        offset: [offset, 0.0],
        read: Box::new(move || Ok(shown(offset))),
    };
    let options = ReliefOptions { reach: 4.0, ..ReliefOptions::default() };
    let picture = shown(0.0);
    let views = [3.0, 4.0].map(view);
    let relief = Relief::build(SIZE, &disparity, &picture, &views, &options, &Unwatched).unwrap();
    let cell = 20 * SIZE[0] + 49;
    let share = share_of_card(&relief, 49, 20);
    assert!((share - 0.4).abs() < 0.05, "{share}");
    let behind = relief.texture[SIZE[0] * SIZE[1] + cell];
    assert!((behind[1] - 0.7).abs() < 0.1, "{behind:?}");
}

#[test]
fn the_background_is_resampled_up_to_the_edge_that_hides_it() {
    let wall = |x: f32| [0.05, 0.4 + 0.3 * (0.4 * x).sin(), 0.6];
    let shown = |offset: f32| {
        let (near, far) = (2.0 * offset, 0.3 * offset);
        soft_card(20.0 - near, 49.4 - near, [0.8, 0.1, 0.05], |x| wall(x + far))
    };
    let view = |offset: f32| OtherView::<Infallible> {
        offset: [offset, 0.0],
        read: Box::new(move || Ok(shown(offset))),
    };
    let options = ReliefOptions { reach: 4.0, ..ReliefOptions::default() };
    let views = [1.0, 2.0, 3.0, 4.0].map(view);
    let relief =
        Relief::build(SIZE, &disparities(card_at), &shown(0.0), &views, &options, &Unwatched).unwrap();
    // The last view sees 6.8 px behind the card: in the last pixel that shows the wall, half is covered by the card.
    for x in 43..50 {
        let behind = SIZE[0] * SIZE[1] + 20 * SIZE[0] + x;
        let (color, expected) = (relief.texture[behind], wall(x as f32 + 0.5));
        assert!((0..3).all(|c| (color[c] - expected[c]).abs() < 0.02), "{color:?}, not {expected:?} at {x}");
        assert!(relief.is_observed[behind], "{x}");
    }
}

#[test]
fn pixels_that_look_like_the_other_side_stay_where_views_show_them() {
    // The wall has a stripe of the card's colour next to the card.
    let card = [0.8, 0.1, 0.05];
    let wall = |x: f32| if (50.0..51.0).contains(&x) { card } else { [0.05, 0.2, 0.6] };
    let shown = |offset: f32| {
        let (near, far) = (2.0 * offset, 0.5 * offset);
        soft_card(20.0 - near, 50.0 - near, card, |x| wall(x + far))
    };
    let view = |offset: f32| OtherView::<Infallible> {
        offset: [offset, 0.0],
        read: Box::new(move || Ok(shown(offset))),
    };
    let options = ReliefOptions { reach: 4.0, ..ReliefOptions::default() };
    let disparity_with = |views: &[OtherView<'_, Infallible>]| {
        let disparity = disparities(|x, y| if self::card(x, y) == 2.0 { 2.0 } else { 0.5 });
        let relief = Relief::build(SIZE, &disparity, &shown(0.0), views, &options, &Unwatched).unwrap();
        first_layer(&relief, Vec2::new(50.4, 20.4)).0
    };
    assert!((disparity_with(&[]) - 2.0).abs() < 0.05, "the picture alone cannot decide");
    let disparity = disparity_with(&[-4.0, -2.0, 2.0, 4.0].map(view));
    assert!((disparity - 0.5).abs() < 0.05, "{disparity}");
}

#[test]
fn edges_of_depth_are_aligned_with_the_picture() {
    let options = ReliefOptions { reach: 4.0, ..ReliefOptions::default() };
    let picture = soft_card(20.0, 50.0, [0.8, 0.1, 0.05], |_| [0.05, 0.2, 0.6]);
    // One pixel too far right, on the left and on the right side.
    let moved = disparities(|x, y| if (21.0..51.0).contains(&x) { card_at(30.0, y) } else { 0.3 });
    let relief = Relief::build::<Infallible>(SIZE, &moved, &picture, &[], &options, &Unwatched).unwrap();
    for y in [15.3, 20.4, 29.6] {
        for (x, expected) in [(19.6, 0.3), (20.4, 2.0), (49.6, 2.0), (50.4, 0.3)] {
            let (disparity, _) = first_layer(&relief, Vec2::new(x, y));
            assert!((disparity - expected).abs() < 0.05, "{disparity} at {x} {y}");
        }
    }
}

#[test]
fn a_hair_lets_through_what_is_behind_it() {
    // A third of a pixel wide, before a wall of two colours.
    let wall = |x: f32| [0.05, 0.2 + 0.001 * x, 0.6];
    let picture = soft_card(30.3, 30.65, [0.9, 0.8, 0.1], wall);
    let whole = soft_card(20.0, 26.0, [0.9, 0.8, 0.1], wall);
    // The same colour is next to it as a whole surface, at the same depth.
    let is_hair = |cell: usize| cell % SIZE[0] == 30;
    let picture: Vec<[f32; 3]> =
        (0..picture.len()).map(|cell| if is_hair(cell) { picture[cell] } else { whole[cell] }).collect();
    let disparity = disparities(|x, y| {
        let is_near = (20.0..26.0).contains(&x) || (30.0..31.0).contains(&x);
        if is_near && (12.0..33.0).contains(&y) { 2.0 } else { 0.3 }
    });
    let options = ReliefOptions { reach: 4.0, ..ReliefOptions::default() };
    let relief = Relief::build::<Infallible>(SIZE, &disparity, &picture, &[], &options, &Unwatched).unwrap();
    for y in 16..29 {
        let cell = y * SIZE[0] + 30;
        let [before, behind] = [relief.texture[cell], relief.texture[SIZE[0] * SIZE[1] + cell]];
        let opacity = relief.opacity[cell];
        assert!((opacity - 0.35).abs() < 0.1, "{opacity} at {y}");
        (0..3).for_each(|c| {
            let both = opacity * before[c] + (1.0 - opacity) * behind[c];
            assert!((both - picture[cell][c]).abs() < 1e-5, "in focus it is the picture");
        });
    }
}
