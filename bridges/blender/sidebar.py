"""The sidebar's panel in the 3D view."""

import bpy

from . import program, settings
from .names import BridgeError


class FOCUSBRUSH_PT_sidebar(bpy.types.Panel):
    bl_idname = "FOCUSBRUSH_PT_sidebar"
    bl_label = "Focus Brush"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Focus Brush"

    def draw(self, context):
        layout, chosen = self.layout, context.scene.focus_brush
        layout.use_property_split = True
        layout.use_property_decorate = False
        try:
            program.find(settings.program_of(context))
        except BridgeError as error:
            column = layout.column()
            column.alert = True
            for line in str(error).replace(": set", ":\nset").split("\n"):
                column.label(text=line)
            column.operator("preferences.addon_show", text="Show Preferences").module = __package__
        layout.prop(chosen, "folder")
        layout.prop(chosen, "light")
        if chosen.light == "cycles":
            layout.prop(chosen, "side")
            layout.prop(chosen, "samples")
        else:
            layout.prop(chosen, "animation")
        layout.operator("focus_brush.open", icon="EXPORT")
        layout.separator()
        layout.prop(chosen, "picture")
        layout.operator("focus_brush.fetch", icon="IMPORT")
        layout.prop(chosen, "live")


def register():
    bpy.utils.register_class(FOCUSBRUSH_PT_sidebar)


def unregister():
    bpy.utils.unregister_class(FOCUSBRUSH_PT_sidebar)
