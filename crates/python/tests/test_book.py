"""The programs of the book's page run, in order, beside the demo scene."""

import importlib.util
import os
import re
import shutil
import unittest

from workplace import FOLDER, REPOSITORY

PAGE = REPOSITORY / "docs" / "guide" / "python.md"


class Book(unittest.TestCase):
    def test_programs_of_the_page(self):
        folder = FOLDER / "book"
        folder.mkdir()
        shutil.copy(REPOSITORY / "assets" / "demo" / "demo.glb", folder)
        programs = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
        self.assertEqual(len(programs), 5)
        names, here = {"print": lambda *words: None}, os.getcwd()
        os.chdir(folder)
        try:
            for number, program in enumerate(programs):
                if "matplotlib" in program and not importlib.util.find_spec("matplotlib"):
                    continue
                exec(compile(program, f"{PAGE.name}, program {number + 1}", "exec"), names)
        finally:
            os.chdir(here)


if __name__ == "__main__":
    unittest.main()
