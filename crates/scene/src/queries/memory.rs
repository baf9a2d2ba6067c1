//! The memory that a scene takes.

use crate::texture::{Image, ImageLevel};
use crate::world::{Environment, World};
use crate::{PictureTexture, Scene};

impl Scene {
    /// The memory of its geometry, images and environments, in bytes.
    pub fn bytes(&self) -> usize {
        let uv: usize = self.uv.iter().chain(&self.further_uv).map(|set| size_of_val(&**set)).sum();
        size_of_val(&*self.positions)
            + size_of_val(&*self.normals)
            + uv
            + size_of_val(&*self.colors)
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.tangents)
            + self.images.iter().map(Image::bytes).sum::<usize>()
            + [&self.embedded_world, &self.world].into_iter().flatten().map(World::bytes).sum::<usize>()
            + self.splats.as_ref().map_or(0, |splats| splats.cloud.bytes() as usize)
            + self.picture.as_ref().map_or(0, PictureTexture::bytes)
    }
}

impl Image {
    fn bytes(&self) -> usize {
        match &self.texels {
            ImageLevel::Bits8(texels) => size_of_val(&**texels),
            ImageLevel::Bits16(texels) => size_of_val(&**texels),
            ImageLevel::Float(texels) => size_of_val(&**texels),
        }
    }
}

impl World {
    fn bytes(&self) -> usize {
        match &self.environment {
            Environment::Map(map) => size_of_val(&*map.texels),
            Environment::Uniform(_) => 0,
        }
    }
}

impl PictureTexture {
    fn bytes(&self) -> usize {
        size_of_val(&*self.is_photographed)
    }
}
