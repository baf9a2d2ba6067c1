//! Sums follow lens, paint and backdrop, and twins share what they can.

use super::*;
use crate::tiny_glb;
use document::Document;
use glam::DVec3;
use lens::FocusOffset;
use progress::Unwatched;

/// A scene of few quads.
fn quads() -> Document {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    Document::create(&scene, &Default::default(), &Default::default(), &Default::default(), &Unwatched)
        .unwrap()
}

/// The texels of the wall whose middle lies where `wanted` says, and the focus with `value` on them.
fn painted(
    document: &Document,
    value: FocusOffset,
    selects: impl Fn(DVec3) -> bool,
) -> (Focus, Vec<[u32; 2]>) {
    let stage = &document.stage;
    let mut map = document.map.clone();
    let [width, height] = map.size();
    let inside = |[x, y]: &[u32; 2]| {
        let texel = stage.texels.texel_at(*x, *y);
        texel.is_some_and(|texel| selects(texel.centroid.position(&stage.scene)))
    };
    let all = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let texels: Vec<_> = all.filter(inside).collect();
    for &[x, y] in &texels {
        map.set(x, y, [value.t as f32, value.anchor as f32]);
        map.set_gloss(x, y, value.gloss as f32);
    }
    (Focus::from_atlas_map(stage.scene.clone(), stage.atlas.clone(), Arc::new(map)), texels)
}

#[test]
fn a_stroke_tells_whether_the_margin_is_still_wide_enough_as_the_whole_frame_does() {
    let document = quads();
    let stage = &document.stage;
    let camera = Camera { width: 90, height: 60, ..document.camera.clone() };
    let (blank, none) = painted(&document, FocusOffset::STANDARD, |_| false);
    assert!(none.is_empty());
    let how = FieldOptions {
        least_margin_px: 0.0,
        tolerance: Tolerance::VIEWING,
        gpu: None,
        bake_on: None,
        light: LightQuality::Fine,
    };
    let mut field = LightField::bake(stage, &camera, &blank, how, &Unwatched).unwrap();
    field.update_sum(&camera, &blank, &Unwatched).unwrap();
    field.survey(&camera, &blank);
    assert_eq!(field.rebake_margin_px(&camera, &blank), None);

    let in_view = |at: DVec3| at.z < -3.5 && at.x.abs() < 0.3 && at.y.abs() < 0.3;
    let per_t = camera.optics().splat_radius_px(1.0 / camera.optics().image_distance);
    let margin = f64::from(field.splatter.salf().margin_px);
    let mut grew = 0;
    for share in [0.5, 0.9, 1.3, 0.2, 2.0] {
        // Anchored at the point: the radius is that of (t − 1)/d.
        let value = FocusOffset::new(1.0 + share * margin / per_t, 1.0);
        let (focus, texels) = painted(&document, value, in_view);
        assert!(texels.len() > 10);
        field.note(&Changes::Texels(texels));
        field.update_sum(&camera, &focus, &Unwatched).unwrap();
        let needed = BakeOptions::for_focus(stage.tracer(), &camera, &focus).margin_px;
        let rebake_px = field.rebake_margin_px(&camera, &focus);
        assert_eq!(rebake_px.is_some(), needed > margin, "{share} of the margin");
        if let Some(rebake_px) = rebake_px {
            assert!((rebake_px - share * margin).abs() < 1e-3 * margin, "{rebake_px} px of {margin}");
            grew += 1;
        }
        field.reach = None;
        assert_eq!(
            field.rebake_margin_px(&camera, &focus),
            rebake_px,
            "whether all are asked or those that moved"
        );
    }
    assert_eq!(grew, 2);

    // Far outside the frame nothing reaches it, however blurred.
    let beside = |at: DVec3| at.z < -3.5 && at.x > 3.5;
    let (focus, texels) = painted(&document, FocusOffset::new(1.0 + 0.05 * margin / per_t, 1.0), beside);
    assert!(!texels.is_empty());
    field.note(&Changes::Everything);
    field.update_sum(&camera, &focus, &Unwatched).unwrap();
    assert_eq!(field.rebake_margin_px(&camera, &focus), None);
    // A much smaller aperture is another reason.
    let stopped = Camera { aperture_radius: camera.aperture_radius * 0.5, ..camera.clone() };
    field.update_sum(&stopped, &focus, &Unwatched).unwrap();
    assert_eq!(field.rebake_margin_px(&stopped, &focus), Some(0.0));
}

#[test]
fn a_stroke_moves_carried_light_where_gloss_obeys_it() {
    let document = quads();
    let stage = &document.stage;
    let camera = Camera { width: 90, height: 60, ..document.camera.clone() };
    let (blank, _) = painted(&document, FocusOffset::STANDARD, |_| false);
    let (tolerance, gpu) = (Tolerance::VIEWING, None);
    let how = FieldOptions { least_margin_px: 0.0, tolerance, gpu, bake_on: None, light: LightQuality::Fine };
    let own = LightField::bake(stage, &camera, &blank, how, &Unwatched).unwrap();
    let samples = own.baked().salf.samples.changed(|sample| sample.is_carried = true);
    let salf = Arc::new(Salf { samples, ..Salf::clone(&own.baked().salf) });
    let summed = |focus: &Focus| {
        let mut field = LightField::from_salf(stage, salf.clone(), tolerance, None);
        field.update_sum(&camera, focus, &Unwatched).unwrap();
        field
    };
    let mut field = summed(&blank);
    let was = field.fetch_picture().unwrap().clone();
    let mut dab = |gloss: f64| {
        let value = FocusOffset::new(1.2, 1.0).with_gloss(gloss);
        let (focus, texels) = painted(&document, value, |at| at.z < -3.5 && at.x.abs() < 0.3);
        field.note(&Changes::Texels(texels));
        let update = field.update_sum(&camera, &focus, &Unwatched).unwrap();
        let picture = field.fetch_picture().unwrap().clone();
        assert!(picture == *summed(&focus).fetch_picture().unwrap(), "gloss {gloss}: as a whole sum");
        (update, picture != was, field.rebake_margin_px(&camera, &focus).is_some())
    };
    assert_eq!(dab(0.0), (SumUpdate::Unchanged, false, false), "it keeps the lens's focus");
    let (update, is_moved, is_outgrown) = dab(0.5);
    assert!(matches!(update, SumUpdate::Region(_)) && is_moved);
    assert!(is_outgrown, "it was told only as finely as the lens shows it");
    // Undone, the map knows nothing of gloss any more.
    let (update, is_moved, is_outgrown) = dab(0.0);
    assert!(matches!(update, SumUpdate::Region(_)) && !is_moved && !is_outgrown);
}

#[test]
fn the_exact_sum_follows_as_a_new_one_would() {
    let document = quads();
    let camera = Camera { width: 90, height: 60, ..document.camera.clone() };
    let (blank, _) = painted(&document, FocusOffset::STANDARD, |_| false);
    let how = FieldOptions {
        least_margin_px: 0.0,
        tolerance: Tolerance::VIEWING,
        gpu: None,
        bake_on: None,
        light: LightQuality::Fine,
    };
    let field = LightField::bake(&document.stage, &camera, &blank, how, &Unwatched).unwrap();
    let mut exact = field.exact();
    assert!(exact.is_twin_of(&field) && exact.summing_bytes() > 0);
    assert!(!exact.is_up_to_date(&camera));
    exact.update_sum(&camera, &blank, &Unwatched).unwrap();
    assert!(exact.is_up_to_date(&camera));
    let was = exact.fetch_picture().unwrap().clone();
    let dab = |at: DVec3| at.z < -3.5 && at.x.abs() < 0.3;
    let (focus, texels) = painted(&document, FocusOffset::new(1.2, 1.0), dab);
    exact.note(&Changes::Texels(texels));
    assert!(matches!(exact.update_sum(&camera, &focus, &Unwatched), Ok(SumUpdate::Region(_))));
    let mut anew = field.exact();
    anew.update_sum(&camera, &focus, &Unwatched).unwrap();
    let exact = exact.fetch_picture().unwrap();
    assert!(exact == anew.fetch_picture().unwrap() && *exact != was);
}
