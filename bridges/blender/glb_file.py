"""glTF binaries, as far as the way back needs them: nodes in the world, triangles with their corners, and writing JSON anew."""

import json
import struct

import numpy as np
from mathutils import Matrix, Quaternion, Vector

from .names import BridgeError

TYPES = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
MAGIC, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
TRIANGLES = 4


class Glb:
    """A file: its document and its chunk."""

    def __init__(self, path):
        self.path = path
        with open(path, "rb") as file:
            data = file.read()
        if len(data) < 20 or struct.unpack_from("<I", data)[0] != MAGIC:
            raise BridgeError(f"{path}: is no glTF binary (export it again)")
        at, self.chunk, self.document = 12, b"", None
        while at + 8 <= len(data):
            length, kind = struct.unpack_from("<II", data, at)
            content = data[at + 8:at + 8 + length]
            if kind == JSON_CHUNK:
                self.document = json.loads(content)
            elif kind == BINARY_CHUNK:
                self.chunk = content
            at += 8 + length
        if self.document is None:
            raise BridgeError(f"{path}: has no document (export it again)")

    def write(self, path):
        """Writes the document, as it is now, and the chunk."""
        text = json.dumps(self.document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunk = self.chunk + b"\0" * (-len(self.chunk) % 4)
        with open(path, "wb") as file:
            file.write(struct.pack("<III", MAGIC, 2, 28 + len(text) + len(chunk)))
            file.write(struct.pack("<II", len(text), JSON_CHUNK) + text)
            file.write(struct.pack("<II", len(chunk), BINARY_CHUNK) + chunk)

    def all(self, name):
        return self.document.get(name, [])

    def accessor(self, index):
        """The elements of an accessor, a row each."""
        accessor = self.document["accessors"][index]
        if "sparse" in accessor or "bufferView" not in accessor:
            raise BridgeError(f"{self.path}: accessor {index} is sparse (export it again)")
        view = self.document["bufferViews"][accessor["bufferView"]]
        kind, width = np.dtype(TYPES[accessor["componentType"]]), COMPONENTS[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        stride = view.get("byteStride", kind.itemsize * width)
        rows = np.ndarray((accessor["count"], width), kind, self.chunk, start, (stride, kind.itemsize))
        return rows.copy()

    def placed_nodes(self):
        """(index, matrix in the world) of every node of the scene that is shown; glTF's axes."""
        scenes = self.all("scenes")
        roots = scenes[self.document.get("scene", 0)].get("nodes", []) if scenes else []
        todo, placed = [(root, Matrix()) for root in roots], []
        while todo:
            index, above = todo.pop()
            node = self.document["nodes"][index]
            world = above @ own_matrix(node)
            placed.append((index, world))
            todo += [(child, world) for child in node.get("children", [])]
        return sorted(placed, key=lambda each: each[0])

    def corners(self, primitive, name):
        """An attribute of the corners of a primitive's triangles, (triangles, 3, components); None if it has none."""
        if primitive.get("mode", TRIANGLES) != TRIANGLES or name not in primitive["attributes"]:
            return None
        values = self.accessor(primitive["attributes"][name])
        if "indices" not in primitive:
            return values.reshape(-1, 3, values.shape[1])
        return values[self.accessor(primitive["indices"])[:, 0]].reshape(-1, 3, values.shape[1])


def own_matrix(node):
    """A node's matrix in its parent."""
    if "matrix" in node:
        values = node["matrix"]
        return Matrix([values[row::4] for row in range(4)])
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    return Matrix.LocRotScale(
        Vector(node.get("translation", (0, 0, 0))), Quaternion((w, x, y, z)), Vector(node.get("scale", (1, 1, 1)))
    )


def atlas_set(primitive):
    """The attribute that is the atlas: Focus Brush appends it, so it is the last set of coordinates."""
    sets = [name for name in primitive["attributes"] if name.startswith("TEXCOORD_")]
    return max(sets, key=lambda name: int(name.removeprefix("TEXCOORD_")), default=None)
