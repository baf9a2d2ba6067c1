"""What the sidebar's buttons do."""

import tempfile
from pathlib import Path

import bpy

from . import cycles_light, focus_back, handover, program, settings
from .names import BridgeError

# How often a background process is asked whether it is done, s.
ASKED_EVERY = 0.5


class FOCUSBRUSH_OT_open(bpy.types.Operator):
    bl_idname = "focus_brush.open"
    bl_label = "Open in Focus Brush"
    bl_description = "Writes the scene, and starts Focus Brush on it. Paint of an earlier time is carried over"

    def execute(self, context):
        scene, chosen = context.scene, context.scene.focus_brush
        try:
            found = program.find(settings.program_of(context))
            folder = handover.folder_of(chosen.folder)
            if chosen.light == "cycles":
                return self._bake(context, found, folder)
            manifest = handover.write(scene, folder, animation=chosen.animation)
            start(found, folder, manifest)
            for sentence in manifest["told"]:
                self.report({"WARNING"}, sentence)
        except BridgeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}

    def _bake(self, context, found, folder):
        handover.check(context.scene)
        chosen = context.scene.focus_brush
        copy = Path(tempfile.mkdtemp(prefix="focus-brush-")) / "scene.blend"
        process = cycles_light.in_background(found, folder, chosen.side, chosen.samples, copy)

        def asked():
            if process.poll() is None:
                return ASKED_EVERY
            copy.unlink(missing_ok=True)
            copy.parent.rmdir()
            told = folder / "bake-error.txt"
            if process.returncode != 0:
                why = told.read_text(encoding="utf-8").strip() if told.is_file() else "Cycles could not bake (see the system console)"
                told.unlink(missing_ok=True)
                _notice("ERROR", [why])
                return None
            start(found, folder, handover.read(folder))
            return None

        bpy.app.timers.register(asked, first_interval=ASKED_EVERY)
        self.report({"INFO"}, "Cycles bakes the light in the background; Focus Brush opens when it is done")
        return {"FINISHED"}


def start(found, folder, manifest):
    """Lets the program make the project, and opens it then."""
    asked, done = handover.project_commands(folder, manifest)

    def opened():
        program.start(found, done())
        if manifest["told"]:
            _notice("INFO", manifest["told"])

    when_done(program.Queue(found, asked), opened)


def when_done(queue, then):
    """Asks a queue until it is done, and does something then. Nothing waits."""

    def asked():
        try:
            if not queue.poll():
                return ASKED_EVERY
            then()
        except BridgeError as error:
            _notice("ERROR", [str(error)])
        return None

    bpy.app.timers.register(asked)


def _notice(icon, lines):
    """Says something where no operator is running."""

    def draw(menu, context):
        for line in lines:
            menu.layout.label(text=line)

    print("Focus Brush:", *lines)
    if not bpy.app.background and bpy.context.window_manager is not None:
        bpy.context.window_manager.popup_menu(draw, title="Focus Brush", icon=icon)


class FOCUSBRUSH_OT_fetch(bpy.types.Operator):
    bl_idname = "focus_brush.fetch"
    bl_label = "Fetch from Focus Brush"
    bl_description = "Brings the saved focus map, the lens and the picture back into this scene"

    def execute(self, context):
        scene = context.scene
        try:
            found = program.find(settings.program_of(context))
            folder = handover.folder_of(scene.focus_brush.folder)
            queue = program.Queue(found, focus_back.commands(folder, scene.focus_brush.picture))
        except BridgeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

        def shown():
            told = focus_back.apply(scene, folder)
            bpy.ops.ed.undo_push(message="Fetch from Focus Brush")
            _notice("INFO", told or ["The paint is here"])

        when_done(queue, shown)
        return {"FINISHED"}


class FOCUSBRUSH_OT_write(bpy.types.Operator):
    bl_idname = "focus_brush.write"
    bl_label = "Write Scene"
    bl_description = "Writes the scene for Focus Brush, and does not start it"

    def execute(self, context):
        scene = context.scene
        try:
            folder = handover.folder_of(scene.focus_brush.folder)
            manifest = handover.write(scene, folder, animation=scene.focus_brush.animation)
        except BridgeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for sentence in manifest["told"]:
            self.report({"WARNING"}, sentence)
        return {"FINISHED"}


CLASSES = (FOCUSBRUSH_OT_open, FOCUSBRUSH_OT_fetch, FOCUSBRUSH_OT_write)


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)


def unregister():
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
