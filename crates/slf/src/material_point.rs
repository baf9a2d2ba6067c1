//! Material and shading frame of a surface point, with textures evaluated.

use crate::media::effective_ior;
use glam::{DVec2, DVec3, Vec3};
use material::{Clearcoat, Film, Frame, Scattering, Sheen, Surface};
use scene::{Anisotropy, Scene, SurfacePoint, Workflow};

/// A surface point prepared for shading.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MaterialPoint {
    /// World position.
    pub position: DVec3,
    /// Material parameters.
    pub surface: Surface,
    /// Shading frame.
    pub frame: Frame,
    /// Index into [`Scene::materials`].
    pub material: u32,
}

impl MaterialPoint {
    /// Evaluates the material at a point: its surface with all textures looked up, and its frame.
    pub fn new(scene: &Scene, point: SurfacePoint, scattering: Scattering) -> Self {
        let material = scene.part_of(point.triangle).material;
        Self {
            position: point.position(scene),
            surface: surface(scene, point, scattering),
            frame: frame(scene, point),
            material,
        }
    }
}

/// Radiance that a point itself emits toward a direction: from its front, and from its back if the material is double
/// sided.
pub(crate) fn emitted(scene: &Scene, point: SurfacePoint, outgoing: DVec3) -> Vec3 {
    let material = scene.material_of(point.triangle);
    let shows =
        material.double_sided || material.unlit || scene.area_normal(point.triangle).dot(outgoing) >= 0.0;
    if shows { scene.emitted_radiance(point) } else { Vec3::ZERO }
}

fn frame(scene: &Scene, point: SurfacePoint) -> Frame {
    let material = scene.material_of(point.triangle);
    let geometric = scene.area_normal(point.triangle).normalize_or_zero();
    let normal = match &material.normal_map {
        Some(map) => scene.bumped_normal(map, point),
        None => scene.shading_normal(point),
    };
    let tangent = material.anisotropy.as_ref().and_then(|anisotropy| {
        let [tangent, bitangent] = scene.tangents_at(point, scene.shading_normal(point))?;
        let direction = anisotropy_direction(scene, anisotropy, point);
        Some(tangent * direction.x + bitangent * direction.y)
    });
    let frame = Frame::new(geometric, normal, tangent.unwrap_or(DVec3::ZERO));
    match &material.clearcoat {
        None => frame,
        // The coat does not follow the normal map of the base.
        Some(coat) => frame.coated(match &coat.normal_map {
            Some(map) => scene.bumped_normal(map, point),
            None => scene.shading_normal(point),
        }),
    }
}

/// Direction of anisotropy in tangent space.
fn anisotropy_direction(scene: &Scene, anisotropy: &Anisotropy, point: SurfacePoint) -> DVec2 {
    let own = anisotropy.texture.as_ref().map(|texture| scene.sample_texture_at(texture, point));
    let own = own.map_or(DVec2::X, |rgba| DVec2::new(f64::from(rgba.x), f64::from(rgba.y)) * 2.0 - 1.0);
    DVec2::from_angle(f64::from(anisotropy.rotation)).rotate(own)
}

fn surface(scene: &Scene, point: SurfacePoint, scattering: Scattering) -> Surface {
    let material = scene.material_of(point.triangle);
    let color = |rgb: Vec3| rgb.as_dvec3().clamp(DVec3::ZERO, DVec3::ONE);
    let scalar = |scalar| f64::from(scene.scalar_at(scalar, point)).clamp(0.0, 1.0);
    let base_color = color(scene.base_color(point).truncate());
    let gloss = match &material.workflow {
        Workflow::MetallicRoughness { metallic, roughness } => Surface {
            base_color,
            metallic: scalar(metallic),
            roughness: scalar(roughness),
            ior: effective_ior(material),
            specular: scalar(&material.specular),
            specular_color: scene.tint_at(&material.specular_color, point).as_dvec3(),
            ..Surface::default()
        },
        Workflow::SpecularGlossiness { specular, glossiness } => Surface::from_specular_glossiness(
            base_color,
            color(scene.tint_at(specular, point)),
            scalar(glossiness),
        ),
    };
    let anisotropy = material.anisotropy.as_ref().map_or(0.0, |anisotropy| {
        let texture = anisotropy.texture.as_ref();
        f64::from(
            anisotropy.strength * texture.map_or(1.0, |texture| scene.sample_texture_at(texture, point).z),
        )
    });
    let through = material.diffuse_transmission.as_ref();
    Surface {
        anisotropy,
        transmission: scalar(&material.transmission),
        is_thin: material.volume.is_none(),
        diffuse_transmission: through.map_or(0.0, |through| scalar(&through.factor)),
        diffuse_transmission_color: through
            .map_or(DVec3::ONE, |through| color(scene.tint_at(&through.color, point))),
        film: material.iridescence.as_ref().map(|film| {
            let [min, max] = film.thickness.map(f64::from);
            let share = film
                .thickness_texture
                .map_or(1.0, |texture| f64::from(scene.sample_texture_at(&texture, point).y));
            Film {
                factor: scalar(&film.factor),
                ior: f64::from(film.ior),
                thickness: min + (max - min) * share,
            }
        }),
        clearcoat: material
            .clearcoat
            .as_ref()
            .map(|coat| Clearcoat { factor: scalar(&coat.factor), roughness: scalar(&coat.roughness) }),
        sheen: material.sheen.as_ref().map(|sheen| Sheen {
            color: color(scene.tint_at(&sheen.color, point)),
            roughness: scalar(&sheen.roughness),
        }),
        scattering,
        ..gloss
    }
}
