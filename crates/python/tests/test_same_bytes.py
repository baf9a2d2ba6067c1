"""The pictures, light fields and numbers of the command line, byte for byte, for every kind of input."""

import json
import unittest

import numpy as np

import focus_brush as fb
from workplace import FOLDER, SHARED, command, write_table

SMALL = ["--size", "64x40"]


class SameBytes(unittest.TestCase):
    def check(self, file, words, make, form="exr"):
        """The picture of the command line with these words, and that of `make`, which is given the opened scene."""
        expected, found = FOLDER / f"expected.{form}", FOLDER / f"found.{form}"
        command("render", file, *words, "--backend", "cpu", "-o", expected)
        make(fb.open(FOLDER / file)).write(found)
        self.assertEqual(found.read_bytes(), expected.read_bytes(), f"{file} {words}")

    def camera(self, scene):
        return scene.find_camera(FOLDER / "camera.json")

    def test_a_scene(self):
        recipe = FOLDER / "recipe.json"
        words = ["--camera", "camera.json", "--focus", "recipe.json"]
        self.check("scene.glb", words, lambda scene: scene.render(self.camera(scene), recipe))
        self.check("scene.glb", words, lambda scene: scene.render(self.camera(scene), recipe), "png")
        with self.assertRaises(AssertionError):
            self.check("scene.glb", words, lambda scene: scene.render(self.camera(scene)))

    def test_options_of_the_command_line(self):
        for words, options in [
            (["--renderer", "blur"], {"renderer": "blur"}),
            (["--tolerance", "0"], {"tolerance": 0}),
            (["--cells", "2", "--light-passes", "1"], {"cells": 2, "light_passes": 1}),
            (["--aov", "coverage,coc,depth,t,alpha"], {"aov": ["coverage", "coc", "depth", "t", "alpha"]}),
        ]:
            make = lambda scene: scene.render(self.camera(scene), **options)  # noqa: E731
            self.check("scene.glb", ["--camera", "camera.json", *words], make)

    def test_the_ground_truth(self):
        words = ["--camera", "camera.json", "--renderer", "truth", "--spp", "8", "--seed", "3"]
        self.check("scene.glb", words, lambda scene: scene.truth(self.camera(scene), spp=8, seed=3))

    def test_a_baked_light_field(self):
        self.check("field.salf", [], lambda scene: scene.render())
        scene = fb.open(FOLDER / "scene.glb")
        field = scene.bake(self.camera(scene))
        field.write(FOLDER / "found.salf")
        self.assertEqual((FOLDER / "found.salf").read_bytes(), (FOLDER / "field.salf").read_bytes())
        self.check("field.salf", [], lambda _: field.render())

    def test_a_painted_project(self):
        self.check("painted.fbrush", [], lambda scene: scene.render())

    def test_arrays_give_what_files_give(self):
        words = ["--camera", "camera.json", "--focus", "recipe.json"]
        over_parts = lambda scene: scene.focus(FOLDER / "recipe.json", over="part")  # noqa: E731
        self.check("scene.glb", words, lambda scene: scene.render(self.camera(scene), over_parts(scene)))
        self.check("painted.fbrush", [], lambda scene: scene.render(focus=scene.focus()))
        # An atlas that is unwrapped: the engines of the program, in children of this Python.
        command("new", "scene.glb", "--camera", "camera.json", "--focus", "recipe.json", "-o", "of_recipe.fbrush")
        over_atlas = lambda: fb.open(FOLDER / "scene.glb").focus(FOLDER / "recipe.json")  # noqa: E731
        saved = fb.open(FOLDER / "of_recipe.fbrush").focus()
        self.assertEqual(over_atlas().t.tobytes(), saved.t.tobytes())
        self.assertEqual(over_atlas().anchor.tobytes(), saved.anchor.tobytes())

    def test_a_focus_for_each_triangle(self):
        words = ["--camera", "camera.json", "--focus", "recipe.json"]
        read = lambda scene: scene.focus(FOLDER / "recipe.json", over="triangle")  # noqa: E731
        self.check("scene.glb", words, lambda scene: scene.render(self.camera(scene), read(scene)))
        scene = fb.open(FOLDER / "scene.glb")
        over_parts, over_triangles = scene.focus(FOLDER / "recipe.json", over="part"), read(scene)
        self.assertEqual(over_triangles.t.shape, (scene.triangles,))
        self.assertEqual(set(over_triangles.t), set(over_parts.t))
        # One triangle of a card alone.
        before = scene.render(self.camera(scene), over_triangles)
        over_triangles.t[-1], over_triangles.anchor[-1] = 1.1, 0.5
        self.assertGreater(np.abs(scene.render(self.camera(scene), over_triangles).radiance - before.radiance).max(), 0)

    def test_a_focus_for_each_splat(self):
        count = 60
        columns = {"t": np.linspace(0.95, 1.05, count), "anchor": np.linspace(0, 1, count), "gloss": np.zeros(count)}
        write_table(FOLDER / "focus.ply", columns)
        words = ["--camera", "camera.json", "--focus", "focus.ply"]
        read = lambda scene: scene.focus(FOLDER / "focus.ply", over="splat")  # noqa: E731
        self.check("splats.ply", words, lambda scene: scene.render(self.camera(scene), read(scene)))
        scene = fb.open(FOLDER / "splats.ply")
        np.testing.assert_array_equal(read(scene).t, columns["t"].astype(np.float32))
        np.testing.assert_array_equal(read(scene).anchor, columns["anchor"].astype(np.float32))
        written = scene.focus(over="splat")
        self.assertTrue((written.t == 1).all())
        written.t, written.anchor = columns["t"], columns["anchor"]
        self.check("splats.ply", words, lambda _: scene.render(self.camera(scene), written))

    def test_inputs_of_other_programs(self):
        inputs = ["splats/model.spz", "photogrammetry/skull", "lightfield/hci_stillLife_3x3", "gltf/cakeBirthday.glb"]
        for name in inputs:
            with self.subTest(name):
                file = SHARED / name
                if not file.exists():
                    self.skipTest(f"{file} is not here")
                small = lambda scene: scene.camera.replace(size=(64, 40))  # noqa: E731
                self.check(file, SMALL, lambda scene: scene.render(small(scene)))

    def test_comparisons(self):
        for name, words in [("a", []), ("b", ["--renderer", "truth", "--spp", "4"])]:
            command("render", "scene.glb", "--camera", "camera.json", *words, "-o", f"{name}.exr")
        expected = json.loads(command("compare", "a.exr", "b.exr", "--json"))
        self.assertEqual(fb.compare(FOLDER / "a.exr", FOLDER / "b.exr"), expected)
        scene = fb.open(FOLDER / "scene.glb")
        camera = self.camera(scene)
        picture, truth = scene.render(camera), scene.truth(camera, spp=4)
        self.assertEqual(fb.compare(picture, truth), expected)
        self.assertEqual(fb.compare(picture.exposed(), truth.exposed()), expected)
        self.assertNotEqual(fb.compare(truth, picture), expected)


if __name__ == "__main__":
    unittest.main()
