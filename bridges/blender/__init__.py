"""Focus Brush in the sidebar: the scene over to it, the paint and the picture back.

Everything goes through files and the command line. The road, a file a step:

    camera_lens       what a lens is, there and here
    area_lights       area lights as quads that shine
    world_light       the world as a picture
    shown             what a render shows, and the scene reduced to it
    gltf_hooks        what the exporter asks
    handover          all of it into a folder, with a manifest for the way back
    program           the program: where it is, what it is asked
    cycles_light      what Cycles sees, baked into the scene's atlas
    glb_file          glTF binaries, as far as the way back needs them
    meshes_back       which corner of which mesh lies where in the atlas
    focus_back        map and picture into Blender
    settings, operators, sidebar, live

The modules below `settings` know no operators, panels or preferences, and work without a display.
"""

from . import live, operators, settings, sidebar
from .gltf_hooks import glTF2ExportUserExtension  # noqa: F401  (the glTF exporter looks for it here)


def register():
    settings.register()
    operators.register()
    sidebar.register()
    live.register()


def unregister():
    live.unregister()
    sidebar.unregister()
    operators.unregister()
    settings.unregister()
