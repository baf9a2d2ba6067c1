//! The pinhole picture, one cell at a time: which surfaces lie along its chief rays.

use crate::baker::occluders::{Depths, Occluders};
use crate::baker::outgoing::own_light_change::OwnLightChange;
use crate::baker::outgoing::{self, ApertureRadiance, LightComponent, MeanRadiance, RadianceQuery};
use crate::baker::placement::Placement;
use crate::domain::{Cell, CellPart, Density};
use crate::jitter::Net;
use crate::options::BakeOptions;
use crate::sample::Sample;
use crate::samples::BakedSample;
use crate::view::View;
use glam::{DVec2, IVec2, Vec3};
use scene::{Scene, SurfacePoint};
use std::ops::Range;
use trace::{Beam, Hit, IncidentLight, OutgoingRadiance, Radiance, ShadingPoint, Tracer, Viewpoint};

/// Surfaces along one chief ray beyond which the trace ends.
const MAX_LAYERS: usize = 12;

/// The same where some of them may be half there, and let others show.
const MAX_PANE_LAYERS: usize = 48;

/// Parallax, px, up to which what a nearer surface hides of a cell and what it does not are samples of their own: the outline
/// is nearly sharp on them, and few rays from either would not resolve how much both together hide.
const JUST_BEHIND_PX: f64 = 1.0;

/// What panes leave of a cell's rays may differ by so much within one sample: along the edge of a pane that is in focus, what lies
/// behind it and what lies beside it are samples of their own.
const SAME_PANES: f32 = 0.05;

/// Where a chief ray of a cell hits a surface, or goes to infinity.
#[derive(Clone, Copy, Debug)]
pub struct Member {
    /// The sub-cells that it represents, a bit each.
    pub sub_cells: u64,
    /// Where it is in the pinhole picture, px.
    pub pixel: DVec2,
    /// The surface; `None` for the background.
    pub point: Option<SurfacePoint>,
    /// 1/z.
    pub inverse_depth: f64,
}

/// A hit that is to be added to a group.
struct HitMember {
    member: Member,
    /// How much of it counts, in [0, 1].
    share: f32,
    /// What panes in front of it leave of its ray.
    panes: f32,
    /// Whether it is the nearest along its ray.
    is_nearest: bool,
    /// 1/z of the nearest.
    nearest: f64,
}

/// Members of one cell that lie on one smooth surface.
#[derive(Clone, Debug)]
pub struct Group {
    /// At most one a ray, in the order of their sub-cells.
    pub members: Vec<Member>,
    /// How much of each counts: its opacity, past what is in front of it where the aperture is a point.
    shares: Vec<f32>,
    /// What panes in front of it leave of the first one's ray.
    panes: f32,
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

/// A square of the picture on which a surface's carried light is computed once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Tile {
    part: u32,
    /// Upper left, px.
    pub corner: [i32; 2],
    /// px.
    tile_side: i32,
    /// The number of aperture cells per side on which it is computed.
    pub side: usize,
}

/// What the rays of a cell met.
pub struct Layers {
    /// Its surfaces.
    pub groups: Vec<Group>,
    /// The largest and the smallest inverse depth among its nearest surfaces.
    pub depth_range: [f32; 2],
    /// Whether a nearest surface is sampled elsewhere and so not among the groups.
    pub has_gap: bool,
    /// Whether a nearest surface is partly transparent, so that others show behind it.
    pub has_pane: bool,
}

/// Traces the chief rays of a cell: to the nearest surface, or, if `hidden`, through all of them.
pub fn trace_cell(
    tracer: &Tracer,
    view: &View,
    placement: &Placement,
    cell: Cell,
    density: Density,
    hidden: bool,
) -> Layers {
    let mut layers =
        Layers { groups: Vec::new(), depth_range: [0.0, f32::INFINITY], has_gap: false, has_pane: false };
    let net = Net::new(density.rays_per_side().ilog2(), cell.corner.as_uvec2().to_array());
    let ray_side = cell.side as f64 / density.rays_per_side() as f64;
    let corner_of = |ray: usize| {
        let [row, column] = Cell::row_and_column(ray);
        cell.corner.as_dvec2() + DVec2::new(column as f64, row as f64) * ray_side
    };
    // Rays that lie together: all, or those of a quadrant.
    for first in (0..density.rays()).step_by(Beam::MAX_RAYS) {
        let pixels: [_; Beam::MAX_RAYS] = std::array::from_fn(|k| {
            let [row, column] = Cell::row_and_column(first + k);
            corner_of(first + k) + DVec2::from_array(net.place(row, column)) * ray_side
        });
        let beam = view.beam(corner_of(first), ray_side * Beam::MAX_RAYS.isqrt() as f64);
        let rays = pixels.map(|pixel| view.chief_ray(pixel));
        let most = match (hidden, tracer.has_transparency()) {
            (false, _) => 1,
            (true, false) => MAX_LAYERS,
            (true, true) => MAX_PANE_LAYERS,
        };
        let met: Vec<(usize, Hit)> = if hidden {
            tracer.all_hits(&beam, &rays, most)
        } else {
            let first = tracer.first_hits(&beam, &rays).into_iter().enumerate();
            let mut met = Vec::with_capacity(Beam::MAX_RAYS);
            met.extend(first.filter_map(|(ray, hit)| Some((ray, hit?))));
            met
        };
        let mut left = met.as_slice();
        for (ray, pixel) in pixels.into_iter().enumerate() {
            let count = left.iter().take_while(|(of, _)| *of == ray).count();
            let (of_ray, others) = left.split_at(count);
            left = others;
            // Behind the last surface lies the background.
            let hits = of_ray.iter().map(|(_, hit)| Some(*hit)).chain([None]).take(most);
            layers.add_hits(tracer, view, placement, density.sub_cells(first + ray), pixel, hits);
        }
    }
    layers
}

impl Layers {
    /// Adds what a ray through `pixel` meets, one surface behind the other.
    fn add_hits(
        &mut self,
        tracer: &Tracer,
        view: &View,
        placement: &Placement,
        sub_cells: u64,
        pixel: DVec2,
        hits: impl Iterator<Item = Option<Hit>>,
    ) {
        let is_pinhole = view.optics.aperture_radius == 0.0;
        let (mut nearest, mut through, mut panes) = (0.0, 1.0, 1.0);
        for (layer, hit) in hits.enumerate() {
            let inverse_depth = hit.map_or(0.0, |hit| 1.0 / hit.t);
            let point = hit.map(|hit| hit.point);
            let opacity = match point {
                Some(point) if tracer.has_transparency() => tracer.scene().opacity(point),
                _ => 1.0,
            };
            if layer == 0 {
                self.has_pane |= opacity < 1.0;
                nearest = inverse_depth;
                let [near, far] = &mut self.depth_range;
                *near = near.max(inverse_depth as f32);
                *far = far.min(inverse_depth as f32);
            }
            let met = HitMember {
                member: Member { sub_cells, pixel, point, inverse_depth },
                share: opacity * if is_pinhole { through } else { 1.0 },
                panes,
                is_nearest: layer == 0,
                nearest,
            };
            through *= 1.0 - opacity;
            panes *= if opacity < 1.0 { 1.0 - opacity } else { 1.0 };
            let is_sampled_here = point.is_none_or(|point| !placement.is_on_surface(point.triangle));
            if is_sampled_here {
                self.add(tracer, view, met);
            } else if layer == 0 {
                self.has_gap = true;
            }
        }
    }

    /// Adds a hit to the group of its surface, or to a new group.
    fn add(&mut self, tracer: &Tracer, view: &View, met: HitMember) {
        let HitMember { member, share, panes, is_nearest, nearest } = met;
        let parallax_px = view.radius_per_kappa_px;
        let is_just_behind = !is_nearest && (nearest - member.inverse_depth) * parallax_px < JUST_BEHIND_PX;
        let part = member.point.map(|p| tracer.scene().triangles[p.triangle as usize].part);
        let is_same_surface = |group: &&mut Group| {
            let first = group.members[0];
            let expected = first.inverse_depth + group.slope.dot(member.pixel - first.pixel);
            group.part == part
                && group.is_just_behind == is_just_behind
                && (panes - group.panes).abs() <= SAME_PANES
                && (member.inverse_depth - expected).abs() * parallax_px <= Occluders::SAME_SURFACE_PX
                && group.members.last().is_none_or(|last| last.sub_cells != member.sub_cells)
        };
        if let Some(group) = self.groups.iter_mut().find(is_same_surface) {
            group.members.push(member);
            group.shares.push(share);
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
        let mut members = Vec::with_capacity(Beam::MAX_RAYS);
        members.push(member);
        let mut shares = Vec::with_capacity(Beam::MAX_RAYS);
        shares.push(share);
        self.groups.push(Group { members, shares, panes, is_nearest, is_just_behind, part, tilt, slope });
    }

    /// The nearest and the farthest inverse depth around the cell, and how far it varies within.
    pub fn depths(&self, cell: Cell) -> Depths {
        let [nearest, farthest] = self.depth_range;
        let slants = self.groups.iter().map(|group| group.slope.abs().element_sum());
        let steepest = if self.has_gap { f64::INFINITY } else { slants.fold(0.0, f64::max) };
        Depths { nearest, farthest, relief: (steepest * cell.side as f64) as f32 }
    }

    /// Whether an outline passes through the cell.
    pub fn has_outline(&self) -> bool {
        self.groups.len() > 1 || self.has_gap && !self.groups.is_empty()
    }

    /// Whether another surface of this cell lies in front of `group` by more than 0.1 px; `parallax_px` is the shift,
    /// px, per inverse depth.
    pub fn has_nearer(&self, group: &Group, parallax_px: f64) -> bool {
        let depth = group.mean_inverse_depth();
        let others = self.groups.iter().filter(|other| !std::ptr::eq(*other, group));
        others.map(Group::mean_inverse_depth).any(|other| (other - depth) * parallax_px > 0.1)
    }
}

impl Group {
    /// The mean inverse depth 1/z of its points, 1/length.
    pub fn mean_inverse_depth(&self) -> f64 {
        mean_inverse_depth(&self.members)
    }

    /// The centre of the sub-cells that it covers, in px of the picture.
    pub fn center(&self, cell: Cell) -> DVec2 {
        cell.part(sub_cells_of(&self.members)).center
    }

    /// The viewpoint of its visibility: the member nearest to its centre. From elsewhere in the cell, the image of an
    /// occluder in focus would be displaced; the exact centre may lie beyond an edge of the surface.
    pub fn viewpoint(&self, view: &View, cell: Cell) -> Viewpoint {
        let member = nearest(&self.members, self.center(cell));
        match member.point {
            Some(point) => Viewpoint::Surface(point),
            None => Viewpoint::Infinity(view.chief_ray(member.pixel).direction),
        }
    }

    /// The point that represents it where light is computed in batches; `None` for the background, and where the surface is so
    /// folded that one point does not represent it.
    pub fn shading_point(&self, scene: &Scene, cell: Cell) -> Option<ShadingPoint> {
        const FLAT: f64 = 0.95;
        let member = nearest(&self.members, self.center(cell));
        let point = member.point?;
        let normal = scene.shading_normal(point);
        let is_alike = |member: &Member| {
            member.point.is_some_and(|other| {
                other.triangle == point.triangle || scene.shading_normal(other).dot(normal) >= FLAT
            })
        };
        self.members.iter().all(is_alike).then_some(ShadingPoint { point, pixel: member.pixel })
    }

    /// Its samples, as if nothing hid the aperture: one with its mean radiance over its share of the cell; one per quadrant where
    /// that varies; one per part of the aperture where it changes over the aperture. Carried light has samples of its own
    /// ([`LightComponent`]). None if the aperture is a point from which it is invisible. `incident` is the interpolated light at
    /// its shading point, `shared` the carried light that it has in common with its neighbours.
    pub fn baked_samples(
        &self,
        radiance: &dyn Radiance,
        view: &View,
        cell: Cell,
        incident: Option<IncidentLight>,
        shared: Option<&ApertureRadiance>,
    ) -> Vec<BakedSample> {
        if self.shares.iter().all(|&share| share == 0.0) {
            return Vec::new();
        }
        let seed = cell.corner.as_uvec2().to_array();
        // Where all own light is interpolated, the rest keeps its focus.
        let is_own_interpolated = incident.is_some_and(|incident| incident.gloss.is_some());
        let blurred =
            if is_own_interpolated { outgoing::blurred_px(view, self.mean_inverse_depth()) } else { 1 };
        let query = RadianceQuery { radiance, view, seed, incident, own_only: shared.is_some(), blurred };
        if let Some(shared) = shared {
            let sent = self.toward_middle(&query);
            let own = mean(&sent, &self.shares);
            return self.glossy_samples(cell, &shared.with_own(own));
        }
        let is_pinhole = view.optics.aperture_radius == 0.0;
        let middle = self.middle(cell);
        let width = middle.and_then(|point| radiance.carried_lobe_width(point));
        let side = width.map_or(1, |width| outgoing::cells_per_side(view, self.mean_inverse_depth(), width));
        if side > 1 {
            let points: Vec<_> = self.weighted_points().collect();
            return self.glossy_samples(cell, &ApertureRadiance::gather(&query, &points, side));
        }
        let sent = match width {
            Some(_) if !is_pinhole => {
                let points = self.members.iter().filter_map(|member| member.point);
                outgoing::toward_aperture_points(&query, &points.collect::<Vec<_>>())
            }
            _ => self.toward_middle(&query),
        };
        let mean = |rays: &Range<usize>| mean(&sent[rays.clone()], &self.shares[rays.clone()]);
        let change =
            middle.and_then(|point| OwnLightChange::sample(&query, point, self.mean_inverse_depth()));
        // Few paths sample what a quadrant carries: it may differ by more.
        let even = if width.is_some() { 2.0 } else { 1.0 } * BakeOptions::EVEN_PER_PX * view.tolerance_px;
        let parts = self.parts(cell, even as f32, |rays| mean(rays).total());
        // Surveys are retained for the whole picture, most with one sample: no spare capacity.
        let mut baked = Vec::with_capacity(parts.len());
        for rays in parts {
            let mut add = |kind| baked.push(self.sample(cell, rays.clone(), kind));
            for kind in mean(&rays).components() {
                match &change {
                    Some(change) if !kind.is_carried => change.parts(&kind).into_iter().for_each(&mut add),
                    _ => add(kind),
                }
            }
        }
        baked
    }

    /// Its surface in the middle of its sub-cells; `None` of the background.
    fn middle(&self, cell: Cell) -> Option<SurfacePoint> {
        nearest(&self.members, self.center(cell)).point
    }

    /// The tile on which it may share its carried light with groups of the same tile. `None` where it has none, or has to compute it alone.
    pub fn tile(&self, radiance: &dyn Radiance, view: &View, cell: Cell) -> Option<Tile> {
        let depth = self.mean_inverse_depth();
        let tile_side = outgoing::tile_side(view, depth);
        if tile_side <= cell.side {
            return None;
        }
        let width = radiance.carried_lobe_width(self.middle(cell)?)?;
        let side = outgoing::cells_per_side(view, depth, width).max(2);
        let [corner, of] = [cell.corner, IVec2::splat(tile_side)];
        let corner = (corner.div_euclid(of) * of).to_array();
        Some(Tile { part: self.part?, corner, tile_side, side })
    }

    /// Its points, with the weight by which each counts.
    pub fn weighted_points(&self) -> impl Iterator<Item = (SurfacePoint, f32)> {
        self.members.iter().zip(&self.shares).filter_map(|(member, share)| Some((member.point?, *share)))
    }

    /// What each member sends to the aperture's middle. On surfaces that are uniform but for their light, a few represent all: two
    /// that lie apart or, if these differ, one of every four.
    fn toward_middle(&self, query: &RadianceQuery) -> Vec<OutgoingRadiance> {
        const TOGETHER: usize = 4;
        const ALIKE: f32 = 0.02;
        let count = self.members.len();
        let sent =
            |at: usize, number: usize, of: usize| member_to_middle(query, &self.members[at], number, of);
        let is_plain = self.members[0].point.is_some_and(|point| !query.radiance.varies_within_pixel(point));
        if is_plain && query.incident.is_some() {
            return vec![sent(count / 2, 0, 1); count];
        }
        if !is_plain || count < TOGETHER * TOGETHER {
            return (0..count).map(|at| sent(at, at, count)).collect();
        }
        // Along Morton's curve those of a quadrant follow each other; its middle ones lie inwards.
        let groups = count.div_ceil(TOGETHER);
        let of_group = |group: usize, number: usize| {
            let at = (group * TOGETHER + (3 * group + group / TOGETHER) % TOGETHER).min(count - 1);
            sent(at, number, groups)
        };
        let far = [0, groups - 1].map(|group| of_group(group, usize::from(group > 0)));
        let [first, last] = far.each_ref().map(OutgoingRadiance::total);
        if (first - last).abs().max_element() <= ALIKE * first.max(last).max_element() {
            let mean = MeanRadiance::mean(far.map(|light| (light, 1.0))).to_outgoing();
            return vec![mean; count];
        }
        let between = |group: usize| match group {
            0 => far[0],
            last if last == groups - 1 => far[1],
            _ => of_group(group, group + 1),
        };
        (0..groups).flat_map(|group| vec![between(group); TOGETHER.min(count - group * TOGETHER)]).collect()
    }

    /// The same where carried light is computed on cells of the aperture: it is common to all members.
    fn glossy_samples(&self, cell: Cell, radiance: &ApertureRadiance) -> Vec<BakedSample> {
        let all = 0..self.members.len();
        let own = radiance.all.components().filter(|kind| !kind.is_carried);
        let kinds = own.chain(radiance.carried());
        kinds.map(|kind| self.sample(cell, all.clone(), kind)).collect()
    }

    /// Its members, or those of each quadrant, if their radiance varies by more than this share of the largest.
    fn parts(&self, cell: Cell, even: f32, mean: impl Fn(&Range<usize>) -> Vec3) -> Vec<Range<usize>> {
        let quadrants = self.quadrants();
        let low = quadrants.iter().map(&mean).fold(Vec3::INFINITY, Vec3::min);
        let high = quadrants.iter().map(&mean).fold(Vec3::ZERO, Vec3::max);
        let is_even = (high - low).max_element() <= even * high.max_element();
        // Light from outside the frame is spread over eight cells and more.
        let all = 0..self.members.len();
        if is_even || cell.side > 1 { vec![all] } else { quadrants }
    }

    /// The members of each quadrant that has any.
    fn quadrants(&self) -> Vec<Range<usize>> {
        let quadrant = |member: &Member| Cell::quadrant(member.sub_cells);
        let parts = self.members.chunk_by(|a, b| quadrant(a) == quadrant(b));
        let following = |end: &mut usize, part: &[Member]| {
            let start = *end;
            *end += part.len();
            Some(start..*end)
        };
        parts.scan(0, following).collect()
    }

    /// The sample that some of its members make, of one kind of light.
    fn sample(&self, cell: Cell, members: Range<usize>, kind: LightComponent) -> BakedSample {
        let there = self.shares[members.clone()].iter().sum::<f32>() / members.len() as f32;
        let members = &self.members[members];
        let sub_cells = sub_cells_of(members);
        let CellPart { center, half_size, weight } = cell.part(sub_cells);
        let share = f64::from(there * kind.share);
        let sample = Sample {
            center: center.as_vec2(),
            half_size: half_size.as_vec2(),
            inverse_depth: mean_inverse_depth(members) as f32,
            weight: (weight * share) as f32,
            tilt: (self.tilt * weight * share).as_vec2(),
            radiance: kind.radiance,
            surface: nearest(members, center).point,
            is_carried: kind.is_carried,
            visibility: kind.toward,
        };
        BakedSample { sample, part_of: Some((cell, sub_cells)), noisy: kind.noisy }
    }
}

/// The mean of what rays of these shares send. If all shares are 0, the rays count equally.
fn mean(sent: &[OutgoingRadiance], shares: &[f32]) -> MeanRadiance {
    let is_there = shares.iter().any(|&share| share > 0.0);
    MeanRadiance::mean(
        sent.iter().zip(shares).map(|(light, share)| (*light, if is_there { *share } else { 1.0 })),
    )
}

/// Of some members, at least one, the nearest to a place in the picture.
fn nearest(members: &[Member], pixel: DVec2) -> &Member {
    let distance = |member: &&Member| member.pixel.distance_squared(pixel);
    members.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("a group has members")
}

/// The sub-cells that members represent, a bit each.
fn sub_cells_of(members: &[Member]) -> u64 {
    members.iter().fold(0, |all, member| all | member.sub_cells)
}

/// Mean of 1/z.
fn mean_inverse_depth(members: &[Member]) -> f64 {
    members.iter().map(|m| m.inverse_depth).sum::<f64>() / members.len() as f64
}

/// What a member sends to the aperture's middle: the `index`-th of `count` queries.
fn member_to_middle(query: &RadianceQuery, member: &Member, index: usize, count: usize) -> OutgoingRadiance {
    let RadianceQuery { radiance, view, .. } = *query;
    match member.point {
        Some(point) => query.outgoing(point, view.eye, index, count),
        None => OutgoingRadiance::from_own(
            radiance.environment(view.chief_ray(member.pixel).direction.normalize()),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use lens::Camera;

    /// Light from infinity: so much on the left, so much on the right.
    struct Halves([f32; 2]);

    impl Radiance for Halves {
        fn outgoing(&self, _point: SurfacePoint, _eye: DVec3) -> trace::OutgoingRadiance {
            unreachable!("there is no surface")
        }
        fn environment(&self, direction: DVec3) -> Vec3 {
            Vec3::splat(self.0[usize::from(direction.x > 0.0)])
        }
    }

    /// The samples of a cell of the background whose upright middle line is the picture's.
    fn samples(side: i32, light: [f32; 2]) -> Vec<BakedSample> {
        let camera = Camera { width: 64, height: 64, ..Camera::default() };
        let view = View::new(&camera, BakeOptions::TOLERANCE_PX);
        // Half a pixel further right, the middle is that of a cell of one pixel.
        let shift = if side == 1 { 0.5 } else { 0.0 };
        let cell = Cell { corner: IVec2::new(32 - side / 2, 8), side };
        let member = |ray: usize| {
            let sub_cells = Density::Coarse.sub_cells(ray);
            let pixel = cell.part(sub_cells).center - DVec2::new(shift, 0.0);
            Member { sub_cells, pixel, point: None, inverse_depth: 0.0 }
        };
        let members: Vec<_> = (0..Density::Coarse.rays()).map(member).collect();
        let group = Group {
            shares: vec![1.0; members.len()],
            members,
            panes: 1.0,
            is_nearest: true,
            is_just_behind: false,
            part: None,
            tilt: DVec2::ZERO,
            slope: DVec2::ZERO,
        };
        group.baked_samples(&Halves(light), &view, cell, None, None)
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
            let parts = found.iter().map(|found| found.part_of.expect("they are of a cell").1);
            assert_eq!(parts.fold(0, |all, part| all | part), u64::MAX);
        }
    }
}
