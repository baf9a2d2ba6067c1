//! How far the light of surfaces in a part of the picture may reach, before anything is baked: bounds from the triangles alone.
//!
//! The picture and its margin are cut into squares. On the plane of a triangle 1/z is linear over the pinhole picture, so that its range
//! over a square is that of the square's corners. Where the focus is known to a range, too, the defocus
//!
//! ```text
//! κ = (t − 1)/d + t·(1 − a)·(1/s − 1/z)
//! ```
//!
//! is linear in each of t, a and 1/z, and so largest at a corner of the three ranges. A surface that something hides counts like
//! any other, and everywhere there may be background.

use crate::baker::placement::Placement;
use crate::domain::Domain;
use crate::view::View;
use glam::{DVec2, DVec3, IVec2};
use lens::FocusOffset;
use rayon::prelude::*;
use scene::{Scene, SurfaceField};
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};

/// How focus offsets range.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FocusRange {
    /// The least and the greatest t.
    t: [f64; 2],
    /// The least and the greatest anchor.
    anchor: [f64; 2],
}

impl FocusRange {
    /// Nothing is painted.
    const STANDARD: Self = Self { t: [1.0; 2], anchor: [0.0; 2] };

    /// Anything may be painted.
    const ANY: Self = Self { t: [-1e9, 1e9], anchor: [0.0, 1.0] };

    /// The range from the least of values to the greatest, and the ordinary lens, which carried light may keep.
    fn spanning([least, greatest]: [FocusOffset; 2]) -> Self {
        let wide = |a: f64, b: f64, standard: f64| [a.min(b).min(standard), a.max(b).max(standard)];
        Self { t: wide(least.t, greatest.t, 1.0), anchor: wide(least.anchor, greatest.anchor, 0.0) }
    }

    /// Whether nothing is painted.
    fn is_standard(self) -> bool {
        self == Self::STANDARD
    }

    /// The largest radius of an aperture image, px, over a range of 1/z.
    fn radius_px(self, view: &View, inverse_depths: [f64; 2]) -> f64 {
        let mut largest = 0.0f64;
        for t in self.t {
            for anchor in self.anchor {
                for inverse_depth in inverse_depths {
                    let kappa = view.optics.kappa(inverse_depth, FocusOffset::new(t, anchor));
                    largest = largest.max(view.optics.splat_radius_px(kappa).abs());
                }
            }
        }
        largest
    }
}

/// Side of a square, px: some blocks.
pub const SQUARE_PX: i32 = 4 * Domain::BLOCK;

/// Bounds of the surfaces in a square.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bound {
    /// The largest 1/z.
    pub inverse_depth: f32,
    /// The largest radius of an aperture image, px; of surfaces that may be edge-on, twice that.
    pub radius_px: f32,
}

impl Bound {
    fn union(self, other: Self) -> Self {
        Self {
            inverse_depth: self.inverse_depth.max(other.inverse_depth),
            radius_px: self.radius_px.max(other.radius_px),
        }
    }
}

/// The bounds of all squares of the picture and its margin.
pub struct Reach {
    /// Columns and rows of squares.
    pub size: IVec2,
    corner: IVec2,
    bounds: Vec<Bound>,
    /// For each part of the scene and each square where it may lie, by number: the largest radius there, px.
    parts: HashMap<(u32, u32), f32>,
    /// Whether anything may be painted.
    pub may_be_painted: bool,
}

/// So many triangles are gathered by one thread.
const CHUNK_TRIANGLES: usize = 1 << 12;

impl Reach {
    /// How far light reaches from each square of `domain`, for what `view` shows of a scene focused by `focus`.
    pub fn new(
        scene: &Scene,
        view: &View,
        domain: Domain,
        placement: &Placement,
        focus: &dyn SurfaceField<FocusOffset>,
    ) -> Self {
        let squares = Squares::new(domain);
        let of_background = FocusRange::spanning([focus.at_infinity().or_standard(); 2]);
        let background = of_background.radius_px(view, [0.0; 2]);
        let is_painted = AtomicBool::new(!of_background.is_standard());
        let empty = || HashMap::<(u32, u32), Bound>::new();
        let triangles: Vec<u32> = (0..scene.triangles.len() as u32).collect();
        let gather = |mut bounds_by_part: HashMap<(u32, u32), Bound>, chunk: &[u32]| {
            for &triangle in chunk {
                let part = scene.triangles[triangle as usize].part;
                let range = focus.bounds(triangle).map_or(FocusRange::ANY, FocusRange::spanning);
                if !range.is_standard() {
                    is_painted.store(true, Ordering::Relaxed);
                }
                // What is edge-on leans toward where its weight is, by up to the radius.
                let wider = if placement.is_on_surface(triangle) { 2.0 } else { 1.0 };
                squares.visit(scene, view, placement, triangle, &mut |square, depths| {
                    let bound = Bound {
                        inverse_depth: depths[1] as f32,
                        radius_px: (wider * range.radius_px(view, depths)) as f32,
                    };
                    let total = bounds_by_part.entry((part, square)).or_default();
                    *total = total.union(bound);
                });
            }
            bounds_by_part
        };
        let both = |mut a: HashMap<(u32, u32), Bound>, b: HashMap<(u32, u32), Bound>| {
            for (key, bound) in b {
                let total = a.entry(key).or_default();
                *total = total.union(bound);
            }
            a
        };
        let bounds_by_part = triangles.par_chunks(CHUNK_TRIANGLES).fold(empty, gather).reduce(empty, both);
        let behind = Bound { inverse_depth: 0.0, radius_px: background as f32 };
        let mut bounds = vec![behind; squares.size.element_product() as usize];
        for ((_, square), bound) in &bounds_by_part {
            let total = &mut bounds[*square as usize];
            *total = total.union(*bound);
        }
        let parts = bounds_by_part.into_iter().map(|(key, bound)| (key, bound.radius_px)).collect();
        let may_be_painted = is_painted.into_inner();
        Self { size: squares.size, corner: squares.corner, bounds, parts, may_be_painted }
    }

    /// All squares with their bounds, row by row: column and row of each square.
    pub fn squares(&self) -> impl Iterator<Item = (IVec2, Bound)> {
        let width = self.size.x;
        let place = move |number: usize| IVec2::new(number as i32 % width, number as i32 / width);
        self.bounds.iter().enumerate().map(move |(number, bound)| (place(number), *bound))
    }

    /// Each part in each square where it may lie, with the largest radius of its images there, px.
    pub fn parts(&self) -> impl Iterator<Item = (u32, IVec2, f32)> {
        let width = self.size.x;
        self.parts.iter().map(move |((part, square), radius)| {
            (*part, IVec2::new(*square as i32 % width, *square as i32 / width), *radius)
        })
    }

    /// The pixels of a square: its upper left, and the end to its lower right.
    pub fn pixels(&self, square: IVec2) -> [IVec2; 2] {
        let first = self.corner + square * SQUARE_PX;
        [first, first + SQUARE_PX]
    }
}

/// Where squares lie.
struct Squares {
    size: IVec2,
    corner: IVec2,
}

impl Squares {
    fn new(domain: Domain) -> Self {
        let side = SQUARE_PX / Domain::BLOCK;
        Self { size: (domain.blocks() + side - 1) / side, corner: IVec2::splat(-domain.margin) }
    }

    /// Calls `visit_square` with the number of each square in which a triangle may lie, and the range of 1/z there.
    fn visit(
        &self,
        scene: &Scene,
        view: &View,
        placement: &Placement,
        triangle: u32,
        visit_square: &mut dyn FnMut(u32, [f64; 2]),
    ) {
        let corners = scene.corners(triangle).map(|p| view.camera.camera_from_world(p));
        if corners.iter().all(|p| p.z <= 0.0) {
            return;
        }
        let is_before = corners.iter().all(|p| p.z > 0.0);
        let is_on_surface = placement.is_on_surface(triangle);
        let own = if is_before {
            let inverse = corners.map(|p| 1.0 / p.z);
            [inverse.into_iter().fold(f64::INFINITY, f64::min), inverse.into_iter().fold(0.0, f64::max)]
        } else {
            [0.0, f64::INFINITY]
        };
        let last = self.size - 1;
        let [low, high] = if is_before {
            let pixels = corners.map(|p| view.camera.pixel_from_q(view.optics.chief(p)));
            let low = pixels[0].min(pixels[1]).min(pixels[2]);
            let high = pixels[0].max(pixels[1]).max(pixels[2]);
            // Pieces of surface may lie a little beside the domain, and count where it ends.
            let room = if is_on_surface { f64::from(SQUARE_PX) } else { 1.0 };
            let square = |pixel: DVec2| {
                let at = (pixel - self.corner.as_dvec2()) / f64::from(SQUARE_PX);
                // What is not a number may be anywhere; casts keep what is far within the range of integers.
                at.floor().as_ivec2()
            };
            let [low, high] = [square(low - room), square(high + room)];
            if low.cmpgt(last).any() || high.cmplt(IVec2::ZERO).any() {
                return;
            }
            [low.max(IVec2::ZERO), high.min(last)]
        } else {
            [IVec2::ZERO, last]
        };
        let plane = Plane::through(corners).filter(|_| !is_on_surface);
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let depths = match &plane {
                    None => own,
                    Some(plane) => {
                        let first = (self.corner + IVec2::new(x, y) * SQUARE_PX).as_dvec2();
                        let [least, most] = plane.range(view, first, f64::from(SQUARE_PX));
                        // Rounding must not lose a triangle that barely reaches the square.
                        let slack = 1e-6 * most.abs().max(least.abs());
                        [(least - slack).max(own[0]), (most + slack).min(own[1])]
                    }
                };
                if depths[1] > 0.0 && depths[0] <= depths[1] {
                    visit_square((y * self.size.x + x) as u32, [depths[0].max(0.0), depths[1]]);
                }
            }
        }
    }
}

/// The plane of a triangle: 1/z = gradient·(x/z, y/z, 1).
struct Plane(DVec3);

impl Plane {
    /// `None` where it passes so close to the aperture's centre that it does not determine 1/z.
    fn through([a, b, c]: [DVec3; 3]) -> Option<Self> {
        const GRAZING: f64 = 1e-7;
        let normal = (b - a).cross(c - a);
        let offset = normal.dot(a);
        let size = normal.length() * a.length().max(b.length()).max(c.length());
        (offset.abs() > GRAZING * size).then(|| Self(normal / offset))
    }

    /// The least and the greatest 1/z over a square of the pinhole picture.
    fn range(&self, view: &View, corner: DVec2, side: f64) -> [f64; 2] {
        let at = |step: DVec2| {
            let q = view.camera.q_from_pixel(corner + step * side) * view.optics.tan_half_yfov;
            self.0.dot(q.extend(1.0))
        };
        let [a, b, c, d] = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(at);
        [a.min(b).min(c).min(d), a.max(b).max(c).max(d)]
    }
}
