"""What was painted, into Blender: the focus map as an image and as attributes, its UV map, the lens, the picture."""

import json
from pathlib import Path

import bpy
import numpy as np

from . import camera_lens, exr_file, handover, meshes_back, program
from .names import ATTRIBUTES, FOCUS_IMAGE, PICTURE, BridgeError


def commands(folder, picture=True):
    """What the program is asked for a project's state, into `back` within the folder: commands of a `program.Queue`."""
    folder = Path(folder)
    project = folder / handover.read(folder)["project"]
    if not project.is_file():
        raise BridgeError(f"{project}: is missing (save it in Focus Brush, or open the scene there again)")
    back = folder / "back"
    back.mkdir(exist_ok=True)
    asked = [
        (("export", project, "--glb", back / "scene.glb", "--focus-map", back / "focus.exr"), None),
        (("info", project, "--json"), back / "info.json"),
    ]
    return asked + ([(("render", project, "-o", back / "picture.exr"), None)] if picture else [])


def fetch(found, folder, picture=True):
    """Asks the program, and waits for it."""
    program.Queue(found, commands(folder, picture)).finish()


def apply(scene, folder):
    """Puts what was fetched into the scene. Gives what there is to tell, a sentence each."""
    manifest, back, told = handover.read(folder), Path(folder) / "back", []
    camera = json.loads((back / "info.json").read_text(encoding="utf-8"))["camera"]
    planes, _ = exr_file.read(back / "focus.exr")
    focus_image(planes)
    meshes_back.forget_copies()
    copies = []
    for placed in meshes_back.placed_meshes(back / "scene.glb"):
        target, is_own = meshes_back.give_uv(scene, placed)
        focus_attributes(target.data, planes)
        if not is_own:
            copies.append(placed.name)
    if copies:
        told.append(f"{len(copies)} objects have corners of their own for the map, in the collection Focus Brush: {', '.join(copies[:8])}")
    shot = scene.objects.get(manifest["camera"])
    if shot is None:
        told.append(f"{manifest['camera']}: there is no camera of this name any more; the lens stays behind")
    else:
        camera_lens.set_pose(shot, camera["camera_to_world"])
        camera_lens.set_lens(shot, camera, camera["yfov"], scene)
    if (back / "picture.exr").is_file():
        picture_image(back / "picture.exr")
    return told


def focus_image(planes):
    """The map as an image: t in red, anchor in green, gloss in blue."""
    height, width = planes["focus.t"].shape
    image = bpy.data.images.get(FOCUS_IMAGE)
    if image is not None and tuple(image.size) != (width, height):
        bpy.data.images.remove(image)
        image = None
    if image is None:
        image = bpy.data.images.new(FOCUS_IMAGE, width, height, alpha=False, float_buffer=True)
        image.colorspace_settings.name = "Non-Color"
    texels = np.ones((height, width, 4), np.float32)
    texels[..., 0], texels[..., 1] = planes["focus.t"], planes["focus.anchor"]
    texels[..., 2] = planes.get("focus.gloss", 0)
    image.pixels.foreach_set(texels[::-1].ravel())
    image.update()
    image.pack()
    return image


def focus_attributes(mesh, planes):
    """What the map says at each corner, as attributes."""
    layer = mesh.uv_layers.get(meshes_back.UV_MAP)
    if layer is None:
        return
    uv = np.empty(2 * len(mesh.loops), np.float32)
    layer.data.foreach_get("uv", uv)
    uv = uv.reshape(-1, 2)
    for channel, name in ATTRIBUTES.items():
        if channel not in planes:
            continue
        attribute = mesh.attributes.get(name)
        if attribute is None or attribute.domain != "CORNER" or attribute.data_type != "FLOAT":
            if attribute is not None:
                mesh.attributes.remove(attribute)
            attribute = mesh.attributes.new(name, "FLOAT", "CORNER")
        attribute.data.foreach_set("value", _sampled(planes[channel], uv))
    mesh.update()


def _sampled(plane, uv):
    """Bilinear, row 0 on top, v upwards."""
    height, width = plane.shape
    x = np.clip(uv[:, 0] * width - 0.5, 0, width - 1)
    y = np.clip((1 - uv[:, 1]) * height - 0.5, 0, height - 1)
    x0, y0 = x.astype(int), y.astype(int)
    x1, y1 = np.minimum(x0 + 1, width - 1), np.minimum(y0 + 1, height - 1)
    fx, fy = x - x0, y - y0
    upper = plane[y0, x0] * (1 - fx) + plane[y0, x1] * fx
    lower = plane[y1, x0] * (1 - fx) + plane[y1, x1] * fx
    return (upper * (1 - fy) + lower * fy).astype(np.float32)


def picture_image(file):
    """The picture into the image editors that show none or an older one."""
    image = bpy.data.images.get(PICTURE)
    if image is None:
        image = bpy.data.images.load(str(file))
        image.name = PICTURE
    else:
        image.filepath = str(file)
        image.reload()
    for screen in bpy.data.screens:
        for area in screen.areas:
            if area.type == "IMAGE_EDITOR" and area.spaces.active.image in (None, image):
                area.spaces.active.image = image
    return image
