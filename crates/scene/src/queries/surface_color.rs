//! The appearance of the surface at a point: base colour, emission, opacity, normal, and the parameters of its
//! material.

use crate::{AlphaMode, NormalMap, Scalar, Scene, SurfacePoint, TextureRef, Tint};
use glam::{DVec3, Vec2, Vec3, Vec4};

impl Scene {
    /// The texture coordinates of a set ([`TextureRef::uv_set`]) at a point; zero if the part has none.
    #[inline]
    pub fn uv_at(&self, point: SurfacePoint, set: u8) -> Vec2 {
        let uv = self.uv_set(set);
        if uv.is_empty() {
            return Vec2::ZERO;
        }
        let [a, b, c] = self.triangles[point.triangle as usize].vertices;
        let [a, b, c] = [uv[a as usize], uv[b as usize], uv[c as usize]];
        let [wa, wb, wc] = point.weights();
        (a.as_dvec2() * wa + b.as_dvec2() * wb + c.as_dvec2() * wc).as_vec2()
    }

    /// The linear vertex colour at a point; 1 if the part has none.
    #[inline]
    pub fn vertex_color_at(&self, point: SurfacePoint) -> Vec4 {
        if self.colors.is_empty() {
            return Vec4::ONE;
        }
        let [a, b, c] = self.triangles[point.triangle as usize].vertices.map(|v| self.colors[v as usize]);
        let [wa, wb, wc] = point.weights().map(|w| w as f32);
        a * wa + b * wb + c * wc
    }

    /// RGBA of a texture (colours linear) at the mesh's texture coordinates (its transform is applied here).
    #[inline]
    pub fn sample_texture(&self, texture: &TextureRef, uv: Vec2) -> Vec4 {
        let image = &self.images[texture.image as usize];
        let uv = (texture.transform * Vec3::new(uv.x, uv.y, 1.0)).truncate();
        image.sample(uv, texture.wrap, texture.nearest, texture.is_color)
    }

    /// A texture's RGBA at a point of the surface; colours are linear, components in [0, 1] unless the texture is a
    /// radiance.
    #[inline]
    pub fn sample_texture_at(&self, texture: &TextureRef, point: SurfacePoint) -> Vec4 {
        self.sample_texture(texture, self.uv_at(point, texture.uv_set))
    }

    /// Linear base colour (factor × texture × vertex colour); opacity in w, before the alpha mode is applied.
    pub fn base_color(&self, point: SurfacePoint) -> Vec4 {
        let material = self.material_of(point.triangle);
        let mut color = material.base_color * self.vertex_color_at(point);
        if let Some(texture) = &material.base_color_texture {
            color *= self.sample_texture_at(texture, point);
        }
        color
    }

    /// The radiance that the surface emits: the base colour of an unlit material, else the emissive factor × texture.
    /// Whether the back emits it too is up to the caller ([`crate::Material::double_sided`]).
    pub fn emitted_radiance(&self, point: SurfacePoint) -> Vec3 {
        let material = self.material_of(point.triangle);
        if material.unlit {
            return self.base_color(point).truncate();
        }
        match &material.emissive_texture {
            Some(texture) if material.emissive != Vec3::ZERO => {
                material.emissive * self.sample_texture_at(texture, point).truncate()
            }
            _ => material.emissive,
        }
    }

    /// The fraction of light that the surface blocks, in [0, 1], with the alpha mode applied: 1 if opaque, 0 or 1 if
    /// masked.
    #[inline]
    pub fn opacity(&self, point: SurfacePoint) -> f32 {
        match self.material_of(point.triangle).alpha {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask(cutoff) => f32::from(self.base_color(point).w >= cutoff),
            AlphaMode::Blend => self.base_color(point).w.clamp(0.0, 1.0),
        }
    }

    /// The unit normal for shading: interpolated if the file has normals, else the triangle's own, on the side from
    /// which the triangle is counter-clockwise. Zero for a degenerate triangle without normals.
    pub fn shading_normal(&self, point: SurfacePoint) -> DVec3 {
        if !self.normals.is_empty() {
            let [a, b, c] =
                self.triangles[point.triangle as usize].vertices.map(|v| self.normals[v as usize].as_dvec3());
            let [wa, wb, wc] = point.weights();
            let normal = (a * wa + b * wb + c * wc).normalize_or_zero();
            if normal != DVec3::ZERO {
                return normal;
            }
        }
        self.area_normal(point.triangle).normalize_or_zero()
    }

    /// A scalar parameter of the material at a point: its factor times its texture.
    #[inline]
    pub fn scalar_at(&self, scalar: &Scalar, point: SurfacePoint) -> f32 {
        match &scalar.texture {
            Some((texture, channel)) => {
                scalar.factor * self.sample_texture_at(texture, point)[usize::from(*channel)]
            }
            None => scalar.factor,
        }
    }

    /// A linear RGB parameter of the material at a point: its factor times its texture.
    #[inline]
    pub fn tint_at(&self, tint: &Tint, point: SurfacePoint) -> Vec3 {
        match &tint.texture {
            Some(texture) => tint.factor * self.sample_texture_at(texture, point).truncate(),
            None => tint.factor,
        }
    }

    /// The tangent frame of the material's normal map at a point: a unit vector along u, perpendicular to `normal`,
    /// and the bitangent, along v upwards. `None` if the part has no tangents.
    pub fn tangents_at(&self, point: SurfacePoint, normal: DVec3) -> Option<[DVec3; 2]> {
        let corners = self.tangents.get(point.triangle as usize)?;
        let tangent: DVec3 = corners
            .iter()
            .zip(point.weights())
            .map(|(corner, weight)| corner.truncate().as_dvec3() * weight)
            .sum();
        let tangent = (tangent - normal * normal.dot(tangent)).try_normalize()?;
        // Corners of one triangle that disagree have no common sign; MikkTSpace produces none.
        let sign = if corners.iter().map(|corner| corner.w).sum::<f32>() < 0.0 { -1.0 } else { 1.0 };
        Some([tangent, sign * normal.cross(tangent)])
    }

    /// The unit normal for shading with a normal map: scaled, and transformed from tangent to world space.
    pub fn bumped_normal(&self, map: &NormalMap, point: SurfacePoint) -> DVec3 {
        let normal = self.shading_normal(point);
        let Some([tangent, bitangent]) = self.tangents_at(point, normal) else { return normal };
        let bump = self.sample_texture_at(&map.texture, point).truncate() * 2.0 - 1.0;
        let bump = (bump * Vec3::new(map.scale, map.scale, 1.0)).as_dvec3();
        (tangent * bump.x + bitangent * bump.y + normal * bump.z).try_normalize().unwrap_or(normal)
    }
}
