"""The world as a picture of all directions, and our world file that names it.

One colour stays one; everything else is rendered by Cycles through a panoramic camera, so any nodes will do. The camera looks along
+X, which is the middle of an equirectangular picture in Blender and in Focus Brush alike.
"""

import json
import math
from pathlib import Path

import bpy

WIDTH = 2048
SAMPLES = 4


def uniform(world):
    """The radiance of a world of one colour, else None."""
    if world is None:
        return [0.0, 0.0, 0.0]
    tree = world.node_tree if world.use_nodes else None
    if tree is None:
        return list(world.color)
    output = tree.get_output_node("CYCLES")
    links = output.inputs["Surface"].links if output else ()
    if not links:
        return [0.0, 0.0, 0.0]
    node = links[0].from_node
    if node.type != "BACKGROUND" or node.inputs["Color"].is_linked or node.inputs["Strength"].is_linked:
        return None
    strength = node.inputs["Strength"].default_value
    return [channel * strength for channel in node.inputs["Color"].default_value[:3]]


def told_of(world):
    """What of a world does not come along."""
    tree = world.node_tree if world is not None and world.use_nodes else None
    output = tree.get_output_node("CYCLES") if tree else None
    if output and output.inputs["Volume"].links:
        return [f"{world.name}: its volume stays behind"]
    return []


def write(scene, folder, name="world"):
    """Writes the world of a scene into a folder; gives the path of the world file."""
    folder = Path(folder)
    found = uniform(scene.world)
    environment = found
    if found is None:
        picture = folder / f"{name}.exr"
        _render(scene.world, picture)
        environment = picture.name
    described = {"environment": environment}
    if scene.render.film_transparent:
        described["backdrop"] = [0, 0, 0]
    file = folder / f"{name}.json"
    file.write_text(json.dumps(described, indent=1) + "\n", encoding="utf-8")
    return file


def _render(world, picture):
    scene = bpy.data.scenes.new("Focus Brush world")
    data = bpy.data.cameras.new("Focus Brush world")
    camera = bpy.data.objects.new("Focus Brush world", data)
    try:
        scene.collection.objects.link(camera)
        scene.camera = camera
        scene.world = world
        data.type = "PANO"
        # Blender 5 moved the kind of panorama from Cycles' settings to the camera's own.
        holder = data if hasattr(data, "panorama_type") else data.cycles
        holder.panorama_type = "EQUIRECTANGULAR"
        camera.rotation_euler = (math.pi / 2, 0, -math.pi / 2)
        scene.render.engine = "CYCLES"
        scene.cycles.samples = SAMPLES
        scene.cycles.use_denoising = False
        scene.cycles.use_adaptive_sampling = False
        scene.cycles.pixel_filter_type = "BOX"
        scene.render.resolution_x, scene.render.resolution_y = WIDTH, WIDTH // 2
        scene.render.resolution_percentage = 100
        scene.render.use_compositing = False
        scene.render.use_sequencer = False
        scene.view_settings.exposure = 0
        exr_output(scene)
        scene.render.filepath = str(picture)
        bpy.ops.render.render(write_still=True, scene=scene.name)
    finally:
        bpy.data.objects.remove(camera)
        bpy.data.cameras.remove(data)
        bpy.data.scenes.remove(scene)


def exr_output(scene):
    """Lets a scene write linear pictures of 32 bits."""
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format = "OPEN_EXR"
    settings.color_mode = "RGB"
    settings.color_depth = "32"
    settings.exr_codec = "ZIP"
