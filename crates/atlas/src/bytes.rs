//! The atlas as bytes, for the project file.
//!
//! Little endian: `FBATLAS1`, width, height, triangles, charts (u32 each), density (f64); six f32 per triangle
//! (corners), u32 per triangle (chart), u32 per chart (part); the 64 hex digits of the hash.

use crate::atlas::hash_of;
use crate::{Atlas, AtlasError, MAX_SIDE};
use glam::Vec2;
use scene::Scene;

const MAGIC: &[u8; 8] = b"FBATLAS1";

impl Atlas {
    /// The atlas as stored on disk; read by [`Self::from_bytes`].
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(96 + 28 * self.corners.len() + 4 * self.charts.len());
        bytes.extend(MAGIC);
        let counts = [self.width, self.height, self.corners.len() as u32, self.charts.len() as u32];
        bytes.extend(counts.into_iter().flat_map(u32::to_le_bytes));
        bytes.extend(self.density.to_le_bytes());
        bytes.extend(self.corners.iter().flatten().flat_map(|c| [c.x, c.y]).flat_map(f32::to_le_bytes));
        bytes.extend(self.chart_of.iter().flat_map(|c| c.to_le_bytes()));
        bytes.extend(self.charts.iter().flat_map(|c| c.part.to_le_bytes()));
        bytes.extend(self.hash.as_bytes());
        bytes
    }

    /// Reads an atlas from its stored form, if it is complete and fits the scene.
    ///
    /// # Errors
    /// [`AtlasError::Stored`] if the bytes are damaged or belong to another scene.
    pub fn from_bytes(bytes: &[u8], scene: &Scene) -> Result<Self, AtlasError> {
        let wrong = |reason: &str| AtlasError::Stored { reason: reason.to_owned() };
        let mut reader = Reader { rest: bytes };
        if reader.take(MAGIC.len()).map_err(wrong)? != MAGIC {
            return Err(wrong("it does not start with the header of one"));
        }
        let [width, height, triangles, charts] = reader.numbers(u32::from_le_bytes).map_err(wrong)?;
        let [density] = reader.numbers(f64::from_le_bytes).map_err(wrong)?;
        if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
            return Err(wrong(&format!("{width}×{height} is not a valid size of an atlas")));
        }
        if triangles as usize != scene.triangles.len() {
            let expected = scene.triangles.len();
            return Err(wrong(&format!(
                "it is of another scene: {triangles} triangles instead of {expected}"
            )));
        }
        if !(density > 0.0 && density.is_finite()) {
            return Err(wrong("its density is not above zero"));
        }
        let corners =
            reader.list(triangles, 24, |c| [0, 8, 16].map(|at| Vec2::new(f32_at(c, at), f32_at(c, at + 4))));
        let corners = corners.map_err(wrong)?;
        let chart_of = reader.list(triangles, 4, u32_at).map_err(wrong)?;
        let part_of_chart = reader.list(charts, 4, u32_at).map_err(wrong)?;
        let hash = reader.take(64).map_err(wrong)?;
        if !reader.rest.is_empty() {
            return Err(wrong("there are bytes after its end"));
        }
        let size = Vec2::new(width as f32, height as f32);
        // Written so that NaN fails.
        if !corners.iter().flatten().all(|c| c.cmpge(Vec2::ZERO).all() && c.cmple(size).all()) {
            return Err(wrong("a corner lies outside"));
        }
        for (triangle, &chart) in scene.triangles.iter().zip(&chart_of) {
            if part_of_chart.get(chart as usize) != Some(&triangle.part) {
                return Err(wrong("a triangle lies in a chart of another part: it is of another scene"));
            }
        }
        if part_of_chart.iter().any(|&part| part as usize >= scene.parts.len()) {
            return Err(wrong("a chart belongs to no part"));
        }
        if hash_of(width, height, &corners).as_bytes() != hash {
            return Err(wrong("its checksum is wrong"));
        }
        Ok(Atlas::new([width, height], corners, chart_of, &part_of_chart, density))
    }
}

struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], &'static str> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or("it ends too early")?;
        self.rest = rest;
        Ok(taken)
    }

    fn numbers<T, const BYTES: usize, const COUNT: usize>(
        &mut self,
        decode: fn([u8; BYTES]) -> T,
    ) -> Result<[T; COUNT], &'static str> {
        let bytes = self.take(BYTES * COUNT)?;
        Ok(std::array::from_fn(|i| decode(std::array::from_fn(|k| bytes[i * BYTES + k]))))
    }

    fn list<T>(
        &mut self,
        count: u32,
        size: usize,
        decode: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, &'static str> {
        let bytes = (count as usize).checked_mul(size).ok_or("it ends too early")?;
        Ok(self.take(bytes)?.chunks_exact(size).map(decode).collect())
    }
}

fn u32_at(bytes: &[u8]) -> u32 {
    u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
}

fn f32_at(bytes: &[u8], at: usize) -> f32 {
    f32::from_bits(u32_at(&bytes[at..]))
}
