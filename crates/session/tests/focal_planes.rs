//! A tilted, curved focal plane as a layer: splatted as its paint is traced, and as a lens is whose focal length changes over
//! the picture.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;
#[allow(dead_code, reason = "only its quads are needed")]
mod tiny_glb;

use at_work::{ON_WALL, opened, settle};
use document::CameraEdit;
use focus::{Adjustment, FocalPlane, Focus, LayerEdit};
use glam::{DMat4, DVec2, DVec3};
use lens::{Camera, Exposure, FocusOffset, Picture};
use progress::Unwatched;
use project::{LinearPicture, compare};
use render::RenderOptions;
use scene::{Scene, SurfaceField, SurfacePoint};
use session::{Command, Session};
use std::sync::Arc;
use trace::truth::{RayFocus, RayOptics, Truth, TruthOptions};

/// A plane that leans over the scene, in the axes of the camera named "front" (it stands at the origin).
fn leaning() -> FocalPlane {
    let points = [[-0.7, -0.4, -1.6], [0.9, -0.3, -2.4], [0.1, 0.8, -4.5]].map(DVec3::from_array);
    FocalPlane { curvature: 0.06, ..FocalPlane::through(points).expect("it is a plane") }
}

/// The lens whose focal length is such, for every direction, that it focuses on the plane: 1/f = 1/z_f + 1/d, T = d.
struct Tilted<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    plane: FocalPlane,
}

impl Tilted<'_> {
    /// 1/z_f where a camera-space direction of depth 1 meets the plane, and what it is bent by.
    fn inverse_depth(&self, direction: DVec3) -> f64 {
        let [a, b, c] = self.plane.points.map(|point| self.camera.camera_from_world(point));
        let normal = (b - a).cross(c - a);
        let bent = direction.truncate() / self.camera.optics().tan_half_yfov;
        normal.dot(direction) / normal.dot(a) + self.plane.curvature * bent.length_squared()
    }
}

impl RayFocus for Tilted<'_> {
    fn optics(&self, point: Option<SurfacePoint>, _u: DVec2) -> RayOptics {
        let at = point.map_or(DVec3::Z, |point| self.camera.camera_from_world(point.position(self.scene)));
        let d = self.camera.optics().image_distance;
        RayOptics { inverse_focal_length: self.inverse_depth(at / at.z) + 1.0 / d, transmission_distance: d }
    }
    fn bounds(&self) -> [RayOptics; 2] {
        // Twice as far out as the corners of the picture.
        let corners = [[-3.0, -2.0], [3.0, -2.0], [-3.0, 2.0], [3.0, 2.0], [0.0, 0.0]].map(|[x, y]| {
            let half = self.camera.optics().tan_half_yfov;
            self.inverse_depth(DVec3::new(x * half, y * half, 1.0))
        });
        let d = self.camera.optics().image_distance;
        [corners.iter().copied().fold(f64::INFINITY, f64::min), corners.iter().copied().fold(0.0, f64::max)]
            .map(|depth| RayOptics { inverse_focal_length: depth + 1.0 / d, transmission_distance: d })
    }
}

struct Unpainted;

impl SurfaceField<FocusOffset> for Unpainted {
    fn at(&self, _point: SurfacePoint) -> FocusOffset {
        FocusOffset::STANDARD
    }
    fn at_infinity(&self) -> FocusOffset {
        FocusOffset::STANDARD
    }
    fn bounds(&self, _triangle: u32) -> Option<[FocusOffset; 2]> {
        Some([FocusOffset::STANDARD; 2])
    }
}

fn decibels(a: &Picture, b: &Picture) -> f64 {
    let linear = |picture| LinearPicture::from_picture(picture, Exposure::Normalise);
    compare(&linear(a), &linear(b)).unwrap().psnr
}

/// The session's document with the plane, its camera at a size that rays can afford.
fn planar(folder: &std::path::Path) -> (Session, Camera) {
    let scene = folder.join("quads.glb");
    tiny_glb::write(&scene);
    let mut session = opened(&scene);
    session.apply(Command::EditCamera(CameraEdit::ApertureRadius(0.06))).unwrap();
    session.apply(Command::EditLayers(LayerEdit::AddPlane)).unwrap();
    session.apply(Command::EditLayers(LayerEdit::Plane(1, leaning()))).unwrap();
    settle(&mut session);
    let camera = Camera { width: 180, height: 120, ..session.document().unwrap().camera.clone() };
    (session, camera)
}

#[test]
fn it_is_splatted_as_it_is_traced() {
    let folder = tempfile::tempdir().unwrap();
    let (session, camera) = planar(folder.path());
    let document = session.document().unwrap();
    let stage = &document.stage;
    let focus =
        Focus::from_atlas_map(stage.scene.clone(), stage.atlas.clone(), Arc::new(document.map.clone()));
    let options = RenderOptions::at_tolerance(0.0);
    let splat = render::render(&stage.lit, &camera, &focus, &options, &Unwatched).unwrap().picture;

    let light = slf::Transport::new(
        stage.tracer().clone(),
        scene::World::uniform(glam::Vec3::ZERO),
        Default::default(),
    );
    let rays = TruthOptions { samples_per_pixel: 512, ..TruthOptions::default() };
    let traced = trace::truth::render(stage.tracer(), &light, &focus, &camera, &rays, &Unwatched).unwrap();
    let tilted = Tilted { scene: &stage.scene, camera: &camera, plane: leaning() };
    let mut truth = Truth::new(stage.tracer(), &light, &Unpainted, &camera, &rays).with_ray_focus(&tilted);
    while !truth.is_done() {
        truth.pass(&Unwatched).unwrap();
    }
    let [of_paint, of_lens] = [&traced.picture, &truth.estimate().picture].map(|p| decibels(&splat, p));
    assert!(of_paint > 42.0, "{of_paint} dB from the ground truth of its paint");
    assert!(of_lens > 42.0, "{of_lens} dB from the lens itself");
    // The ordinary lens is another picture.
    let plain = Focus::constant(stage.scene.clone(), FocusOffset::STANDARD);
    let plain = render::render(&stage.lit, &camera, &plain, &options, &Unwatched).unwrap().picture;
    let unlike = decibels(&plain, &traced.picture);
    eprintln!("paint {of_paint:.1} dB, lens {of_lens:.1} dB, ordinary lens {unlike:.1} dB");
    assert!(unlike < of_lens - 10.0, "{unlike} dB");
}

#[test]
fn it_stays_in_the_scene_when_the_camera_moves_and_is_undone() {
    let folder = tempfile::tempdir().unwrap();
    let (mut session, _) = planar(folder.path());
    let wall = session.pick(&session.picture_ray(ON_WALL).unwrap()).unwrap();
    let circle = |session: &Session| {
        let camera = &session.document().unwrap().camera;
        let depth = camera.camera_from_world(wall.position).z;
        camera.optics().kappa(1.0 / depth, session.focus_at(&wall).unwrap())
    };
    let plane = |session: &Session| match &session.document().unwrap().layers.active().adjustment {
        Some(Adjustment::Plane(plane)) => plane.clone(),
        other => panic!("a plane: {other:?}"),
    };
    let before = circle(&session);
    assert!(before.abs() > 1e-2, "the wall lies beside the plane");
    for edit in [
        CameraEdit::FocusDistance(1.1),
        CameraEdit::SensorHeight(0.036),
        CameraEdit::Pose(DMat4::from_translation(DVec3::new(0.0, 0.1, -1.0))),
    ] {
        let is_moved = matches!(edit, CameraEdit::Pose(_));
        session.apply(Command::EditCamera(edit)).unwrap();
        settle(&mut session);
        assert_eq!(plane(&session), leaning());
        let now = circle(&session);
        assert_eq!(
            (now - before).abs() > 1e-4,
            is_moved,
            "{now} and {before}: seen from another place alone"
        );
    }
    let seen_last = circle(&session);
    // Through the wall's own point, it is sharp.
    let through =
        FocalPlane { points: [wall.position, DVec3::ZERO, DVec3::new(3.0, 0.0, -9.0)], ..leaning() };
    let through = FocalPlane { curvature: 0.0, ..through };
    session.apply(Command::EditLayers(LayerEdit::Plane(1, through))).unwrap();
    settle(&mut session);
    assert!(circle(&session).abs() < 1e-3, "{}", circle(&session));
    session.apply(Command::Undo).unwrap();
    settle(&mut session);
    assert_eq!(plane(&session), leaning());
    assert!((circle(&session) - seen_last).abs() < 1e-6, "its values are back");
    let [held, _] = session.document().unwrap().undo_bytes();
    let texels =
        session.document().unwrap().map.width() as usize * session.document().unwrap().map.height() as usize;
    assert!(held < 4 * texels, "steps hold rules, not what follows from them: {held} bytes");
    let line = [0.0, 1.0, 2.0].map(|x| DVec3::new(x, 0.0, -2.0));
    let refused =
        session.apply(Command::EditLayers(LayerEdit::Plane(1, FocalPlane { points: line, ..leaning() })));
    assert!(refused.unwrap_err().to_string().contains("in one line"));
    // What was saved has it.
    let file = folder.path().join("plane.fbrush");
    session.apply(Command::SaveAs(file.clone())).unwrap();
    settle(&mut session);
    let again = opened(&file);
    assert_eq!(plane(&again), leaning());
    assert_eq!(again.document().unwrap().map, session.document().unwrap().map);
}
