//! Layers: painted with masks, blended, drawn as curves; what they make together.

use focus::{
    Adjustment, BlendMode, Brush, BrushMode, Canvas, CanvasTexel, Channels, Curve, DepthCurve, FillTarget,
    FocusLayer, FocusMap, LayerStack, PenSample, Stroke, SurfaceHit, fill,
};
use glam::{DVec3, Vec3};
use lens::{Camera, FocusOffset};
use std::sync::Arc;

const SIZE: [u32; 2] = [150, 70];

/// A plane z = −(1 + y), facing +z, a texel of 0.01 each; the last column is a gutter of the one before.
fn slope() -> Arc<Canvas> {
    let mut texels = Vec::new();
    let mut gutters = Vec::new();
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] - 1 {
            let position = DVec3::new(x as f64 * 0.01, 0.0, -1.0 - y as f64 * 0.01);
            texels.push(CanvasTexel { x, y, position, normal: Vec3::Y, area: 1e-4, part: 0, chart: 0 });
        }
        gutters.push([[SIZE[0] - 1, y], [SIZE[0] - 2, y]]);
    }
    Arc::new(Canvas::from_texels(SIZE, texels, &gutters, vec![[0, 0]]))
}

fn camera() -> Camera {
    Camera { focus_distance: 1.3, ..Camera::default() }
}

fn empty() -> FocusMap {
    FocusMap::transparent(SIZE[0], SIZE[1])
}

fn stack() -> LayerStack {
    LayerStack::from_map(FocusMap::new(SIZE[0], SIZE[1], FocusOffset::STANDARD))
}

fn hit(x: f64, depth: f64) -> SurfaceHit {
    SurfaceHit { position: DVec3::new(x, 0.0, -depth), normal: Some(Vec3::Y) }
}

fn stroke(layers: &mut LayerStack, map: &mut FocusMap, canvas: &Arc<Canvas>, brush: &Brush) {
    let mut stroke = Stroke::begin(&layers.active().map, canvas.clone(), brush.clone()).unwrap();
    for k in 0..5 {
        let at = hit(0.3 + 0.1 * k as f64, 1.3);
        let changed = stroke.extend(&mut layers.active_mut().map, at, PenSample::default());
        layers.recomposite(map, &changed);
    }
    stroke.commit(&layers.active().map).expect("something was painted");
}

fn painter(mode: BrushMode, t: f64) -> Brush {
    Brush { radius: 0.12, mode, target: FocusOffset::new(t, 1.0), ..Brush::default() }
}

#[test]
fn a_layer_paints_as_the_map_itself_would_and_leaves_what_lies_beneath() {
    let canvas = slope();
    let mut single = stack();
    let mut flat = single.composite();
    stroke(&mut single, &mut flat, &canvas, &painter(BrushMode::Set, 1.2));
    assert_eq!(flat, single.active().map, "one plain layer is the composite");

    let mut layers = stack();
    let below = layers.active().map.clone();
    assert!(layers.insert(FocusLayer::from_map("above", empty())));
    let mut map = layers.composite();
    stroke(&mut layers, &mut map, &canvas, &painter(BrushMode::Set, 1.2));
    assert_eq!(layers.layers()[0].map, below);
    let mut differs = 0;
    for texel in canvas.texels() {
        let [a, b] = [&map, &flat].map(|map| map.texel(texel.x, texel.y));
        // Over the ordinary lens, mask times value is what the brush gives.
        assert!((a[0] - b[0]).abs() < 1e-5 && (a[1] - b[1]).abs() < 1e-5, "{a:?} {b:?}");
        differs += usize::from(b[0] != 1.0);
    }
    assert!(differs > 500);
    assert_eq!(map, layers.composite(), "kept up to date by dirty tiles alone");
    let gutter = [SIZE[0] - 1, 30];
    assert_eq!(map.at(gutter[0], gutter[1]), map.at(gutter[0] - 1, 30));

    // What lies beneath shows through where the layer is taken away, also if it has changed since.
    let white = FocusOffset::new(0.9, 1.0);
    layers.activate(0);
    fill(&mut layers.active_mut().map, &canvas, FillTarget::Everything, white, Channels::All).unwrap();
    layers.activate(1);
    layers.recomposite_all(&mut map);
    assert!((map.at(50, 30).t - 1.2).abs() < 1e-6, "the stroke covers");
    let wide = Brush { radius: 0.2, hardness: 1.0, ..painter(BrushMode::Reset, 1.0) };
    stroke(&mut layers, &mut map, &canvas, &wide);
    for texel in canvas.texels() {
        assert!((map.at(texel.x, texel.y).t - white.t).abs() < 1e-6);
    }
    assert_eq!(map, layers.composite());
}

#[test]
fn opacity_visibility_blending_and_order_count() {
    let canvas = slope();
    let value = |t: f64, anchor: f64| FocusOffset::new(t, anchor);
    let painted = |name: &str, focus: FocusOffset| {
        let mut map = empty();
        fill(&mut map, &canvas, FillTarget::Everything, focus, Channels::All).unwrap();
        fill(&mut map, &canvas, FillTarget::Background, focus, Channels::All).unwrap();
        FocusLayer::from_map(name, map)
    };
    let mut layers = stack();
    assert!(layers.insert(painted("far", value(1.1, 1.0))));
    assert!(layers.insert(painted("add", value(1.05, 0.0))));
    layers.active_mut().blend = BlendMode::Add;
    layers.active_mut().opacity = 0.5;
    let near = |a: FocusOffset, t: f64, anchor: f64| {
        assert!((a.t - t).abs() < 1e-6 && (a.anchor - anchor).abs() < 1e-6, "{a:?}, not {t} {anchor}");
    };
    let map = layers.composite();
    near(map.at(20, 20), 1.125, 1.0);
    near(map.background, 1.125, 1.0);
    layers.layer_mut(1).unwrap().opacity = 0.5;
    near(layers.composite().at(20, 20), 1.075, 0.5);
    layers.layer_mut(1).unwrap().is_visible = false;
    near(layers.composite().at(20, 20), 1.025, 0.0);
    layers.layer_mut(1).unwrap().is_visible = true;
    layers.layer_mut(1).unwrap().opacity = 1.0;
    layers.move_layer(2, 1);
    assert_eq!(layers.active_index(), 1, "the active layer moved along");
    near(layers.composite().at(20, 20), 1.1, 1.0);
    assert!(layers.remove(2) && layers.remove(1) && !layers.remove(0), "the last one stays");
    assert!(layers.is_single_painted_layer());
    near(layers.composite().at(20, 20), 1.0, 0.0);
}

#[test]
fn a_depth_curve_gives_every_depth_its_blur_and_follows_the_camera() {
    let canvas = slope();
    let curve = Curve::new([[1.1f64.ln(), 1.0], [1.4f64.ln(), 1.0], [1.6f64.ln(), 1.05]]).unwrap();
    let curve = DepthCurve { curve, anchor: 1.0 };
    let mut camera = camera();
    let mut layers = stack();
    assert!(layers.insert(FocusLayer::from_adjustment(
        "surface",
        Adjustment::Curve(curve.clone()),
        &canvas,
        &camera
    )));
    let map = layers.composite();
    let texel = |map: &FocusMap, depth: f64| map.at(40, ((depth - 1.0) / 0.01).round() as u32);
    assert_eq!(texel(&map, 1.2), FocusOffset::SHARP);
    assert!((texel(&map, 1.6).t - 1.05).abs() < 1e-5);
    assert!((texel(&map, 1.65).t - 1.05).abs() < 1e-6 && map.background.t == 1.05);
    let optics = camera.optics();
    let circle = |depth: f64| optics.circle_of_confusion_px(optics.kappa(1.0 / depth, texel(&map, depth)));
    assert!(circle(1.35) < 1e-6 && circle(1.55) > 1.0, "an ordinary lens cannot: sharp from 1.1 to 1.4");

    camera.camera_to_world.w_axis.z += 0.4;
    layers.evaluate(&canvas, &camera);
    let moved = layers.composite();
    assert!((texel(&moved, 1.2).t - 1.05).abs() < 1e-5, "it now stands at a depth of 1.6");

    // Its mask is painted as any other's, its values are not.
    let values = layers.active().map.clone();
    layers.active_mut().map.add_mask();
    let brush = Brush { channels: Channels::Mask, ..painter(BrushMode::Reset, 1.3) };
    let mut map = layers.composite();
    stroke(&mut layers, &mut map, &canvas, &brush);
    assert_eq!(layers.active().map.to_rows(), values.to_rows());
    assert_eq!(map.at(50, 30), FocusOffset::STANDARD, "taken away under the brush");
    assert_eq!(map, layers.composite());
    layers.active_mut().map.invert_mask();
    assert_eq!(layers.active().map.mask_at(50, 30), 1.0);
    assert_eq!(layers.active().map.mask_at(50, 2), 0.0);
}

#[test]
fn sharpening_makes_a_ramp_steeper_without_a_rim_and_flow_builds_up() {
    let canvas = slope();
    let ease = |x: f32| {
        let s = ((x - 30.0) / 40.0).clamp(0.0, 1.0);
        0.1 * s * s * (3.0 - 2.0 * s)
    };
    let rows: Vec<[f32; 2]> =
        (0..SIZE[0] * SIZE[1]).map(|k| [1.0 + ease((k % SIZE[0]) as f32), 0.5]).collect();
    let ramp = FocusMap::from_rows(SIZE[0], SIZE[1], &rows, FocusOffset::STANDARD).unwrap();
    let mut layers = LayerStack::from_map(ramp.clone());
    let mut map = layers.composite();
    for _ in 0..4 {
        stroke(&mut layers, &mut map, &canvas, &painter(BrushMode::Sharpen, 1.0));
    }
    let slope =
        |map: &FocusMap| (0..SIZE[0] - 6).map(|x| map.at(x + 4, 30).t - map.at(x, 30).t).fold(0.0, f64::max);
    assert!(slope(&map) > 1.5 * slope(&ramp), "{} {}", slope(&map), slope(&ramp));
    let range = |map: &FocusMap| {
        let t = canvas.texels().map(|texel| map.at(texel.x, texel.y).t);
        t.fold((f64::INFINITY, 0.0f64), |(low, high), t| (t.min(low), t.max(high)))
    };
    let ((low, high), (least, most)) = (range(&map), range(&ramp));
    assert!(low >= least && high <= most);

    let once = |flow: f64| {
        let mut map = FocusMap::new(SIZE[0], SIZE[1], FocusOffset::STANDARD);
        let brush = Brush { flow, hardness: 1.0, ..painter(BrushMode::Set, 1.2) };
        let mut stroke = Stroke::begin(&map, canvas.clone(), brush).unwrap();
        stroke.extend(&mut map, hit(0.5, 1.3), PenSample::default());
        let dab = map.at(50, 30).t;
        for _ in 0..30 {
            stroke.lift();
            stroke.extend(&mut map, hit(0.5, 1.3), PenSample::default());
        }
        (dab, map.at(50, 30).t)
    };
    let (dab, many) = once(0.25);
    assert!((dab - 1.05).abs() < 1e-6 && (many - 1.2).abs() < 1e-4, "{dab} {many}");
    assert_eq!(once(1.0), (1.2f32 as f64, 1.2f32 as f64));
}
