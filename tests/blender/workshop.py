"""The add-on in a bpy without a display, built and installed as a user installs it; and scenes to try it on."""

import importlib
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parent.parent / "bridges" / "blender"
# Nothing of the user's is read or written.
PLACE = Path(tempfile.mkdtemp(prefix="focus-brush-blender-"))
os.environ["BLENDER_USER_RESOURCES"] = str(PLACE / "blender")
(PLACE / "blender").mkdir()

import bpy  # noqa: E402

PROGRAM = os.environ.get("FOCUS_BRUSH", "focus-brush")
MODULE = "bl_ext.user_default.focus_brush"


def extension_tool():
    """Blender's own tool for extensions, which is in bpy's wheel."""
    for folder in (bpy.utils.resource_path("LOCAL"), bpy.utils.resource_path("SYSTEM")):
        tool = Path(folder) / "scripts" / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"
        if tool.is_file():
            return tool
    raise AssertionError("bpy has no blender_ext.py")


def install():
    """Validates, builds, installs and enables the add-on; gives its package."""
    tool = extension_tool()
    package = PLACE / "focus_brush.zip"
    for command in (["validate", SOURCE], ["build", "--source-dir", SOURCE, "--output-filepath", package], ["validate", package]):
        subprocess.run([sys.executable, tool, *map(str, command)], check=True, stdout=subprocess.DEVNULL)
    bpy.ops.extensions.package_install_files(filepath=str(package), repo="user_default", enable_on_install=True)
    assert MODULE in bpy.context.preferences.addons.keys(), bpy.context.preferences.addons.keys()
    bpy.context.preferences.addons[MODULE].preferences.program = PROGRAM
    return importlib.import_module(MODULE)


def empty():
    """A file with nothing in it."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.render.threads_mode, scene.render.threads = "FIXED", 2
    return scene


def put(scene, name, data, location=(0, 0, 0), rotation=(0, 0, 0), scale=(1, 1, 1), parent=None):
    each = bpy.data.objects.new(name, data)
    each.location, each.rotation_euler, each.scale, each.parent = location, rotation, scale, parent
    scene.collection.objects.link(each)
    return each


def mesh_of(add, name, **arguments):
    """A mesh that one of Blender's operators makes."""
    getattr(bpy.ops.mesh, add)(**arguments)
    made = bpy.context.active_object
    mesh = made.data
    mesh.name = name
    bpy.data.objects.remove(made)
    return mesh


def plain(name, color, roughness=0.8):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1)
    shader.inputs["Roughness"].default_value = roughness
    return material


def camera(scene, name, location, at, **fields):
    """A camera object that looks at a place."""
    from mathutils import Vector

    data = bpy.data.cameras.new(name)
    dof = fields.pop("dof", {})
    for key, value in fields.items():
        setattr(data, key, value)
    data.dof.use_dof = True
    for key, value in dof.items():
        setattr(data.dof, key, value)
    made = put(scene, name, data, location)
    made.rotation_euler = (Vector(at) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    return made


def studio():
    """Nodes, instances, modifiers, two cameras with lenses, an area light and a world."""
    scene = empty()
    scene.render.resolution_x, scene.render.resolution_y = 96, 64
    red, grey = plain("red", (0.7, 0.1, 0.1)), plain("grey", (0.5, 0.5, 0.5))
    ground = put(scene, "Ground", mesh_of("primitive_plane_add", "ground", size=8))
    ground.data.materials.append(grey)
    box = mesh_of("primitive_cube_add", "box", size=1)
    box.materials.append(red)
    arm = put(scene, "Arm", None, (0.2, 0.1, 0.5), (0.1, 0.2, 0.5))
    put(scene, "Box", box.copy(), (-1, 0, 0), (0, 0, 0.3), (0.8, 0.9, 1.1), arm)
    for k in range(3):
        put(scene, f"Twin {k}", box, (k - 1, 1.5, 0.4), (0, 0, 0.2 * k), (0.4, 0.4, 0.4))
    ball = mesh_of("primitive_ico_sphere_add", "ball", subdivisions=2, radius=0.4)
    ball.materials.append(red)
    smooth = put(scene, "Ball", ball, (1.2, -0.5, 0.5))
    smooth.modifiers.new("Subdivision", "SUBSURF").levels = 1
    rows = put(scene, "Row", mesh_of("primitive_cube_add", "brick", size=0.2), (-1, -1, 0.15))
    array = rows.modifiers.new("Array", "ARRAY")
    array.count = 4
    kept = bpy.data.collections.new("Kept")
    stone = bpy.data.objects.new("Stone", mesh_of("primitive_cone_add", "stone", radius1=0.2, depth=0.4))
    kept.objects.link(stone)
    for k in range(2):
        instance = put(scene, f"Instance {k}", None, (0.5 * k, -1.5, 0.2))
        instance.instance_type, instance.instance_collection = "COLLECTION", kept
    target = put(scene, "Target", None, (0.3, 0.2, 0.6))
    lens = {"aperture_fstop": 1.8, "focus_object": target, "aperture_blades": 5, "aperture_rotation": 0.2, "aperture_ratio": 1.5}
    scene.camera = camera(scene, "Wide", (2.5, -5, 2.2), (0, 0, 0.5), lens=35, shift_x=0.11, shift_y=-0.07, dof=lens)
    camera(
        scene, "Tall", (-3, -4, 1.5), (0, 0, 0.4), lens=70, sensor_fit="VERTICAL", sensor_height=30, shift_y=0.15,
        dof={"aperture_fstop": 4, "focus_distance": 4.2, "aperture_ratio": 0.6},
    )
    lamp = bpy.data.lights.new("Panel", "AREA")
    lamp.energy, lamp.shape, lamp.size, lamp.size_y, lamp.color = 60, "RECTANGLE", 1.2, 0.6, (1, 0.9, 0.7)
    put(scene, "Panel", lamp, (1, 1, 3), (0.3, 0.1, 0))
    sky(scene)
    bpy.context.view_layer.update()
    return scene


def sky(scene):
    """A world with nodes: bright toward +X, blue above."""
    world = bpy.data.worlds.new("Sky")
    scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    place = nodes.new("ShaderNodeTexCoord")
    parts = nodes.new("ShaderNodeSeparateXYZ")
    mixed = nodes.new("ShaderNodeCombineXYZ")
    links.new(place.outputs["Generated"], parts.inputs[0])
    for channel, axis in (("X", "X"), ("Y", "Y"), ("Z", "Z")):
        scaled = nodes.new("ShaderNodeMath")
        scaled.operation = "MULTIPLY_ADD"
        links.new(parts.outputs[axis], scaled.inputs[0])
        scaled.inputs[1].default_value, scaled.inputs[2].default_value = 0.3, 0.4
        links.new(scaled.outputs[0], mixed.inputs[channel])
    background = next(node for node in nodes if node.type == "BACKGROUND")
    links.new(mixed.outputs[0], background.inputs["Color"])
    return world


def still(size, roughness, glass):
    """A still life: checks of world coordinates on a floor of this roughness, noise on a ball, a ball of glass."""
    scene = empty()
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.sample_clamp_indirect = 0
    floor = plain("floor", (0.6, 0.6, 0.6), roughness)
    nodes, links = floor.node_tree.nodes, floor.node_tree.links
    shader = nodes["Principled BSDF"]
    checks, place = nodes.new("ShaderNodeTexChecker"), nodes.new("ShaderNodeTexCoord")
    checks.inputs["Scale"].default_value = 3.0
    checks.inputs["Color1"].default_value, checks.inputs["Color2"].default_value = (0.6, 0.5, 0.35, 1), (0.12, 0.15, 0.2, 1)
    links.new(place.outputs["Object"], checks.inputs["Vector"])
    links.new(checks.outputs["Color"], shader.inputs["Base Color"])
    ground = put(scene, "Floor", mesh_of("primitive_plane_add", "floor", size=3))
    ground.data.materials.append(floor)
    # Off the edges of the checks, which lie where z is 0.
    ground.location.z = -0.011
    rock = plain("rock", (0.5, 0.5, 0.5), max(roughness, 0.4))
    noise = rock.node_tree.nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = 4
    rock.node_tree.links.new(noise.outputs["Color"], rock.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    ball = mesh_of("primitive_uv_sphere_add", "ball", segments=32, ring_count=16, radius=0.35)
    ball.shade_smooth()
    ball.materials.append(rock)
    stone = put(scene, "Rock", ball, (-0.45, 0.2, 0.35))
    stone.modifiers.new("Subdivision", "SUBSURF").levels = 1
    stone.modifiers["Subdivision"].render_levels = 1
    if glass:
        clear = plain("glass", (1, 1, 1), 0.0)
        clear.node_tree.nodes["Principled BSDF"].inputs["Transmission Weight"].default_value = 1
        drop = mesh_of("primitive_uv_sphere_add", "drop", segments=48, ring_count=24, radius=0.3)
        drop.shade_smooth()
        drop.materials.append(clear)
        put(scene, "Drop", drop, (0.45, -0.1, 0.3))
    lamp = bpy.data.lights.new("Panel", "AREA")
    lamp.energy, lamp.size = 40, 1.5
    put(scene, "Panel", lamp, (0.8, -0.5, 2.2), (0.3, 0.3, 0))
    sky(scene)
    dof = {"aperture_fstop": 0.7, "focus_distance": 2.6}
    scene.camera = camera(scene, "Shot", (0.2, -2.6, 1.1), (0, 0, 0.25), lens=45, dof=dof)
    bpy.context.view_layer.update()
    return scene


def render(scene, path, **settings):
    """Cycles' own picture, linear."""
    import numpy as np

    kept = {name: getattr(scene.cycles, name) for name in settings}
    for name, value in settings.items():
        setattr(scene.cycles, name, value)
    images = scene.render.image_settings
    if hasattr(images, "media_type"):
        images.media_type = "IMAGE"
    images.file_format, images.color_depth, images.color_mode = "OPEN_EXR", "32", "RGB"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    for name, value in kept.items():
        setattr(scene.cycles, name, value)
    return path


def degrees(*values):
    return tuple(math.radians(value) for value in values)


def write_places(glb, focus):
    """Writes a focus map whose three channels say where in Blender's world the middle of each texel lies."""
    write_map(glb, focus, lambda places: places.T)


def write_map(glb, focus, values_of):
    """Writes a focus map over another of the same atlas: `values_of` gives t, anchor and, if it likes, gloss of places in Blender's
    world. In place of what a brush would have painted: the same file in the same form."""
    import struct

    import numpy as np

    exr_file = importlib.import_module(f"{MODULE}.exr_file")
    height, width = exr_file.read(focus)[0]["focus.t"].shape
    places, is_covered = _places(glb, width, height)
    names = ["focus.t", "focus.anchor", "focus.gloss"]
    found = values_of(places[is_covered])
    values = {}
    for name, painted, blank in zip(names, found, (1, 0, 0)):
        values[name] = np.full((height, width), blank, np.float32)
        values[name][is_covered] = painted
    data = focus.read_bytes()
    own = b"".join(_own_attributes(data))

    def attribute(name, kind, content):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(content)) + content

    channels = sorted(values)
    listed = b"".join(name.encode() + b"\0" + struct.pack("<IB3xii", 2, 0, 1, 1) for name in channels) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = struct.pack("<II", exr_file.MAGIC, 2)
    header += attribute("channels", "chlist", listed) + attribute("compression", "compression", b"\0")
    header += attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window) + own
    header += attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)) + attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    header += b"\0"
    row = 4 * len(channels) * width
    first = len(header) + 8 * height
    rows = b"".join(
        struct.pack("<ii", y, row) + b"".join(values[name][y].astype("<f4").tobytes() for name in channels) for y in range(height)
    )
    focus.write_bytes(header + struct.pack(f"<{height}Q", *(first + y * (8 + row) for y in range(height))) + rows)


def _own_attributes(data):
    """The attributes of ours in the header of an EXR, as they stand there."""
    import struct

    at = 8
    while data[at] != 0:
        begin = at
        name_end = data.index(b"\0", at)
        at = data.index(b"\0", name_end + 1) + 1
        at += 4 + struct.unpack_from("<I", data, at)[0]
        if data[begin:name_end].startswith(b"focusBrush."):
            yield data[begin:at]


def _places(glb, width, height):
    """Where in Blender's world the middle of each texel lies, and which texels a triangle touches: those near one, too, as its plane
    goes on there."""
    import numpy as np

    meshes_back = importlib.import_module(f"{MODULE}.meshes_back")
    places = np.zeros((height, width, 3))
    nearness = np.full((height, width), np.inf)
    for placed in meshes_back.placed_meshes(glb):
        world = np.array(placed.world)
        corners = placed.corners @ world[:3, :3].T + world[:3, 3]
        uv = placed.uv * (width, -height) + (0, height)
        for (a, b, c), (p, q, r) in zip(corners, uv):
            low = np.maximum(np.floor(np.minimum(np.minimum(p, q), r) - 1.5), 0).astype(int)
            high = np.minimum(np.ceil(np.maximum(np.maximum(p, q), r) + 1.5), (width, height)).astype(int)
            x, y = np.meshgrid(np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1]) + 0.5)
            edge, other = q - p, r - p
            area = edge[0] * other[1] - edge[1] * other[0]
            if area == 0 or x.size == 0:
                continue
            s = ((x - p[0]) * other[1] - (y - p[1]) * other[0]) / area
            t = ((y - p[1]) * edge[0] - (x - p[0]) * edge[1]) / area
            # How far outside of the triangle the texel's middle lies, in texels; 0 inside.
            lengths = [np.hypot(*each) for each in (other, edge, r - q)]
            outside = np.maximum.reduce([-s * abs(area) / lengths[0], -t * abs(area) / lengths[1], (s + t - 1) * abs(area) / lengths[2]])
            outside = np.maximum(outside, 0)
            box = (slice(low[1], high[1]), slice(low[0], high[0]))
            nearer = (outside < nearness[box]) & (outside < 1.5)
            at = a + s[..., None] * (b - a) + t[..., None] * (c - a)
            places[box][nearer] = at[nearer]
            nearness[box][nearer] = outside[nearer]
    return places, np.isfinite(nearness)


def said(program_path, *arguments):
    """What a command says on both streams."""
    done = subprocess.run([program_path, *map(str, arguments)], capture_output=True, text=True, check=True)
    return done.stdout + done.stderr
