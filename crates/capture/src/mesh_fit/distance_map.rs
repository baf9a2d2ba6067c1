//! How far away the surface is in each pixel of a photograph.

use glam::{DVec2, DVec3};
use scene::{Scene, View};

/// Parts of triangles that look larger are divided before they are drawn, so that any lens may be between: the chord between the
/// directions of two corners.
const MAX_CHORD: f64 = 0.15;
/// How often a triangle may be divided.
const MAX_DIVISIONS: u32 = 100;
/// The most parts that triangles are divided into, and the most pixels that are visited for each of the map: files come from anywhere, and
/// beyond that the map stays incomplete.
const MAX_PARTS: usize = 100_000;
const MAX_VISITS: usize = 200;

/// The distance to the nearest surface along the ray through the centre of each pixel of a reduced photograph.
pub(super) struct DistanceMap {
    /// How many pixels of the photograph are one pixel of the map along each side.
    pub factor: f64,
    pub width: usize,
    pub height: usize,
    /// Row by row; infinite where nothing is hit.
    distances: Vec<f32>,
}

impl DistanceMap {
    /// Draws the map of `view`, scaled down by `factor`: the distance of the scene's surface from the camera, scene
    /// units; infinite where none is.
    pub fn new(scene: &Scene, view: &View, factor: f64) -> Self {
        let [width, height] = view.lens.size_px().map(|side| (f64::from(side) / factor).ceil() as usize);
        let mut map = Self { factor, width, height, distances: vec![f32::INFINITY; width * height] };
        let field = FieldOfView::new(view);
        let corner = |position: &DVec3| {
            let camera = view.camera_from_world(*position);
            let is_in_reach = field.contains(camera);
            Corner::new(camera, is_in_reach.then(|| view.lens.project(camera)).flatten(), factor)
        };
        let corners: Vec<Corner> = scene.positions.iter().map(corner).collect();
        let mut budget = Budget { parts: MAX_PARTS, visits: MAX_VISITS.saturating_mul(width * height) };
        for triangle in &scene.triangles {
            let triangle = triangle.vertices.map(|vertex| corners[vertex as usize]);
            if widest_edge(&triangle).0 <= MAX_CHORD {
                map.draw(&triangle, &mut budget);
            } else {
                map.draw_divided(triangle, view, &field, &mut budget);
            }
        }
        map
    }

    /// The distance at a pixel of the map; `None` where nothing is hit, or outside.
    pub fn at(&self, x: usize, y: usize) -> Option<f64> {
        let is_inside = x < self.width && y < self.height;
        let distance = is_inside.then(|| self.distances[y * self.width + x])?;
        distance.is_finite().then_some(f64::from(distance))
    }

    /// The world position of the surface in a pixel of the map; `None` where there is none.
    pub fn point(&self, view: &View, x: usize, y: usize) -> Option<DVec3> {
        let distance = self.at(x, y)?;
        let pixel = (DVec2::new(x as f64, y as f64) + 0.5) * self.factor;
        Some(view.position() + view.direction(pixel)? * distance)
    }

    /// The place in the map where a world point is visible; `None` if it is outside or something is before it.
    pub fn visible_at(&self, view: &View, point: DVec3) -> Option<DVec2> {
        /// The share of the distance by which a surface point may be behind the map, which has one value a pixel.
        const TOLERANCE: f64 = 0.01;
        let camera = view.camera_from_world(point);
        let place = view.lens.project(camera).filter(|pixel| view.lens.is_in_picture(*pixel))? / self.factor;
        let [x, y] = place.floor().to_array().map(|side| side as usize);
        // The farthest of the pixels around, for surfaces that are seen at a shallow angle.
        let around =
            (y.saturating_sub(1)..=y + 1).flat_map(|y| (x.saturating_sub(1)..=x + 1).map(move |x| (x, y)));
        let farthest = around.filter_map(|(x, y)| self.at(x, y)).reduce(f64::max)?;
        (camera.length() <= farthest * (1.0 + TOLERANCE)).then_some(place)
    }

    /// Column and row of all pixels of the map that show a surface, row by row.
    pub fn hits(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let is_hit = |index: &usize| self.distances[*index].is_finite();
        (0..self.distances.len()).filter(is_hit).map(|index| [index % self.width, index / self.width])
    }

    fn draw_divided(&mut self, triangle: [Corner; 3], view: &View, field: &FieldOfView, budget: &mut Budget) {
        let mut parts = vec![(triangle, 0)];
        while let Some((part, divisions)) = parts.pop() {
            if !field.may_contain(&part) {
                continue;
            }
            let (chord, edge) = widest_edge(&part);
            if chord <= MAX_CHORD {
                self.draw(&part, budget);
            } else if divisions < MAX_DIVISIONS && budget.parts > 0 {
                budget.parts -= 1;
                let [a, b, c] = [part[edge], part[(edge + 1) % 3], part[(edge + 2) % 3]];
                let middle = 0.5 * (a.camera + b.camera);
                let middle = Corner::new(middle, view.lens.project(middle), self.factor);
                parts.push(([a, middle, c], divisions + 1));
                parts.push(([middle, b, c], divisions + 1));
            }
        }
    }

    /// Draws a triangle that looks small.
    fn draw(&mut self, corners: &[Corner; 3], budget: &mut Budget) {
        let [Some(a), Some(b), Some(c)] = corners.map(|corner| corner.pixel) else { return };
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let area = (b - a).perp_dot(c - a);
        // A panorama's left and right end are one place.
        let spans_seam = high.x - low.x > 0.5 * self.width as f64 && self.width > 8;
        if area == 0.0 || spans_seam {
            return;
        }
        // Inverse depths are linear in the pixels of a perspective lens, and nearly so in the few of any other.
        let is_ahead = corners.iter().all(|corner| corner.direction.z > 0.1);
        let nearness =
            corners.map(|corner| if is_ahead { corner.camera.z } else { corner.camera.length() }.recip());
        let range = |low: f64, high: f64, side: usize| {
            let first = (low - 0.5).ceil().max(0.0) as usize;
            first..((high - 0.5).floor() + 1.0).clamp(0.0, side as f64) as usize
        };
        let (columns, rows) = (range(low.x, high.x, self.width), range(low.y, high.y, self.height));
        let visits = columns.len() * rows.len();
        if visits > budget.visits {
            return;
        }
        budget.visits -= visits;
        for (y, x) in rows.flat_map(|y| columns.clone().map(move |x| (y, x))) {
            let place = DVec2::new(x as f64, y as f64) + 0.5;
            let first = (b - place).perp_dot(c - place) / area;
            let second = (c - place).perp_dot(a - place) / area;
            let weights = [first, second, 1.0 - first - second];
            if weights.iter().all(|weight| *weight >= -1e-9) {
                let shares = [0, 1, 2].map(|k| weights[k] * nearness[k]);
                let point: DVec3 = (0..3).map(|k| shares[k] * corners[k].camera).sum();
                let nearest = point.length() / shares.iter().sum::<f64>();
                let distance = &mut self.distances[y * self.width + x];
                *distance = distance.min(nearest as f32);
            }
        }
    }
}

/// What drawing may still cost.
struct Budget {
    parts: usize,
    visits: usize,
}

/// A corner in the camera's space, its direction, and its place in the map.
#[derive(Clone, Copy)]
struct Corner {
    camera: DVec3,
    direction: DVec3,
    pixel: Option<DVec2>,
}

impl Corner {
    /// `pixel` is that of the photograph.
    fn new(camera: DVec3, pixel: Option<DVec2>, factor: f64) -> Self {
        Self { camera, direction: camera.normalize_or_zero(), pixel: pixel.map(|pixel| pixel / factor) }
    }
}

/// The longest chord between the directions of a triangle's corners, and the corner at which its edge begins.
fn widest_edge(triangle: &[Corner; 3]) -> (f64, usize) {
    let chord = |edge: usize| triangle[edge].direction.distance_squared(triangle[(edge + 1) % 3].direction);
    let edge = (0..3).max_by(|a, b| chord(*a).total_cmp(&chord(*b))).unwrap_or(0);
    (chord(edge).sqrt(), edge)
}

/// The cone of directions that a lens may see.
struct FieldOfView {
    /// rad from the axis
    reach: f64,
    cos_reach: f64,
}

impl FieldOfView {
    /// rad, for what lies between the samples of the picture's border
    const MARGIN: f64 = 0.1;

    fn new(view: &View) -> Self {
        const STEPS: u32 = 16;
        let [width, height] = view.lens.size_px().map(f64::from);
        let border = (0..=STEPS).flat_map(|step| {
            let share = f64::from(step) / f64::from(STEPS);
            let (x, y) = (share * width, share * height);
            [DVec2::new(x, 0.0), DVec2::new(x, height), DVec2::new(0.0, y), DVec2::new(width, y)]
        });
        // Where a lens sees nothing at the border, its reach is unknown.
        let angle = |pixel: DVec2| {
            view.lens
                .unproject(pixel)
                .map_or(std::f64::consts::PI, |direction| direction.angle_between(DVec3::Z))
        };
        let reach = border.map(angle).fold(0.0, f64::max) + Self::MARGIN;
        let reach = reach.min(std::f64::consts::PI);
        Self { reach, cos_reach: reach.cos() }
    }

    /// Whether a direction is in the cone.
    fn contains(&self, camera: DVec3) -> bool {
        camera.z >= self.cos_reach * camera.length()
    }

    /// Whether a triangle may have a point in the cone.
    fn may_contain(&self, triangle: &[Corner; 3]) -> bool {
        let directions = triangle.map(|corner| corner.direction);
        let middle = directions[0] + directions[1] + directions[2];
        let radius = directions.iter().map(|direction| direction.angle_between(middle)).fold(0.0, f64::max);
        // Of a triangle that looks wide nothing is known.
        radius.is_nan() || radius > 1.0 || middle.angle_between(DVec3::Z) <= self.reach + radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat4;
    use lens::CalibratedLens;
    use scene::{LoadOptions, SurfaceMesh};

    fn view() -> View {
        View {
            name: "a".into(),
            picture: "a".into(),
            orientation: 1,
            exif_orientation: 1,
            lens: CalibratedLens::pinhole([60, 40], 50.0).unwrap(),
            camera_to_world: DMat4::IDENTITY,
            mask: None,
            exposure_hint: None,
        }
    }

    fn scene(positions: &[DVec3], triangles: &[[u32; 3]]) -> Scene {
        let mesh = SurfaceMesh {
            positions: positions.to_vec(),
            triangles: triangles.to_vec(),
            ..SurfaceMesh::default()
        };
        Scene::from_mesh(mesh, &LoadOptions::default()).unwrap()
    }

    #[test]
    fn a_plane_from_before_to_behind_the_camera() {
        // The ground, 2 below, much larger than what is seen: its corners are behind the camera or far away.
        let at = |x: f64, z: f64| DVec3::new(x, -2.0, z);
        let ground = [at(-900.0, 900.0), at(900.0, 900.0), at(900.0, -900.0), at(-900.0, -900.0)];
        let map = DistanceMap::new(&scene(&ground, &[[0, 1, 2], [0, 2, 3]]), &view(), 1.0);
        for y in [0, 10, 19] {
            assert_eq!(map.at(30, y), None, "{y} is above the horizon");
        }
        for (x, y) in [(30, 39), (0, 39), (59, 30), (12, 25)] {
            let direction = DVec3::new(x as f64 + 0.5 - 30.0, 20.0 - (y as f64 + 0.5), 50.0) / 50.0;
            let expected = direction.length() * 2.0 / -direction.y;
            let distance = map.at(x, y).unwrap();
            assert!((distance / expected - 1.0).abs() < 1e-6, "{x} {y}: {distance} instead of {expected}");
            let point = map.point(&view(), x, y).unwrap();
            assert!((point.y / -2.0 - 1.0).abs() < 1e-6, "{point}");
        }
    }

    #[test]
    fn what_is_behind_something_is_not_visible() {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let wall = |z: f64, half: f64| [at(-half, -half, z), at(half, -half, z), at(0.0, half, z)];
        let positions = [wall(-3.0, 0.5), wall(-6.0, 3.0)].concat();
        let map = DistanceMap::new(&scene(&positions, &[[0, 1, 2], [3, 4, 5]]), &view(), 2.0);
        assert_eq!([map.width, map.height], [30, 20]);
        assert!((map.at(15, 11).unwrap() - 3.0).abs() < 0.05, "{:?}", map.at(15, 11));
        let place = map.visible_at(&view(), at(0.0, -0.2, -3.0)).unwrap();
        assert!(place.abs_diff_eq(DVec2::new(15.0, 20.0 / 2.0 + 50.0 * 0.2 / 3.0 / 2.0), 1e-9), "{place}");
        assert_eq!(map.visible_at(&view(), at(0.0, -0.2, -6.0)), None);
        assert!(map.visible_at(&view(), at(1.5, -1.5, -6.0)).is_some());
        assert_eq!(map.visible_at(&view(), at(0.0, 0.0, 3.0)), None, "behind the camera");
        assert!(map.hits().count() > 50 && map.hits().all(|[x, y]| map.at(x, y).is_some()));
    }
}
