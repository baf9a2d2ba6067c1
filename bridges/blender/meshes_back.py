"""Which corner of which mesh lies where in the atlas.

The program writes the scene's file with the atlas as one more set of coordinates. A triangle there and one here are the same if their
corners have the same bits: the exporter only swaps axes. So nothing is guessed: a mesh whose triangles are not all found again is told.
"""

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix

from .glb_file import Glb, atlas_set
from .names import COLLECTION, UV_MAP, of_extras

TO_BLENDER = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
FROM_BLENDER = TO_BLENDER.inverted()


@dataclass
class Placed:
    """Triangles of a node: the object that it was, where it stands, corners in its own axes (Blender's) and in the atlas."""

    name: str
    object_name: str
    world: Matrix
    corners: np.ndarray
    uv: np.ndarray


def placed_meshes(path):
    """All nodes with triangles of a file with an atlas."""
    glb = Glb(path)
    found = []
    for index, world in glb.placed_nodes():
        node = glb.document["nodes"][index]
        if "mesh" not in node:
            continue
        corners, uv = [], []
        for primitive in glb.document["meshes"][node["mesh"]]["primitives"]:
            name = atlas_set(primitive)
            positions = glb.corners(primitive, "POSITION")
            if name is None or positions is None:
                continue
            corners.append(positions[:, :, [0, 2, 1]] * np.float32((1, -1, 1)))
            uv.append(glb.corners(primitive, name) * np.float32((1, -1)) + np.float32((0, 1)))
        if corners:
            object_name = of_extras(node).get("object", "")
            to_world = TO_BLENDER @ world @ FROM_BLENDER
            found.append(Placed(node.get("name", f"node {index}"), object_name, to_world, np.concatenate(corners), np.concatenate(uv)))
    return found


def _keys(corners):
    """A key a triangle, the same wherever it begins, and how far it was turned for that."""
    # -0 is 0.
    corners = np.ascontiguousarray(corners + np.float32(0))
    keys, turns = [], []
    for triangle in corners:
        texts = [corner.tobytes() for corner in triangle]
        turn = min(range(3), key=lambda k: (texts[k], texts[(k + 1) % 3], texts[(k + 2) % 3]))
        keys.append(b"".join(texts[(turn + k) % 3] for k in range(3)))
        turns.append(turn)
    return keys, turns


def uv_of_loops(mesh, placed):
    """The atlas coordinates of a mesh's corners, (loops, 2); None where its triangles are others, or a corner lies in two places."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    if count != len(placed.corners):
        return None
    loops = np.empty(3 * count, np.int32)
    mesh.loop_triangles.foreach_get("loops", loops)
    loops = loops.reshape(-1, 3)
    positions = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", positions)
    vertex_of_loop = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", vertex_of_loop)
    here = positions.reshape(-1, 3)[vertex_of_loop[loops]]
    by_key = {}
    for triangle, (key, turn) in enumerate(zip(*_keys(placed.corners))):
        by_key.setdefault(key, []).append((triangle, turn))
    uv = np.full((len(mesh.loops), 2), np.nan, np.float32)
    for triangle, (key, turn) in enumerate(zip(*_keys(here))):
        found = by_key.get(key)
        if not found:
            return None
        there, turn_there = found.pop(0)
        for k in range(3):
            loop, value = loops[triangle][(turn + k) % 3], placed.uv[there][(turn_there + k) % 3]
            if not np.isnan(uv[loop, 0]) and np.any(uv[loop] != value):
                return None
            uv[loop] = value
    return None if np.isnan(uv).any() else uv


def is_same_place(a, b):
    return all(abs(x - y) <= 1e-5 * max(1, abs(x)) for row, other in zip(a, b) for x, y in zip(row, other))


def give_uv(scene, placed):
    """Gives a node's coordinates to the object that it was, as a UV map, or, where that has no corners of its own for them (modifiers
    that make geometry, instances, seams within a face), to a mesh of its own in a collection of ours. Gives the object and whether it
    is the scene's own."""
    own = scene.objects.get(placed.object_name)
    is_own = own is not None and own.type == "MESH" and own.data.users == 1 and own.data.library is None
    if is_own and is_same_place(own.matrix_world, placed.world):
        uv = uv_of_loops(own.data, placed)
        if uv is not None:
            _set_uv(own.data, uv)
            return own, True
    return _copy(scene, placed), False


def _set_uv(mesh, uv):
    layer = mesh.uv_layers.get(UV_MAP) or mesh.uv_layers.new(name=UV_MAP, do_init=False)
    if layer is not None:
        layer.data.foreach_set("uv", uv.ravel())
        mesh.update()


def _copy(scene, placed):
    collection = bpy.data.collections.get(COLLECTION)
    if collection is None:
        collection = bpy.data.collections.new(COLLECTION)
        collection.hide_render = True
    if collection.name not in scene.collection.children:
        scene.collection.children.link(collection)
    name = f"{placed.name} (focus)"
    mesh = bpy.data.meshes.new(name)
    points, indices = np.unique(placed.corners.reshape(-1, 3), axis=0, return_inverse=True)
    mesh.from_pydata(points.tolist(), [], indices.reshape(-1, 3).tolist())
    _set_uv(mesh, placed.uv.reshape(-1, 2))
    copy = bpy.data.objects.new(name, mesh)
    copy.matrix_world = placed.world
    collection.objects.link(copy)
    return copy


def forget_copies():
    """Removes the meshes that an earlier way back made."""
    collection = bpy.data.collections.get(COLLECTION)
    for copy in list(collection.objects) if collection else ():
        mesh = copy.data
        bpy.data.objects.remove(copy)
        if mesh is not None and mesh.users == 0:
            bpy.data.meshes.remove(mesh)
