"""`report` measures what the command line measures, and takes up what was measured."""

import json
import unittest

import focus_brush as fb
from workplace import FOLDER

SETTINGS = {"camera": FOLDER / "camera.json", "size": (32, 20), "spp": 2, "quick": True}


class Report(unittest.TestCase):
    def test_a_scene_is_measured_once(self):
        folder, steps = FOLDER / "report", set()
        told = fb.report(FOLDER / "scene.glb", folder, progress=lambda share, step: steps.add(step), **SETTINGS)
        self.assertEqual(told["new"], len(told["records"]))
        self.assertEqual({record["scene"] for record in told["records"]}, {"scene"})
        self.assertGreater(len({record["renderer"] for record in told["records"]}), 3)
        self.assertIsNone(told["hard_cases"])
        self.assertTrue(steps)
        written = json.loads((folder / "report.json").read_text())
        self.assertEqual(told["records"], written)
        self.assertIn(str(folder / "report.html"), told["files"])
        again = fb.report([FOLDER / "scene.glb"], folder, **SETTINGS)
        self.assertEqual((again["new"], again["records"]), (0, told["records"]))

    def test_nothing_to_measure(self):
        told = fb.report([], FOLDER / "nothing")
        self.assertEqual((told["records"], told["new"]), ([], 0))
        self.assertIn("cores", told["machine"])


if __name__ == "__main__":
    unittest.main()
