//! The pinhole picture, one cell at a time: which surfaces lie along its chief rays.

use crate::bake::BakeOptions;
use crate::domain::{Cell, CellPart};
use crate::jitter::Net;
use crate::occluders::{Depths, Occluders};
use crate::placement::Placement;
use crate::sample::{Sample, Visibility};
use crate::samples::Found;
use crate::view::View;
use glam::{DVec2, Vec3};
use scene::SurfacePoint;
use std::ops::Range;
use trace::{Hit, Radiance, Tracer};

/// Surfaces along one chief ray beyond which nothing is looked for.
const DEEPEST_LAYER: usize = 12;

/// Parallax, px, up to which what a nearer surface hides of a cell and what it does not are samples of their own: the outline
/// is nearly sharp on them, and few rays from either would not tell how much of both together it hides.
const JUST_BEHIND_PX: f64 = 1.0;

/// Where a chief ray of a cell meets a surface, or goes to infinity.
#[derive(Clone, Copy, Debug)]
pub struct Member {
    /// Its sub-cell.
    pub sub_cell: usize,
    /// Where it is in the pinhole picture, px.
    pub pixel: DVec2,
    /// The surface; `None` for the background.
    pub point: Option<SurfacePoint>,
    /// 1/z.
    pub inverse_depth: f64,
}

/// Members of one cell that lie on one smooth surface.
#[derive(Clone, Debug)]
pub struct Group {
    /// At most one a sub-cell, in the order of [`Cell::sub_cells`].
    pub members: Vec<Member>,
    /// Whether the surface is the nearest along every member's ray.
    pub is_nearest: bool,
    /// Whether a surface less than [`JUST_BEHIND_PX`] of parallax nearer hides every member from the aperture's centre.
    is_just_behind: bool,
    part: Option<u32>,
    /// The weight's relative change over the unit aperture.
    tilt: DVec2,
    /// Gradient of 1/z, per px.
    pub slope: DVec2,
}

/// What the rays of a cell met.
pub struct Layers {
    /// Its surfaces.
    pub groups: Vec<Group>,
    /// The largest and the smallest inverse depth among its nearest surfaces.
    pub depth_range: [f32; 2],
    /// Whether a nearest surface is sampled elsewhere and so not among the groups.
    pub has_gap: bool,
}

/// Traces the chief rays of a cell: to the nearest surface, or, if `hidden`, through all of them.
pub fn trace_cell(tracer: &Tracer, view: &View, placement: &Placement, cell: Cell, hidden: bool) -> Layers {
    let mut layers = Layers { groups: Vec::new(), depth_range: [0.0, f32::INFINITY], has_gap: false };
    let beam = view.beam(cell);
    let seed = cell.corner.as_uvec2();
    let net = Net::new(Cell::SUBDIVISION.ilog2(), seed.to_array());
    let pixels: [_; Cell::RAYS] = std::array::from_fn(|sub_cell| {
        let [row, column] = Cell::row_and_column(sub_cell);
        cell.sub_corner(sub_cell) + DVec2::from_array(net.place(row, column)) * cell.sub_side()
    });
    let rays = pixels.map(|pixel| view.chief_ray(pixel));
    let most = if hidden { DEEPEST_LAYER } else { 1 };
    let met: Vec<(usize, Hit)> = if hidden {
        tracer.all_hits(&beam, &rays, most)
    } else {
        let first = tracer.first_hits(&beam, &rays).into_iter().enumerate();
        let mut met = Vec::with_capacity(Cell::RAYS);
        met.extend(first.filter_map(|(sub_cell, hit)| Some((sub_cell, hit?))));
        met
    };
    for sub_cell in Cell::sub_cells() {
        let (pixel, mut nearest) = (pixels[sub_cell], 0.0);
        let [start, end] = [sub_cell, sub_cell + 1].map(|next| met.partition_point(|(of, _)| *of < next));
        let mine = &met[start..end];
        // Behind the last surface lies the background.
        let hits = mine.iter().map(|(_, hit)| Some(*hit)).chain([None]).take(most);
        for (layer, hit) in hits.enumerate() {
            let inverse_depth = hit.map_or(0.0, |hit| 1.0 / hit.t);
            let point = hit.map(|hit| hit.point);
            if layer == 0 {
                nearest = inverse_depth;
                let [near, far] = &mut layers.depth_range;
                *near = near.max(inverse_depth as f32);
                *far = far.min(inverse_depth as f32);
            }
            let member = Member { sub_cell, pixel, point, inverse_depth };
            let is_sampled_here = point.is_none_or(|point| !placement.is_on_surface(point.triangle));
            if is_sampled_here {
                layers.add(tracer, view, member, layer == 0, nearest);
            } else if layer == 0 {
                layers.has_gap = true;
            }
        }
    }
    layers
}

impl Layers {
    /// Adds a member; `nearest` is 1/z of the nearest surface along its ray.
    fn add(&mut self, tracer: &Tracer, view: &View, member: Member, is_nearest: bool, nearest: f64) {
        let parallax_px = view.radius_per_kappa_px;
        let is_just_behind = !is_nearest && (nearest - member.inverse_depth) * parallax_px < JUST_BEHIND_PX;
        let part = member.point.map(|p| tracer.scene().triangles[p.triangle as usize].part);
        let belongs = |group: &&mut Group| {
            let first = group.members[0];
            let expected = first.inverse_depth + group.slope.dot(member.pixel - first.pixel);
            group.part == part
                && group.is_just_behind == is_just_behind
                && (member.inverse_depth - expected).abs() * parallax_px <= Occluders::SAME_SURFACE_PX
                && group.members.last().is_none_or(|last| last.sub_cell != member.sub_cell)
        };
        if let Some(group) = self.groups.iter_mut().find(belongs) {
            group.members.push(member);
            group.is_nearest &= is_nearest;
            return;
        }
        let (mut tilt, mut slope) = (DVec2::ZERO, DVec2::ZERO);
        if let Some(point) = member.point {
            let scene = tracer.scene();
            tilt = view.relative_tilt(scene.area_normal(point.triangle), point.position(scene));
            if parallax_px > 0.0 {
                slope = DVec2::new(-tilt.x, tilt.y) / parallax_px;
            }
        }
        let mut members = Vec::with_capacity(Cell::RAYS);
        members.push(member);
        self.groups.push(Group { members, is_nearest, is_just_behind, part, tilt, slope });
    }

    /// What they tell of the depths around their cell.
    pub fn depths(&self, cell: Cell) -> Depths {
        let [nearest, farthest] = self.depth_range;
        let slants = self.groups.iter().map(|group| group.slope.abs().element_sum());
        let steepest = if self.has_gap { f64::INFINITY } else { slants.fold(0.0, f64::max) };
        Depths { nearest, farthest, relief: (steepest * cell.side as f64) as f32 }
    }

    /// Whether another surface of this cell lies noticeably in front of `group`.
    pub fn has_nearer(&self, group: &Group, parallax_px: f64) -> bool {
        let depth = group.mean_inverse_depth();
        let others = self.groups.iter().filter(|other| !std::ptr::eq(*other, group));
        others.map(Group::mean_inverse_depth).any(|other| (other - depth) * parallax_px > 0.1)
    }
}

impl Group {
    /// Mean of 1/z.
    pub fn mean_inverse_depth(&self) -> f64 {
        mean_inverse_depth(&self.members)
    }

    /// The centre of its sub-cells, px.
    pub fn center(&self, cell: Cell) -> DVec2 {
        cell.part(rays_of(&self.members)).center
    }

    /// Its samples, as if each saw the whole aperture: one with its mean radiance over its share of the cell; where that
    /// varies, one a quadrant.
    pub fn samples(&self, radiance: &dyn Radiance, view: &View, cell: Cell) -> Vec<Found> {
        let emitted: Vec<Vec3> = self.members.iter().map(|m| toward_aperture(radiance, view, m)).collect();
        let quadrants = self.quadrants();
        let mean = |rays: &Range<usize>| emitted[rays.clone()].iter().sum::<Vec3>() / rays.len() as f32;
        let low = quadrants.iter().map(mean).fold(Vec3::INFINITY, Vec3::min);
        let high = quadrants.iter().map(mean).fold(Vec3::ZERO, Vec3::max);
        let even = (BakeOptions::EVEN_PER_PX * view.tolerance_px) as f32;
        let is_even = (high - low).max_element() <= even * high.max_element();
        // Light from outside the frame is spread over eight cells and more.
        let all = 0..emitted.len();
        let parts = if is_even || cell.side > 1 { vec![all] } else { quadrants };
        parts.into_iter().map(|rays| self.sample(cell, rays.clone(), mean(&rays))).collect()
    }

    /// The members of each quadrant that has any.
    fn quadrants(&self) -> Vec<Range<usize>> {
        let quadrant = |member: &Member| Cell::quadrant(member.sub_cell);
        let parts = self.members.chunk_by(|a, b| quadrant(a) == quadrant(b));
        let following = |end: &mut usize, part: &[Member]| {
            let start = *end;
            *end += part.len();
            Some(start..*end)
        };
        parts.scan(0, following).collect()
    }

    /// The sample that some of its members make.
    fn sample(&self, cell: Cell, members: Range<usize>, radiance: Vec3) -> Found {
        let members = &self.members[members];
        let rays = rays_of(members);
        let CellPart { center, half_size, weight } = cell.part(rays);
        let middle = members
            .iter()
            .min_by(|a, b| a.pixel.distance_squared(center).total_cmp(&b.pixel.distance_squared(center)))
            .expect("a group has members");
        let sample = Sample {
            center: center.as_vec2(),
            half_size: half_size.as_vec2(),
            inverse_depth: mean_inverse_depth(members) as f32,
            weight: weight as f32,
            tilt: (self.tilt * weight).as_vec2(),
            radiance,
            surface: middle.point,
            visibility: Visibility::Open,
        };
        Found { sample, rays: Some((cell, rays)) }
    }
}

/// The sub-cells of members, a bit each.
fn rays_of(members: &[Member]) -> u16 {
    members.iter().fold(0, |rays, member| rays | 1 << member.sub_cell)
}

/// Mean of 1/z.
fn mean_inverse_depth(members: &[Member]) -> f64 {
    members.iter().map(|m| m.inverse_depth).sum::<f64>() / members.len() as f64
}

fn toward_aperture(radiance: &dyn Radiance, view: &View, member: &Member) -> Vec3 {
    match member.point {
        Some(point) => radiance.toward(point, view.eye),
        None => radiance.from_infinity(view.chief_ray(member.pixel).direction.normalize()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, IVec2};
    use lens::Camera;

    /// Light from infinity: so much on the left, so much on the right.
    struct Halves([f32; 2]);

    impl Radiance for Halves {
        fn toward(&self, _point: SurfacePoint, _eye: DVec3) -> Vec3 {
            unreachable!("there is no surface")
        }
        fn from_infinity(&self, direction: DVec3) -> Vec3 {
            Vec3::splat(self.0[usize::from(direction.x > 0.0)])
        }
    }

    /// The samples of a cell of the background whose upright middle line is the picture's.
    fn samples(side: i32, light: [f32; 2]) -> Vec<Found> {
        let camera = Camera { width: 64, height: 64, ..Camera::default() };
        let view = View::new(&camera);
        // Half a pixel further right, the middle is that of a cell of one pixel.
        let shift = if side == 1 { 0.5 } else { 0.0 };
        let cell = Cell { corner: IVec2::new(32 - side / 2, 8), side };
        let member = |sub_cell: usize| {
            let pixel = cell.sub_corner(sub_cell) + cell.sub_side() / 2.0 - DVec2::new(shift, 0.0);
            Member { sub_cell, pixel, point: None, inverse_depth: 0.0 }
        };
        let members = Cell::sub_cells().map(member).collect();
        let (tilt, slope) = (DVec2::ZERO, DVec2::ZERO);
        let group = Group { members, is_nearest: true, is_just_behind: false, part: None, tilt, slope };
        group.samples(&Halves(light), &view, cell)
    }

    #[test]
    fn a_pixel_is_a_sample_a_quadrant_where_its_radiance_varies() {
        for (side, light, count) in [
            (1, [0.5, 0.5], 1),
            (1, [0.5, 0.52], 1),
            (1, [0.5, 2.0], 4),
            (1, [0.0, 1e-6], 4),
            (4, [0.5, 2.0], 1),
        ] {
            let found = samples(side, light);
            assert_eq!(found.len(), count, "{side} px, {light:?}");
            let weight: f32 = found.iter().map(|found| found.sample.weight).sum();
            let sent: f32 = found.iter().map(|found| found.sample.weight * found.sample.radiance.x).sum();
            assert_eq!(weight, (side * side) as f32);
            assert!((sent / weight - (light[0] + light[1]) / 2.0).abs() < 1e-6, "{found:?}");
            let rays = found.iter().fold(0, |all, found| all | found.rays.expect("they are of a cell").1);
            assert_eq!(rays, u16::MAX);
        }
    }
}
