"""Live: saving here writes the scene again, which Focus Brush notices; saving the project there is noticed here.

A timer looks at the project's date, and lets a process fetch what is new; nothing here waits for it.
"""

import bpy
from bpy.app.handlers import persistent

from . import focus_back, handover, program, settings
from .names import BridgeError

# How often the project is looked at, s.
LOOKED_EVERY = 1.0

# The project that was seen last, and its date.
_seen = {}
# What is being fetched.
_fetching = None


@persistent
def saved(*_):
    """Writes the scene again after the file was saved."""
    scene = bpy.context.scene
    if not scene.focus_brush.live or scene.focus_brush.light != "scene":
        return
    try:
        folder = handover.folder_of(scene.focus_brush.folder)
        handover.read(folder)
        handover.write(scene, folder, animation=scene.focus_brush.animation)
    except BridgeError as error:
        print("Focus Brush:", error)


def changed(scene):
    """Whether the project was saved since it was looked at last."""
    folder = handover.folder_of(scene.focus_brush.folder)
    project = folder / handover.read(folder)["project"]
    if not project.is_file():
        return False
    date = project.stat().st_mtime_ns
    before = _seen.get(str(project))
    _seen[str(project)] = date
    return before is not None and before != date


def look():
    """Looks at the project; fetches what is new, and shows it when it is there."""
    global _fetching
    scene = bpy.context.scene
    if scene is None or not scene.focus_brush.live:
        return LOOKED_EVERY
    try:
        folder = handover.folder_of(scene.focus_brush.folder)
        if _fetching is not None:
            if _fetching.poll():
                _fetching = None
                focus_back.apply(scene, folder)
        elif changed(scene):
            asked = focus_back.commands(folder, scene.focus_brush.picture)
            _fetching = program.Queue(program.find(settings.program_of(bpy.context)), asked)
    except BridgeError as error:
        _fetching = None
        print("Focus Brush:", error)
    return LOOKED_EVERY


def register():
    bpy.app.handlers.save_post.append(saved)
    bpy.app.timers.register(look, first_interval=LOOKED_EVERY, persistent=True)


def unregister():
    global _fetching
    if _fetching is not None:
        _fetching.stop()
        _fetching = None
    if bpy.app.timers.is_registered(look):
        bpy.app.timers.unregister(look)
    if saved in bpy.app.handlers.save_post:
        bpy.app.handlers.save_post.remove(saved)
    _seen.clear()
