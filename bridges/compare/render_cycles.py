#!/usr/bin/env python3
"""Renders a glTF scene by Blender's Cycles as a Focus Brush camera sees it, to compare pictures with.

    python render_cycles.py garden.glb camera.json cycles.exr --world sky.hdr --spp 256
    blender --background --python render_cycles.py -- garden.glb camera.json cycles.exr

The camera is a camera file or a project (.fbrush), whose camera and world are taken. Cycles knows no paint, so what comes
out is the picture of the ordinary lens. To compare with it:

    focus-brush render garden.glb --camera camera.json --world sky.hdr --back-faces show -o ours.exr
    focus-brush compare ours.exr cycles.exr

Needs the module bpy, 4.2 to 5.x (4.2.23, 4.5.15 and 5.0.1 were tried; `pip install bpy`), or Blender itself. Materials are what Blender's glTF importer makes of
the file. Made alike for both:

- the camera: pose, angle of view, focus distance, aperture radius, polygon of blades and anamorphic ratio. Cycles' polygon
  has the middle of an edge at its rotation, ours a corner;
- lights: intensities of glTF files are taken as radiant ones, as Focus Brush does, not divided by 683 lm/W;
- textures are decoded before they are interpolated, as glTF asks for; Cycles by itself does it afterwards, which is darker;
- a mesh without a material has glTF's own, a rough white metal; Blender's is grey;
- skinned models stand as their nodes do; Blender would show the first picture of their first animation;
- the world: an equirectangular picture, or one radiance, its rotation, strength and backdrop;
- one pixel is a box; no clamping, no denoiser, no blurred gloss, no adaptive sampling; float EXR, linear.

Exit codes: 0 done, 2 wrong usage, 3 bad input. Errors are one line, `error: FILE: what is wrong (what to do)`.
"""
import argparse
import json
import math
import os
import sys
import time
import zipfile

# The camera's fields that have a default, as docs/reference/files.md has them.
CAMERA_DEFAULTS = {
    "focus_distance": 3.0,
    "aperture_radius": 0.0125,
    "sensor_height": 0.024,
    "background": None,
    "aperture": {"shape": "disc"},
}
# Environments that no file holds.
OWN_ENVIRONMENTS = ("studio", "scene")
# Of 32 bounces in a room whose walls keep four fifths of the light, one part in a thousand is left.
AS_MANY_BOUNCES_AS_MATTER = 32
# A focus distance that is "inf": Blender wants a number, and at this one 1/s is nothing beside any 1/z of a scene.
FAR_AWAY = 1e9


class BadInput(Exception):
    """What the command line says in one line."""


def read_json(path):
    """The object in a JSON file."""
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except OSError as error:
        raise BadInput(f"{path}: {error.strerror} (check the path)") from None
    except ValueError as error:
        raise BadInput(f"{path}: {error} (write it as docs/reference/files.md says)") from None


def read_camera_and_world(path):
    """The camera of a camera file or project, complete, and the project's world, or None."""
    world = None
    if path.endswith(".fbrush"):
        try:
            with zipfile.ZipFile(path) as project:
                manifest = json.loads(project.read("manifest.json"))
            given = manifest["cameras"][manifest.get("active_camera", 0)]["camera"]
        except (OSError, KeyError, IndexError, ValueError, zipfile.BadZipFile) as error:
            raise BadInput(f"{path}: no project with a camera: {error} (open and save it in Focus Brush)") from None
        world = manifest.get("world")
        world = world and world_as_seen_from_here(world, path)
    else:
        given = read_json(path)
    camera = {**CAMERA_DEFAULTS, **given}
    missing = [name for name in ("width", "height", "yfov", "camera_to_world") if name not in camera]
    if missing:
        raise BadInput(f"{path}: {', '.join(missing)}: missing (write all of the camera, or give a project)")
    if camera["focus_distance"] == "inf":
        camera["focus_distance"] = FAR_AWAY
    return camera, world


def read_world(name):
    """A world from a world file, or from an environment's file alone."""
    if not name.endswith(".json"):
        return {"environment": name}
    return world_as_seen_from_here(read_json(name), name)


def world_as_seen_from_here(world, file):
    """The world that a file says, its environment's path not from the file's folder but from ours."""
    environment = world.get("environment", "studio")
    if isinstance(environment, str) and environment not in OWN_ENVIRONMENTS:
        environment = os.path.join(os.path.dirname(file), environment)
    return {**world, "environment": environment}


def import_scene(bpy, path):
    """Reads the glTF file: its surfaces and lights as it has them, its nodes posed as they stand, no camera."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    try:
        bpy.ops.import_scene.gltf(
            filepath=os.path.abspath(path),
            import_shading="NORMALS",
            guess_original_bind_pose=False,
            export_import_convert_lighting_mode="COMPAT",
        )
    except RuntimeError as error:
        raise BadInput(f"{path}: Blender cannot read it: {str(error).strip().splitlines()[-1]} (check it by focus-brush info)") from None
    decode_textures(bpy)
    default = gltf_default_material(bpy)
    for item in list(bpy.context.scene.objects):
        if item.type == "CAMERA":
            bpy.data.objects.remove(item)
        elif item.type == "ARMATURE":
            item.data.pose_position = "REST"
        elif item.type == "MESH" and not any(slot.material for slot in item.material_slots):
            item.data.materials.clear()
            item.data.materials.append(default)


def decode_textures(bpy):
    """Makes textures of sRGB bytes linear floats: of bytes Cycles interpolates first and decodes afterwards. Those of 16 bits are
    linear floats already."""
    import numpy

    for image in list(bpy.data.images):
        if image.colorspace_settings.name != "sRGB" or image.is_float:
            continue
        width, height = image.size
        pixels = numpy.empty(width * height * 4, numpy.float32)
        image.pixels.foreach_get(pixels)
        pixels = pixels.reshape(-1, 4)
        colours = pixels[:, :3]
        pixels[:, :3] = numpy.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
        linear = bpy.data.images.new(image.name, width, height, alpha=True, float_buffer=True, is_data=True)
        linear.alpha_mode = "CHANNEL_PACKED"  # colours are not multiplied by it
        linear.pixels.foreach_set(pixels.ravel())
        image.user_remap(linear)


def leave_out_multiple_scattering(bpy):
    """Lets light meet microfacets once, as `focus-brush render --single-scattering` does."""
    for material in bpy.data.materials:
        for node in material.node_tree.nodes if material.node_tree else []:
            if node.type == "BSDF_PRINCIPLED":
                node.distribution = "GGX"


def gltf_default_material(bpy):
    """glTF's material of what has none: white, metallic 1, roughness 1."""
    material = bpy.data.materials.new("glTF default")
    material.use_nodes = True
    surface = material.node_tree.nodes["Principled BSDF"]
    surface.inputs["Base Color"].default_value = (1, 1, 1, 1)
    surface.inputs["Metallic"].default_value = 1
    surface.inputs["Roughness"].default_value = 1
    return material


def set_camera(bpy, camera, path):
    """The shot camera, with its lens and aperture."""
    from mathutils import Matrix

    data = bpy.data.cameras.new("shot")
    item = bpy.data.objects.new("shot", data)
    bpy.context.scene.collection.objects.link(item)
    bpy.context.scene.camera = item
    # glTF's y is Blender's z.
    blender_from_gltf = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
    item.matrix_world = blender_from_gltf @ Matrix(camera["camera_to_world"])
    image_distance = camera["sensor_height"] / (2 * math.tan(camera["yfov"] / 2))
    data.sensor_fit = "VERTICAL"
    data.sensor_height = 1000 * camera["sensor_height"]
    data.lens = 1000 * image_distance
    data.clip_start, data.clip_end = 1e-3, 1e5
    if camera["aperture_radius"] > 0:
        set_aperture(data.dof, camera, image_distance, path)


def set_aperture(dof, camera, image_distance, path):
    """The lens's blur: where it is focused, how wide and of what shape its aperture is."""
    aperture = camera["aperture"]
    radius = camera["aperture_radius"]
    ratio = aperture.get("ratio", 1.0)
    shape = aperture.get("shape", "disc")
    dof.use_dof = True
    dof.focus_distance = camera["focus_distance"]
    if shape == "polygon" and aperture.get("roundness", 0) == 0:
        dof.aperture_blades = aperture["blades"]
        dof.aperture_rotation = aperture.get("rotation", 0.0) + math.pi / aperture["blades"]
    elif shape == "square":
        # Its corners lie beyond the radius, which is half a side here and the circumradius there.
        dof.aperture_blades = 4
        radius *= math.sqrt(2)
    elif shape != "disc":
        raise BadInput(f"{path}: aperture: Cycles has no {shape} of this kind (take a disc, a square or straight blades)")
    # Cycles widens x by 1/ratio; here the larger of both sides stays.
    dof.aperture_ratio = ratio
    dof.aperture_fstop = image_distance / (2 * radius * min(ratio, 1.0))


def set_world(bpy, world):
    """What lies beyond all surfaces: it lights them, and is seen unless there is a backdrop."""
    environment = world["environment"]
    if environment in OWN_ENVIRONMENTS:
        raise BadInput(f"world: {environment}: known to Focus Brush alone (give both the same picture of a sky)")
    tree_owner = bpy.data.worlds.new("world")
    bpy.context.scene.world = tree_owner
    tree_owner.use_nodes = True
    tree = tree_owner.node_tree
    shader, output = tree.nodes["Background"], tree.nodes["World Output"]
    shader.inputs["Strength"].default_value = world.get("strength", 1.0)
    if isinstance(environment, str):
        place, mapping, picture = (tree.nodes.new(f"ShaderNode{name}") for name in ("TexCoord", "Mapping", "TexEnvironment"))
        try:
            picture.image = bpy.data.images.load(os.path.abspath(environment))
        except RuntimeError:
            raise BadInput(f"{environment}: no picture that Blender can read (check the path)") from None
        picture.image.colorspace_settings.name = "Non-Color"
        mapping.inputs["Rotation"].default_value[2] = -world.get("rotation", 0.0)
        tree.links.new(place.outputs["Generated"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs["Vector"], picture.inputs["Vector"])
        tree.links.new(picture.outputs["Color"], shader.inputs["Color"])
    else:
        shader.inputs["Color"].default_value = (*environment, 1)
    backdrop = world.get("backdrop", "environment")
    if backdrop != "environment":
        seen, mix, path = (tree.nodes.new(f"ShaderNode{name}") for name in ("Background", "MixShader", "LightPath"))
        seen.inputs["Color"].default_value = (*backdrop, 1)
        tree.links.new(path.outputs["Is Camera Ray"], mix.inputs[0])
        tree.links.new(shader.outputs[0], mix.inputs[1])
        tree.links.new(seen.outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], output.inputs["Surface"])


def render(bpy, camera, options, bounces):
    """Draws the picture into the file, as linear floats; seconds it took."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = camera["width"], camera["height"]
    scene.render.resolution_percentage = 100
    if options.threads:
        scene.render.threads_mode, scene.render.threads = "FIXED", options.threads
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", options.spp, options.seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
    cycles.transparent_max_bounces = 256
    picture = scene.render.image_settings
    if hasattr(picture, "media_type"):  # Blender 5 asks for it first
        picture.media_type = "IMAGE"
    picture.file_format, picture.color_mode, picture.color_depth = "OPEN_EXR", "RGB", "32"
    picture.exr_codec = "ZIP"
    scene.render.filepath, scene.render.use_file_extension = os.path.abspath(options.picture), False
    start = time.monotonic()
    bpy.ops.render.render(write_still=True)
    return time.monotonic() - start


def options_of(arguments):
    """The command line's options."""
    parser = argparse.ArgumentParser(description="Renders a glTF scene by Cycles as a Focus Brush camera sees it.")
    parser.add_argument("scene", help="the scene (.glb, .gltf)")
    parser.add_argument("camera", help="a camera file (.json) or a project (.fbrush)")
    parser.add_argument("picture", help="where to write the picture (.exr)")
    parser.add_argument("--world", help="a world file (.json), or an equirectangular .hdr or .exr")
    parser.add_argument("--size", help="WIDTHxHEIGHT in pixels instead of the camera's")
    parser.add_argument("--single-scattering", action="store_true", help="leave out light that meets microfacets more than once")
    parser.add_argument("--spp", type=int, default=256, help="rays a pixel (256)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the rays (0)")
    parser.add_argument("--threads", type=int, default=0, help="threads (all)")
    options = parser.parse_args(arguments)
    if options.size:
        try:
            options.size = tuple(int(side) for side in options.size.split("x"))
            valid = len(options.size) == 2 and min(options.size) > 0
        except ValueError:
            valid = False
        if not valid:
            parser.error("--size: two numbers, as 480x270")
    return options


def main():
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    options = options_of(arguments)
    try:
        import bpy
    except ImportError:
        raise BadInput("bpy: missing (pip install bpy, or run it by Blender: blender --background --python …)") from None
    camera, world = read_camera_and_world(options.camera)
    if options.size:
        camera["width"], camera["height"] = options.size
    if options.world:
        world = read_world(options.world)
    elif world is None:
        world = {"environment": camera["background"] or [0, 0, 0]}
    bounces = world.get("bounces")
    import_scene(bpy, options.scene)
    if options.single_scattering:
        leave_out_multiple_scattering(bpy)
    set_camera(bpy, camera, options.camera)
    set_world(bpy, world)
    seconds = render(bpy, camera, options, AS_MANY_BOUNCES_AS_MATTER if bounces is None else bounces)
    print(f"Cycles {bpy.app.version_string}: {options.spp} rays a pixel in {seconds:.1f} s, {options.picture}")


if __name__ == "__main__":
    try:
        main()
    except BadInput as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(3)
