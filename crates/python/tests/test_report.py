"""`report` measures what the command line measures, and takes up what was measured."""

import json
import unittest

import focus_brush as fb
from workplace import FOLDER

SETTINGS = {"camera": FOLDER / "camera.json", "size": (32, 20), "spp": 2, "quick": True}


class Report(unittest.TestCase):
    def test_a_scene_is_measured_once(self):
        folder, steps = FOLDER / "report", set()
        first = fb.report(FOLDER / "scene.glb", folder, progress=lambda share, step: steps.add(step), **SETTINGS)
        # What stands in two sweeps is measured once.
        self.assertTrue(0 < first["new"] <= len(first["records"]))
        self.assertEqual({record["scene"] for record in first["records"]}, {"scene"})
        self.assertGreater(len({record["renderer"] for record in first["records"]}), 3)
        self.assertIsNone(first["hard_cases"])
        self.assertTrue(steps)
        written = json.loads((folder / "report.json").read_text())
        self.assertEqual(first["records"], written)
        self.assertIn(str(folder / "report.html"), first["files"])
        again = fb.report([FOLDER / "scene.glb"], folder, **SETTINGS)
        self.assertEqual((again["new"], again["records"]), (0, first["records"]))

    def test_nothing_to_measure(self):
        nothing = fb.report([], FOLDER / "nothing")
        self.assertEqual((nothing["records"], nothing["new"]), ([], 0))
        self.assertIn("cores", nothing["machine"])


if __name__ == "__main__":
    unittest.main()
