//! Where the triangles of an unwrapped scene lie in its atlas.

use serde_json::Value;

/// The atlas positions of a scene's triangles.
pub struct Unwrapped {
    /// The corners of each triangle, in the file's order.
    pub triangles: Vec<[[f32; 2]; 3]>,
}

/// Samples a side, at which overlaps are looked for.
const SAMPLES: usize = 2048;
/// A sample this close to an edge, as a share of the triangle, may belong to its neighbour.
const MARGIN: f64 = 1e-3;
/// A triangle that is lower than this many samples is not looked at: it has none that is safely inside.
const MIN_HEIGHT: f64 = 0.05;

impl Unwrapped {
    /// Reads the second UV set of the first mesh of a GLB; `None` if it has none.
    pub fn read(bytes: &[u8]) -> Option<Self> {
        let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?) as usize);
        let json = bytes.get(20..20 + word(12)?)?;
        let buffer = bytes.get(28 + word(12)?..)?;
        let scene: Value = serde_json::from_slice(json).ok()?;
        let mut triangles = Vec::new();
        for primitive in scene["meshes"][0]["primitives"].as_array()? {
            let set = index(&primitive["attributes"]["TEXCOORD_1"])?;
            let corners: Vec<[f32; 2]> = elements(&scene, buffer, set, 8)?
                .map(|bytes| [float(&bytes[..4]), float(&bytes[4..])])
                .collect();
            let order: Vec<usize> = match index(&primitive["indices"]) {
                None => (0..corners.len()).collect(),
                Some(accessor) => {
                    let size = match scene["accessors"][accessor]["componentType"].as_u64()? {
                        5121 => 1,
                        5123 => 2,
                        _ => 4,
                    };
                    let number =
                        |bytes: &[u8]| bytes.iter().rev().fold(0, |n, byte| n << 8 | usize::from(*byte));
                    elements(&scene, buffer, accessor, size)?.map(number).collect()
                }
            };
            for corner in order.chunks_exact(3) {
                triangles.push([
                    *corners.get(corner[0])?,
                    *corners.get(corner[1])?,
                    *corners.get(corner[2])?,
                ]);
            }
        }
        Some(Self { triangles })
    }

    /// Two triangles that cover the same place, if any do.
    pub fn overlapping(&self) -> Option<[usize; 2]> {
        let mut owners = vec![u32::MAX; SAMPLES * SAMPLES];
        for (index, corners) in self.triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|corner| corner.map(|c| f64::from(c) * SAMPLES as f64));
            let cross = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
                (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
            };
            let whole = cross(a, b, c);
            let length = |p: [f64; 2], q: [f64; 2]| (q[0] - p[0]).hypot(q[1] - p[1]);
            let longest = length(a, b).max(length(b, c)).max(length(c, a));
            if whole.abs() <= longest * MIN_HEIGHT {
                continue;
            }
            let range = |axis: usize| {
                let all = [a[axis], b[axis], c[axis]];
                let low = all.iter().fold(f64::INFINITY, |low, v| low.min(*v)).floor().max(0.0) as usize;
                let high = all.iter().fold(0.0f64, |high, v| high.max(*v)).ceil() as usize;
                low..high.min(SAMPLES)
            };
            for y in range(1) {
                for x in range(0) {
                    let p = [x as f64 + 0.5, y as f64 + 0.5];
                    let shares = [cross(p, b, c) / whole, cross(a, p, c) / whole, cross(a, b, p) / whole];
                    if shares.iter().any(|share| *share < MARGIN) {
                        continue;
                    }
                    let owner = &mut owners[y * SAMPLES + x];
                    if *owner != u32::MAX {
                        return Some([*owner as usize, index]);
                    }
                    *owner = index as u32;
                }
            }
        }
        None
    }
}

/// The area of a triangle in the atlas.
pub fn area([a, b, c]: &[[f32; 2]; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(|corner| corner.map(f64::from));
    ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs() / 2.0
}

fn index(value: &Value) -> Option<usize> {
    usize::try_from(value.as_u64()?).ok()
}

fn float(bytes: &[u8]) -> f32 {
    bytes.try_into().map_or(f32::NAN, f32::from_le_bytes)
}

/// The elements of an accessor, each of `size` bytes.
fn elements<'a>(
    scene: &Value,
    buffer: &'a [u8],
    accessor: usize,
    size: usize,
) -> Option<impl Iterator<Item = &'a [u8]> + use<'a>> {
    let accessor = &scene["accessors"][accessor];
    let view = &scene["bufferViews"][index(&accessor["bufferView"])?];
    let offset = |of: &Value| index(&of["byteOffset"]).unwrap_or(0);
    let start = offset(view) + offset(accessor);
    let stride = index(&view["byteStride"]).unwrap_or(size);
    let count = index(&accessor["count"])?;
    let end = start + count.checked_sub(1)? * stride + size;
    let bytes = buffer.get(start..end)?;
    Some((0..count).map(move |k| &bytes[k * stride..k * stride + size]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_overlap_is_found_and_a_shared_edge_is_none() {
        let half = [[0.1, 0.1], [0.5, 0.1], [0.1, 0.5]];
        let other_half = [[0.5, 0.1], [0.5, 0.5], [0.1, 0.5]];
        let within = [[0.12, 0.12], [0.2, 0.12], [0.12, 0.2]];
        assert_eq!(Unwrapped { triangles: vec![half, other_half] }.overlapping(), None);
        assert_eq!(Unwrapped { triangles: vec![other_half, half, within] }.overlapping(), Some([1, 2]));
    }
}
