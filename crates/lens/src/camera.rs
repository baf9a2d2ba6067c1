//! The camera as it is saved, and its validation.

use crate::{Aperture, CameraError, Character, CharacterOptics, Falloff, Optics, Vignetting};
use glam::{DMat3, DMat4, DVec2, DVec3};

/// A wide-aperture camera. Lengths in scene units, angles in radians.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Picture width, px.
    pub width: u32,
    /// Picture height, px.
    pub height: u32,
    /// Full vertical angle of view, in (0, π).
    pub yfov: f64,
    /// Axial distance from the aperture to the focus plane, > 0; may be infinite.
    pub focus_distance: f64,
    /// Half the side of the square that the aperture lies in; 0 is a pinhole.
    pub aperture_radius: f64,
    /// Height of the sensor: decides how much blur a focus offset causes.
    pub sensor_height: f64,
    /// Offset of the sensor in its plane, in picture heights, right and up as seen in the picture: the picture is the
    /// part of the image around this point instead of the axis. Perspective and depth stay those of the axis.
    pub shift: DVec2,
    /// Pose, a rigid motion; glTF axes: the camera looks down −Z, +Y up.
    pub camera_to_world: DMat4,
    /// Radiance where there is no surface, linear RGB, if chosen; otherwise the scene's world decides.
    pub background: Option<[f64; 3]>,
    /// The aperture's shape.
    pub aperture: Aperture,
    /// What the lens does beside focusing.
    pub character: Character,
}

impl Default for Camera {
    /// A 50 mm lens at f/2 on a 24 mm high sensor, focused at 3, 960 × 540.
    fn default() -> Self {
        Self {
            width: 960,
            height: 540,
            yfov: 2.0 * (12.0f64 / 50.0).atan(),
            focus_distance: 3.0,
            aperture_radius: 0.0125,
            sensor_height: 0.024,
            shift: DVec2::ZERO,
            camera_to_world: DMat4::IDENTITY,
            background: None,
            aperture: Aperture::default(),
            character: Character::default(),
        }
    }
}

impl Camera {
    /// Maximum side of a picture, px.
    pub const LARGEST_SIDE_PX: u32 = 16384;
    /// Maximum shift, picture heights: farther from the axis light arrives at a grazing angle.
    pub const LARGEST_SHIFT: f64 = 100.0;

    /// Checks that all fields are within their ranges.
    ///
    /// # Errors
    /// The first field that makes the camera invalid.
    pub fn validate(&self) -> Result<(), CameraError> {
        let require = |ok: bool, field, must| if ok { Ok(()) } else { Err(CameraError { field, must }) };
        let side = 1..=Self::LARGEST_SIDE_PX;
        let positive = |x: f64| x > 0.0 && x.is_finite();
        require(side.contains(&self.width), "width", "1 to 16384 px")?;
        require(side.contains(&self.height), "height", "1 to 16384 px")?;
        require(self.yfov > 0.0 && self.yfov < std::f64::consts::PI, "yfov", "an angle in (0, π) rad")?;
        require(self.focus_distance > 0.0, "focus_distance", "above 0, or \"inf\"")?;
        require(
            self.aperture_radius >= 0.0 && self.aperture_radius.is_finite(),
            "aperture_radius",
            "0 (a pinhole) or more, and finite",
        )?;
        require(positive(self.sensor_height), "sensor_height", "above 0 and finite")?;
        let in_reach = self.shift.abs().max_element() <= Self::LARGEST_SHIFT;
        require(self.shift.is_finite() && in_reach, "shift", "two numbers of picture heights, -100 to 100")?;
        require(
            self.background.iter().flatten().all(|c| *c >= 0.0 && c.is_finite()),
            "background",
            "finite radiances of 0 or more",
        )?;
        let pose = self.camera_to_world;
        require(pose.is_finite(), "camera_to_world", "finite")?;
        let rotation = DMat3::from_mat4(pose);
        let deviation = rotation.transpose() * rotation - DMat3::IDENTITY;
        let rigid = deviation.to_cols_array().iter().all(|e| e.abs() < 1e-3) && rotation.determinant() > 0.0;
        require(rigid, "camera_to_world", "a rigid motion (orthonormal axes, no mirroring)")?;
        self.aperture.validate()?;
        self.character.validate(self.optics().image_distance)
    }

    /// The same camera with `side` × `side` pixels in place of each: see [`Picture::averaged`](crate::Picture::averaged).
    pub fn finer(&self, side: u32) -> Self {
        let [width, height] = [self.width, self.height].map(|pixels| pixels.saturating_mul(side));
        Self { width, height, ..self.clone() }
    }

    /// The same camera with `px` more pixels of the same picture on each side: its lens and the effect of a focus
    /// offset stay, sensor and angle of view grow.
    pub fn overscanned(&self, px: u32) -> Self {
        let grown = |side: u32| side.saturating_add(px.saturating_mul(2));
        let factor = f64::from(grown(self.height)) / f64::from(self.height);
        Self {
            width: grown(self.width),
            height: grown(self.height),
            yfov: 2.0 * (factor * (self.yfov / 2.0).tan()).atan(),
            sensor_height: factor * self.sensor_height,
            // In heights of the larger picture.
            shift: self.shift / factor,
            // By the square of the larger picture's half-heights.
            character: Character {
                field_curvature: self.character.field_curvature * factor * factor,
                ..self.character
            },
            ..self.clone()
        }
    }

    /// The numbers that focusing takes, computed once: focus distance, image distance, aperture radius and angle of
    /// view and picture height.
    pub fn optics(&self) -> Optics {
        let tan_half_yfov = (self.yfov / 2.0).tan();
        Optics {
            inverse_focus_distance: 1.0 / self.focus_distance,
            image_distance: self.sensor_height / (2.0 * tan_half_yfov),
            aperture_radius: self.aperture_radius,
            tan_half_yfov,
            half_height_px: self.height as f64 / 2.0,
        }
    }

    /// The numbers of the lens's character, computed once.
    pub fn character_optics(&self) -> CharacterOptics {
        CharacterOptics::new(self.optics(), &self.aperture, &self.character)
    }

    /// How much less light arrives beside the axis than on it; `None` if the lens has no rims.
    pub fn falloff(&self) -> Option<Falloff> {
        let optics = self.character_optics();
        optics.has_rims().then(|| Falloff::new(&optics, &self.aperture, self.frame_q()))
    }

    /// How its picture darkens toward the corners by the lens's character; `None` if it does not.
    pub fn vignetting(&self) -> Option<Vignetting> {
        Vignetting::new(self.character_optics(), self.falloff())
    }

    /// The aperture's centre in the world, scene units.
    pub fn position(&self) -> DVec3 {
        self.camera_to_world.w_axis.truncate()
    }

    /// A world point, scene units, in camera space (x right, y up, z forward, the aperture's centre at the origin).
    pub fn camera_from_world(&self, point: DVec3) -> DVec3 {
        self.camera_direction(point - self.position())
    }

    /// A world direction in camera space; its length is kept.
    pub fn camera_direction(&self, direction: DVec3) -> DVec3 {
        let m = &self.camera_to_world;
        DVec3::new(
            m.x_axis.truncate().dot(direction),
            m.y_axis.truncate().dot(direction),
            -m.z_axis.truncate().dot(direction),
        )
    }

    /// A camera-space point in the world, scene units. Inverse of [`Self::camera_from_world`].
    pub fn world_from_camera(&self, point: DVec3) -> DVec3 {
        self.position() + self.world_direction(point)
    }

    /// A camera-space direction in the world. Inverse of [`Self::camera_direction`].
    #[inline]
    pub fn world_direction(&self, direction: DVec3) -> DVec3 {
        let m = &self.camera_to_world;
        m.x_axis.truncate() * direction.x + m.y_axis.truncate() * direction.y
            - m.z_axis.truncate() * direction.z
    }

    /// The picture's width over its height.
    pub fn aspect(&self) -> f64 {
        self.width as f64 / self.height as f64
    }

    /// Where the lens's axis meets the picture, px: its middle, unless the sensor is shifted.
    #[inline]
    pub fn principal_point_px(&self) -> DVec2 {
        let [width, height] = [self.width, self.height].map(f64::from);
        DVec2::new(width / 2.0 - self.shift.x * height, height / 2.0 + self.shift.y * height)
    }

    /// The picture's middle and half its extent, both as picture positions q in half picture heights.
    pub fn frame_q(&self) -> [DVec2; 2] {
        [2.0 * self.shift, DVec2::new(self.aspect(), 1.0)]
    }

    /// The pixel position (x right, y down, (0, 0) the frame's upper left corner) of q in half-heights.
    pub fn pixel_from_q(&self, q: DVec2) -> DVec2 {
        let half_height = self.height as f64 / 2.0;
        let axis = self.principal_point_px();
        DVec2::new(axis.x + q.x * half_height, axis.y - q.y * half_height)
    }

    /// The picture position q, in half picture heights from the lens's axis, y up, of a pixel position (px, y down).
    /// Inverse of [`Self::pixel_from_q`].
    #[inline]
    pub fn q_from_pixel(&self, pixel: DVec2) -> DVec2 {
        let half_height = self.height as f64 / 2.0;
        let axis = self.principal_point_px();
        DVec2::new((pixel.x - axis.x) / half_height, (axis.y - pixel.y) / half_height)
    }

    /// The f-number f/(2R): the thin lens's focal length over the aperture's diameter.
    pub fn f_number(&self) -> f64 {
        self.optics().focal_length() / (2.0 * self.aperture_radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spaces_invert() {
        let pose = DMat4::from_rotation_translation(
            glam::DQuat::from_euler(glam::EulerRot::YXZ, 0.4, -0.3, 0.2),
            DVec3::new(1.0, -2.0, 3.0),
        );
        let shift = DVec2::new(0.3, -1.25);
        let camera = Camera { camera_to_world: pose, shift, ..Camera::default() };
        camera.validate().unwrap();
        let p = DVec3::new(0.3, -7.0, 2.0);
        assert!(camera.world_from_camera(camera.camera_from_world(p)).distance(p) < 1e-12);
        let pixel = DVec2::new(13.25, 400.5);
        assert!(camera.pixel_from_q(camera.q_from_pixel(pixel)).distance(pixel) < 1e-12);
        let ahead = pose.transform_point3(DVec3::new(0.0, 0.0, -2.0));
        assert!(camera.camera_from_world(ahead).distance(DVec3::new(0.0, 0.0, 2.0)) < 1e-12);
    }

    #[test]
    fn a_shifted_picture_is_a_part_of_a_larger_one() {
        let shifted =
            Camera { width: 40, height: 30, shift: DVec2::new(0.5, 1.0 / 3.0), ..Camera::default() };
        // The same lens over a picture of three times the size about the axis.
        let tan = 3.0 * (shifted.yfov / 2.0).tan();
        let whole = Camera { width: 120, height: 90, yfov: 2.0 * tan.atan(), ..Camera::default() };
        let corner = DVec2::new(40.0 + 15.0, 30.0 - 10.0);
        for point in [DVec3::new(0.2, 0.3, 2.0), DVec3::new(-4.0, 5.0, 9.0)] {
            let [part, all] =
                [&shifted, &whole].map(|camera| camera.pixel_from_q(camera.optics().chief(point)));
            assert!((part + corner).distance(all) < 1e-9, "{part} {all}");
        }
    }

    #[test]
    fn overscan_shows_more_of_the_same_picture() {
        let shift = DVec2::new(0.25, -0.5);
        let camera = Camera { width: 100, height: 60, shift, ..Camera::default() };
        let larger = camera.overscanned(20);
        assert_eq!((larger.width, larger.height), (140, 100));
        larger.validate().unwrap();
        assert!((larger.optics().image_distance / camera.optics().image_distance - 1.0).abs() < 1e-12);
        let kappa = 0.3;
        let radii = [&camera, &larger].map(|camera| camera.optics().splat_radius_px(kappa));
        assert!((radii[0] / radii[1] - 1.0).abs() < 1e-12, "{radii:?}");
        // A point of the frame lies as much further from the corner.
        let slope = |camera: &Camera, pixel| camera.q_from_pixel(pixel) * (camera.yfov / 2.0).tan();
        let pixel = DVec2::new(17.0, 41.5);
        assert!(slope(&camera, pixel).distance(slope(&larger, pixel + 20.0)) < 1e-12);
        assert_eq!(camera.overscanned(0).optics(), camera.optics());
    }

    #[test]
    fn bad_fields_are_named() {
        let good = Camera::default();
        let bad = [
            (Camera { width: 0, ..good.clone() }, "width"),
            (Camera { yfov: f64::NAN, ..good.clone() }, "yfov"),
            (Camera { focus_distance: 0.0, ..good.clone() }, "focus_distance"),
            (Camera { aperture_radius: -1.0, ..good.clone() }, "aperture_radius"),
            (Camera { sensor_height: f64::INFINITY, ..good.clone() }, "sensor_height"),
            (Camera { shift: DVec2::new(0.0, f64::NAN), ..good.clone() }, "shift"),
            (Camera { shift: DVec2::new(101.0, 0.0), ..good.clone() }, "shift"),
            (
                Camera { camera_to_world: DMat4::from_scale(DVec3::splat(2.0)), ..good.clone() },
                "camera_to_world",
            ),
        ];
        for (camera, field) in bad {
            assert_eq!(camera.validate().unwrap_err().field, field);
        }
        Camera { focus_distance: f64::INFINITY, aperture_radius: 0.0, ..good }.validate().unwrap();
    }
}
