//! Binary form of light from photographs, for the program that made it: lists as they lie in memory, each preceded by
//! its length (u64).

use super::PhotographLight;
use super::alignment::Displacement;
use super::exposures::Exposure;
use super::fitting::{CrossValidation, Kernel, Mirrored, Residuals};
use super::texels::{DirectionGrid, TexelBlocks, TexelGrid};
use super::transients::InlierMap;
use atlas::NO_TEXEL;
use bytemuck::{Pod, Zeroable, pod_collect_to_vec};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;
use trace::Tracer;

const MAGIC: &[u8; 8] = b"FBPHOTO3";

/// Fixed-size header.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Head {
    scale: f64,
    width: u32,
    height: u32,
    reach: f32,
    noise: f32,
    background_rows: u32,
    mirrored_rows: u32,
}

impl PhotographLight {
    /// Serialises everything except the scene, uncompressed. Only the same build can read it.
    pub fn to_bytes(&self) -> Vec<u8> {
        let (grid, kernel) = (&self.grid, self.residuals.kernel);
        let head = Head {
            scale: grid.scale,
            width: grid.width,
            height: grid.height,
            reach: kernel.reach,
            noise: kernel.noise,
            background_rows: self.sphere.rows as u32,
            mirrored_rows: self.mirrored.sphere.rows as u32,
        };
        let mut bytes = MAGIC.to_vec();
        bytes.extend(bytemuck::bytes_of(&head));
        write_list(&mut bytes, grid.corners.as_flattened());
        write_list(&mut bytes, &grid.index);
        write_list(&mut bytes, &self.exposures);
        write_list(&mut bytes, &self.eyes);
        self.displacements.iter().for_each(|displacement| write_list(&mut bytes, displacement.nodes()));
        self.inlier_maps.iter().for_each(|inlier_map| write_list(&mut bytes, inlier_map.tiles()));
        write_list(&mut bytes, &self.constant);
        write_list(&mut bytes, &self.observed_share);
        write_list(&mut bytes, &self.observation_counts);
        let CrossValidation { mirrored_share, confidence, errors } = &self.residuals.cross_validation;
        [mirrored_share, confidence, errors].into_iter().for_each(|list| write_list(&mut bytes, list));
        write_list(&mut bytes, &self.residuals.start);
        write_list(&mut bytes, &self.residuals.all);
        write_list(&mut bytes, &self.mirrored.surroundings);
        write_list(&mut bytes, &self.mirrored.strength);
        write_list(&mut bytes, &self.mirrored.strength_of_block);
        write_list(&mut bytes, &self.background);
        bytes
    }

    /// Restores the light of the scene in `tracer` from the bytes of [`Self::to_bytes`]; `None` if they are malformed
    /// or of another scene.
    pub fn from_bytes(bytes: &[u8], tracer: &Arc<Tracer>) -> Option<Self> {
        let scene = tracer.scene();
        let rest = bytes.strip_prefix(MAGIC)?;
        let (head, mut rest) = rest.split_at_checked(size_of::<Head>())?;
        let head: Head = bytemuck::pod_read_unaligned(head);
        let corners: Vec<Vec2> = read_list(&mut rest)?;
        let index = read_list(&mut rest)?;
        let exposures: Vec<Exposure> = read_list(&mut rest)?;
        let eyes: Vec<DVec3> = read_list(&mut rest)?;
        let mut read_displacement = |view| Displacement::from_nodes(view, read_list(&mut rest)?);
        let displacements = scene.views.iter().map(&mut read_displacement).collect::<Option<Vec<_>>>()?;
        let mut read_inlier_map = |view| InlierMap::from_tiles(view, read_list(&mut rest)?);
        let inlier_maps = scene.views.iter().map(&mut read_inlier_map).collect::<Option<Vec<_>>>()?;
        let constant: Vec<Vec3> = read_list(&mut rest)?;
        let (observed_share, observation_counts): (Vec<f32>, Vec<u16>) =
            (read_list(&mut rest)?, read_list(&mut rest)?);
        let (mirrored_share, confidence, errors) =
            (read_list(&mut rest)?, read_list(&mut rest)?, read_list(&mut rest)?);
        let cross_validation = CrossValidation { mirrored_share, confidence, errors };
        let (start, all) = (read_list(&mut rest)?, read_list(&mut rest)?);
        let (surroundings, strength) = (read_list(&mut rest)?, read_list(&mut rest)?);
        let strength_of_block = read_list(&mut rest)?;
        let background = read_list(&mut rest)?;
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
            inlier_maps,
            constant,
            observed_share,
            observation_counts,
            residuals: Residuals { kernel, cross_validation, start, all },
            sphere: DirectionGrid::with_rows(head.background_rows as usize),
            background,
            mirrored: Mirrored {
                sphere: DirectionGrid::with_rows(head.mirrored_rows as usize),
                surroundings,
                strength,
                strength_of_block,
            },
        };
        (rest.is_empty() && light.is_consistent()).then_some(light)
    }

    /// Whether the sizes and indices of all lists are consistent.
    fn is_consistent(&self) -> bool {
        let (texels, views) = (self.constant.len(), self.tracer.scene().views.len());
        let (grid, residuals) = (&self.grid, &self.residuals);
        let CrossValidation { mirrored_share, confidence, errors } = &residuals.cross_validation;
        let by_block =
            [mirrored_share.len(), confidence.len(), errors.len(), self.mirrored.strength_of_block.len()];
        let blocks = TexelBlocks::new([grid.width, grid.height]).count();
        grid.corners.len() == self.tracer.scene().triangles.len()
            && grid.index.len() as u64 == u64::from(grid.width) * u64::from(grid.height)
            && grid.index.iter().all(|&texel| texel == NO_TEXEL || (texel as usize) < texels)
            && [self.exposures.len(), self.eyes.len()] == [views; 2]
            && [self.observed_share.len(), self.observation_counts.len(), self.mirrored.strength.len()]
                == [texels; 3]
            && (by_block == [blocks; 4] || by_block == [0; 4])
            && residuals.start.len() == texels + 1
            && residuals.start.is_sorted()
            && residuals.start[texels] as usize == residuals.all.len()
            && residuals.all.iter().all(|residual| usize::from(residual.view) < views)
            && self.background.len() == self.sphere.count()
            && self.mirrored.surroundings.len() == self.mirrored.sphere.count()
    }
}

fn write_list<T: Pod>(bytes: &mut Vec<u8>, list: &[T]) {
    bytes.extend((list.len() as u64).to_le_bytes());
    bytes.extend(bytemuck::cast_slice::<T, u8>(list));
}

fn read_list<T: Pod>(rest: &mut &[u8]) -> Option<Vec<T>> {
    let (length, after) = rest.split_first_chunk()?;
    let size = usize::try_from(u64::from_le_bytes(*length)).ok()?.checked_mul(size_of::<T>())?;
    let (list, after) = after.split_at_checked(size)?;
    *rest = after;
    Some(pod_collect_to_vec(list))
}
