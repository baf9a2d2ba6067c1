"""Area lights as quads that shine, which glTF can carry.

An area light of power P sends the radiance P / (pi A) from one side, A its area in the world. A lamp that the camera does not see
in Blender is seen as a quad; a beam narrower than 180 degrees becomes a full one.
"""

import math
from contextlib import contextmanager

import bpy
from mathutils import Vector

# Corners of a disc.
ROUND = 48


def outline(light):
    """The corners of a light in its own plane, counter-clockwise seen from where it shines (its -Z)."""
    width = light.size
    height = light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    if light.shape in {"SQUARE", "RECTANGLE"}:
        corners = [(-1, -1), (-1, 1), (1, 1), (1, -1)]
        return [(x * width / 2, y * height / 2) for x, y in corners]
    turn = 2 * math.pi / ROUND
    # As wide that the polygon has the ellipse's area.
    reach = math.sqrt(turn / math.sin(turn))
    return [(reach * math.cos(-k * turn) * width / 2, reach * math.sin(-k * turn) * height / 2) for k in range(ROUND)]


def area(corners, matrix):
    """The area of an outline in the world."""
    placed = [matrix.to_3x3() @ Vector((x, y, 0)) for x, y in corners]
    return sum((a.cross(b) for a, b in zip(placed, placed[1:] + placed[:1])), Vector()).length / 2


def radiance(light, world_area):
    """Linear radiance of an area light."""
    color = list(light.color)
    if getattr(light, "use_temperature", False):
        color = [a * b for a, b in zip(color, light.temperature_color)]
    power = light.energy * 2 ** getattr(light, "exposure", 0)
    if light.use_nodes and light.node_tree:
        node = _emission(light.node_tree)
        if node is not None:
            strength = node.inputs["Strength"].default_value
            color = [a * b * strength for a, b in zip(color, node.inputs["Color"].default_value)]
    scale = power / (math.pi * (world_area if getattr(light, "normalize", True) else 1))
    return [channel * scale for channel in color]


def _emission(tree):
    output = tree.get_output_node("CYCLES")
    links = output.inputs["Surface"].links if output else ()
    node = links[0].from_node if links else None
    return node if node is not None and node.type == "EMISSION" else None


def told_of(light_object):
    """What of an area light does not come along."""
    light, told = light_object.data, []
    node = _emission(light.node_tree) if light.use_nodes and light.node_tree else None
    if light.use_nodes and light.node_tree and (node is None or any(node.inputs[name].is_linked for name in ("Color", "Strength"))):
        told.append(f"{light_object.name}: its nodes are more than a colour and a strength, and stay behind")
    if light.spread < math.pi - 1e-3:
        told.append(f"{light_object.name}: its beam is narrower than 180 degrees, and comes over as a full one")
    if not light_object.visible_camera:
        told.append(f"{light_object.name}: is not seen by the camera here, and is as a quad")
    return told


def quad(light_object, matrix):
    """The mesh of a quad that shines as an area light at a place does, and its material."""
    light = light_object.data
    corners = outline(light)
    mesh = bpy.data.meshes.new(light_object.name)
    mesh.from_pydata([(x, y, 0) for x, y in corners], [], [list(range(len(corners)))])
    material = emitting(f"{light_object.name} (light)", radiance(light, area(corners, matrix)))
    mesh.materials.append(material)
    return mesh, material


def emitting(name, shine):
    """A new material that sends a radiance from its front, and reflects nothing."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.use_backface_culling = True
    shader = material.node_tree.nodes.get("Principled BSDF")
    strength = max(shine)
    shader.inputs["Base Color"].default_value = (0, 0, 0, 1)
    shader.inputs["Specular IOR Level"].default_value = 0
    shader.inputs["Roughness"].default_value = 1
    shader.inputs["Emission Color"].default_value = (*((channel / strength for channel in shine) if strength > 0 else (0, 0, 0)), 1)
    shader.inputs["Emission Strength"].default_value = strength
    return material


@contextmanager
def as_quads(lights):
    """Within, every one of these area lights has a quad below it that shines as it does; afterwards nothing is left of them. Gives what
    does not come along."""
    made, told = [], []
    try:
        for light in lights:
            mesh, material = quad(light, light.matrix_world)
            below = bpy.data.objects.new(f"{light.name} (light)", mesh)
            made += [below, mesh, material]
            below.parent = light
            for collection in light.users_collection:
                collection.objects.link(below)
            told += told_of(light)
        bpy.context.view_layer.update()
        yield told
    finally:
        bpy.data.batch_remove(made)
