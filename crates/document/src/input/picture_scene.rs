//! The surface of a picture as a scene, with the picture as its texture, and its atlas.
//!
//! ```text
//! 1/z = (d + o)/s        x = z·(p_x − c_x)/f        y = −z·(p_y − c_y)/f
//! ```
//!
//! | symbol | meaning | unit |
//! | --- | --- | --- |
//! | d, o | disparity, and the offset that makes all 1/z > 0 | px per step |
//! | s | disparity at distance 1, without offset: f·b, where b is the distance between views | px per step |
//! | p, c | position in the picture, and its centre | px |
//! | f | focal length | px |
//! | x, y, z | position to the right, upward, ahead of the camera | scene units |

use crate::input::picture_regions::triangle_regions;
use atlas::Atlas;
use glam::{DMat4, DVec3, Mat3, Vec2};
use lens::Camera;
use rayon::prelude::*;
use relief::{GLOSS_TERMS, Gloss, Relief, TEXTURE_LAYERS};
use scene::{
    AlphaMode, CameraLens, Image, ImageLevel, Material, Node, Part, PictureGloss, PictureTexture, Scene,
    SceneCamera, TextureRef, Triangle, Wrap, srgb_from_linear,
};
use std::path::Path;
use std::sync::Arc;

/// The mapping from disparities to distances, and from pixels to directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PictureSpace {
    /// Focal length f, px.
    pub focal_px: f64,
    /// Disparity offset o, px per step.
    pub offset: f64,
    /// Disparity at distance 1, s > 0, px per step.
    pub scale: f64,
}

impl PictureSpace {
    /// The inverse depth 1/z (1/scene unit) of a disparity, px between neighbouring views.
    pub fn inverse_depth(&self, disparity: f64) -> f64 {
        (disparity + self.offset) / self.scale
    }

    /// The distance between neighbouring views, scene units.
    pub fn baseline(&self) -> f64 {
        self.scale / self.focal_px
    }
}

/// Depth of the nearest point if distances are unknown.
const NEAREST_DISTANCE: f64 = 1.0;
/// Depth of the farthest point if distances are unknown.
const FARTHEST_DISTANCE: f64 = 5.0;

/// The space for disparities in a range, low to high, with unknown scale and offset.
pub(crate) fn uncalibrated_space([low, high]: [f64; 2], focal_px: f64) -> PictureSpace {
    // A picture of one depth is a plane at the nearest distance.
    let range = if high > low { high - low } else { 1.0 };
    let scale = range / (1.0 / NEAREST_DISTANCE - 1.0 / FARTHEST_DISTANCE);
    PictureSpace { focal_px, scale, offset: scale / NEAREST_DISTANCE - high }
}

/// Name and origin of a surface.
pub(crate) struct SurfaceSource<'a> {
    pub name: &'a str,
    pub path: &'a Path,
    /// See [`PictureTexture::origin`].
    pub origin: String,
}

/// The picture that a surface was made from, which may be finer than the surface.
pub(crate) struct SourcePicture<'a> {
    /// Linear RGB, row by row.
    pub pixels: &'a [[f32; 3]],
    /// Columns and rows.
    pub size: [usize; 2],
    /// Side of a cell of the surface, px; the last cells may extend beyond the picture.
    pub cell_px: usize,
}

impl SourcePicture<'_> {
    /// Columns and rows, in cells.
    fn size_in_cells(&self) -> Vec2 {
        Vec2::new(self.size[0] as f32, self.size[1] as f32) / self.cell_px as f32
    }
}

/// The scene of a surface. Pixels of `space` are cells of the surface; the camera focuses on `focus_disparity`.
pub(crate) fn picture_scene(
    relief: &Relief,
    source_picture: &SourcePicture<'_>,
    space: &PictureSpace,
    source: &SurfaceSource<'_>,
    focus_disparity: f64,
) -> Scene {
    let [width, height] = relief.size;
    let layer_stride_rows = height + PictureTexture::GUTTER as usize;
    let rows = height + (TEXTURE_LAYERS - 1) * layer_stride_rows;
    let margin = relief.margin as f32;
    let center = source_picture.size_in_cells() / 2.0;
    let position = |place: Vec2, disparity: f32| {
        let z = 1.0 / space.inverse_depth(f64::from(disparity));
        let lateral = ((place - center).as_dvec2() * z) / space.focal_px;
        DVec3::new(lateral.x, -lateral.y, -z)
    };
    let uv = |place: Vec2, layer: u8| {
        let (column, row) =
            (place.x + margin, place.y + margin + f32::from(layer) * layer_stride_rows as f32);
        Vec2::new(column / width as f32, row / rows as f32)
    };
    let positions = relief.vertices.iter().map(|vertex| position(vertex.place, vertex.disparity)).collect();
    let (image, brightest) = texture_image(relief, source_picture, layer_stride_rows, rows);
    let texture = TextureRef {
        image: 0,
        is_color: true,
        uv_set: 0,
        transform: Mat3::IDENTITY,
        wrap: [Wrap::Clamp; 2],
        // Pixels are constant over their area: averaged over a pixel, the texture is the picture again.
        nearest: true,
    };
    let material = Material {
        name: source.name.into(),
        base_color: glam::Vec3::splat(brightest).extend(1.0),
        base_color_texture: Some(texture),
        alpha: AlphaMode::Opaque,
        ..Material::unlit_white()
    };
    let translucent = Material { alpha: AlphaMode::Blend, ..material.clone() };
    let (mut triangles, mut parts) = (Vec::new(), Vec::new());
    // Translucent triangles have a material of their own, so that the opacity of others need not be looked up.
    for (material_index, triangle_vertices) in
        [&relief.triangles, &relief.translucent].into_iter().enumerate()
    {
        let (material_index, first) = (material_index as u32, triangles.len() as u32);
        if material_index > 0 && triangle_vertices.is_empty() {
            continue;
        }
        triangles
            .extend(triangle_vertices.iter().map(|&vertices| Triangle { vertices, part: material_index }));
        parts.push(Part {
            node: 0,
            material: material_index,
            triangles: first..triangles.len() as u32,
            has_uv: [true, false],
            mirrored: false,
        });
    }
    let materials = [material, translucent].into_iter().take(parts.len()).collect();
    let camera = SceneCamera {
        name: "picture".into(),
        index: None,
        camera_to_world: DMat4::IDENTITY,
        yfov: 2.0 * (f64::from(center.y) / space.focal_px).atan(),
        aspect: Some(f64::from(center.x / center.y)),
        focus_distance: 1.0 / space.inverse_depth(focus_disparity),
        lens: CameraLens::default(),
    };
    Scene {
        path: source.path.into(),
        positions,
        normals: vec![glam::Vec3::ZERO; relief.vertices.len()],
        uv: [relief.vertices.iter().map(|vertex| uv(vertex.place, vertex.layer)).collect(), Vec::new()],
        triangles,
        parts,
        nodes: vec![Node { name: source.name.into(), index: 0, world: DMat4::IDENTITY }],
        materials,
        images: vec![image],
        cameras: vec![camera],
        picture: Some(PictureTexture {
            size: [width as u32, rows as u32],
            behind_first_row: layer_stride_rows as u32,
            margin: relief.margin as u32,
            pixels_per_texel: source_picture.cell_px as u32,
            origin: source.origin.clone(),
            is_photographed: stack_layers(&relief.is_observed, relief.size, layer_stride_rows, rows, true),
            gloss: relief.gloss.as_ref().map(|gloss| Arc::new(gloss_in_scene_units(gloss, space))),
        }),
        ..Scene::default()
    }
}

/// The camera of the picture, of `size` pixels, with an aperture radius of `radius` steps between views.
pub(crate) fn picture_camera(scene: &Scene, size: [u32; 2], space: &PictureSpace, radius: f64) -> Camera {
    let SceneCamera { camera_to_world, yfov, focus_distance, .. } = scene.cameras[0];
    Camera {
        width: size[0],
        height: size[1],
        yfov,
        focus_distance,
        camera_to_world,
        aperture_radius: radius * space.baseline(),
        ..Camera::default()
    }
}

/// The atlas of a picture's surface, which is its texture; `None` for other scenes. Its charts are the regions that are connected in depth.
pub(crate) fn picture_atlas(scene: &Scene) -> Option<Atlas> {
    let picture = scene.picture.as_ref()?;
    let size = Vec2::new(picture.size[0] as f32, picture.size[1] as f32);
    let corners: Vec<[Vec2; 3]> = scene
        .triangles
        .iter()
        .map(|triangle| triangle.vertices.map(|v| scene.uv[0][v as usize] * size))
        .collect();
    let (chart_of, count) = triangle_regions(scene, &corners);
    // Texels per unit of length at the focus distance.
    let camera = scene.cameras.first()?;
    let height = 2.0 * camera.focus_distance * (0.5 * camera.yfov).tan();
    let density = f64::from(picture.picture_size()[1]) / height;
    Some(Atlas::new(picture.size, corners, chart_of, &vec![0; count], density))
}

/// The gloss of a surface, in the scene's units.
fn gloss_in_scene_units(gloss: &Gloss, space: &PictureSpace) -> PictureGloss {
    const { assert!(GLOSS_TERMS == PictureGloss::TERMS && Gloss::NONE == PictureGloss::NO_POLYNOMIAL) };
    PictureGloss {
        block_size: gloss.block as u32,
        block_counts: gloss.blocks.map(|side| side as u32),
        aperture_half_extent: gloss.reach.map(|steps| f64::from(steps) * space.baseline()),
        polynomial_of_block: gloss.numbers.clone(),
        polynomials: gloss.polynomials.clone(),
    }
}

/// Values per texel of all layers, row by row of the whole texture; rows between layers have `gap_value`.
fn stack_layers<T: Copy>(
    layers: &[T],
    [width, height]: [usize; 2],
    layer_stride_rows: usize,
    rows: usize,
    gap_value: T,
) -> Vec<T> {
    let mut stacked = vec![gap_value; width * rows];
    for (layer, values) in layers.chunks_exact(width * height).enumerate() {
        let first = layer * layer_stride_rows * width;
        stacked[first..first + values.len()].copy_from_slice(values);
    }
    stacked
}

/// The texture, sRGB-encoded and divided by its brightest value, if that is above white; returned with that value. The picture has its full
/// resolution, the surface around and behind it that of the cells.
fn texture_image(
    relief: &Relief,
    source_picture: &SourcePicture<'_>,
    layer_stride_rows: usize,
    rows: usize,
) -> (Image, f32) {
    let (width, margin, cell_px) = (relief.size[0], relief.margin, source_picture.cell_px);
    let channel_values = relief.texture.iter().chain(source_picture.pixels).flatten();
    let brightest = channel_values.copied().fold(1.0, f32::max);
    let texture = stack_layers(&relief.texture, relief.size, layer_stride_rows, rows, [0.0; 3]);
    let encoded = |linear: f32| {
        let encoded = srgb_from_linear((linear / brightest).clamp(0.0, 1.0));
        (encoded * 65535.0).round() as u16
    };
    let mut texels = vec![u16::MAX; 4 * width * cell_px * rows * cell_px];
    texels.par_chunks_mut(4 * width * cell_px).enumerate().for_each(|(y, row)| {
        for (x, texel) in row.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let picture_pixel = x.checked_sub(margin * cell_px).zip(y.checked_sub(margin * cell_px));
            let picture_pixel =
                picture_pixel.filter(|&(x, y)| x < source_picture.size[0] && y < source_picture.size[1]);
            let cell = y / cell_px * width + x / cell_px;
            let opacity = relief.opacity.get(cell).copied().unwrap_or(1.0);
            let is_picture = relief.is_matted.get(cell).is_some_and(|is_separated| !is_separated);
            let color = match picture_pixel {
                Some((x, y)) if is_picture => source_picture.pixels[y * source_picture.size[0] + x],
                // Cells may be coarser than the picture: composited over the layer behind them, they are the picture again.
                Some((x, y)) if cell_px > 1 && opacity < 1.0 => {
                    let (all, back) = (
                        source_picture.pixels[y * source_picture.size[0] + x],
                        texture[cell + layer_stride_rows * width],
                    );
                    std::array::from_fn(|c| (all[c] - (1.0 - opacity) * back[c]).max(0.0) / opacity)
                }
                _ => texture[cell],
            };
            texel[..3].copy_from_slice(&color.map(encoded));
            texel[3] = (opacity * f32::from(u16::MAX)).round() as u16;
        }
    });
    let image = Image {
        name: "picture".into(),
        width: (width * cell_px) as u32,
        height: (rows * cell_px) as u32,
        texels: ImageLevel::Bits16(texels),
    };
    (image, brightest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use progress::Unwatched;
    use relief::ReliefOptions;
    use std::convert::Infallible;

    #[test]
    fn vertices_project_to_their_pixels() {
        let size = [24, 16];
        let disparity: Vec<f32> = (0..size[0] * size[1]).map(|cell| (cell % 24) as f32 * 0.02).collect();
        let picture: Vec<[f32; 3]> =
            (0..size[0] * size[1]).map(|cell| [(cell % 7) as f32 * 0.3; 3]).collect();
        let options = ReliefOptions { reach: 2.0, margin_px: 3, ..ReliefOptions::default() };
        let relief =
            Relief::build::<Infallible>(size, &disparity, &picture, &[], &options, &Unwatched).unwrap();
        let space = uncalibrated_space([0.0, 0.46], 30.0);
        assert!((1.0 / space.inverse_depth(0.46) - NEAREST_DISTANCE).abs() < 1e-12);
        assert!((1.0 / space.inverse_depth(0.0) - FARTHEST_DISTANCE).abs() < 1e-12);
        let named = SurfaceSource { name: "a", path: Path::new("a.png"), origin: String::new() };
        let shown = SourcePicture { pixels: &picture, size, cell_px: 1 };
        let scene = picture_scene(&relief, &shown, &space, &named, 0.2);
        let camera = picture_camera(&scene, [24, 16], &space, 2.0);
        let optics = camera.optics();
        for (vertex, position) in relief.vertices.iter().zip(&scene.positions) {
            let projected = optics.chief(camera.camera_from_world(*position));
            let half = 8.0;
            let place = Vec2::new(12.0 + (projected.x * half) as f32, 8.0 - (projected.y * half) as f32);
            assert!(place.distance(vertex.place) < 1e-4, "{place} {}", vertex.place);
        }
        // A step to the side moves points of disparity d by d pixels.
        let near = 1.0 / space.inverse_depth(0.4);
        let far = 1.0 / space.inverse_depth(0.1);
        let parallax = |z: f64| space.focal_px * space.baseline() / z;
        assert!((parallax(near) - parallax(far) - 0.3).abs() < 1e-9);
        let atlas = picture_atlas(&scene).unwrap();
        assert_eq!([atlas.width, atlas.height], [30, 48]);
        // Values above white are preserved.
        assert_eq!(scene.materials[0].base_color.x, 1.8000001);
    }

    #[test]
    fn regions_connected_in_depth_are_charts_and_specks_join_the_region_around_them() {
        let size = [40, 30];
        // A card in front of a wall, and a speck on the card.
        let disparity = |x: usize, y: usize| match (x, y) {
            (18..=19, 14..=15) => 5.0,
            (10..30, 8..22) => 3.0,
            _ => 0.0,
        };
        let disparity: Vec<f32> = (0..size[0] * size[1]).map(|k| disparity(k % 40, k / 40)).collect();
        let picture: Vec<[f32; 3]> = disparity.iter().map(|d| [0.2 + 0.1 * d, 0.3, 0.4]).collect();
        let options = ReliefOptions { reach: 2.0, margin_px: 2, ..ReliefOptions::default() };
        let relief =
            Relief::build::<Infallible>(size, &disparity, &picture, &[], &options, &Unwatched).unwrap();
        let space = uncalibrated_space([0.0, 5.0], 40.0);
        let named = SurfaceSource { name: "a", path: Path::new("a.png"), origin: String::new() };
        let shown = SourcePicture { pixels: &picture, size, cell_px: 1 };
        let scene = picture_scene(&relief, &shown, &space, &named, 0.0);
        let atlas = picture_atlas(&scene).unwrap();
        let at = |x: f32, y: f32, layer: f32| {
            let place =
                Vec2::new(x + 2.0, y + 2.0 + layer * scene.picture.as_ref().unwrap().behind_first_row as f32);
            let is_in = |[a, b, c]: &[Vec2; 3]| {
                let sides = [(*a, *b), (*b, *c), (*c, *a)].map(|(p, q)| (q - p).perp_dot(place - p));
                sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0)
            };
            atlas.chart_of[atlas.corners.iter().position(is_in).expect("a triangle is there")]
        };
        let (wall, card) = (at(3.0, 3.0, 0.0), at(12.0, 10.0, 0.0));
        assert_ne!(wall, card);
        assert_eq!(at(37.0, 27.0, 0.0), wall, "around the card");
        assert_eq!(at(10.6, 12.4, 1.0), wall, "what the card hides of the wall");
        assert_eq!(at(18.9, 14.9, 0.0), card, "a speck");
    }
}
