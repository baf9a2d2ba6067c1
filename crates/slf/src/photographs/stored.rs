//! Light from photographs as bytes, for the program that made it: lists as they lie in memory, each behind its length (u64).

use super::PhotographLight;
use super::alignment::Displacement;
use super::exposures::Exposure;
use super::odd::Belonging;
use super::places::{Blocks, Sphere, TexelGrid};
use super::telling::{Believed, Kernel, Mirrored, Residuals};
use atlas::NO_TEXEL;
use bytemuck::{Pod, Zeroable, pod_collect_to_vec};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;
use trace::Tracer;

const MAGIC: &[u8; 8] = b"FBPHOTO3";

/// What is there once.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Head {
    scale: f64,
    width: u32,
    height: u32,
    reach: f32,
    noise: f32,
    beyond_rows: u32,
    mirrored_rows: u32,
}

impl PhotographLight {
    /// All of it, without the scene. Only a program that keeps it alike (the same build) can read it.
    pub fn to_bytes(&self) -> Vec<u8> {
        let (grid, kernel) = (&self.grid, self.residuals.kernel);
        let head = Head {
            scale: grid.scale,
            width: grid.width,
            height: grid.height,
            reach: kernel.reach,
            noise: kernel.noise,
            beyond_rows: self.sphere.rows as u32,
            mirrored_rows: self.mirrored.sphere.rows as u32,
        };
        let mut bytes = MAGIC.to_vec();
        bytes.extend(bytemuck::bytes_of(&head));
        add(&mut bytes, grid.corners.as_flattened());
        add(&mut bytes, &grid.index);
        add(&mut bytes, &self.exposures);
        add(&mut bytes, &self.eyes);
        self.displacements.iter().for_each(|displacement| add(&mut bytes, displacement.nodes()));
        self.belonging.iter().for_each(|belonging| add(&mut bytes, belonging.tiles()));
        add(&mut bytes, &self.constant);
        add(&mut bytes, &self.seen);
        add(&mut bytes, &self.seeing);
        let Believed { share, belief, errors } = &self.residuals.believed;
        [share, belief, errors].into_iter().for_each(|list| add(&mut bytes, list));
        add(&mut bytes, &self.residuals.start);
        add(&mut bytes, &self.residuals.all);
        add(&mut bytes, &self.mirrored.surroundings);
        add(&mut bytes, &self.mirrored.strength);
        add(&mut bytes, &self.mirrored.strength_of_block);
        add(&mut bytes, &self.beyond);
        bytes
    }

    /// The light of the scene in `tracer` from the bytes of [`Self::to_bytes`]; none if they are no such, or of another scene.
    pub fn from_bytes(bytes: &[u8], tracer: &Arc<Tracer>) -> Option<Self> {
        let scene = tracer.scene();
        let rest = bytes.strip_prefix(MAGIC)?;
        let (head, mut rest) = rest.split_at_checked(size_of::<Head>())?;
        let head: Head = bytemuck::pod_read_unaligned(head);
        let corners: Vec<Vec2> = list(&mut rest)?;
        let index = list(&mut rest)?;
        let exposures: Vec<Exposure> = list(&mut rest)?;
        let eyes: Vec<DVec3> = list(&mut rest)?;
        let mut of_view = |view| Displacement::of_nodes(view, list(&mut rest)?);
        let displacements = scene.views.iter().map(&mut of_view).collect::<Option<Vec<_>>>()?;
        let mut of_view = |view| Belonging::of_tiles(view, list(&mut rest)?);
        let belonging = scene.views.iter().map(&mut of_view).collect::<Option<Vec<_>>>()?;
        let constant: Vec<Vec3> = list(&mut rest)?;
        let (seen, seeing): (Vec<f32>, Vec<u16>) = (list(&mut rest)?, list(&mut rest)?);
        let (share, belief, errors) = (list(&mut rest)?, list(&mut rest)?, list(&mut rest)?);
        let believed = Believed { share, belief, errors };
        let (start, all) = (list(&mut rest)?, list(&mut rest)?);
        let (surroundings, strength) = (list(&mut rest)?, list(&mut rest)?);
        let strength_of_block = list(&mut rest)?;
        let beyond = list(&mut rest)?;
        let kernel = Kernel { reach: head.reach, noise: head.noise };
        let light = Self {
            tracer: tracer.clone(),
            grid: TexelGrid {
                scale: head.scale,
                width: head.width,
                height: head.height,
                corners: corners.as_chunks::<3>().0.to_vec(),
                index,
            },
            exposures,
            eyes,
            displacements,
            belonging,
            constant,
            seen,
            seeing,
            residuals: Residuals { kernel, believed, start, all },
            sphere: Sphere::of_rows(head.beyond_rows as usize),
            beyond,
            mirrored: Mirrored {
                sphere: Sphere::of_rows(head.mirrored_rows as usize),
                surroundings,
                strength,
                strength_of_block,
            },
        };
        (rest.is_empty() && light.holds_together()).then_some(light)
    }

    /// Whether no list leads beyond the end of another.
    fn holds_together(&self) -> bool {
        let (texels, views) = (self.constant.len(), self.tracer.scene().views.len());
        let (grid, residuals) = (&self.grid, &self.residuals);
        let Believed { share, belief, errors } = &residuals.believed;
        let by_block = [share.len(), belief.len(), errors.len(), self.mirrored.strength_of_block.len()];
        let blocks = Blocks::of([grid.width, grid.height]).count();
        grid.corners.len() == self.tracer.scene().triangles.len()
            && grid.index.len() as u64 == u64::from(grid.width) * u64::from(grid.height)
            && grid.index.iter().all(|&texel| texel == NO_TEXEL || (texel as usize) < texels)
            && [self.exposures.len(), self.eyes.len()] == [views; 2]
            && [self.seen.len(), self.seeing.len(), self.mirrored.strength.len()] == [texels; 3]
            && (by_block == [blocks; 4] || by_block == [0; 4])
            && residuals.start.len() == texels + 1
            && residuals.start.is_sorted()
            && residuals.start[texels] as usize == residuals.all.len()
            && residuals.all.iter().all(|residual| usize::from(residual.view) < views)
            && self.beyond.len() == self.sphere.count()
            && self.mirrored.surroundings.len() == self.mirrored.sphere.count()
    }
}

fn add<T: Pod>(bytes: &mut Vec<u8>, list: &[T]) {
    bytes.extend((list.len() as u64).to_le_bytes());
    bytes.extend(bytemuck::cast_slice::<T, u8>(list));
}

fn list<T: Pod>(rest: &mut &[u8]) -> Option<Vec<T>> {
    let (length, after) = rest.split_first_chunk()?;
    let size = usize::try_from(u64::from_le_bytes(*length)).ok()?.checked_mul(size_of::<T>())?;
    let (list, after) = after.split_at_checked(size)?;
    *rest = after;
    Some(pod_collect_to_vec(list))
}
