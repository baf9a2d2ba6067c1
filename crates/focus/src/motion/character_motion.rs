//! The character of a lens between two keys, and in files.

use super::keys::mix;
use lens::{Character, Rim};

/// The character at `share` of the way from one to another: every number by itself. A rim that only one of them has opens from
/// infinitely wide or to it, at its own place; cos⁴ is that of the first until the second.
pub fn between(from: &Character, to: &Character, share: f64) -> Character {
    if share == 0.0 || from == to {
        return *from;
    }
    let pair = |from: [f64; 2], to: [f64; 2]| [0, 1].map(|k| mix(from[k], to[k], share));
    Character {
        widest_radius: match (from.widest_radius, to.widest_radius) {
            (Some(from), Some(to)) => Some(mix(from, to, share)),
            (from, _) => from,
        },
        field_curvature: mix(from.field_curvature, to.field_curvature, share),
        longitudinal_colour: pair(from.longitudinal_colour, to.longitudinal_colour),
        lateral_colour: pair(from.lateral_colour, to.lateral_colour),
        edges: mix(from.edges, to.edges, share),
        rims: [0, 1].map(|k| rim_between(from.rims[k], to.rims[k], share)),
        has_cos4_falloff: from.has_cos4_falloff,
    }
}

/// In the reciprocal of the radius, so that none is no special case.
fn rim_between(from: Option<Rim>, to: Option<Rim>, share: f64) -> Option<Rim> {
    let per_radius = |rim: Option<Rim>| rim.map_or(0.0, |rim| 1.0 / rim.radius);
    let distance = match (from, to) {
        (Some(from), Some(to)) => mix(from.distance, to.distance, share),
        (Some(only), None) | (None, Some(only)) => only.distance,
        (None, None) => return None,
    };
    let radius = 1.0 / mix(per_radius(from), per_radius(to), share);
    radius.is_finite().then_some(Rim { radius, distance })
}

/// A character as the JSON object of camera files; what is not there is left out.
pub mod form {
    use lens::{Character, Rim};
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    #[derive(Default, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    struct Form {
        #[serde(skip_serializing_if = "Option::is_none")]
        widest_radius: Option<f64>,
        #[serde(skip_serializing_if = "is_nothing")]
        field_curvature: f64,
        #[serde(skip_serializing_if = "is_nothing")]
        longitudinal_colour: [f64; 2],
        #[serde(skip_serializing_if = "is_nothing")]
        lateral_colour: [f64; 2],
        #[serde(skip_serializing_if = "is_nothing")]
        edges: f64,
        #[serde(skip_serializing_if = "Vec::is_empty")]
        rims: Vec<RimForm>,
        #[serde(skip_serializing_if = "is_nothing")]
        cos4: bool,
    }

    #[derive(PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct RimForm {
        radius: f64,
        distance: f64,
    }

    fn is_nothing<T: Default + PartialEq>(value: &T) -> bool {
        *value == T::default()
    }

    /// Writes a character.
    ///
    /// # Errors
    /// Errors of `to`.
    pub fn serialize<S: Serializer>(character: &Character, to: S) -> Result<S::Ok, S::Error> {
        let rims = character.rims().map(|Rim { radius, distance }| RimForm { radius, distance });
        Form {
            widest_radius: character.widest_radius,
            field_curvature: character.field_curvature,
            longitudinal_colour: character.longitudinal_colour,
            lateral_colour: character.lateral_colour,
            edges: character.edges,
            rims: rims.collect(),
            cos4: character.has_cos4_falloff,
        }
        .serialize(to)
    }

    /// Reads a character; ranges are checked with the keys.
    ///
    /// # Errors
    /// A field is unknown or of another type, or there are more than two rims.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Character, D::Error> {
        let form = Form::deserialize(from)?;
        if form.rims.len() > 2 {
            return Err(D::Error::custom(format!("has {} rims (give two at most)", form.rims.len())));
        }
        let rim = |k: usize| form.rims.get(k).map(|rim| Rim { radius: rim.radius, distance: rim.distance });
        Ok(Character {
            widest_radius: form.widest_radius,
            field_curvature: form.field_curvature,
            longitudinal_colour: form.longitudinal_colour,
            lateral_colour: form.lateral_colour,
            edges: form.edges,
            rims: [rim(0), rim(1)],
            has_cos4_falloff: form.cos4,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn soft() -> Character {
        let rim = Rim { radius: 0.02, distance: 0.04 };
        Character {
            widest_radius: Some(0.02),
            longitudinal_colour: [1e-4, -2e-4],
            edges: -0.8,
            rims: [Some(rim), None],
            ..Character::default()
        }
    }

    #[test]
    fn between_two_characters_every_number_is_between() {
        let plain = Character { widest_radius: Some(0.01), ..Character::default() };
        assert_eq!([between(&plain, &soft(), 0.0), between(&plain, &soft(), 1.0)], [plain, soft()]);
        let half = between(&plain, &soft(), 0.5);
        assert_eq!((half.widest_radius, half.edges, half.longitudinal_colour[1]), (Some(0.015), -0.4, -1e-4));
        assert_eq!(
            half.rims,
            [Some(Rim { radius: 0.04, distance: 0.04 }), None],
            "it closes from infinitely wide"
        );
        // Hardly begun, it cuts nothing.
        let begun = between(&plain, &soft(), 1e-9);
        assert!(begun.rims[0].is_some_and(|rim| rim.radius > 1e6));
        begun.validate(f64::INFINITY).unwrap();
    }
}
