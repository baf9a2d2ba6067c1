"""Scenes opened, focused, rendered and compared, as NumPy arrays.

A real lens can only blur by depth; Focus Brush lets you decide, for every point of a 3D scene, how it is focused, and
renders the result as a physically formed picture. Pictures are linear RGB, float32, row 0 on top.

>>> import focus_brush as fb
>>> scene = fb.open("demo.glb")
>>> camera = scene.camera.replace(size=(96, 54))
>>> field = scene.bake(camera)
>>> near, far = (field.render(camera=camera.replace(focus_distance=distance)) for distance in (1.5, 6.0))
>>> near.exposed().shape
(54, 96, 3)
>>> fb.compare(near, far)["psnr"] < 60
True
"""

import os as _os

# What `open` starts to unwrap surfaces: see that file.
_UNWRAP_CHILD = _os.path.join(_os.path.dirname(_os.path.abspath(__file__)), "_unwrap.py")

from ._native import (  # noqa: E402
    Camera,
    Cancelled,
    Field,
    Focus,
    GpuAbsent,
    Picture,
    Scene,
    __version__,
    compare,
    open,
    read_picture,
    report,
    set_threads,
)

__all__ = [
    "Camera",
    "Cancelled",
    "Field",
    "Focus",
    "GpuAbsent",
    "Picture",
    "Scene",
    "__version__",
    "compare",
    "open",
    "read_picture",
    "report",
    "set_threads",
]
