"""The types of `__init__.pyi` are those of the module, by mypy's stubtest where mypy is installed."""

import importlib.util
import subprocess
import sys
import unittest

from workplace import FOLDER


class Types(unittest.TestCase):
    @unittest.skipUnless(importlib.util.find_spec("mypy"), "mypy is not installed (python3-mypy)")
    def test_stubs(self):
        words = [sys.executable, "-m", "mypy.stubtest", "focus_brush"]
        done = subprocess.run(words, cwd=FOLDER, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
