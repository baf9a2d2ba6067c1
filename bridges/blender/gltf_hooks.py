"""What Blender's glTF exporter asks: names, lenses and places that it has no field or no room for."""

import bpy

from . import camera_lens
from .meshes_back import FROM_BLENDER, TO_BLENDER
from .names import KEY, extras
from .shown import as_rendered, shown_scene

# How exact a matrix taken apart must be put together again, in shares of its scale.
SAME = 1e-6


class glTF2ExportUserExtension:
    """Also at work when the user exports a glTF file: then lenses and names of objects go into it."""

    def gather_scene_hook(self, gltf2_scene, blender_scene, export_settings):
        if shown_scene.current is not None:
            gltf2_scene.name = shown_scene.current.source.name

    def gather_tree_filter_tag_hook(self, vtree, export_settings):
        if as_rendered.current is not None:
            as_rendered.current.tag(vtree)

    def gather_camera_hook(self, gltf2_camera, blender_camera, export_settings):
        if gltf2_camera.perspective is None:
            return
        found = _lens(blender_camera)
        if found is None:
            return
        lens, gltf2_camera.perspective.yfov, gltf2_camera.perspective.aspect_ratio = found
        gltf2_camera.extras = {**(gltf2_camera.extras or {}), KEY: lens}

    def gather_node_hook(self, gltf2_node, blender_object, export_settings):
        if not isinstance(blender_object, bpy.types.Object):
            return
        going = shown_scene.current
        if going is not None:
            _as_shown(gltf2_node, blender_object, going.shown[blender_object.name])
        # Quads of area lights are ours, and hang below an object that is.
        elif gltf2_node.mesh is not None and not (blender_object.parent and blender_object.parent.type == "LIGHT"):
            _name(gltf2_node, blender_object.name, blender_object.library.filepath if blender_object.library else "")


def _lens(data):
    """What stands in the extras of a camera, its angle of view and its aspect."""
    if shown_scene.current is not None:
        return shown_scene.current.lenses.get(data.name)
    scene = bpy.context.scene
    users = camera_lens.cameras_of(data, scene)
    if not users:
        return None
    frame = camera_lens.Frame(data, scene.render)
    return camera_lens.lens_of(users[0], scene, bpy.context.evaluated_depsgraph_get()), frame.yfov(data), frame.width / frame.height


def _name(node, name, library):
    node.extras = {**(node.extras or {}), KEY: extras(object=name, **({"library": library} if library else {}))}


def _as_shown(node, stand_in, shown):
    """Gives a node the names of the object that it stands for, and its whole place."""
    node.name = shown.name
    if node.mesh is None:
        return
    node.mesh.name = shown.data_name
    if not shown.is_ours:
        _name(node, shown.name, shown.library)
    kept = stand_in.matrix_world
    reach = max(abs(value) for row in shown.matrix.to_3x3() for value in row)
    apart = max(abs(a - b) for row, other in zip(kept, shown.matrix) for a, b in zip(row[:3], other[:3]))
    if apart > SAME * reach:
        # Sheared: no translation, rotation and scale.
        whole = FROM_BLENDER @ shown.matrix @ TO_BLENDER
        node.matrix = [value for column in whole.transposed() for value in column]
        node.translation = node.rotation = node.scale = None
