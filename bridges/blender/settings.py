"""What the user sets: in the add-on's preferences, and in the scene."""

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, PointerProperty, StringProperty


# From 4.5 on Blender wants to be told which paths may begin with "//".
RELATIVE = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (4, 5, 0) else set()


class FocusBrushPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: StringProperty(
        name="Program",
        description="The file focus-brush. Empty: the one on the system's search path",
        subtype="FILE_PATH",
    )

    def draw(self, context):
        self.layout.prop(self, "program")


class FocusBrushSettings(bpy.types.PropertyGroup):
    folder: StringProperty(
        name="Folder",
        description="Where scene, project and manifest are written",
        subtype="DIR_PATH",
        default="//focus-brush",
        options=RELATIVE,
    )
    light: EnumProperty(
        name="Light",
        items=[
            ("scene", "From Focus Brush", "Lights, world and materials go over as glTF has them; Focus Brush finds the light"),
            ("cycles", "From Cycles", "Cycles bakes what the camera sees: any nodes but volumes, one point of view"),
        ],
    )
    side: IntProperty(name="Atlas", description="Side of the baked atlas in texels", default=2048, min=64, max=8192)
    samples: IntProperty(name="Samples", description="Cycles' samples a texel", default=256, min=1, max=65536)
    animation: BoolProperty(name="Animation", description="Animation goes over, too", default=False)
    live: BoolProperty(
        name="Live",
        description="Saving here writes the scene again; saving the project in Focus Brush shows its paint here",
        default=False,
    )
    picture: BoolProperty(name="Picture", description="Fetching renders the picture, too", default=True)


def program_of(context):
    """The path of the program that the user chose; empty if none was."""
    entry = context.preferences.addons.get(__package__)
    return entry.preferences.program if entry else ""


CLASSES = (FocusBrushPreferences, FocusBrushSettings)


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.focus_brush = PointerProperty(type=FocusBrushSettings)


def unregister():
    del bpy.types.Scene.focus_brush
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
