#!/usr/bin/env python3
"""Writes a scene of small lamps and a camera that looks at it: lamps.py FOCAL_LENGTH F_NUMBER SCENE.glb CAMERA.json

Lamps behind the focus fill the frame; a row of greenish ones hangs before it. All lengths follow the focal length (m), so that lenses of different
angles show the same lamps.
"""

import json
import struct
import sys

focal_length, f_number = float(sys.argv[1]), float(sys.argv[2])
WIDTH, HEIGHT, SENSOR = 640, 360, 0.024
far = 15 * focal_length
focus, near = far / 2, far / 3
tan_half = SENSOR / 2 * (1 / focal_length - 1 / focus)


def quad(x, y, depth, half):
    """Two triangles that face the camera, at a place of the frame (half-heights) and a depth."""
    scale = depth * tan_half
    return [((x + dx * half) * scale, (y + dy * half) * scale, -depth) for dx, dy in ((-1, -1), (1, -1), (1, 1), (-1, -1), (1, 1), (-1, 1))]


aspect = WIDTH / HEIGHT
lamps = [quad(aspect * (column / 4 - 1) * 0.94, 0.84 - 0.4 * row, far, 0.012) for row in range(4) for column in range(9)]
before = [quad(aspect * (column / 4 - 1) * 0.94, -0.78, near, 0.012) for column in range(9)]
lines = [quad(0.12 * column - 0.3, 0.1, focus, 0.025) for column in range(6)]

data, views, accessors, meshes = b"", [], [], []
for material, quads in enumerate((lamps, before, lines)):
    points = [point for corners in quads for point in corners]
    block = b"".join(struct.pack("<3f", *point) for point in points)
    views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(block)})
    bounds = [[limit(point[axis] for point in points) for axis in range(3)] for limit in (min, max)]
    accessors.append({"bufferView": material, "componentType": 5126, "count": len(points), "type": "VEC3", "min": bounds[0], "max": bounds[1]})
    meshes.append({"primitives": [{"attributes": {"POSITION": material}, "material": material}]})
    data += block


def lamp(color, strength):
    return {
        "emissiveFactor": color,
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}},
        "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0},
        "doubleSided": True,
    }


gltf = {
    "asset": {"version": "2.0"},
    "extensionsUsed": ["KHR_materials_emissive_strength"],
    "scene": 0,
    "scenes": [{"nodes": [0, 1, 2]}],
    "nodes": [{"mesh": mesh} for mesh in range(3)],
    "meshes": meshes,
    "materials": [lamp([1, 0.72, 0.4], 40), lamp([0.6, 1, 0.7], 40), lamp([1, 1, 1], 1)],
    "accessors": accessors,
    "bufferViews": views,
    "buffers": [{"byteLength": len(data)}],
}
text = json.dumps(gltf).encode()
text += b" " * (-len(text) % 4)
with open(sys.argv[3], "wb") as file:
    file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)))
    file.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data)

camera = {
    "width": WIDTH,
    "height": HEIGHT,
    "yfov": 1.0,
    "sensor_height": SENSOR,
    "focus_distance": focus,
    "aperture_radius": focal_length / f_number / 2,
    "background": [0.01, 0.012, 0.02],
}
with open(sys.argv[4], "w", encoding="utf-8") as file:
    json.dump(camera, file)
