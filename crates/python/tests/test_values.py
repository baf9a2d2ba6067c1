"""Values: what is wrong raises a sentence, what is right is taken, in whatever form NumPy has it."""

import gc
import itertools
import math
import random
import unittest

import numpy as np

import focus_brush as fb
from workplace import FOLDER


class Values(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = fb.open(FOLDER / "scene.glb")
        cls.camera = cls.scene.find_camera(FOLDER / "camera.json")
        cls.field = cls.scene.bake(cls.camera)

    def test_errors_are_the_sentences_of_the_command_line(self):
        scene, field, camera = self.scene, self.field, self.camera
        other = fb.open(FOLDER / "scene.glb")
        cases = [
            (FileNotFoundError, "nowhere.glb: ", lambda: fb.open("nowhere.glb")),
            (ValueError, "is not a scene, project, light field", lambda: fb.open(__file__)),
            (ValueError, "no variant is called", lambda: fb.open(FOLDER / "scene.glb", variant="none")),
            (ValueError, 'no camera is called "x"', lambda: scene.find_camera("x")),
            (FileNotFoundError, "x.json", lambda: scene.find_camera("x.json")),
            (FileNotFoundError, "x.json", lambda: fb.Camera.read("x.json")),
            (ValueError, "width", lambda: camera.replace(size=(0, 3))),
            (ValueError, "focus_distance", lambda: camera.replace(focus_distance=math.nan)),
            (ValueError, "camera_to_world", lambda: camera.replace(camera_to_world=np.zeros((4, 4)))),
            (ValueError, "no number, text, list or dict", lambda: fb.Camera(width=object())),
            (ValueError, "is not a valid field", lambda: fb.Camera(focal_length=0.05)),
            (ValueError, "spp: 0 is out of range", lambda: scene.truth(spp=0)),
            (ValueError, "spp: -1 is out of range", lambda: scene.render(spp=-1)),
            (ValueError, "tolerance", lambda: scene.render(tolerance=-1)),
            (ValueError, "tolerance", lambda: scene.render(tolerance=math.inf)),
            (ValueError, "cells: 5", lambda: scene.render(cells=5)),
            (ValueError, "renderer", lambda: scene.render(renderer="magic")),
            (ValueError, "aov", lambda: scene.render(aov=["magic"])),
            (TypeError, "spread", lambda: scene.render(spread=1)),
            (ValueError, "already baked", lambda: field.render(cells=2)),
            (ValueError, "it was baked for 64 × 40 px", lambda: field.render(camera=camera.replace(size=(32, 20)))),
            (ValueError, "another scene", lambda: scene.render(camera, other.focus(over="part"))),
            (TypeError, "focus", lambda: scene.render(camera, 3)),
            (FileNotFoundError, "x.json", lambda: scene.focus("x.json")),
            (ValueError, "over", lambda: scene.focus(over="sample")),
            (ValueError, "no Gaussian splats", lambda: scene.focus(over="splat")),
            (ValueError, "differs within parts", lambda: fb.open(FOLDER / "painted.fbrush").focus(over="part")),
            (ValueError, "over triangles", lambda: scene.focus(over="triangle").select(np.zeros((40, 64), bool))),
            (FileNotFoundError, "x.glb", lambda: fb.report("x.glb", FOLDER / "report")),
            (ValueError, "is not a scene, project, light field", lambda: fb.report(__file__, FOLDER / "report")),
            (ValueError, "spp: 1 is out of range", lambda: fb.report([], FOLDER / "report", spp=1)),
            (ValueError, "exposure", lambda: field.render().exposed("bright")),
            (ValueError, "name an .exr or .png", lambda: field.render().write("x.gif")),
            (fb.GpuAbsent, "no GPU backend", lambda: scene.render(renderer="blur", backend="gpu")),
            (RuntimeError, "work has begun", lambda: fb.set_threads(3)),
        ]
        for kind, text, call in cases:
            with self.subTest(text), self.assertRaises(kind) as caught:
                call()
            self.assertIn(text, str(caught.exception))

    def test_cameras_go_out_and_in(self):
        file = FOLDER / "written.json"
        camera = self.camera.replace(focus_distance=math.inf, aperture={"shape": "polygon", "blades": 5})
        camera.write(file)
        self.assertEqual(fb.Camera.read(file), camera)
        self.assertEqual(fb.Camera(**camera.to_dict()), camera)
        self.assertNotEqual(camera.replace(width=65), camera)
        self.assertEqual(camera.replace(width=np.int32(64), yfov=np.float32(0.5)).yfov, 0.5)

    def test_focus_takes_every_form_of_numbers(self):
        focus = self.scene.focus()
        rows, columns = focus.t.shape
        ramp = np.linspace(0.98, 1.02, rows * columns).reshape(rows, columns)
        expected = None
        forms = [
            ramp,
            ramp.astype(np.float32),
            np.asfortranarray(ramp),
            np.repeat(ramp, 2, axis=1)[:, ::2],
            ramp[::-1][::-1],
            ramp.astype(">f8"),
            ramp.tolist(),
        ]
        for form in forms:
            focus.t = form
            picture = self.field.render(focus).radiance.tobytes()
            expected = expected or picture
            self.assertEqual(picture, expected)
        self.assertNotEqual(self.field.render().radiance.tobytes(), expected)

    def test_numbers_that_cannot_be_used_raise(self):
        for over in ["atlas", "part", "triangle"]:
            focus = self.scene.focus(over=over)
            for name, value in itertools.product(["t", "anchor", "gloss"], [math.nan, math.inf, -math.inf, -1, 2]):
                if name == "t" and math.isfinite(value):
                    continue
                array = getattr(focus, name)
                saved = array.flat[0]
                array.flat[0] = value
                with self.subTest(f"{over} {name} {value}"), self.assertRaises(ValueError):
                    self.field.render(focus)
                array.flat[0] = saved
            focus.background = (math.nan, 0, 0)
            with self.assertRaises(ValueError):
                self.field.render(focus)

    def test_any_array_is_compared_or_refused(self):
        choose = random.Random(5)
        kinds = [np.float16, np.float32, np.float64, np.uint8, np.int64, bool, complex, object, "U3", "M8[s]"]
        for _ in range(300):
            shape = [choose.choice([0, 1, 2, 3, 5]) for _ in range(choose.choice([0, 1, 2, 3, 3, 3, 4]))]
            if len(shape) == 3 and choose.random() < 0.8:
                shape[2] = 3
            array = np.zeros(shape, np.float64).astype(choose.choice(kinds))
            if array.ndim and choose.random() < 0.3:
                array = array[:: choose.choice([-1, 2])]
            try:
                measured = fb.compare(array, array)
            except (ValueError, TypeError):
                continue
            self.assertEqual(array.shape[2:], (3,))
            self.assertEqual((measured["height"], measured["width"]), array.shape[:2])

    def test_arrays_are_views_that_outlive_the_picture(self):
        picture = self.field.render()
        radiance, coverage = picture.radiance, picture.coverage
        self.assertEqual((radiance.shape, radiance.dtype), ((40, 64, 3), np.float32))
        self.assertEqual((coverage.shape, coverage.dtype), ((40, 64), np.float32))
        self.assertFalse(radiance.flags.owndata or radiance.flags.writeable)
        self.assertTrue(np.shares_memory(radiance, picture.radiance))
        with self.assertRaises(ValueError):
            radiance[0] = 0
        saved = radiance.copy()
        del picture
        gc.collect()
        self.field.render()
        np.testing.assert_array_equal(radiance, saved)

    def test_exposures(self):
        focus = self.scene.focus(over="part")
        focus.t, focus.anchor = 1.05, 0.5
        picture = self.field.render(focus)
        covered = picture.coverage[..., None]
        np.testing.assert_array_equal(picture.exposed("conserve"), picture.radiance)
        normalised = np.divide(picture.radiance, covered, out=np.zeros_like(picture.radiance), where=covered > 0)
        np.testing.assert_array_equal(picture.exposed("normalise"), normalised)
        self.assertGreater(np.abs(covered - 1).max(), 0.01)

    def test_samples(self):
        samples = self.field.samples()
        self.assertEqual({len(array) for array in samples.values()}, {len(self.field)})
        self.assertEqual(samples["radiance"].shape[1], 3)
        # Footprints tile the frame.
        area = (4 * samples["half_size"].prod(axis=1))[samples["is_open"]].sum()
        self.assertGreater(area, 0)


if __name__ == "__main__":
    unittest.main()
