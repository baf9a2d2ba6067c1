//! Files of Gaussian splats as scenes.

use crate::{CameraLens, Fault, Scene, SceneCamera, SceneError};
use gaussians::{CameraList, CapturedView, GaussianError, Placement, ReadOptions, SplatFile};
use glam::{DMat3, DQuat, DVec3};
use lens::Camera;
use progress::Progress;
use std::path::Path;
use std::sync::Arc;

/// Reads a file of Gaussian splats, or a folder of SOG. They stand upright: by the axes of their format, or by the views of `cameras.json`, if one is beside
/// them, which are then the scene's cameras; otherwise a default camera frames them.
///
/// # Errors
/// The file cannot be read or has no splats; a `variant` is requested, which such files do not have; or `progress` cancels.
pub fn load_splats(path: &Path, variant: Option<&str>, progress: &dyn Progress) -> Result<Scene, SceneError> {
    if let Some(name) = variant {
        let fault = Fault::NoVariant { name: name.into(), available: "splats have no variants".into() };
        return Err(SceneError::Bad { file: path.into(), fault });
    }
    let SplatFile { cloud, format, warnings } = gaussians::open(path, &ReadOptions::default(), progress)?;
    let (list, list_warning) = match camera_list(path) {
        Ok(list) => (list, None),
        Err(error) => (None, Some(format!("{error}; its views are left out"))),
    };
    let mut placement = Placement::upright(cloud.traits().axes);
    if let Some(up) = list.as_ref().and_then(CameraList::up) {
        let up = placement.rotation * up;
        placement.rotation =
            DMat3::from_quat(DQuat::from_rotation_arc(up.normalize(), DVec3::Y)) * placement.rotation;
    }
    let mut scene = Scene::from_splats(path.into(), name_of(path), Arc::new(cloud), placement, format.name());
    let views = list.map_or_else(Vec::new, |list| list.views);
    if !views.is_empty() {
        scene.set_cameras(views.iter().map(|view| scene_camera(view, &placement)).collect());
    }
    // Each warning names the file, which is added again where it is shown.
    let prefix = format!("{}: ", path.display());
    let warnings = warnings.into_iter().map(|warning| match warning.strip_prefix(&prefix) {
        Some(rest) => rest.into(),
        None => warning,
    });
    scene.warnings = warnings.chain(list_warning).collect();
    Ok(scene)
}

/// Adds the splats of a file to a scene of meshes, upright and about the scene's origin.
///
/// # Errors
/// The scene has splats already, the file cannot be read or has no splats; or `progress` cancels.
pub fn add_splat_file(scene: &mut Scene, path: &Path, progress: &dyn Progress) -> Result<(), SceneError> {
    if scene.splats.is_some() {
        let fault = Fault::SplatsTwice { added: path.into() };
        return Err(SceneError::Bad { file: scene.path.clone(), fault });
    }
    let SplatFile { cloud, format, warnings } = gaussians::open(path, &ReadOptions::default(), progress)?;
    let placement = Placement::upright(cloud.traits().axes);
    if !scene.has_light_sources() && scene.embedded_world.is_none() {
        scene.warnings.push(
            "no light is in the file, and splats give none: its surfaces are black unless a world is chosen \
             (the studio, for example)"
                .into(),
        );
    }
    scene.add_splats(name_of(path), Arc::new(cloud), placement, format.name());
    if let Some(splats) = scene.splats.as_mut().map(Arc::make_mut) {
        splats.file = Some(path.into());
    }
    scene.warnings.extend(warnings);
    scene.set_upright(DQuat::IDENTITY);
    Ok(())
}

/// The name of a scene: that of its file, or of its folder.
fn name_of(path: &Path) -> String {
    let is_list = path.file_name().is_some_and(|name| name == "meta.json");
    let named = if is_list { path.parent().unwrap_or(path) } else { path };
    named.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn camera_list(path: &Path) -> Result<Option<CameraList>, GaussianError> {
    CameraList::path_beside(path).map(|file| CameraList::read(&file)).transpose()
}

fn scene_camera(view: &CapturedView, placement: &Placement) -> SceneCamera {
    let camera = view.camera(placement, &Camera::default());
    SceneCamera {
        name: view.name.clone(),
        index: None,
        camera_to_world: camera.camera_to_world,
        yfov: view.yfov,
        aspect: Some(f64::from(view.width) / f64::from(view.height)),
        focus_distance: 1.0,
        lens: CameraLens::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::World;
    use gaussians::{CloudBuilder, CloudTraits, Splat, write_ply};
    use glam::{Quat, Vec3};
    use progress::Unwatched;

    fn write_file(path: &Path) {
        let mut builder = CloudBuilder::new(0, 64);
        for k in 0..64u32 {
            let mean = Vec3::new((k % 8) as f32 - 3.5, (k / 8) as f32 - 3.5, 5.0) * 0.2;
            let splat = Splat {
                mean,
                rotation: Quat::IDENTITY,
                log_scale: Vec3::splat(0.15f32.ln()),
                opacity: 0.95,
                base_color: Vec3::ZERO,
            };
            builder.push(splat, &[]);
        }
        let cloud = builder.finish(CloudTraits::default());
        write_ply(&mut std::fs::File::create(path).unwrap(), &cloud).unwrap();
    }

    #[test]
    fn splats_stand_upright_and_are_framed_or_seen_as_they_were_photographed() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("room.ply");
        write_file(&file);
        let scene = load_splats(&file, None, &Unwatched).unwrap();
        assert!(scene.has_default_camera && scene.nodes[0].name == "room" && scene.warnings.is_empty());
        // 3DGS looks along +z with y down.
        let (low, high) = scene.bounds();
        assert!((0.5 * (low + high)).distance(DVec3::NEG_Z) < 1e-3, "{low} {high}");
        let view = r#"[{"img_name": "left", "width": 80, "height": 60, "position": [0, 0, 0],
            "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "fy": 60.0}]"#;
        std::fs::write(folder.path().join("cameras.json"), view).unwrap();
        let scene = load_splats(&file, None, &Unwatched).unwrap();
        let camera = &scene.cameras[0];
        assert!(!scene.has_default_camera && camera.name == "left");
        assert!((camera.focus_distance - 1.0).abs() < 0.05, "{}", camera.focus_distance);
        assert!(camera.camera_to_world.y_axis.truncate().distance(DVec3::Y) < 1e-9);
        std::fs::write(folder.path().join("cameras.json"), "{").unwrap();
        let scene = load_splats(&file, None, &Unwatched).unwrap();
        assert!(scene.has_default_camera && scene.warnings[0].ends_with("its views are left out"));
        assert!(load_splats(&file, Some("red"), &Unwatched).unwrap_err().to_string().contains("no variant"));
        assert!(load_splats(&folder.path().join("none.ply"), None, &Unwatched).is_err());
    }

    #[test]
    fn surfaces_beside_splats_that_nothing_lights_are_reported() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("room.ply");
        write_file(&file);
        for (embedded_world, warnings) in [(None, 1), (Some(World::studio()), 0)] {
            let mut scene = Scene { embedded_world, ..Scene::default() };
            add_splat_file(&mut scene, &file, &Unwatched).unwrap();
            assert_eq!(scene.warnings.len(), warnings, "{:?}", scene.warnings);
        }
    }
}
