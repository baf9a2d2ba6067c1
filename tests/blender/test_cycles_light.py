"""Light from Cycles: a procedural texture, a glossy floor and glass, our picture of what was baked against Cycles' own."""

import importlib
import math
import unittest

import workshop
from workshop import PLACE, PROGRAM, bpy

import numpy as np  # noqa: E402

workshop.install()
cycles_light, exr_file, handover, program, world_light = (
    importlib.import_module(f"{workshop.MODULE}.{name}") for name in ("cycles_light", "exr_file", "handover", "program", "world_light")
)

SIZE = (96, 60)
SIDE = 448
BAKED, DRAWN = 24, 256
world_light.WIDTH = 256


def psnr(ours, theirs):
    """Against a peak of 1, as `compare` says it for pictures of light up to that."""
    found, wanted = (np.stack([exr_file.read(file)[0][channel] for channel in "RGB"]).astype(float) for file in (ours, theirs))
    return -10 * math.log10(np.mean((np.minimum(found, 1) - np.minimum(wanted, 1)) ** 2))


def compared(name, scene, aperture):
    """The picture of the baked scene by the program, and Cycles' own, dB."""
    folder = PLACE / name
    folder.mkdir()
    scene.camera.data.dof.use_dof = aperture
    theirs = workshop.render(scene, folder / "cycles.exr", samples=DRAWN)
    manifest = cycles_light.bake(scene, PROGRAM, folder, SIDE, BAKED)
    project = handover.make_project(PROGRAM, folder, manifest)
    lens = [] if aperture else ["--aperture-radius", "0"]
    program.run(PROGRAM, "render", project, *lens, "-o", folder / "ours.exr")
    found = psnr(folder / "ours.exr", theirs)
    print(f"{name}: {found:.1f} dB")
    return found


class CyclesLight(unittest.TestCase):
    def test_a_pinhole_picture(self):
        self.assertGreaterEqual(compared("pinhole", workshop.still(SIZE, 0.15, glass=True), aperture=False), 35)

    def test_a_lens_before_rough_things(self):
        self.assertGreaterEqual(compared("lens", workshop.still(SIZE, 0.3, glass=False), aperture=True), 34)

    def test_a_copy_is_baked_in_the_background(self):
        """As the button does it: the open scene stays as it is, and what fails is said in one line."""
        scene = workshop.still((16, 10), 0.5, glass=False)
        before = sorted(each.name for each in bpy.data.objects)
        folder = PLACE / "background"
        folder.mkdir()
        done = cycles_light.in_background(PROGRAM, folder, 64, 1, PLACE / "copy.blend")
        code, told = done.wait(300), folder / "bake-error.txt"
        self.assertEqual(code, 0, told.read_text() if told.is_file() else "")
        self.assertEqual(handover.read(folder)["light"], "cycles")
        self.assertTrue((folder / "light.exr").is_file())
        self.assertEqual(sorted(each.name for each in bpy.data.objects), before)
        failed = cycles_light.in_background(str(PLACE / "nothing"), folder, 64, 1, PLACE / "copy.blend")
        self.assertEqual(failed.wait(300), 3)
        self.assertRegex((folder / "bake-error.txt").read_text(), "nothing: cannot be started")

    def test_another_light_is_told_apart(self):
        """The comparison fails where it must: a picture against the same one at another place."""
        scene = workshop.still(SIZE, 0.3, glass=False)
        scene.camera.data.dof.use_dof = False
        one = workshop.render(scene, PLACE / "one.exr", samples=64)
        scene.objects["Rock"].location.x += 0.1
        other = workshop.render(scene, PLACE / "other.exr", samples=64)
        self.assertLess(psnr(one, other), 30)


if __name__ == "__main__":
    unittest.main(verbosity=1)
