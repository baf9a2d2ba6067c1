//! The surface divided into patches.

use super::lattice::Lattice;
use super::patch_sizes::PatchSizes;
use super::place::Place;
use crate::emitters::uniform_barycentric;
use glam::{DVec2, DVec3, IVec3, Vec3};
use scene::{Scene, SurfacePoint};
use std::collections::HashMap;

/// Patches of a scene's lit surface.
#[derive(Debug)]
pub(crate) struct Patches {
    sizes: PatchSizes,
    /// By level: the patches of the parts of that level.
    lattices: Vec<Lattice>,
    patches: Vec<Patch>,
    /// Points distributed over the patches, in the order of the patches.
    points: Vec<PatchPoint>,
}

/// The surface of one part within one lattice cell that faces roughly one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Patch {
    pub part: u32,
    /// Mean position of its points.
    pub position: DVec3,
    /// Mean normal of its points, unit.
    pub normal: DVec3,
    pub area: f64,
    first_point: u32,
    points: u32,
}

/// A surface point where incident light is gathered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PatchPoint {
    pub point: SurfacePoint,
    pub is_front: bool,
}

/// Maximum number of points of a patch.
const MAX_POINTS: usize = 16;
/// Candidate points examined per cell-sized square of surface.
const CANDIDATES_PER_CELL: f64 = 24.0;

/// A candidate point before it is assigned to a patch.
struct Candidate {
    key: (IVec3, u32, u8),
    point: PatchPoint,
    position: DVec3,
    normal: DVec3,
    area: f64,
}

impl Patches {
    /// Divides a scene's surface into about `target_count` patches, and never more than twice as many. Unlit surfaces
    /// get none, since light does not affect them.
    pub fn new(scene: &Scene, target_count: u32) -> Self {
        let lit = || {
            let parts = scene.parts.iter().filter(|part| !scene.materials[part.material as usize].unlit);
            parts.flat_map(|part| part.triangles.clone())
        };
        let sides = |triangle: u32| if scene.material_of(triangle).double_sided { 2.0 } else { 1.0 };
        let area_of = |triangle: u32| scene.area_normal(triangle).length() / 2.0 * sides(triangle);
        let mut part_areas = vec![0.0; scene.parts.len()];
        for triangle in lit() {
            part_areas[scene.triangles[triangle as usize].part as usize] += area_of(triangle);
        }
        let mut spacing = (part_areas.iter().sum::<f64>() / f64::from(target_count)).sqrt();
        loop {
            let sizes = PatchSizes::new(spacing, &part_areas, target_count);
            let candidates = surface_candidates(scene, lit(), &sizes);
            let grouped = Self::group(candidates, sizes);
            if grouped.patches.len() <= 2 * target_count as usize || !spacing.is_finite() {
                return grouped;
            }
            spacing *= 1.5;
        }
    }

    fn group(candidates: Vec<Candidate>, sizes: PatchSizes) -> Self {
        let mut groups: HashMap<(IVec3, u32, u8), Vec<u32>> = HashMap::new();
        for (index, candidate) in (0..).zip(&candidates) {
            groups.entry(candidate.key).or_default().push(index);
        }
        let mut groups: Vec<_> = groups.into_iter().collect();
        groups.sort_unstable_by_key(|((cell, part, facing), _)| (cell.to_array(), *part, *facing));
        let (mut patches, mut points, mut cells) = (Vec::new(), Vec::new(), Vec::new());
        for ((cell, part, _), members) in groups {
            let members: Vec<&Candidate> = members.iter().map(|&index| &candidates[index as usize]).collect();
            let area: f64 = members.iter().map(|member| member.area).sum();
            let mean = |property: &dyn Fn(&Candidate) -> DVec3| {
                members.iter().map(|member| property(member) * member.area).sum::<DVec3>() / area
            };
            let first_point = points.len() as u32;
            // Points at even steps of cumulative area.
            let count = members.len().min(MAX_POINTS);
            let (mut area_sum, mut next) = (0.0, 0);
            for member in &members {
                area_sum += member.area;
                while next < count && area_sum >= (next as f64 + 0.5) / count as f64 * area {
                    points.push(member.point);
                    next += 1;
                }
            }
            patches.push(Patch {
                part,
                position: mean(&|member| member.position),
                normal: mean(&|member| member.normal).normalize_or(members[0].normal),
                area,
                first_point,
                points: points.len() as u32 - first_point,
            });
            cells.push(cell);
        }
        let lattice = |level: u8| {
            let numbered = (0..).zip(&patches).zip(&cells);
            let of_level =
                numbered.filter(|((_, patch), _): &((u32, &Patch), _)| sizes.level(patch.part) == level);
            Lattice::new(sizes.of_level(level), of_level.map(|((number, _), &cell)| (number, cell)))
        };
        let lattices = (0..=sizes.max_level()).map(lattice).collect();
        Self { lattices, sizes, patches, points }
    }

    /// The side of the cells of space whose surface makes a patch of a part, scene units.
    pub fn spacing(&self, part: u32) -> f64 {
        self.sizes.of_part(part)
    }

    /// About how many patches a part has.
    pub fn estimated_count(&self, part: u32) -> f64 {
        self.sizes.cells_of_part(part)
    }

    fn lattice(&self, part: u32) -> &Lattice {
        &self.lattices[usize::from(self.sizes.level(part))]
    }

    /// The memory that they take, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.patches)
            + size_of_val(&*self.points)
            + self.lattices.iter().map(Lattice::bytes).sum::<usize>()
    }

    /// All patches, by number.
    pub fn all(&self) -> &[Patch] {
        &self.patches
    }

    /// The points of the surface at which a patch's irradiance is measured.
    pub fn points(&self, patch: &Patch) -> &[PatchPoint] {
        &self.points[patch.first_point as usize..(patch.first_point + patch.points) as usize]
    }

    /// The patches around a place with their interpolation weights, above 0: by distance along and off the surface and by
    /// orientation.
    #[inline]
    pub fn around<'a>(&'a self, place: &'a Place) -> impl Iterator<Item = (u32, f32)> + Clone + 'a {
        let lattice = self.lattice(place.part);
        let spacing = lattice.spacing;
        lattice.around(place.position).filter_map(move |(number, share)| {
            let patch = &self.patches[number as usize];
            if patch.part != place.part {
                return None;
            }
            let facing = patch.normal.dot(place.normal);
            let off = (place.position - patch.position).dot(place.normal).abs() / spacing;
            // Patches that face more than 70° away, or lie more than a cell off the tangent plane, do not contribute.
            let weight = share * (facing - 0.35).max(0.0).powi(2) * (1.0 - off).max(0.0);
            (weight > 0.0).then_some((number, weight as f32))
        })
    }

    /// The interpolated value of the patches around a place; `None` if no patch covers it.
    pub fn interpolate(&self, place: &Place, value: impl Fn(usize) -> Vec3) -> Option<Vec3> {
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for (patch, weight) in self.around(place) {
            sum += value(patch as usize) * weight;
            weights += weight;
        }
        (weights > 0.0).then(|| sum / weights)
    }

    /// Whether any patch contributes to the irradiance at a place.
    pub fn covers(&self, place: &Place) -> bool {
        self.around(place).next().is_some()
    }

    /// Visits the patches in the surrounding cells that face roughly the same direction.
    pub fn visit_neighbors(&self, patch: &Patch, mut visit: impl FnMut(u32)) {
        let lattice = self.lattice(patch.part);
        let cell = Lattice::cell(lattice.spacing, patch.position);
        for k in 0..27 {
            let around = cell + IVec3::new(k % 3, k / 3 % 3, k / 9) - 1;
            for &number in lattice.numbers(around) {
                let other = &self.patches[number as usize];
                if other.part == patch.part && other.normal.dot(patch.normal) > 0.8 {
                    visit(number);
                }
            }
        }
    }
}

/// Points distributed over triangles, about [`CANDIDATES_PER_CELL`] per square of the lattice's spacing and at least
/// one each, on every side that can be lit and visible.
fn surface_candidates(
    scene: &Scene,
    triangles: impl Iterator<Item = u32>,
    sizes: &PatchSizes,
) -> Vec<Candidate> {
    let mut candidates = Vec::new();
    for triangle in triangles {
        let area = scene.area_normal(triangle).length() / 2.0;
        if !(area > 0.0 && area.is_finite()) {
            continue;
        }
        let spacing = sizes.of_part(scene.triangles[triangle as usize].part);
        let count = (area / (spacing * spacing) * CANDIDATES_PER_CELL).ceil().clamp(1.0, 4e6) as u32;
        let sides: &[bool] = if scene.material_of(triangle).double_sided { &[true, false] } else { &[true] };
        for k in 0..count {
            let point = SurfacePoint { triangle, barycentric: barycentric(k, count) };
            for &is_front in sides {
                let place = Place::new(scene, point, is_front);
                let (position, normal) = (place.position, place.normal);
                let key = (Lattice::cell(spacing, position), place.part, facing(normal));
                let area = area / f64::from(count);
                candidates.push(Candidate {
                    key,
                    point: PatchPoint { point, is_front },
                    position,
                    normal,
                    area,
                });
            }
        }
    }
    candidates
}

/// Which of the six axis directions a normal is nearest to.
pub(crate) fn facing(normal: DVec3) -> u8 {
    let size = normal.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    2 * axis + u8::from(normal[usize::from(axis)] < 0.0)
}

/// Point `k` of `count` evenly distributed over a triangle (Roberts 2018), none on its border.
fn barycentric(k: u32, count: u32) -> DVec2 {
    if count == 1 {
        return DVec2::splat(1.0 / 3.0);
    }
    const STEPS: DVec2 = DVec2::new(0.754_877_666_246_692_8, 0.569_840_290_998_053_3);
    uniform_barycentric((STEPS * f64::from(k) + 0.5).fract())
}
