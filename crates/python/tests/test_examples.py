"""The examples of the docstrings run."""

import doctest
import os
import shutil
import unittest

import focus_brush as fb
from workplace import FOLDER


class Examples(unittest.TestCase):
    def test_docstrings(self):
        folder = FOLDER / "examples"
        folder.mkdir()
        shutil.copy(FOLDER / "scene.glb", folder / "demo.glb")
        finder = doctest.DocTestFinder(exclude_empty=False)
        public = [(name, getattr(fb, name)) for name in fb.__all__ if name != "__version__"]
        found = [*finder.find(fb, "focus_brush")]
        for name, thing in public:
            self.assertTrue(thing.__doc__, name)
            found += finder.find(thing, name)
        tests = {test.name: test for test in found if test.examples}
        self.assertGreaterEqual(len(tests), 8, sorted(tests))
        runner = doctest.DocTestRunner()
        here = os.getcwd()
        os.chdir(folder)
        try:
            for test in tests.values():
                self.assertEqual(runner.run(test).failed, 0, test.name)
        finally:
            os.chdir(here)


if __name__ == "__main__":
    unittest.main()
