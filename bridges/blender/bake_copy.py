"""Runs in a process of its own: bakes the light of a copy of a file. Arguments: program, folder, scene, side, samples."""

import importlib.util
import os
import sys
from pathlib import Path

import bpy


def package():
    """The add-on that this file belongs to, whatever name it goes by here."""
    here = Path(__file__).resolve().parent
    name = "focus_brush_bridge"
    spec = importlib.util.spec_from_file_location(name, here / "__init__.py", submodule_search_locations=[str(here)])
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    # The glTF exporter asks the add-ons of the preferences, which this process may not have.
    bpy.context.preferences.addons.new().module = name
    return name


def main(arguments):
    found, folder, scene, side, samples = arguments
    name = package()
    bridge = importlib.import_module(f"{name}.cycles_light")
    errors = importlib.import_module(f"{name}.names")
    try:
        bridge.bake(bpy.data.scenes[scene], found, folder, int(side), int(samples))
    except errors.BridgeError as error:
        Path(folder, "bake-error.txt").write_text(f"{error}\n", encoding="utf-8")
        return 3
    return 0


if __name__ == "__main__":
    if "--" in sys.argv:
        sys.exit(main(sys.argv[sys.argv.index("--") + 1:]))
    else:
        bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
        code = main(sys.argv[2:])
        # bpy 4.2 fails while it ends after its glTF exporter ran; all is written by now.
        sys.stdout.flush()
        os._exit(code)
