"""Where the tests work: a folder with a scene and what the command line makes of it.

The test of the program (app/tests/python.rs) starts them with FOCUS_BRUSH, the command line, and FOCUS_BRUSH_SCENE, a small scene.
"""

import json
import os
import pathlib
import subprocess
import tempfile

import numpy as np

PROGRAM = os.environ["FOCUS_BRUSH"]
SCENE = pathlib.Path(os.environ["FOCUS_BRUSH_SCENE"])
REPOSITORY = pathlib.Path(__file__).resolve().parents[3]
SHARED = REPOSITORY.parent / "shared" / "data"

CAMERA = {"width": 64, "height": 40, "focus_distance": 2.0, "aperture_radius": 0.1, "sensor_height": 0.1}
RECIPE = {
    "background": {"t": 0.9, "anchor": 0.5},
    "nodes": {"card": {"t": 1.2, "anchor": 1}},
    "materials": {"wall paint": {"t": 0.8, "anchor": 0.5}},
}
STROKES = {
    "format": "focus-brush strokes",
    "version": 3,
    "steps": [{"fill": {"layer": "Paint", "targets": [{"node": 1}], "focus": {"t": 1.1, "anchor": 0.5}}}],
}

_place = tempfile.TemporaryDirectory(prefix="focus-brush-")
FOLDER = pathlib.Path(_place.name)


def command(*words):
    """Runs the command line in the folder, and returns what it prints."""
    done = subprocess.run([PROGRAM, *map(str, words)], cwd=FOLDER, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{words}: {done.stderr}")
    return done.stdout


def write_table(file, columns):
    """Writes a PLY file whose vertices have these columns of float32, by name: Gaussian splats, or a focus for each."""
    rows = np.column_stack([np.asarray(column, "<f4") for column in columns.values()])
    properties = "".join(f"property float {name}\n" for name in columns)
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(rows)}\n{properties}end_header\n"
    file.write_bytes(head.encode() + rows.astype("<f4").tobytes())


def _write_splats(file, count=60):
    """Writes a ball of splats before the camera."""
    k = np.arange(count)
    height, angle = 2 * (k + 0.5) / count - 1, 2.4 * k
    radius = np.sqrt(1 - height**2)
    place = {"x": 0.6 * radius * np.cos(angle), "y": 0.6 * height, "z": -2.5 + 0.6 * radius * np.sin(angle)}
    color = {f"f_dc_{c}": np.sin(angle + c) for c in range(3)}
    rest = {"opacity": 2, "scale_0": -2.5, "scale_1": -2, "scale_2": -3, "rot_0": 1, "rot_1": 0.1, "rot_2": 0.2, "rot_3": 0.3}
    write_table(file, {**place, **color, **{name: np.full(count, value) for name, value in rest.items()}})


def _prepare():
    (FOLDER / "scene.glb").write_bytes(SCENE.read_bytes())
    for name, content in [("camera", CAMERA), ("recipe", RECIPE), ("strokes", STROKES)]:
        (FOLDER / f"{name}.json").write_text(json.dumps(content))
    _write_splats(FOLDER / "splats.ply")
    command("new", "scene.glb", "--camera", "camera.json", "-o", "project.fbrush")
    command("replay", "project.fbrush", "strokes.json", "-o", "painted.fbrush")
    command("bake", "scene.glb", "--camera", "camera.json", "-o", "field.salf")


_prepare()
