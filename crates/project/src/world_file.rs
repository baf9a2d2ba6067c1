//! World files, and the world of a project: environment and backdrop.
//!
//! ```json
//! {"environment": "FILE.hdr" | "FILE.exr" | "studio" | "overcast" | "evening" | "scene" | [r, g, b], "rotation": rad, "strength": 1.0,
//!  "backdrop": "environment" | [r, g, b], "bounces": null}
//! ```
//!
//! Defaults: the studio, 0, 1, the environment (for the studio a neutral grey), as many bounces as matter. A path is
//! relative to the folder of the file that names it.

use crate::ProjectError;
use crate::environment_file::read_environment;
use crate::json::{Field, Fields, Json};
use crate::named_file::named_file;
use crate::scene_path::ScenePath;
use glam::Vec3;
use scene::{Backdrop, BuiltInEnvironment, Environment, Scene, World};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const FIELDS: [&str; 5] = ["environment", "rotation", "strength", "backdrop", "bounces"];

/// A world as given by a file, its environment not yet loaded.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldFile {
    /// The source of its light.
    pub environment: EnvironmentChoice,
    /// About +Y, rad.
    pub rotation: f64,
    /// Scales its radiance, ≥ 0.
    pub strength: f32,
    /// What the camera sees where there is no surface; `None`: the environment's default.
    pub backdrop: Option<Backdrop>,
    /// See [`World::bounces`].
    pub bounces: Option<u32>,
}

/// The source of light from infinity.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentChoice {
    /// An equirectangular picture, .hdr or .exr.
    File(PathBuf),
    /// One that comes with the program.
    BuiltIn(BuiltInEnvironment),
    /// The one embedded in the scene's file ([`Scene::embedded_world`]).
    Scene,
    /// The same radiance from everywhere.
    Uniform(Vec3),
}

impl Default for WorldFile {
    fn default() -> Self {
        Self {
            environment: EnvironmentChoice::BuiltIn(BuiltInEnvironment::Studio),
            rotation: 0.0,
            strength: 1.0,
            backdrop: None,
            bounces: None,
        }
    }
}

impl WorldFile {
    /// Reads a world file.
    ///
    /// # Errors
    /// The file cannot be read, a field is unknown, or a value is out of range.
    pub fn read(file: &Path) -> Result<Self, ProjectError> {
        let json = Json::read(file)?;
        Self::from_fields(&Field::root(file, &json).object()?, &|name| named_file(file, name))
    }

    /// Describes `world`, that of a `scene` which was loaded before.
    pub fn from_world(world: &World, scene: &Scene) -> Self {
        let embedded = scene.embedded_world.as_ref().map(|own| &own.environment);
        let environment = match &world.environment {
            environment if Some(environment) == embedded => EnvironmentChoice::Scene,
            environment => match (environment.built_in(), environment) {
                (Some(built_in), _) => EnvironmentChoice::BuiltIn(built_in),
                (None, Environment::Map(map)) => EnvironmentChoice::File(PathBuf::from(&map.name)),
                (None, Environment::Uniform(color)) => EnvironmentChoice::Uniform(*color),
            },
        };
        Self {
            environment,
            rotation: world.rotation,
            strength: world.strength,
            backdrop: Some(world.backdrop),
            bounces: world.bounces,
        }
    }

    /// The world of an environment file alone, for light and backdrop.
    pub fn from_environment_file(file: &Path) -> Self {
        Self { environment: EnvironmentChoice::File(file.into()), ..Self::default() }
    }

    /// The world stored in a project at `file`.
    pub(crate) fn from_value(file: &Path, value: &Value) -> Result<Self, ProjectError> {
        let json = Json::parse(file, &value.to_string())?;
        // The sky of a project may lie anywhere, as its scene may.
        let folder = file.parent().unwrap_or(Path::new(""));
        Self::from_fields(&Field::root(file, &json).object()?, &|name| Ok(folder.join(name)))
    }

    /// The world of these fields; `find_file` finds the file of a sky by its name.
    fn from_fields(
        fields: &Fields<'_>,
        find_file: &dyn Fn(&str) -> Result<PathBuf, ProjectError>,
    ) -> Result<Self, ProjectError> {
        fields.allow_only(&FIELDS)?;
        let mut world = Self::default();
        if let Some(field) = fields.get("environment") {
            world.environment = match field.value {
                Json::Text(text) if text == "scene" => EnvironmentChoice::Scene,
                Json::Text(text) => match BuiltInEnvironment::from_name(text) {
                    Some(built_in) => EnvironmentChoice::BuiltIn(built_in),
                    None => EnvironmentChoice::File(find_file(text)?),
                },
                _ => EnvironmentChoice::Uniform(radiance(&field)?),
            };
        }
        if let Some(field) = fields.get("rotation") {
            world.rotation = field.number()?;
        }
        if let Some(field) = fields.get("strength") {
            world.strength = field.number()? as f32;
            if !(world.strength >= 0.0 && world.strength.is_finite()) {
                return Err(field.error("is not a strength", "give a number of 0 or more"));
            }
        }
        if let Some(field) = fields.get("backdrop") {
            world.backdrop = Some(match field.value {
                Json::Text(text) if text == "environment" => Backdrop::Environment,
                Json::Text(_) => {
                    return Err(field.error("is not a backdrop", "give \"environment\" or [r, g, b]"));
                }
                _ => Backdrop::Color(radiance(&field)?),
            });
        }
        if let Some(field) = fields.get("bounces").filter(|field| *field.value != Json::Null) {
            world.bounces = Some(field.whole_number()?);
        }
        Ok(world)
    }

    /// As JSON; a file's path becomes relative to `from`, the file that will contain it.
    pub fn to_json(&self, from: &Path) -> Value {
        let environment = match &self.environment {
            EnvironmentChoice::BuiltIn(built_in) => json!(built_in.name()),
            EnvironmentChoice::Scene => json!("scene"),
            EnvironmentChoice::Uniform(color) => json!(color.to_array()),
            EnvironmentChoice::File(file) => {
                json!(ScenePath::new(file, from).path)
            }
        };
        let mut json = json!({
            "environment": environment,
            "rotation": self.rotation,
            "strength": self.strength,
            "bounces": self.bounces,
        });
        match self.backdrop {
            Some(Backdrop::Environment) => json["backdrop"] = json!("environment"),
            Some(Backdrop::Color(color)) => json["backdrop"] = json!(color.to_array()),
            None => {}
        }
        json
    }

    /// Loads the environment and returns the world of `scene`, and warnings about the environment's file.
    ///
    /// # Errors
    /// The environment's file cannot be used, or the scene has no embedded world.
    pub fn load(&self, scene: &Scene) -> Result<(World, Vec<String>), ProjectError> {
        let mut warnings = Vec::new();
        let (environment, default_backdrop) = match &self.environment {
            EnvironmentChoice::BuiltIn(built_in) => {
                let world = World::built_in(*built_in);
                (world.environment, world.backdrop)
            }
            EnvironmentChoice::Scene => match &scene.embedded_world {
                Some(own) => (own.environment.clone(), own.backdrop),
                None => {
                    let problem =
                        "has no embedded environment (EXT_lights_image_based), which its world refers to";
                    return Err(ProjectError::content(&scene.path, problem, "choose another environment"));
                }
            },
            EnvironmentChoice::Uniform(color) => (Environment::Uniform(*color), Backdrop::Environment),
            EnvironmentChoice::File(file) => {
                let (map, faults) = read_environment(file)?;
                warnings = faults;
                (Environment::Map(Arc::new(map)), Backdrop::Environment)
            }
        };
        let world = World {
            environment,
            rotation: self.rotation,
            strength: self.strength,
            backdrop: self.backdrop.unwrap_or(default_backdrop),
            bounces: self.bounces,
        };
        Ok((world, warnings))
    }
}

fn radiance(field: &Field<'_>) -> Result<Vec3, ProjectError> {
    let color = Vec3::from_array(field.numbers::<3>()?.map(|channel| channel as f32));
    let is_radiance = color.is_finite() && color.cmpge(Vec3::ZERO).all();
    is_radiance
        .then_some(color)
        .ok_or_else(|| field.error("is not a radiance", "give three numbers of 0 or more"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::EnvironmentMap;
    use std::fs;

    fn read(text: &str) -> Result<WorldFile, ProjectError> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("world.json");
        fs::write(&file, text).unwrap();
        WorldFile::read(&file)
    }

    #[test]
    fn missing_fields_have_defaults() {
        assert_eq!(read("{}").unwrap(), WorldFile::default());
        let load = |text| read(text).unwrap().load(&Scene::default()).unwrap().0;
        let world = load("{}");
        assert_eq!(world, World::studio());
        let sky = load(r#"{"environment": [1, 2, 3], "strength": 0.5, "bounces": 2}"#);
        assert_eq!((sky.radiance(glam::DVec3::X), sky.bounces), (Vec3::new(0.5, 1.0, 1.5), Some(2)));
        assert_eq!(sky.backdrop_radiance(glam::DVec3::X), sky.radiance(glam::DVec3::X));
        let before_red = load(r#"{"backdrop": [1, 0, 0], "bounces": null}"#);
        assert_eq!((before_red.backdrop_radiance(glam::DVec3::X), before_red.bounces), (Vec3::X, None));
    }

    #[test]
    fn what_is_wrong_names_its_field() {
        for (text, field) in [
            (r#"{"environment": [1, 2]}"#, "environment"),
            (r#"{"environment": [1, 2, -1]}"#, "environment"),
            (r#"{"strength": -1}"#, "strength"),
            (r#"{"rotation": "left"}"#, "rotation"),
            (r#"{"backdrop": "sky"}"#, "backdrop"),
            (r#"{"bounces": 0.5}"#, "bounces"),
            (r#"{"sun": 1}"#, "sun"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(field), "{text}: {error}");
        }
        let error = read(r#"{"environment": "nowhere.hdr"}"#)
            .unwrap()
            .load(&Scene::default())
            .unwrap_err()
            .to_string();
        assert!(error.contains("nowhere.hdr"), "{error}");
        let error =
            read(r#"{"environment": "sky.png"}"#).unwrap().load(&Scene::default()).unwrap_err().to_string();
        assert!(error.contains("equirectangular"), "{error}");
    }

    #[test]
    fn it_is_written_as_it_was_read() {
        let world = WorldFile {
            environment: EnvironmentChoice::File("/somewhere/sky.exr".into()),
            rotation: 1.5,
            strength: 2.0,
            backdrop: Some(Backdrop::Color(Vec3::new(0.25, 0.5, 1.0))),
            bounces: Some(3),
        };
        let at = Path::new("/somewhere/else/scene.fbrush");
        let json = world.to_json(at);
        assert_eq!(json["environment"], "../sky.exr");
        let again = WorldFile::from_value(at, &json).unwrap();
        assert_eq!(
            again,
            WorldFile { environment: EnvironmentChoice::File("/somewhere/else/../sky.exr".into()), ..world }
        );
    }

    #[test]
    fn an_embedded_environment_is_named_as_such() {
        let map = EnvironmentMap { name: "light".into(), width: 2, height: 1, texels: vec![[2.0; 3]; 2] };
        let own = World { environment: Environment::Map(Arc::new(map)), ..World::uniform(Vec3::ZERO) };
        let scene = Scene { embedded_world: Some(own.clone()), path: "lit.glb".into(), ..Scene::default() };
        let world_file = read(r#"{"environment": "scene", "strength": 3}"#).unwrap();
        let (world, _) = world_file.load(&scene).unwrap();
        assert_eq!(world, World { strength: 3.0, ..own });
        assert_eq!(
            WorldFile::from_world(&world, &scene).to_json(Path::new("x.fbrush"))["environment"],
            "scene"
        );
        for built_in in BuiltInEnvironment::ALL {
            let stored = WorldFile::from_world(&World::built_in(built_in), &scene);
            assert_eq!(stored.environment, EnvironmentChoice::BuiltIn(built_in));
            let json = stored.to_json(Path::new("world.json")).to_string();
            assert_eq!(read(&json).unwrap().load(&scene).unwrap().0, World::built_in(built_in), "{json}");
        }
        let without = Scene { path: "dark.glb".into(), ..Scene::default() };
        let error = world_file.load(&without).unwrap_err().to_string();
        assert!(error.contains("dark.glb") && error.contains("EXT_lights_image_based"), "{error}");
    }
}
