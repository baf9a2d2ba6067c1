"""A scene as Focus Brush opens it: a folder with all that it needs, and a manifest for the way back.

    scene.glb          the geometry that is rendered, modifiers applied, cameras with lenses, lights
    world.json         and world.exr, what lies beyond
    NAME.fbrush        the project, made by the program
    focus-brush.json   the manifest
"""

import json
from pathlib import Path

import bpy

from . import camera_lens, program, world_light
from .names import BridgeError
from .shown import as_rendered, shown_scene

MANIFEST = "focus-brush.json"
FORMAT = "focus-brush handover"


def folder_of(chosen):
    """The folder that was chosen, absolute; made if it is not there."""
    if chosen.startswith("//") and not bpy.data.filepath:
        raise BridgeError("The folder lies beside the .blend file, and that is not saved yet (save it, or choose another folder)")
    if not chosen.strip():
        raise BridgeError("No folder is chosen for what goes over (choose one in the sidebar)")
    folder = Path(bpy.path.abspath(chosen))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BridgeError(f"{folder}: cannot be made: {error} (choose another folder)") from error
    return folder


def export_glb(scene, path, animation=False, only_seen_lights=False):
    """Writes what a render of the scene shows. Gives what does not come along, a sentence each."""
    if animation:
        with as_rendered.tagged(scene) as going:
            # One animation of all that moves, as the scene plays it; its first frame is at 0 s.
            _export(
                path,
                use_renderable=False,
                export_animations=True,
                export_animation_mode="SCENE",
                export_anim_scene_split_object=False,
                export_anim_slide_to_zero=True,
                export_current_frame=False,
            )
    else:
        with shown_scene.of(scene, only_seen_lights) as going:
            _export(path, export_animations=False, export_current_frame=True)
    return going.told


def _export(path, **chosen):
    done = bpy.ops.export_scene.gltf(
        filepath=str(path),
        check_existing=False,
        export_format="GLB",
        use_active_scene=True,
        export_apply=True,
        export_gn_mesh=True,
        export_yup=True,
        export_cameras=True,
        export_lights=True,
        export_import_convert_lighting_mode="COMPAT",
        **chosen,
    )
    if done != {"FINISHED"} or not Path(path).is_file():
        raise BridgeError(f"{path}: the glTF exporter wrote nothing (its reason stands in the system console)")


def check(scene):
    """Refuses a scene without a camera that has a lens."""
    if scene.camera is None:
        raise BridgeError(f"{scene.name}: has no active camera (make one the scene's camera)")
    if scene.camera.data.type != "PERSP":
        raise BridgeError(camera_lens.told_of(scene.camera, scene, scene.camera.matrix_world)[0])


def write(scene, folder, project="scene.fbrush", animation=False):
    """Writes scene, world and manifest; gives the manifest."""
    check(scene)
    folder = Path(folder)
    told = export_glb(scene, folder / "scene.glb", animation)
    world = world_light.write(scene, folder)
    told += world_light.told_of(scene.world)
    return save(folder, scene, world.name, project, "scene", told)


def save(folder, scene, world, project, light, told):
    """Writes the manifest of what lies in the folder; gives it. `light` says whose it is: "scene" or "cycles"."""
    manifest = {
        "format": FORMAT,
        "version": 1,
        "blend": bpy.data.filepath,
        "scene_name": scene.name,
        "frame": scene.frame_current,
        "camera": scene.camera.name,
        "camera_data": scene.camera.data.name,
        "scene": "scene.glb",
        "world": world,
        "project": project,
        "light": light,
        "told": told,
    }
    (Path(folder) / MANIFEST).write_text(json.dumps(manifest, indent=1) + "\n", encoding="utf-8")
    return manifest


def read(folder):
    """The manifest of a folder."""
    file = Path(folder) / MANIFEST
    try:
        manifest = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise BridgeError(f"{file}: is missing, so nothing went over from here yet (Open in Focus Brush first)") from error
    except (OSError, ValueError) as error:
        raise BridgeError(f"{file}: cannot be read: {error} (Open in Focus Brush again)") from error
    if manifest.get("format") != FORMAT or manifest.get("version") != 1:
        raise BridgeError(f"{file}: is of another version (Open in Focus Brush again)")
    return manifest


def project_commands(folder, manifest):
    """What the program is asked for the project: a new one, or, where there is one already, one that carries its paint over. Commands of
    a `program.Queue`, and what is to be done after them."""
    folder = Path(folder)
    project, after = folder / manifest["project"], folder / "next.fbrush"
    arguments = ["new", folder / manifest["scene"], "--camera", manifest["camera_data"], "--world", folder / manifest["world"]]
    if not project.is_file():
        return [([*arguments, "-o", project], None)], lambda: project

    def replaced():
        project.replace(project.with_name(f"{project.stem} before.fbrush"))
        return after.replace(project)

    return [([*arguments, "--paint-from", project, "-o", after], folder / "carried.txt")], replaced


def make_project(found, folder, manifest):
    """Makes the project, and waits for it. Gives its path."""
    asked, done = project_commands(folder, manifest)
    program.Queue(found, asked).finish()
    return done()
