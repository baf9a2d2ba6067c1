"""Where the tests work: a folder with a scene and what the command line makes of it.

The test of the program (app/tests/python.rs) starts them with FOCUS_BRUSH, the command line, and FOCUS_BRUSH_SCENE, a small scene.
"""

import json
import os
import pathlib
import subprocess
import tempfile

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


def _prepare():
    (FOLDER / "scene.glb").write_bytes(SCENE.read_bytes())
    for name, content in [("camera", CAMERA), ("recipe", RECIPE), ("strokes", STROKES)]:
        (FOLDER / f"{name}.json").write_text(json.dumps(content))
    command("new", "scene.glb", "--camera", "camera.json", "-o", "project.fbrush")
    command("replay", "project.fbrush", "strokes.json", "-o", "painted.fbrush")
    command("bake", "scene.glb", "--camera", "camera.json", "-o", "field.salf")


_prepare()
