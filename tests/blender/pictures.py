"""Makes the pictures of docs/guide/blender.md. Run with a Python that has bpy; FOCUS_BRUSH names the program."""

import importlib
import json
import sys

import workshop
from workshop import PLACE, PROGRAM, bpy

import numpy as np  # noqa: E402

workshop.install()
cycles_light, exr_file, focus_back, handover, meshes_back, names, program = (
    importlib.import_module(f"{workshop.MODULE}.{name}")
    for name in ("cycles_light", "exr_file", "focus_back", "handover", "meshes_back", "names", "program")
)

OUT = workshop.HERE.parent.parent / "docs" / "pictures" / "blender"
SIZE = (320, 200)
RECIPE = {"nodes": {"Rock": {"t": 1, "anchor": 1}, "Drop": {"t": 0.93, "anchor": 1}}}


def pixels(file):
    planes, _ = exr_file.read(file)
    return np.stack([planes[channel] for channel in "RGB"], -1)


def side_by_side(pictures, file):
    """Pictures of linear light, in sRGB, as PNG."""
    gap = np.ones((pictures[0].shape[0], 4, 3))
    joined = [part for picture in pictures for part in (picture, gap)][:-1]
    linear = np.clip(np.concatenate(joined, 1), 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    height, width, _ = encoded.shape
    image = bpy.data.images.new(file.stem, width, height)
    texels = np.ones((height, width, 4), np.float32)
    texels[..., :3] = encoded[::-1]
    image.pixels.foreach_set(texels.ravel())
    image.filepath_raw, image.file_format = str(file), "PNG"
    image.save()
    bpy.data.images.remove(image)


def light(samples):
    """Cycles' picture, ours of its light, and ours painted; then the map back in Blender."""
    scene = workshop.still(SIZE, 0.25, glass=True)
    folder = PLACE / "pictures"
    folder.mkdir()
    scene.camera.data.dof.use_dof = True
    theirs = workshop.render(scene, folder / "cycles.exr", samples=2 * samples)
    keep = folder / "still.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(keep), copy=True)
    manifest = cycles_light.bake(scene, PROGRAM, folder, 1024, samples)
    (folder / "recipe.json").write_text(json.dumps(RECIPE))
    project = handover.make_project(PROGRAM, folder, manifest)
    program.run(PROGRAM, "render", project, "-o", folder / "ours.exr")
    program.run(PROGRAM, "render", project, "--focus", folder / "recipe.json", "-o", folder / "painted.exr")
    side_by_side([pixels(theirs), pixels(folder / "ours.exr"), pixels(folder / "painted.exr")], OUT / "blender-light.png")
    program.run(PROGRAM, "new", folder / "scene.glb", "--camera", manifest["camera_data"], "--focus", folder / "recipe.json", "-o", project)
    bpy.ops.wm.open_mainfile(filepath=str(keep))
    return folder


def map_back(folder):
    """The attribute of the focus map on Blender's own surfaces."""
    scene = bpy.context.scene
    focus_back.fetch(PROGRAM, folder, picture=False)
    focus_back.apply(scene, folder)
    shown = bpy.data.materials.new("map")
    shown.use_nodes = True
    nodes, links = shown.node_tree.nodes, shown.node_tree.links
    nodes.clear()
    value, ramp, shine, out = (nodes.new(f"ShaderNode{kind}") for kind in ("Attribute", "MapRange", "Emission", "OutputMaterial"))
    value.attribute_name = names.ATTRIBUTES["focus.t"]
    ramp.inputs["From Min"].default_value, ramp.inputs["From Max"].default_value = 0.9, 1.1
    color = nodes.new("ShaderNodeValToRGB")
    color.color_ramp.elements[0].color, color.color_ramp.elements[1].color = (0.8, 0.1, 0.05, 1), (0.05, 0.2, 0.8, 1)
    middle = color.color_ramp.elements.new(0.5)
    middle.color = (0.5, 0.5, 0.5, 1)
    links.new(value.outputs["Fac"], ramp.inputs["Value"])
    links.new(ramp.outputs["Result"], color.inputs["Fac"])
    links.new(color.outputs["Color"], shine.inputs["Color"])
    links.new(shine.outputs["Emission"], out.inputs["Surface"])
    own = bpy.data.collections.get(names.COLLECTION)
    copies = list(own.objects) if own else []
    if own:
        own.hide_render = False
    replaced = {each.name.removesuffix(" (focus)") for each in copies}
    for each in [each for each in scene.objects if each.type == "MESH"]:
        each.hide_render = each.name in replaced
        each.data.materials.clear()
        each.data.materials.append(shown)
    scene.camera.data.dof.use_dof = False
    image = bpy.data.images[names.FOCUS_IMAGE]
    width, height = image.size
    t = np.array(image.pixels[:]).reshape(height, width, 4)[::-1, :, 0]
    drawn = pixels(workshop.render(scene, folder / "map.exr", samples=32))
    shade = np.clip((t - 0.9) / 0.2, 0, 1)[..., None]
    ends = np.array([(0.8, 0.1, 0.05), (0.5, 0.5, 0.5), (0.05, 0.2, 0.8)])
    atlas = np.where(shade < 0.5, ends[0] + (ends[1] - ends[0]) * 2 * shade, ends[1] + (ends[2] - ends[1]) * (2 * shade - 1))
    step = max(1, -(-height // SIZE[1]))
    small = atlas[::step, ::step]
    room = np.zeros((SIZE[1], small.shape[1], 3))
    room[: small.shape[0]] = small[: SIZE[1]]
    side_by_side([drawn, room], OUT / "blender-map.png")


if __name__ == "__main__":
    map_back(light(int(sys.argv[1]) if len(sys.argv) > 1 else 128))
