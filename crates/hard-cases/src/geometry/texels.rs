//! Texels whose centre lies outside their triangle, and paint at a UV seam.

use crate::case::{Case, Effort, NOT_COMPUTED, Verdict};
use crate::support::light_field::offset_of;
use crate::support::measure::worst;
use crate::support::shot::Shot;
use atlas::{Atlas, Density, TexelMap, UnwrapOptions};
use focus::{Canvas, Channels, FillTarget, Focus, FocusMap, fill};
use glam::{DVec2, DVec3, Vec2};
use lens::{Camera, Exposure, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use scene::{Scene, SurfaceField, SurfacePoint};
use std::f64::consts::PI;
use std::sync::Arc;
use test_scenes::{Mesh, unlit_scene_of};

pub const CASES: &[Case] = &[
    Case {
        name: "texel centres outside their triangle",
        reason: "A texel represents the area it covers, which need not contain its centre: the areas of texel \
                 ∩ triangle sum to that of the mesh.",
        control: "a texel counted if its centre lies in the triangle",
        check: covered_areas,
    },
    Case {
        name: "t step across a UV seam",
        reason: "If one side of a seam is painted, each side keeps its value up to the seam: the gutter \
                 repeats its own chart.",
        control: "the gutter left unpainted",
        check: seam,
    },
    Case {
        name: "t step across a UV seam, in the picture",
        reason: "At the step the sharp half keeps its radiance 1, and the blurred half adds the part of its \
                 disc that extends over it: radiance is conserved, so a wall of 1 shows 1.5 and 0.5.",
        control: "the white that blurring a finished picture leaves unchanged",
        check: seam_in_the_picture,
    },
];

/// The atlas of a scene; `None` only if unwrapping is cancelled.
fn unwrapped(scene: &Scene, side: u32, progress: &dyn Progress) -> Result<Atlas, Cancelled> {
    let options = UnwrapOptions { density: Density::Side(side), ..UnwrapOptions::default() };
    Atlas::unwrap(scene, &options, progress).map_err(|_| Cancelled)
}

fn covered_areas(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    // Thousands of triangles smaller than a texel, a fan of needles, and two triangles without area.
    let sphere = Mesh::sphere(DVec3::ZERO, 1.0, effort.choose(60, 24));
    let mut fan = Mesh { positions: vec![DVec3::new(3.0, 0.0, 0.0)], triangles: Vec::new() };
    for k in 0..=200u32 {
        fan.positions.push(DVec3::new(5.0, 1e-3 * f64::from(k).powf(1.5), 0.0));
        if k > 0 {
            fan.triangles.push([0, k, k + 1]);
        }
    }
    let nothing = [[DVec3::ONE; 3], [DVec3::ZERO, DVec3::X, DVec3::X * 3.0]].map(Mesh::triangle);
    let meshes = [&sphere, &fan, &nothing[0], &nothing[1]];
    let scene = unlit_scene_of(meshes.map(|mesh| (mesh, [1.0; 3])));
    let mesh_area: f64 = (0..scene.triangles.len() as u32).map(|t| scene.area_normal(t).length() / 2.0).sum();
    let (mut right, mut wrong) = (Vec::new(), f64::INFINITY);
    for side in [64, 256] {
        let atlas = unwrapped(&scene, side, progress)?;
        let covered: f64 = atlas.texels(&scene).iter().map(|texel| texel.area).sum();
        right.push(covered / mesh_area - 1.0);
        wrong = wrong.min((centre_sampled_area(&atlas, &scene) / mesh_area - 1.0).abs());
    }
    let expected = format!("areas of {} triangles sum to the mesh's to 1e-6", scene.triangles.len());
    Ok(Verdict::new(expected, [("relative error", 1e-6)], [worst(right)], [wrong]))
}

/// The world area of the texels whose centre lies in a triangle.
fn centre_sampled_area(atlas: &Atlas, scene: &Scene) -> f64 {
    let of_triangle = |triangle: u32| {
        let corners = atlas.corners[triangle as usize].map(Vec2::as_dvec2);
        let [a, b, c] = corners;
        let doubled = (b - a).perp_dot(c - a);
        let (low, high) = (a.min(b).min(c).floor(), a.max(b).max(c).ceil());
        let (columns, rows) = ((high.x - low.x) as u32, (high.y - low.y) as u32);
        let inside = (0..columns * rows).filter(|k| {
            let p = low + DVec2::new(f64::from(k % columns) + 0.5, f64::from(k / columns) + 0.5);
            let side = |p0: DVec2, p1: DVec2| (p1 - p0).perp_dot(p - p0) * doubled >= 0.0;
            side(a, b) && side(b, c) && side(c, a)
        });
        let world_by_atlas = scene.area_normal(triangle).length() / doubled.abs();
        if doubled == 0.0 { 0.0 } else { inside.count() as f64 * world_by_atlas }
    };
    (0..scene.triangles.len() as u32).map(of_triangle).sum()
}

/// Two squares that share the edge x = 0 at z = −3, each a separate chart; the right one can be painted.
struct Seam {
    scene: Arc<Scene>,
    atlas: Arc<Atlas>,
    texels: TexelMap,
}

impl Seam {
    fn new(progress: &dyn Progress) -> Result<Self, Cancelled> {
        let side = DVec3::new(2.0, 4.0, 0.0);
        let squares = [-side.x, 0.0].map(|x| {
            Mesh::rectangle(DVec3::new(x, -side.y / 2.0, -DEPTH), DVec3::X * side.x, DVec3::Y * side.y)
        });
        let scene = unlit_scene_of(squares.iter().map(|mesh| (mesh, [1.0; 3])));
        let atlas = Arc::new(unwrapped(&scene, 128, progress)?);
        let texels = atlas.texel_map(&scene);
        Ok(Self { scene, atlas, texels })
    }

    /// The gutter texels and their sources.
    fn gutters(&self) -> Vec<[[u32; 2]; 2]> {
        let place = |index: u32| [index % self.texels.width, index / self.texels.width];
        self.texels.dilations.iter().map(|d| [place(d.texel), place(d.source)]).collect()
    }

    /// The map with the right square filled with `offset`; `None` if that fails.
    fn painted(&self, offset: FocusOffset, gutters: &[[[u32; 2]; 2]]) -> Option<Focus> {
        let mut map = FocusMap::new(self.atlas.width, self.atlas.height, FocusOffset::STANDARD);
        let canvas = Canvas::new(&self.scene, &self.atlas, &self.texels.texels, gutters);
        fill(&mut map, &canvas, FillTarget::Part(1), offset, Channels::All).ok()?;
        Some(Focus::from_atlas_map(self.scene.clone(), self.atlas.clone(), Arc::new(map)))
    }
}

/// Depth of the squares, on which the camera is focused.
const DEPTH: f64 = 3.0;

fn seam(_: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let seam = Seam::new(progress)?;
    let painted = FocusOffset::new(1.25, 0.5);
    let error = |gutters: &[[[u32; 2]; 2]]| {
        let Some(focus) = seam.painted(painted, gutters) else { return f64::NAN };
        let values = points_at_the_seam(&seam.scene).into_iter().map(|point| {
            let expected = if point.triangle < 2 { FocusOffset::STANDARD } else { painted };
            let found = focus.at(point);
            worst([found.t - expected.t, found.anchor - expected.anchor])
        });
        worst(values)
    };
    let expected = "t and anchor exactly those of the point's own side, from on the seam to 0.1 off it";
    Ok(Verdict::new(expected, [("error", 0.0)], [error(&seam.gutters())], [error(&[])]))
}

/// Points of both squares at and near the edge x = 0.
fn points_at_the_seam(scene: &Scene) -> Vec<SurfacePoint> {
    let mut points = Vec::new();
    for triangle in 0..4 {
        let corners = scene.corners(triangle);
        for off in [0.0, 1e-9, 1e-4, 1e-2, 0.1] {
            for k in 0..50 {
                let x = if triangle < 2 { -off } else { off };
                let target = DVec3::new(x, (f64::from(k) + 0.5) / 12.5 - 2.0, -DEPTH);
                let [e1, e2, r] = [corners[1] - corners[0], corners[2] - corners[0], target - corners[0]];
                let doubled = e1.cross(e2).z;
                let barycentric = DVec2::new(r.cross(e2).z, e1.cross(r).z) / doubled;
                if barycentric.min_element() >= 0.0 && barycentric.element_sum() <= 1.0 {
                    points.push(SurfacePoint { triangle, barycentric });
                }
            }
        }
    }
    points
}

fn seam_in_the_picture(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let camera = Camera {
        width: 64,
        height: 16,
        yfov: 0.2,
        focus_distance: DEPTH,
        aperture_radius: 0.1,
        ..Camera::default()
    };
    let seam = Seam::new(progress)?;
    let shot = Shot::new(seam.scene.clone(), camera.clone());
    let (mut splatted, mut traced, mut wrong) = (Vec::new(), Vec::new(), f64::INFINITY);
    for radius_px in [-9.0, 5.0, 12.0] {
        let offset = offset_of(radius_px / camera.optics().splat_radius_px(1.0), &camera);
        let error = |picture: &Picture| {
            let columns = (0..picture.radiance.len()).map(|k| {
                let x = (k % 64) as f64 - 32.0;
                f64::from(picture.radiance[k][1]) - step_of_blur(x, f64::abs(radius_px))
            });
            worst(columns)
        };
        let Some(focus) = seam.painted(offset, &seam.gutters()) else { continue };
        let picture = shot.splat_with(&focus, progress)?;
        splatted.push(error(&picture));
        traced.push(error(&shot.truth_with(&focus, effort.choose(256, 64), 1, progress)?));
        let white = picture.exposed(Exposure::Normalise);
        wrong = wrong.min(error(&Picture { radiance: white, ..picture }));
    }
    let limits = [("splat", 0.02), ("truth", 0.05)];
    let expected =
        "1 left and F(x/r) to both sides, so 1.5 | 0.5 at the seam: ± 0.02 splatted, ± 0.05 traced";
    Ok(Verdict::new(expected, limits, [worst(splatted), worst(traced)], [wrong, NOT_COMPUTED]))
}

/// Mean over a pixel from x to x + 1 (px right of the seam) of a wall of radiance 1 that is sharp on the left
/// and blurred by a disc of radius r on the right: [x < 0] + F(x/r), where F(s) = 1/2 + (s·√(1 − s²) + asin
/// s)/π is the share of a disc left of s.
fn step_of_blur(x: f64, radius_px: f64) -> f64 {
    const STEPS: usize = 64;
    let left_of = |s: f64| 0.5 + (s * (1.0 - s * s).sqrt() + s.asin()) / PI;
    let at = |k: usize| left_of(((x + (k as f64 + 0.5) / STEPS as f64) / radius_px).clamp(-1.0, 1.0));
    let blurred = (0..STEPS).map(at).sum::<f64>() / STEPS as f64;
    blurred + f64::from(x < 0.0)
}
