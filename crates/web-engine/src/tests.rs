//! The engine against the splatter itself.

use crate::test_field::{PaintedWall, SIZE, camera, wall};
use crate::{ApertureChoice, Engine, FieldOfPage, LensChoice, PageBrush, Paint};
use lens::{Aperture, ApertureShape, Camera, Exposure, FocusOffset};
use numerics::screen_level;
use progress::Unwatched;
use splat::Splatter;
use std::sync::Arc;
use surface::SurfaceField;

fn engine() -> Engine {
    let field = FieldOfPage::new(&wall(), &PaintedWall, Exposure::Normalise);
    Engine::new(FieldOfPage::from_bytes(&field.to_bytes()).unwrap())
}

fn lens(inverse_distance: f64) -> LensChoice {
    LensChoice { inverse_distance, aperture_share: 1.0, aperture: ApertureChoice::Exported, is_painted: true }
}

/// The pixels of the splatter itself, which looks the focus up on the surface.
fn exact(camera: &Camera, focus: &dyn SurfaceField<FocusOffset>) -> Vec<[u8; 4]> {
    let mut splatter = Splatter::new(Arc::new(wall()));
    splatter.set_tolerance(Engine::TOLERANCE);
    splatter.render(camera, focus, &Unwatched).unwrap();
    let picture = splatter.picture();
    let levels = |(rgb, coverage): (&[f32; 3], &f32)| {
        let [r, g, b] = rgb.map(|light| screen_level(light * Exposure::Normalise.scale(1.0, *coverage)));
        [r, g, b, 255]
    };
    picture.radiance.iter().zip(&picture.coverage).map(levels).collect()
}

/// No pixels.
const NONE: [usize; 0] = [];

/// The pixels in which the engine's picture is not the expected one.
fn differing(engine: &Engine, expected: &[[u8; 4]]) -> Vec<usize> {
    let pixels = &engine.screen().pixels;
    assert_eq!(pixels.len(), expected.len());
    (0..pixels.len()).filter(|&k| pixels[k] != expected[k]).collect()
}

#[test]
fn the_picture_is_that_of_the_splatter() {
    let mut engine = engine();
    let polygon =
        |blades| ApertureShape::Polygon { blades, rotation: std::f64::consts::FRAC_PI_2, roundness: 0.0 };
    for inverse_distance in [0.0, 0.3, 0.4, 0.5, 1.0] {
        for (aperture_share, aperture, shape) in [
            (1.0, ApertureChoice::Exported, camera().aperture.shape),
            (0.5, ApertureChoice::Blades(6), polygon(6)),
        ] {
            let choice = LensChoice { aperture_share, aperture, ..lens(inverse_distance) };
            engine.refocus(choice, false).unwrap();
            let camera = Camera {
                focus_distance: 1.0 / inverse_distance,
                aperture_radius: 0.1 * aperture_share,
                aperture: Aperture::from(shape),
                ..camera()
            };
            assert_eq!(engine.screen().size, SIZE);
            let apart = differing(&engine, &exact(&camera, &PaintedWall));
            assert_eq!(apart, NONE, "{inverse_distance} {aperture:?}");
        }
    }
    let full = engine.screen().clone();
    engine.refocus(lens(1.0), true).unwrap();
    assert_eq!(engine.screen().size, [24, 16], "a draft");
    assert_ne!(engine.screen(), &full);
}

/// Nothing is painted.
struct Unpainted;

impl SurfaceField<FocusOffset> for Unpainted {
    fn at(&self, _: surface::SurfacePoint) -> FocusOffset {
        FocusOffset::STANDARD
    }
    fn at_infinity(&self) -> FocusOffset {
        FocusOffset::STANDARD
    }
}

#[test]
fn paint_is_shown_or_the_ordinary_lens() {
    let mut engine = engine();
    let ordinary = LensChoice { is_painted: false, ..lens(0.4) };
    let camera = Camera { focus_distance: 2.5, ..camera() };
    engine.refocus(ordinary, false).unwrap();
    assert_eq!(differing(&engine, &exact(&camera, &Unpainted)), NONE);
    assert_eq!(engine.sharp_inverse_distance(0.1, 0.1), Some(Some(0.25)));
    engine.refocus(lens(0.4), false).unwrap();
    assert_eq!(differing(&engine, &exact(&camera, &PaintedWall)), NONE);
    let map = engine.paint_map();
    let at = |x: u32, y: u32| map[(y * SIZE[0] + x) as usize];
    assert_eq!((map.len(), at(3, 3), at(30, 3), at(46, 3)), (48 * 32, 128, 0, 0));
    assert!(at(3, 25) > 128, "t above 1 blurs as far");

    // Painting shows the paint.
    engine.refocus(ordinary, false).unwrap();
    let brush = PageBrush { radius_px: 0.1, hardness: 1.0, paint: Paint::Circle(0.0) };
    assert!(engine.begin_stroke(brush, 0.1, 0.1));
    engine.draw_stroke().unwrap();
    assert_eq!(differing(&engine, &exact(&camera, &PaintedWall)), NONE, "it is sharp there already");
}

#[test]
fn lenses_that_make_no_sense_are_refused() {
    let mut engine = engine();
    let default = lens(0.4);
    for wrong in [
        LensChoice { inverse_distance: f64::NAN, ..default },
        LensChoice { inverse_distance: -1.0, ..default },
        LensChoice { aperture_share: f64::NAN, ..default },
        LensChoice { aperture_share: -0.5, ..default },
        LensChoice { aperture: ApertureChoice::Blades(2), ..default },
        LensChoice { aperture: ApertureChoice::Blades(u32::MAX), ..default },
    ] {
        assert!(engine.refocus(wrong, false).is_err(), "{wrong:?}");
    }
    engine.refocus(LensChoice { aperture_share: 7.0, ..default }, false).unwrap();
    let expected = exact(&Camera { focus_distance: 2.5, ..camera() }, &PaintedWall);
    assert_eq!(differing(&engine, &expected), NONE, "no wider than exported");
}

#[test]
fn clicks_find_what_is_there() {
    let engine = engine();
    assert_eq!(engine.range(), [0.0, 0.5]);
    assert_eq!(engine.sharp_inverse_distance(0.75, 0.5), Some(Some(0.5)), "the card");
    assert_eq!(engine.sharp_inverse_distance(0.1, 0.1), Some(None), "painted sharp, and stays so");
    let painted = engine.sharp_inverse_distance(0.1, 0.9).flatten().unwrap();
    let expected = camera()
        .optics()
        .sharp_inverse_focus_distance(0.25, FocusOffset::new(f64::from(1.02f32), f64::from(0.3f32)));
    assert!((painted - expected.unwrap()).abs() < 1e-5, "{painted}");
    for beside in [[0.99, 0.5], [-0.1, 0.5], [0.5, 1.0], [f64::NAN, 0.5]] {
        assert_eq!(engine.sharp_inverse_distance(beside[0], beside[1]), None, "{beside:?}");
    }
}

#[test]
fn strokes_paint_what_lies_in_their_dabs() {
    let mut engine = engine();
    engine.refocus(lens(0.4), false).unwrap();
    let before = engine.screen().clone();
    let brush = PageBrush { radius_px: 4.0, hardness: 1.0, paint: Paint::Circle(8.0) };
    assert!(engine.begin_stroke(brush, 0.75, 0.5));
    let (radius, target) = engine.stroke_facts().unwrap();
    let optics = camera().optics();
    assert!((radius - 4.0 * 2.0 * optics.tan_half_yfov / 16.0).abs() < 1e-9, "at depth 2: {radius}");
    let circle = optics.circle_of_confusion_px(optics.kappa(0.5, target));
    assert!((circle - 8.0).abs() < 1e-9 && target.anchor == 1.0, "{circle}");
    engine.extend_stroke(0.75, 0.75);
    assert_eq!(engine.screen(), &before, "not drawn yet");
    engine.draw_stroke().unwrap();
    let painted = engine.screen().clone();
    assert_ne!(painted, before);

    // The same as if the surface were painted there: all samples of the card within 4 px of the path.
    struct OnCard(FocusOffset);
    impl SurfaceField<FocusOffset> for OnCard {
        fn at(&self, point: surface::SurfacePoint) -> FocusOffset {
            let [x, y] = [point.barycentric.x * 96.0 + 0.5, point.barycentric.y * 64.0 + 0.5];
            let along = y.clamp(16.0, 24.0);
            let is_near = (x - 36.0).hypot(y - along) <= 4.0;
            if point.triangle == 1 && is_near { self.0 } else { PaintedWall.at(point) }
        }
        fn at_infinity(&self) -> FocusOffset {
            FocusOffset::STANDARD
        }
    }
    let expected = exact(&Camera { focus_distance: 2.5, ..camera() }, &OnCard(target));
    assert_eq!(differing(&engine, &expected), NONE);
    assert_eq!(engine.sharp_inverse_distance(0.75, 0.6), Some(None));

    assert!(engine.end_stroke());
    assert_eq!(engine.history_lengths(), [1, 0]);
    engine.undo().unwrap();
    assert_eq!(engine.screen(), &before);
    engine.redo().unwrap();
    assert_eq!(engine.screen(), &painted);

    // With another lens, drawn as a draft, and back.
    engine.refocus(lens(0.5), true).unwrap();
    engine.undo().unwrap();
    engine.refocus(lens(0.4), false).unwrap();
    assert_eq!(engine.screen(), &before);
    assert!(!engine.begin_stroke(brush, 0.99, 0.5), "there is no surface");
    assert!(!engine.end_stroke());
}

#[test]
fn a_stroke_is_no_stronger_where_dabs_overlap() {
    let mut engine = engine();
    engine.refocus(lens(0.4), false).unwrap();
    let brush = PageBrush { radius_px: 6.0, hardness: 0.0, paint: Paint::Circle(0.0) };
    engine.begin_stroke(brush, 0.25, 0.8);
    engine.draw_stroke().unwrap();
    let once = engine.screen().clone();
    for _ in 0..5 {
        engine.extend_stroke(0.25, 0.8);
        engine.draw_stroke().unwrap();
    }
    assert_eq!(engine.screen(), &once);
    engine.end_stroke();
    let erase = PageBrush { radius_px: 60.0, hardness: 1.0, paint: Paint::OrdinaryLens };
    engine.begin_stroke(erase, 0.25, 0.8);
    engine.draw_stroke().unwrap();
    let camera = Camera { focus_distance: 2.5, ..camera() };
    // The wall alone was painted, and all of it lies within 60 px of depth 4.
    assert_eq!(differing(&engine, &exact(&camera, &Unpainted)), NONE);
}
