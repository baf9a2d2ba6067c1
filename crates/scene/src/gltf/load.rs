//! From a file to a scene: the steps of reading one, from top to bottom.

use crate::error::{Fault, Stop};
use crate::gltf::animation::pose::{PosedScene, RestParts, RestTriangle};
use crate::gltf::animation::{self, Animation, AnimationTime};
use crate::gltf::compressed;
use crate::gltf::document::{Document, nonempty_name};
use crate::gltf::extension;
use crate::gltf::geometry::assembly::{Placement, append_primitive};
use crate::gltf::geometry::hierarchy::Hierarchy;
use crate::gltf::geometry::instancing;
use crate::gltf::geometry::primitive::Primitive;
use crate::gltf::geometry::skin;
use crate::gltf::geometry::triangulation::MODE_NAMES;
use crate::gltf::image_based_light;
use crate::gltf::lint;
use crate::gltf::materials::material_reader::{MaterialReader, default_material};
use crate::gltf::materials::variants::Variants;
use crate::gltf::punctual_light;
use crate::gltf::scene_cameras;
use crate::gltf::source::{GltfSource, PartSource};
use crate::gltf::splats;
use crate::{Inspection, LoadOptions, Material, Node, Scene, SceneError};
use glam::{DMat4, DQuat, Vec3};
use progress::{Progress, Unwatched};
use std::collections::HashMap;
use std::panic::AssertUnwindSafe;
use std::path::Path;
use std::sync::Arc;

/// Reads a .glb or .gltf file, and the files in its folder that it refers to.
///
/// # Errors
/// [`SceneError::NoTriangles`] if there is nothing to render, [`SceneError::Bad`] for every fault that affects the
/// picture, [`SceneError::Cancelled`] if `progress` is cancelled. Harmless defects are listed in [`Scene::warnings`].
pub fn load(path: &Path, options: &LoadOptions, progress: &dyn Progress) -> Result<Scene, SceneError> {
    let (scene, inspection) = load_and_inspect(path, options, progress)?;
    if scene.triangles.is_empty() {
        let other_primitives: Vec<String> = (inspection.primitives.iter().zip(MODE_NAMES))
            .filter(|&(&count, _)| count > 0)
            .map(|(count, name)| format!("{count} × {name}"))
            .collect();
        let why = match (inspection.meshes, other_primitives.is_empty()) {
            (0, _) => "the file has no mesh".into(),
            _ if inspection.hidden_nodes > 0 => {
                format!("{} of its nodes are hidden (KHR_node_visibility)", inspection.hidden_nodes)
            }
            (_, true) => "its meshes are empty".into(),
            (_, false) => {
                format!("the file has {}, none of which shows a triangle", other_primitives.join(", "))
            }
        };
        // What was left out explains more than the count.
        let left_out = scene.warnings.iter().find(|warning| warning.contains("left out"));
        let why = left_out.map_or_else(|| why.clone(), |warning| format!("{why}; {warning}"));
        return Err(SceneError::NoTriangles { file: path.into(), why });
    }
    progress.report(1.0);
    Ok(scene)
}

/// Summarises a .glb or .gltf file; unlike [`load`] it also opens files without a triangle.
///
/// # Errors
/// As [`load`], except [`SceneError::NoTriangles`].
pub fn inspect(path: &Path, options: &LoadOptions) -> Result<Inspection, SceneError> {
    Ok(load_and_inspect(path, options, &Unwatched)?.1)
}

/// Reads a .glb or .gltf file in order to write it again, and passes it to `work`.
///
/// # Errors
/// As [`load`], except [`SceneError::NoTriangles`].
pub fn with_source<T>(
    path: &Path,
    options: &LoadOptions,
    progress: &dyn Progress,
    work: impl FnOnce(&GltfSource<'_>) -> T,
) -> Result<T, SceneError> {
    catch_panics(path, || {
        let bytes = read_file(path, options)?;
        let document = parse_document(path, &bytes, options)?;
        let mut parts = Some(Vec::new());
        let variants = Variants::read(&document, options.variant.as_deref())?;
        let (scene, ..) = read_geometry(path, &document, &variants, &mut parts, progress)?;
        Ok(work(&GltfSource { document: &document, scene, parts: parts.unwrap_or_default() }))
    })
}

/// The scene of a file at any time of its animations.
pub struct AnimatedScene {
    rest: Arc<Scene>,
    options: LoadOptions,
    animations: Vec<Animation>,
    parts: RestParts,
    /// Indices of the file's materials that are in use at rest.
    materials: Vec<usize>,
}

impl AnimatedScene {
    /// Opens the file of a scene that was read with these options; the variant is the scene's.
    ///
    /// # Errors
    /// As [`load`]; and the file has changed since the scene was read.
    pub fn open(
        rest: Arc<Scene>,
        options: &LoadOptions,
        progress: &dyn Progress,
    ) -> Result<Self, SceneError> {
        let options = LoadOptions { variant: rest.variant.clone(), ..options.clone() };
        let path = rest.path.clone();
        catch_panics(&path, || {
            let bytes = read_file(&path, &options)?;
            let document = parse_document(&path, &bytes, &options)?;
            let variants = Variants::read(&document, options.variant.as_deref())?;
            let mut sources = Some(Vec::new());
            let (scene, _, used) = read_geometry(&path, &document, &variants, &mut sources, progress)?;
            if !scene.is_surface_of(&rest) {
                return Err(file_changed().into());
            }
            let parts = RestParts::new(&scene, &sources.unwrap_or_default());
            let materials = used.first_user_by_material.into_keys().collect();
            Ok(Self { rest, options, animations: animation::list_animations(&document), parts, materials })
        })
    }

    /// The scene at rest.
    pub fn rest(&self) -> &Arc<Scene> {
        &self.rest
    }

    /// The animations of the file, in order.
    pub fn animations(&self) -> &[Animation] {
        &self.animations
    }

    /// The scene at a time. Its cameras have the focus distances of those at rest; its world and rendering options
    /// are those of the scene at rest.
    ///
    /// # Errors
    /// As [`load`], except that there may be no triangle; and the animation does not exist.
    pub fn pose_at(&self, moment: &AnimationTime, progress: &dyn Progress) -> Result<PosedScene, SceneError> {
        let (rest, path) = (&self.rest, &self.rest.path);
        catch_panics(path, || {
            let bytes = read_file(path, &self.options)?;
            let document = parse_document(path, &bytes, &self.options)?;
            let animated = animation::apply_animation(&document, moment)?;
            let document = document.with_root(animated.root)?;
            let variants = Variants::read(&document, self.options.variant.as_deref())?;
            let mut sources = Some(Vec::new());
            let (mut scene, _, used) = read_geometry(path, &document, &variants, &mut sources, progress)?;
            let has_rest_materials =
                used.first_user_by_material.keys().all(|material| self.materials.contains(material));
            if !has_rest_materials
                || animated.changes_materials
                || used.uses_default && !self.has_default(&document)
            {
                let mut materials = MaterialReader::new(&document);
                used.read_into(&mut scene, &document, &mut materials)?;
                scene.images = materials.into_images();
            } else {
                (scene.materials, scene.images) = (rest.materials.clone(), rest.images.clone());
            }
            scene.normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
            self.copy_static_state(&mut scene);
            let mut rest_triangles =
                self.parts.rest_triangles(&scene, &sources.unwrap_or_default()).ok_or_else(file_changed)?;
            let unmoved = |triangle| Some(RestTriangle { triangle, is_flipped: false });
            rest_triangles.extend(scene.add_floor_of(rest).map(unmoved));
            rest_triangles.extend(scene.add_splats_of(rest).map(unmoved));
            let mut warnings = document.warnings();
            warnings.retain(|warning| !rest.warnings.contains(warning));
            scene.warnings = warnings;
            Ok(PosedScene { scene, rest_triangles })
        })
    }

    /// Whether the scene at rest uses glTF's default material.
    fn has_default(&self, document: &Document<'_>) -> bool {
        let added = usize::from(self.rest.splats.is_some()) + usize::from(self.rest.floor.is_some());
        self.rest.materials.len() - added > document.len("materials")
    }

    /// Copies what is not animated from the scene at rest.
    fn copy_static_state(&self, scene: &mut Scene) {
        let rest = &self.rest;
        scene.variant = rest.variant.clone();
        scene.variants = rest.variants.clone();
        scene.embedded_world = rest.embedded_world.clone();
        scene.world = rest.world.clone();
        scene.back_faces = rest.back_faces;
        if rest.has_default_camera {
            (scene.cameras, scene.has_default_camera) = (rest.cameras.clone(), true);
        } else if scene.cameras.len() == rest.cameras.len() {
            for (camera, at_rest) in scene.cameras.iter_mut().zip(&rest.cameras) {
                camera.focus_distance = at_rest.focus_distance;
            }
        }
    }
}

fn file_changed() -> Fault {
    Fault::NotGltf("it has changed since it was opened".into())
}

/// Reads a file.
fn load_and_inspect(
    path: &Path,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<(Scene, Inspection), SceneError> {
    catch_panics(path, || read_scene(path, options, progress))
}

/// Runs `work` for the file at `path`; panics of decoders become errors.
fn catch_panics<T>(path: &Path, work: impl FnOnce() -> Result<T, Stop>) -> Result<T, SceneError> {
    let result = std::panic::catch_unwind(AssertUnwindSafe(work));
    let stop = match result {
        Ok(Ok(read)) => return Ok(read),
        Ok(Err(stop)) => stop,
        Err(panic) => {
            let text =
                panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
            Fault::Panicked(text.unwrap_or("for an unknown reason").into()).into()
        }
    };
    Err(match stop {
        Stop::Cancelled => SceneError::Cancelled(progress::Cancelled),
        Stop::Fault(fault) => SceneError::Bad { file: path.into(), fault },
    })
}

fn read_scene(
    path: &Path,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<(Scene, Inspection), Stop> {
    let bytes = read_file(path, options)?;
    let document = parse_document(path, &bytes, options)?;
    progress.check()?;

    let variants = Variants::read(&document, options.variant.as_deref())?;
    let (mut scene, hierarchy, used) = read_geometry(path, &document, &variants, &mut None, progress)?;
    scene.variant = variants.selected_name().map(String::from);
    scene.variants = variants.names;
    let mut materials = MaterialReader::new(&document);
    used.read_into(&mut scene, &document, &mut materials)?;
    scene.images = materials.into_images();
    scene.embedded_world = image_based_light::read_embedded_world(&document)?;
    scene.normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
    splats::add_splats(&mut scene, &document, &hierarchy, progress)?;
    add_missing_camera(&document, &mut scene);
    lint::lint(&document);
    let animations = animation::list_animations(&document);
    scene.warnings = document.warnings();
    let inspection = count_contents(&document, &hierarchy, &scene, animations);
    Ok((scene, inspection))
}

fn parse_document<'a>(path: &Path, bytes: &'a [u8], options: &LoadOptions) -> Result<Document<'a>, Fault> {
    let folder = crate::gltf::document::canonical_folder(path).map_err(Fault::Unreadable)?;
    let document = compressed::decompress(Document::parse(bytes, folder, options)?)?;
    extension::check(&document)?;
    Ok(document)
}

/// The geometry that the nodes show in a variant, and the materials in use. If `sources` is given, the origin of each
/// part in the file is appended to it.
fn read_geometry(
    path: &Path,
    document: &Document<'_>,
    variants: &Variants,
    sources: &mut Option<Vec<PartSource>>,
    progress: &dyn Progress,
) -> Result<(Scene, Hierarchy, MaterialUses), Stop> {
    let mut scene = Scene { path: path.into(), ..Scene::default() };
    let hierarchy = Hierarchy::read(document)?;
    let mut used = MaterialUses::default();
    for (i, &index) in hierarchy.shown.iter().enumerate() {
        progress.report(i as f32 / hierarchy.shown.len() as f32);
        let Some(node) = document.typed().nodes().nth(index) else { continue };
        let Some(world) = hierarchy.world[index] else { continue };
        scene.cameras.extend(scene_cameras::node_camera(document, &node, world)?);
        if hierarchy.hidden[index] {
            continue;
        }
        scene.lights.extend(punctual_light::node_light(document, &node, world)?);
        let mesh = MeshNode { document, variants, hierarchy: &hierarchy, node, world };
        mesh.append_to(&mut scene, &mut used, sources, progress)?;
    }
    Ok((scene, hierarchy, used))
}

/// The bytes of a regular file within the size limit.
fn read_file(path: &Path, options: &LoadOptions) -> Result<Vec<u8>, Fault> {
    let size = std::fs::metadata(path).map_err(Fault::Unreadable)?;
    if !size.is_file() {
        return Err(Fault::NotGltf("it is not a regular file".into()));
    }
    if size.len() > options.max_memory {
        let limit = options.max_memory >> 20;
        return Err(Fault::TooBig {
            what: format!("the file has {} MiB, the limit is {limit} MiB", size.len() >> 20),
        });
    }
    std::fs::read(path).map_err(Fault::Unreadable)
}

/// The materials in use, in the order of the file, the default one last.
#[derive(Default)]
struct MaterialUses {
    /// For each of the file's materials, the place of its first use.
    first_user_by_material: HashMap<usize, String>,
    uses_default: bool,
}

impl MaterialUses {
    /// Notes a use of a material of the file; returns its index in the scene.
    fn note_use(&mut self, document: &Document<'_>, material: Option<usize>, place: &str) -> u32 {
        match material {
            Some(index) => {
                self.first_user_by_material.entry(index).or_insert_with(|| format!("{place}/material"));
                index as u32
            }
            None => {
                self.uses_default = true;
                document.len("materials") as u32
            }
        }
    }

    /// Reads the materials. One that is not in use gets its name and nothing else.
    fn read_into(
        self,
        scene: &mut Scene,
        document: &Document<'_>,
        reader: &mut MaterialReader<'_>,
    ) -> Result<(), Fault> {
        for index in 0..document.len("materials") {
            scene.materials.push(match self.first_user_by_material.get(&index) {
                Some(place) => reader.read(index, place)?,
                None => Material { name: reader.material_name(index), ..default_material() },
            });
        }
        if self.uses_default {
            scene.materials.push(default_material());
        }
        Ok(())
    }
}

/// A node whose mesh is being added to the scene.
struct MeshNode<'a> {
    document: &'a Document<'a>,
    variants: &'a Variants,
    hierarchy: &'a Hierarchy,
    node: gltf::Node<'a>,
    world: DMat4,
}

impl MeshNode<'_> {
    /// Appends every primitive of every instance of the node's mesh.
    fn append_to(
        &self,
        scene: &mut Scene,
        used: &mut MaterialUses,
        sources: &mut Option<Vec<PartSource>>,
        progress: &dyn Progress,
    ) -> Result<(), Stop> {
        let (document, node) = (self.document, &self.node);
        let place = format!("/nodes/{}", node.index());
        document.check_at(&format!("{place}/mesh"))?;
        let Some(mesh) = node.mesh() else { return Ok(()) };
        document.check_at(&format!("{place}/weights"))?;
        document.check_at(&format!("/meshes/{}/weights", mesh.index()))?;
        let weights = node.weights().or(mesh.weights()).unwrap_or_default();
        let weights: Vec<f64> = weights.iter().copied().map(f64::from).collect();
        let primitives = self.read_primitives(&mesh, &weights, used, progress)?;
        if primitives.is_empty() {
            return Ok(());
        }
        document.check_at(&format!("{place}/skin"))?;
        let joints = match node.skin() {
            Some(skin) => Some(skin::joint_matrices(document, self.hierarchy, &skin)?),
            None => None,
        };
        let instances = match joints {
            Some(_) => vec![DMat4::IDENTITY],
            None => instancing::instance_matrices(document, node)?,
        };
        let is_instanced = node.extension_value(instancing::EXTENSION).is_some() && instances.len() > 1;
        for (i, instance) in instances.into_iter().enumerate() {
            let first_part = scene.parts.len();
            for (index, primitive, material) in &primitives {
                progress.check()?;
                if i > 0 {
                    document.budget.take_triangles(primitive.triangles.len() as u64)?;
                }
                let placement = match &joints {
                    Some(joints) if !primitive.influences.is_empty() => Placement::Skinned(joints),
                    _ => Placement::Rigid(self.world * instance),
                };
                let scene_node = scene.nodes.len() as u32;
                let shown = append_primitive(scene, document, primitive, &placement, scene_node, *material)?;
                if let Some(sources) = sources.as_mut().filter(|_| !shown.vertices.is_empty()) {
                    let elements = shown.vertices.iter().map(|&v| primitive.elements[v as usize]);
                    sources.push(PartSource {
                        node: node.index(),
                        instance: is_instanced.then_some((i, instance)),
                        mesh: mesh.index(),
                        primitive: *index,
                        vertices: elements.collect(),
                        triangles: shown.triangles,
                    });
                }
            }
            if scene.parts.len() > first_part {
                let index = node.index();
                let name = nonempty_name(node.name()).unwrap_or_else(|| format!("node {index}"));
                scene.nodes.push(Node { name, index: index as u32, world: self.world * instance });
            }
        }
        primitives.into_iter().for_each(|(_, primitive, _)| primitive.release(document));
        Ok(())
    }

    /// The primitives of a mesh that have triangles, with their index in the mesh and their material in the scene.
    fn read_primitives(
        &self,
        mesh: &gltf::Mesh<'_>,
        weights: &[f64],
        used: &mut MaterialUses,
        progress: &dyn Progress,
    ) -> Result<Vec<(usize, Primitive, u32)>, Stop> {
        let document = self.document;
        let mut primitives = Vec::new();
        let place = format!("/meshes/{}", mesh.index());
        document.check_at(&place)?;
        document.check_at(&format!("{place}/primitives"))?;
        for file in mesh.primitives() {
            progress.check()?;
            let place = format!("{place}/primitives/{}", file.index());
            match Primitive::read(document, &file, &place, self.variants, weights) {
                Ok(Some(primitive)) => {
                    let material = used.note_use(document, primitive.material, &primitive.place);
                    primitives.push((file.index(), primitive, material));
                }
                Ok(None) => {}
                Err(fault @ Fault::NoData { .. }) => {
                    document.warn(format!("{place}: left out, because of {fault}"))
                }
                Err(fault) => return Err(fault.into()),
            }
        }
        Ok(primitives)
    }
}

/// Adds a camera if the file has none. Missing light comes from the world.
fn add_missing_camera(document: &Document<'_>, scene: &mut Scene) {
    if scene.triangles.is_empty() {
        return;
    }
    if scene.cameras.is_empty() {
        scene.cameras.push(scene_cameras::framing_camera(scene, DQuat::IDENTITY));
        scene.has_default_camera = true;
    }
    scene_cameras::focus_cameras(scene);
    let needs_light = scene.parts.iter().any(|part| !scene.materials[part.material as usize].unlit);
    let is_dark = !scene.lights.is_empty() && scene.lights.iter().all(|light| light.intensity == Vec3::ZERO);
    if needs_light && is_dark && !scene.has_emissive_materials() && scene.embedded_world.is_none() {
        document.warn("all of its lights have an intensity of 0; surfaces that need light are black");
    }
}

/// Counts the file's contents.
fn count_contents(
    document: &Document<'_>,
    hierarchy: &Hierarchy,
    scene: &Scene,
    animation_list: Vec<Animation>,
) -> Inspection {
    let mut primitives = [0; 7];
    for mesh in document.typed().meshes() {
        for primitive in mesh.primitives() {
            let place = format!("/meshes/{}/primitives/{}", mesh.index(), primitive.index());
            if document.check_at(&format!("{place}/mode")).is_ok() {
                primitives[primitive.mode().as_gl_enum() as usize] += 1;
            }
        }
    }
    Inspection {
        generator: document.typed().as_json().asset.generator.clone(),
        nodes: document.len("nodes"),
        hidden_nodes: hierarchy.shown.iter().filter(|&&node| hierarchy.hidden[node]).count(),
        meshes: document.len("meshes"),
        primitives,
        materials: document.len("materials"),
        variants: scene.variants.clone(),
        images: document.len("images"),
        cameras: document.len("cameras"),
        lights: document.len("lights"),
        skins: document.len("skins"),
        animations: document.len("animations"),
        animation_list,
        triangles: scene.surface_triangles().len(),
        splats: scene.splats.as_ref().map_or(0, |splats| splats.cloud.len()),
        extensions_used: extension::used(document).map(String::from).collect(),
        extensions_required: extension::required(document).map(String::from).collect(),
        warnings: scene.warnings.clone(),
    }
}
