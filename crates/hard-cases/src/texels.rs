//! Texels whose centre lies beside their triangle, and paint at a seam.

use crate::case::{Case, Effort, Finding};
use crate::measure::worst;
use crate::scenery::{Mesh, scene_of};
use atlas::{Atlas, Density, UnwrapOptions};
use focus::{Canvas, Channels, FillTarget, Focus, FocusMap, fill};
use glam::{DVec2, DVec3, Vec2};
use lens::FocusOffset;
use progress::{Cancelled, Progress};
use scene::{Scene, SurfaceField, SurfacePoint};
use std::sync::Arc;

pub const CASES: &[Case] = &[
    Case {
        name: "texel centres outside their triangle",
        reason: "A texel stands for what it covers, to which its centre need not belong: areas of texel ∩ triangle sum to \
                 the mesh's.",
        control: "a texel counted where its centre lies in the triangle",
        check: covered_areas,
    },
    Case {
        name: "t step across a UV seam",
        reason: "Painted to the seam, each side keeps its value up to it: the gutter repeats its own chart.",
        control: "the gutter left unpainted",
        check: seam,
    },
];

/// The atlas of a scene; `None` if there is none, which only a cancelled unwrapping gives here.
fn unwrapped(scene: &Scene, side: u32, progress: &dyn Progress) -> Result<Atlas, Cancelled> {
    let options = UnwrapOptions { density: Density::Side(side), ..UnwrapOptions::default() };
    Atlas::unwrap(scene, &options, progress).map_err(|_| Cancelled)
}

fn covered_areas(effort: Effort, progress: &dyn Progress) -> Result<Finding, Cancelled> {
    // Thousands of triangles below a texel, and a fan of needles.
    let sphere = Mesh::sphere(DVec3::ZERO, 1.0, effort.pick(60, 24));
    let mut fan = Mesh { positions: vec![DVec3::new(3.0, 0.0, 0.0)], triangles: Vec::new() };
    for k in 0..=200u32 {
        fan.positions.push(DVec3::new(5.0, 1e-3 * f64::from(k).powf(1.5), 0.0));
        if k > 0 {
            fan.triangles.push([0, k, k + 1]);
        }
    }
    let scene = scene_of([(&sphere, [1.0; 3]), (&fan, [1.0; 3])]);
    let mesh_area: f64 = (0..scene.triangles.len() as u32).map(|t| scene.area_normal(t).length() / 2.0).sum();
    let (mut right, mut wrong) = (Vec::new(), f64::INFINITY);
    for side in [64, 256] {
        let atlas = unwrapped(&scene, side, progress)?;
        let covered: f64 = atlas.texels(&scene).iter().map(|texel| texel.area).sum();
        right.push(covered / mesh_area - 1.0);
        wrong = wrong.min((centre_sampled_area(&atlas, &scene) / mesh_area - 1.0).abs());
    }
    let expected = format!("areas of {} triangles sum to the mesh's to 1e-6", scene.triangles.len());
    Ok(Finding::of(expected, [("relative error", 1e-6)], [worst(right)], [wrong]))
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

fn seam(_: Effort, progress: &dyn Progress) -> Result<Finding, Cancelled> {
    // Two squares that share the edge x = 0, each a chart.
    let squares = [-1.0, 0.0].map(|x| Mesh::rectangle(DVec3::new(x, 0.0, -3.0), DVec3::X, DVec3::Y));
    let scene = scene_of(squares.iter().map(|mesh| (mesh, [1.0; 3])));
    let atlas = Arc::new(unwrapped(&scene, 128, progress)?);
    let texels = atlas.texel_map(&scene);
    let place = |index: u32| [index % texels.width, index / texels.width];
    let gutters: Vec<_> = texels.dilations.iter().map(|d| [place(d.texel), place(d.source)]).collect();
    let painted = FocusOffset::new(1.25, 0.5);
    let map_with = |gutters: &[[[u32; 2]; 2]]| {
        let mut map = FocusMap::new(atlas.width, atlas.height, FocusOffset::STANDARD);
        let canvas = Canvas::new(&scene, &atlas, &texels.texels, gutters);
        let filled = fill(&mut map, &canvas, FillTarget::Part(1), painted, Channels::Both);
        filled.is_ok().then(|| Focus::painted(scene.clone(), atlas.clone(), Arc::new(map)))
    };
    let error = |gutters: &[[[u32; 2]; 2]]| {
        let Some(focus) = map_with(gutters) else { return f64::NAN };
        let values = points_at_the_seam(&scene).into_iter().map(|point| {
            let expected = if point.triangle < 2 { FocusOffset::STANDARD } else { painted };
            let found = focus.at(point);
            worst([found.t - expected.t, found.anchor - expected.anchor])
        });
        worst(values)
    };
    let expected = "t and anchor exactly those of the point's own side, from on the seam to 0.1 off it";
    Ok(Finding::of(expected, [("error", 0.0)], [error(&gutters)], [error(&[])]))
}

/// Points of either square on and by its edge at x = 0.
fn points_at_the_seam(scene: &Scene) -> Vec<SurfacePoint> {
    let mut points = Vec::new();
    for triangle in 0..4 {
        let corners = scene.corners(triangle);
        for off in [0.0, 1e-9, 1e-4, 1e-2, 0.1] {
            for k in 0..50 {
                let x = if triangle < 2 { -off } else { off };
                let target = DVec3::new(x, (f64::from(k) + 0.5) / 50.0, -3.0);
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
