//! The light sheet: one texture in which every surface has a block of its own, so that its texture
//! coordinates serve as the atlas for painting too.

use super::light::{Facing, Lamp, Lighting};
use super::rays::Rays;
use super::surface::{Object, Shine, Surface};
use glam::{Vec2, Vec3};

/// Texels kept free around a block.
const GAP: usize = 2;

/// A block: upper left corner and size in texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Column of its first texel.
    pub x: usize,
    /// Row of its first texel.
    pub y: usize,
    /// Columns and rows.
    pub size: [usize; 2],
}

/// The layout of the surfaces.
pub struct Sheet {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// For each object, for each of its surfaces.
    pub blocks: Vec<Vec<Block>>,
}

impl Sheet {
    /// Lays the surfaces of all objects out, the tallest first.
    pub fn new(objects: &[Object], width: usize) -> Self {
        let mut places: Vec<(usize, usize)> = Vec::new();
        for (o, object) in objects.iter().enumerate() {
            places.extend((0..object.surfaces.len()).map(|s| (o, s)));
        }
        let size = |&(o, s): &(usize, usize)| objects[o].surfaces[s].texels;
        places.sort_by_key(|place| (std::cmp::Reverse(size(place)[1]), std::cmp::Reverse(size(place)[0])));
        let empty = Block { x: 0, y: 0, size: [0, 0] };
        let mut blocks: Vec<Vec<Block>> = objects.iter().map(|o| vec![empty; o.surfaces.len()]).collect();
        // The skyline: how far down each column is taken. A block goes where its top is highest.
        let mut taken = vec![0usize; width];
        for place in &places {
            let [w, h] = size(place).map(|n| n + 2 * GAP);
            let top_at = |x: usize| (taken[x..x + w].iter().copied().max().unwrap_or(0), x);
            let (y, x) = (0..=width - w).map(top_at).min().expect("a block is narrower than the sheet");
            taken[x..x + w].fill(y + h);
            blocks[place.0][place.1] = Block { x: x + GAP, y: y + GAP, size: size(place) };
        }
        let height = taken.into_iter().max().unwrap_or(0);
        Self { width, height: height.next_multiple_of(16), blocks }
    }

    /// The texture coordinates of (u, v) in a block: from the centre of its first texel to that of its last,
    /// so that filtering never reads beyond it.
    pub fn texture_uv(&self, block: &Block, uv: Vec2) -> Vec2 {
        let along = |start: usize, size: usize, t: f32| start as f32 + 0.5 + t * (size - 1) as f32;
        Vec2::new(
            along(block.x, block.size[0], uv.x) / self.width as f32,
            along(block.y, block.size[1], uv.y) / self.height as f32,
        )
    }

    /// Bakes the light: 8-bit sRGB, row 0 on top.
    pub fn bake(&self, objects: &[Object], lamps: &[Lamp], eye: Vec3, sky_rays: usize) -> Vec<u8> {
        let (triangles, facing) = gather(objects);
        let rays = Rays::new(&triangles);
        let lighting = Lighting { rays: &rays, facing: &facing, lamps, eye, sky_rays };
        let jobs: Vec<(&Surface, Block)> = objects
            .iter()
            .zip(&self.blocks)
            .filter(|(object, _)| matches!(object.shine, Shine::Baked))
            .flat_map(|(object, blocks)| object.surfaces.iter().zip(blocks.iter().copied()))
            .collect();
        let next = std::sync::atomic::AtomicUsize::new(0);
        let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
        let baked: Vec<(Block, Vec<Vec3>)> = std::thread::scope(|scope| {
            let worker = || {
                let mut done = Vec::new();
                while let Some((surface, block)) =
                    jobs.get(next.fetch_add(1, std::sync::atomic::Ordering::Relaxed))
                {
                    done.push((*block, bake_block(surface, block, &lighting)));
                }
                done
            };
            let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
            workers.into_iter().flat_map(|w| w.join().expect("a baking thread ended")).collect()
        });
        let mut sheet = vec![0u8; self.width * self.height * 3];
        for (block, radiance) in &baked {
            self.write(&mut sheet, block, radiance);
        }
        sheet
    }

    /// Writes a block and repeats its rim into half the gap.
    fn write(&self, sheet: &mut [u8], block: &Block, radiance: &[Vec3]) {
        let [w, h] = block.size;
        for j in 0..h + 2 {
            for i in 0..w + 2 {
                let from = radiance[j.saturating_sub(1).min(h - 1) * w + i.saturating_sub(1).min(w - 1)];
                let to = (block.y + j - 1) * self.width + block.x + i - 1;
                let encoded = shoulder(from).to_array().map(encode);
                sheet[to * 3..to * 3 + 3].copy_from_slice(&encoded);
            }
        }
    }
}

fn bake_block(surface: &Surface, block: &Block, lighting: &Lighting) -> Vec<Vec3> {
    let [w, h] = block.size;
    let at = |i: usize, n: usize| if n > 1 { i as f32 / (n - 1) as f32 } else { 0.5 };
    (0..w * h)
        .map(|k| {
            let place = surface.place(Vec2::new(at(k % w, w), at(k / w, h)));
            let skin = (surface.shader)(&place);
            let seed = ((block.y + k / w) * 4096 + block.x + k % w) as i32;
            lighting.radiance(&place, &skin, surface.thin, seed)
        })
        .collect()
}

/// All triangles, with the appearance of each.
fn gather(objects: &[Object]) -> (Vec<[Vec3; 3]>, Vec<Facing>) {
    let (mut triangles, mut facing) = (Vec::new(), Vec::new());
    for object in objects {
        for surface in &object.surfaces {
            for corners in surface.triangles() {
                triangles.push(corners.map(|i| surface.points[i as usize]));
                let uv = corners.iter().map(|&i| surface.uv_of(i as usize)).sum::<Vec2>() / 3.0;
                let skin = (surface.shader)(&surface.place(uv));
                let glow = match object.shine {
                    Shine::Baked => skin.glow,
                    Shine::Emitter(color, strength) => color * strength,
                };
                facing.push(Facing { albedo: skin.albedo, glow });
            }
        }
    }
    (triangles, facing)
}

/// Compresses values above 0.6 smoothly to below 1, the maximum of an unlit texture.
fn shoulder(radiance: Vec3) -> Vec3 {
    let bend = |x: f32| if x <= 0.6 { x } else { 0.6 + 0.4 * (1.0 - (-(x - 0.6) / 0.4).exp()) };
    Vec3::from_array(radiance.max(Vec3::ZERO).to_array().map(bend))
}

/// 8-bit sRGB of a linear value.
fn encode(linear: f32) -> u8 {
    let encoded = if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (encoded.clamp(0.0, 1.0) * 255.0).round() as u8
}
