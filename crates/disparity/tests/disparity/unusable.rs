//! Invalid light fields and requests are refused.

use disparity::{DisparityError, DisparityRequest, Picture, View, estimate_disparities};
use progress::{Progress, Unwatched};

fn view(rgb: &[[f32; 3]], position: [f64; 2]) -> View<'_> {
    View { picture: Picture { width: 20, height: 16, rgb }, position }
}

#[test]
fn each_mistake_has_its_error() {
    let rgb = vec![[0.5; 3]; 320];
    let mut broken = rgb.clone();
    broken[45][1] = f32::NAN;
    let two = [view(&rgb, [0.0, 0.0]), view(&rgb, [1.0, 0.0])];
    let request = |reference, range| DisparityRequest { reference, others: Vec::new(), range };
    let refusal = |views: &[View<'_>], request: &DisparityRequest| {
        estimate_disparities(views, request, &Unwatched).unwrap_err()
    };
    assert_eq!(refusal(&two[..1], &request(0, None)), DisparityError::TooFewViews { views: 1 });
    assert_eq!(refusal(&two, &request(2, None)), DisparityError::NoSuchView { view: 2, views: 2 });
    let others = DisparityRequest { others: vec![7], ..DisparityRequest::default() };
    assert_eq!(refusal(&two, &others), DisparityError::NoSuchView { view: 7, views: 2 });
    let nan = [two[0], view(&broken, [1.0, 0.0])];
    assert_eq!(refusal(&nan, &request(0, None)), DisparityError::NotFinite { view: 1, x: 5, y: 2 });
    assert!(matches!(
        refusal(&[two[0], two[0]], &request(0, None)),
        DisparityError::Position { view: 1, .. }
    ));
    let nowhere = [two[0], view(&rgb, [f64::INFINITY, 0.0])];
    assert!(matches!(refusal(&nowhere, &request(0, None)), DisparityError::Position { view: 1, .. }));
    let short = [two[0], view(&rgb[1..], [1.0, 0.0])];
    assert!(matches!(refusal(&short, &request(0, None)), DisparityError::Size { view: 1, .. }));
    for range in [(1.0, 1.0), (f32::NAN, 1.0), (2.0, -2.0)] {
        assert!(matches!(refusal(&two, &request(0, Some(range))), DisparityError::Range { .. }));
    }
}

#[test]
fn a_picture_without_texture_has_finite_disparities_and_no_confidence() {
    let rgb = vec![[0.5; 3]; 320];
    let views = [view(&rgb, [0.0, 0.0]), view(&rgb, [1.0, 0.0]), view(&rgb, [0.0, 3.5])];
    for range in [None, Some((-0.5, 0.5)), Some((-1e30, 1e30))] {
        let maps = estimate_disparities(
            &views,
            &DisparityRequest { range, others: vec![2], ..DisparityRequest::default() },
            &Unwatched,
        )
        .unwrap();
        for map in maps {
            assert!(map.disparity.iter().all(|d| d.is_finite()));
            assert!(map.confidence.iter().all(|c| *c == 0.0));
        }
    }
}

#[test]
fn it_stops_when_cancelled() {
    struct Stop;
    impl Progress for Stop {
        fn report(&self, _fraction: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let rgb = vec![[0.5; 3]; 320];
    let views = [view(&rgb, [0.0, 0.0]), view(&rgb, [1.0, 0.0])];
    assert!(matches!(
        estimate_disparities(&views, &DisparityRequest::default(), &Stop),
        Err(DisparityError::Cancelled(_))
    ));
}
