"""What a render shows, as objects that can be baked: instances made real as the render has them, and every curve a mesh.

The scene is changed. Its own objects stay what they are, with their modifiers and their coordinates.
"""

import bpy

from . import rendered

RAYS = ("visible_camera", "visible_diffuse", "visible_glossy", "visible_transmission", "visible_volume_scatter", "visible_shadow")

# What Blender makes a mesh in its place. Of a family of balls it makes none.
CURVES = {"CURVE", "SURFACE", "FONT"}


def of(scene):
    """Makes the instances of a scene real; gives the meshes that the camera sees."""
    layer, own, instances = rendered.layer_of(scene), {}, []
    rendered.look(scene, layer, lambda depsgraph: _gather(depsgraph, layer, own, instances))
    instancers = {above for above, *_ in instances}
    for each in layer.objects:
        _instance_nothing(each)
        each.hide_render = each.hide_render or (each.type != "EMPTY" and each not in own)
    seen = {_put(scene, *instance) for instance in instances}
    here = [each for each in layer.objects if each in own]
    shown = {each.name for each in here if own[each]}
    _convert(layer, [each for each in here if each.type in CURVES or each in instancers])
    return [each for each in layer.objects if each.type == "MESH" and (each.name in shown or each in seen)]


def _gather(depsgraph, layer, own, instances):
    """Fills in the objects that are shown themselves, with whether the camera sees them; and the instances."""
    meshes = {}
    for instance in depsgraph.object_instances:
        each = instance.object
        if not instance.show_self or each.type not in {"MESH", "LIGHT"}:
            continue
        original = each.original
        above = instance.parent.original if instance.parent else original
        is_seen = each.type == "MESH" and rendered.why_left(instance, layer) is None
        if not instance.is_instance or (above == original and original.type in CURVES):
            own[original] = is_seen
            continue
        data = original.data
        if each.type == "MESH":
            key = each.data.as_pointer(), each.as_pointer()
            if key not in meshes:
                meshes[key] = rendered.mesh_of(each, depsgraph, rendered.materials_of(each))
            data = meshes[key]
        rays = {name: getattr(each, name) and getattr(above, name) for name in RAYS}
        instances.append((above, original.name, data, instance.matrix_world.copy(), rays, is_seen))


def _instance_nothing(each):
    if each.instance_type != "NONE":
        each.instance_type = "NONE"
    for system in each.particle_systems:
        if system.settings.render_type in {"OBJECT", "COLLECTION"}:
            system.settings.render_type = "NONE"


def _put(scene, above, name, data, matrix, rays, is_seen):
    """An instance as an object beside what instances it, so that it is of the same collections; gives it if the camera sees it."""
    each = bpy.data.objects.new(name, data)
    each.matrix_basis = matrix
    for ray, value in rays.items():
        setattr(each, ray, value)
    here = [collection for collection in above.users_collection if collection in scene.collection.children_recursive]
    for collection in here or [scene.collection]:
        collection.objects.link(each)
    return each if is_seen else None


def _convert(layer, objects):
    """Makes objects meshes, without what their modifiers instance."""
    if objects:
        bpy.ops.object.select_all(action="DESELECT")
        for each in objects:
            each.select_set(True)
        layer.objects.active = objects[0]
        bpy.ops.object.convert(target="MESH")
