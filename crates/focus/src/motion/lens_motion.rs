//! Keyframes of the lens.

use super::character_motion;
use super::keys::{Keys, mix};
use glam::{DVec2, DVec3};
use lens::{Camera, Character};
use scene::SurfacePoint;
use serde::{Deserialize, Serialize};

/// What the lens is focused on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FocusTarget {
    /// An axial distance > 0; may be infinite.
    #[serde(with = "distance")]
    Distance(f64),
    /// A point of the surface, named on the scene at rest and followed as it moves: its depth.
    #[serde(with = "surface_point")]
    Point(SurfacePoint),
}

impl FocusTarget {
    fn is_valid(&self) -> bool {
        match self {
            Self::Distance(distance) => *distance > 0.0,
            Self::Point(point) => {
                let [u, v] = point.barycentric.to_array();
                u >= 0.0 && v >= 0.0 && u + v <= 1.0
            }
        }
    }

    /// The reciprocal of its depth, 1/length; that of the camera's own focus distance if the point is not in front of
    /// the camera.
    fn inverse_depth(&self, camera: &Camera, position: &dyn Fn(SurfacePoint) -> Option<DVec3>) -> f64 {
        let depth = match self {
            Self::Distance(distance) => Some(*distance),
            Self::Point(point) => position(*point).map(|position| camera.camera_from_world(position).z),
        };
        1.0 / depth.filter(|depth| *depth > 0.0).unwrap_or(camera.focus_distance)
    }
}

/// The character of a lens as the value of a key.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct KeyedCharacter(#[serde(with = "character_motion::form")] pub Character);

/// Keyframes of the lens: what it is focused on, its f-number, and its character.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LensMotion {
    /// What it is focused on. Between two keys the reciprocal of the distance is interpolated, so that a rack from
    /// infinity is no special case.
    #[serde(default, skip_serializing_if = "Keys::is_empty")]
    pub focus: Keys<FocusTarget>,
    /// f/(2R), > 0. Between two keys its logarithm is interpolated, as stops are counted.
    #[serde(default, skip_serializing_if = "Keys::is_empty")]
    pub f_number: Keys<f64>,
    /// What it does beside focusing. Between two keys every number is interpolated; a widest radius that a key does not give is the
    /// camera's.
    #[serde(default, skip_serializing_if = "Keys::is_empty")]
    pub character: Keys<KeyedCharacter>,
}

impl LensMotion {
    /// Whether nothing is animated.
    pub fn is_empty(&self) -> bool {
        self.focus.is_empty() && self.f_number.is_empty() && self.character.is_empty()
    }

    /// Whether all its keys are valid: f-numbers above 0 and finite, characters within their ranges for some lens.
    pub fn is_valid(&self) -> bool {
        self.focus.is_valid(FocusTarget::is_valid)
            && self.f_number.is_valid(|number| *number > 0.0 && number.is_finite())
            && self.character.is_valid(|KeyedCharacter(character)| character.validate(f64::INFINITY).is_ok())
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        let lists = size_of_val(self.focus.keys()) + size_of_val(self.f_number.keys());
        size_of::<Self>() + lists + size_of_val(self.character.keys())
    }

    /// The times of all keys, s; some may occur twice.
    pub fn times(&self) -> impl Iterator<Item = f64> {
        let focus = self.focus.keys().iter().map(|key| key.seconds);
        let f_number = self.f_number.keys().iter().map(|key| key.seconds);
        focus.chain(f_number).chain(self.character.keys().iter().map(|key| key.seconds))
    }

    /// `camera` with the lens as it is at a time. `position` returns the position of a surface point at that time;
    /// `None` if the point does not exist.
    pub fn camera_at(
        &self,
        seconds: f64,
        camera: &Camera,
        position: &dyn Fn(SurfacePoint) -> Option<DVec3>,
    ) -> Camera {
        let mut moved = camera.clone();
        if let Some(span) = self.focus.span_at(seconds) {
            let [from, to] = [span.from, span.to].map(|target| target.inverse_depth(camera, position));
            moved.focus_distance = match span.from {
                // A constant distance is returned exactly as it was set.
                FocusTarget::Distance(distance) if span.from == span.to => *distance,
                _ => 1.0 / mix(from, to, span.share),
            };
        }
        if let Some(number) = self.f_number_at(seconds).filter(|number| *number != moved.f_number()) {
            moved.aperture_radius = moved.optics().focal_length() / (2.0 * number);
        }
        if let Some(span) = self.character.span_at(seconds) {
            let character = character_motion::between(&span.from.0, &span.to.0, span.share);
            let widest = camera.character.widest_radius.unwrap_or(camera.aperture_radius);
            let widest_radius = character.widest_radius.or((widest > 0.0).then_some(widest));
            moved.character = Character { widest_radius, ..character };
        }
        moved
    }

    /// The f-number at a time, s, if it is animated: interpolated as its logarithm.
    pub fn f_number_at(&self, seconds: f64) -> Option<f64> {
        let span = self.f_number.span_at(seconds)?;
        // Equal values are returned exactly.
        if span.from == span.to {
            return Some(*span.from);
        }
        let number = mix(span.from.ln(), span.to.ln(), span.share).exp();
        Some(number.clamp(span.from.min(*span.to), span.from.max(*span.to)))
    }
}

/// A distance as a number, or "inf".
mod distance {
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    #[derive(Serialize, Deserialize)]
    #[serde(untagged)]
    enum Form {
        Number(f64),
        Word(String),
    }

    /// Writes a distance in scene units: as a number, or "inf" if it is infinite.
    ///
    /// # Errors
    /// Errors of `to`.
    pub fn serialize<S: Serializer>(distance: &f64, to: S) -> Result<S::Ok, S::Error> {
        let is_infinite = distance.is_infinite();
        if is_infinite { Form::Word("inf".into()) } else { Form::Number(*distance) }.serialize(to)
    }

    /// Reads a distance in scene units, a number or "inf".
    ///
    /// # Errors
    /// It is something else.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        match Form::deserialize(from)? {
            Form::Number(distance) => Ok(distance),
            Form::Word(word) if word == "inf" => Ok(f64::INFINITY),
            Form::Word(word) => Err(D::Error::custom(format!("{word:?} is not a distance"))),
        }
    }
}

/// A surface point as its triangle and two barycentric weights.
mod surface_point {
    use super::{DVec2, SurfacePoint};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    struct Form {
        triangle: u32,
        barycentric: [f64; 2],
    }

    /// Writes a surface point as triangle and barycentric weights.
    ///
    /// # Errors
    /// Errors of `to`.
    pub fn serialize<S: Serializer>(point: &SurfacePoint, to: S) -> Result<S::Ok, S::Error> {
        Form { triangle: point.triangle, barycentric: point.barycentric.to_array() }.serialize(to)
    }

    /// Reads a surface point as it is written by [`serialize`].
    ///
    /// # Errors
    /// The form is another.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<SurfacePoint, D::Error> {
        let Form { triangle, barycentric } = Form::deserialize(from)?;
        Ok(SurfacePoint { triangle, barycentric: DVec2::from_array(barycentric) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ease, Key};

    #[test]
    fn a_rack_follows_its_points() {
        let point = |triangle| SurfacePoint { triangle, barycentric: DVec2::ZERO };
        let mut motion = LensMotion::default();
        for (seconds, triangle) in [(0.0, 1), (1.0, 4)] {
            let value = FocusTarget::Point(point(triangle));
            assert!(motion.focus.insert(Key { seconds, value, ease: Ease::Linear }));
        }
        // Triangle n stands n in front of the camera.
        let camera = Camera::default();
        let place = |point: SurfacePoint| Some(DVec3::NEG_Z * f64::from(point.triangle));
        let distance = |seconds, place: &dyn Fn(SurfacePoint) -> Option<DVec3>| {
            motion.camera_at(seconds, &camera, place).focus_distance
        };
        assert_eq!([0.0, 1.0].map(|seconds| distance(seconds, &place)), [1.0, 4.0]);
        assert_eq!(distance(0.5, &place), 1.0 / 0.625, "in the reciprocal");
        let away = |_: SurfacePoint| None;
        assert!((distance(0.5, &away) - camera.focus_distance).abs() < 1e-12);
        let behind = |_: SurfacePoint| Some(DVec3::Z);
        assert!((distance(0.5, &behind) - camera.focus_distance).abs() < 1e-12);
    }

    #[test]
    fn a_character_comes_and_goes_with_its_keys() {
        let mut motion = LensMotion::default();
        let soft = Character { edges: -0.8, ..Character::default() };
        for (seconds, character) in [(0.0, Character::default()), (2.0, soft)] {
            assert!(motion.character.insert(Key {
                seconds,
                value: KeyedCharacter(character),
                ease: Ease::Linear
            }));
        }
        assert!(motion.is_valid() && !motion.is_empty() && motion.times().eq([0.0, 2.0]));
        let camera = Camera { aperture_radius: 0.02, ..Camera::default() };
        let at = |seconds| motion.camera_at(seconds, &camera, &|_| None).character;
        assert_eq!(at(1.0), Character { edges: -0.4, widest_radius: Some(0.02), ..Character::default() });
        assert!(at(0.0).is_neutral() && at(9.0).edges == -0.8);
        let text = serde_json::to_string(&motion).unwrap();
        assert!(text.contains(r#""value":{"edges":-0.8}"#), "{text}");
        assert_eq!(serde_json::from_str::<LensMotion>(&text).unwrap(), motion);
        let wrong = text.replace("-0.8", "-1.8");
        assert!(!serde_json::from_str::<LensMotion>(&wrong).unwrap().is_valid());
        assert!(serde_json::from_str::<LensMotion>(&text.replace("edges", "swirl")).is_err());
    }

    #[test]
    fn stops_are_counted_by_their_logarithm() {
        let mut motion = LensMotion::default();
        assert!(motion.f_number.insert(Key { seconds: 0.0, value: 2.0, ease: Ease::Linear }));
        assert!(motion.f_number.insert(Key { seconds: 2.0, value: 8.0, ease: Ease::Linear }));
        let camera = motion.camera_at(1.0, &Camera::default(), &|_| None);
        assert!((camera.f_number() - 4.0).abs() < 1e-12);
        assert_eq!(camera.focus_distance, Camera::default().focus_distance);
    }

    #[test]
    fn infinity_and_points_come_back_from_json() {
        let mut motion = LensMotion::default();
        let point = SurfacePoint { triangle: 7, barycentric: DVec2::new(0.25, 0.5) };
        for (seconds, value) in
            [(0.0, FocusTarget::Distance(f64::INFINITY)), (1.0, FocusTarget::Point(point))]
        {
            assert!(motion.focus.insert(Key { seconds, value, ease: Ease::Smooth }));
        }
        let text = serde_json::to_string(&motion).unwrap();
        assert!(text.contains("\"inf\"") && !text.contains("f_number"), "{text}");
        assert_eq!(serde_json::from_str::<LensMotion>(&text).unwrap(), motion);
        assert!(motion.is_valid());
        let other = text.replace("\"inf\"", "-1.0");
        assert!(!serde_json::from_str::<LensMotion>(&other).unwrap().is_valid());
    }
}
