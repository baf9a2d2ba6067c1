"""Runs in a process of its own: bakes the light of a copy of a file. Arguments: program, folder, scene, side, samples."""

import importlib.util
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
        sys.exit(3)


if __name__ == "__main__":
    if "--" in sys.argv:
        main(sys.argv[sys.argv.index("--") + 1:])
    else:
        bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
        main(sys.argv[2:])
