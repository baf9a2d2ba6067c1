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
    """Writes a focus map whose three channels say where in Blender's world the middle of each texel lies, found from the file's
    triangles; texels of none are left. In place of what a brush would have painted: the same file in the same form."""
    import struct

    import numpy as np

    meshes_back = importlib.import_module(f"{MODULE}.meshes_back")
    exr_file = importlib.import_module(f"{MODULE}.exr_file")
    planes, _ = exr_file.read(focus)
    height, width = planes["focus.t"].shape
    places = np.zeros((3, height, width), np.float32)
    for placed in meshes_back.placed_meshes(glb):
        world = np.array(placed.world)
        corners = placed.corners @ world[:3, :3].T + world[:3, 3]
        uv = placed.uv * (width, -height) + (0, height)
        for (a, b, c), (p, q, r) in zip(corners, uv):
            low = np.floor(np.minimum(np.minimum(p, q), r) - 1).astype(int)
            high = np.ceil(np.maximum(np.maximum(p, q), r) + 1).astype(int)
            x, y = np.meshgrid(np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1]) + 0.5)
            edge, other = q - p, r - p
            area = edge[0] * other[1] - edge[1] * other[0]
            s = ((x - p[0]) * other[1] - (y - p[1]) * other[0]) / area
            t = ((y - p[1]) * edge[0] - (x - p[0]) * edge[1]) / area
            # Texels whose square may touch the triangle.
            slack = 0.75 * np.abs(np.stack((other, edge))).sum(1) / abs(area)
            near = (s > -slack[0]) & (t > -slack[1]) & (s + t < 1 + slack.sum())
            at = a + s[near][:, None] * (b - a) + t[near][:, None] * (c - a)
            rows, columns = (y[near] - 0.5).astype(int), (x[near] - 0.5).astype(int)
            kept = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
            inside = (s >= 0) & (t >= 0) & (s + t <= 1)
            empty_or_inside = (places[:, rows[kept], columns[kept]] == 0).all(0) | inside[near][kept]
            rows, columns, at = rows[kept][empty_or_inside], columns[kept][empty_or_inside], at[kept][empty_or_inside]
            places[:, rows, columns] = at.T
    channels = ["focus.anchor", "focus.gloss", "focus.t"]
    values = {"focus.t": places[0], "focus.anchor": places[1], "focus.gloss": places[2]}
    header = struct.pack("<II", exr_file.MAGIC, 2)

    def attribute(name, kind, content):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(content)) + content

    listed = b"".join(name.encode() + b"\0" + struct.pack("<IB3xii", 2, 0, 1, 1) for name in channels) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header += attribute("channels", "chlist", listed) + attribute("compression", "compression", b"\0")
    header += attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window)
    header += attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)) + attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    header += b"\0"
    size = 8 + 12 * width
    first = len(header) + 8 * height
    rows = b"".join(
        struct.pack("<ii", y, 12 * width) + b"".join(values[name][y].astype("<f4").tobytes() for name in channels) for y in range(height)
    )
    focus.write_bytes(header + struct.pack(f"<{height}Q", *(first + y * size for y in range(height))) + rows)
