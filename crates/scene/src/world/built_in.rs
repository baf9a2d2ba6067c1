//! The environments that come with the program, made by code.

use super::environment_map::EnvironmentMap;
use super::sky::{evening_radiance, overcast_radiance};
use super::studio::studio_radiance;
use glam::{DVec2, DVec3, Vec3};
use std::sync::{Arc, LazyLock};

const WIDTH: u32 = 512;
const HEIGHT: u32 = 256;

/// An environment that comes with the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BuiltInEnvironment {
    /// A soft neutral studio. Its front is +Z, as for glTF's models.
    Studio,
    /// A cloudy sky over open ground: soft light from above.
    Overcast,
    /// A low sun, its sky and the first dusk opposite.
    Evening,
}

impl BuiltInEnvironment {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Studio, Self::Overcast, Self::Evening];

    /// Its name in world files and projects.
    pub fn name(self) -> &'static str {
        match self {
            Self::Studio => "studio",
            Self::Overcast => "overcast",
            Self::Evening => "evening",
        }
    }

    /// The one of this name; `None` if there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|environment| environment.name() == name)
    }

    /// Its map: always the same one in memory.
    pub fn map(self) -> Arc<EnvironmentMap> {
        static MAPS: LazyLock<[Arc<EnvironmentMap>; 3]> = LazyLock::new(|| {
            let radiance: [fn(DVec3) -> Vec3; 3] = [studio_radiance, overcast_radiance, evening_radiance];
            let map = |kind: BuiltInEnvironment| Arc::new(render(kind.name(), radiance[kind as usize]));
            BuiltInEnvironment::ALL.map(map)
        });
        MAPS[self as usize].clone()
    }
}

/// The map of a function of the (unit) direction.
fn render(name: &str, radiance: impl Fn(DVec3) -> Vec3) -> EnvironmentMap {
    let mut map = EnvironmentMap { name: name.into(), width: WIDTH, height: HEIGHT, texels: Vec::new() };
    let cells =
        (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| DVec2::new(f64::from(x), f64::from(y)) + 0.5));
    map.texels = cells.map(|position| radiance(map.direction_at(position)).to_array()).collect();
    map
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Irradiance/π of a wall of this normal: the radiance of a white one.
    fn white_wall(environment: BuiltInEnvironment, normal: DVec3) -> Vec3 {
        let (map, n) = (environment.map(), 300);
        let mut sum = Vec3::ZERO;
        for k in 0..n * n {
            let (u, v) = (f64::from(k % n) + 0.5, f64::from(k / n) + 0.5);
            let (z, turn) = (1.0 - 2.0 * v / f64::from(n), std::f64::consts::TAU * u / f64::from(n));
            let flat = (1.0 - z * z).sqrt();
            let direction = DVec3::new(flat * turn.cos(), z, flat * turn.sin());
            sum += map.radiance(direction) * normal.dot(direction).max(0.0) as f32;
        }
        sum * 4.0 / (n * n) as f32
    }

    #[test]
    fn each_lights_a_white_scene_to_about_1() {
        for environment in BuiltInEnvironment::ALL {
            let walls = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::Z, DVec3::NEG_Z];
            let brightest =
                walls.map(|normal| white_wall(environment, normal).y).into_iter().fold(0.0, f32::max);
            assert!((0.7..1.6).contains(&brightest), "{environment:?}: {brightest}");
        }
    }

    #[test]
    fn the_evening_is_warm_toward_the_sun_and_cool_opposite() {
        let [sunlit, opposite] =
            [DVec3::Z, DVec3::NEG_Z].map(|normal| white_wall(BuiltInEnvironment::Evening, normal));
        assert!(sunlit.x > 1.3 * sunlit.z && opposite.z > opposite.x, "{sunlit} {opposite}");
        let [left, right] =
            [DVec3::X, DVec3::NEG_X].map(|normal| white_wall(BuiltInEnvironment::Overcast, normal).y);
        assert!((left / right - 1.0).abs() < 0.1, "no side of a cloudy sky is brighter: {left} {right}");
    }

    #[test]
    fn names_are_found_again_and_maps_are_finite() {
        for environment in BuiltInEnvironment::ALL {
            assert_eq!(BuiltInEnvironment::from_name(environment.name()), Some(environment));
            assert!(
                environment.map().texels.iter().flatten().all(|value| value.is_finite() && *value >= 0.0)
            );
        }
        assert_eq!(BuiltInEnvironment::from_name("night"), None);
    }
}
