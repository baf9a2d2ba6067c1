"""Long work: progress, interruption, threads and processes; nothing on stdout."""

import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

import focus_brush as fb
from workplace import FOLDER


def bake_in_child(connection):
    try:
        fb.open(FOLDER / "scene.glb").render()
        connection.send("rendered")
    except RuntimeError as error:
        connection.send(str(error))


class Work(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = fb.open(FOLDER / "scene.glb")
        cls.camera = cls.scene.find_camera(FOLDER / "camera.json")

    def long_work(self):
        """Work of at least many seconds, by name."""
        large = self.camera.replace(size=(3840, 2400))
        return {
            "truth": lambda progress=None: self.scene.truth(self.camera, spp=1 << 20, progress=progress),
            "bake": lambda progress=None: self.scene.bake(large, light_passes=1 << 14, progress=progress),
        }

    def test_progress_is_reported(self):
        reports = []
        self.scene.bake(self.camera.replace(size=(480, 300)), progress=lambda *report: reports.append(report))
        self.assertTrue(reports)
        for share, step in reports:
            self.assertTrue(0 <= share <= 1 and step, reports)

    def test_what_a_callback_raises_comes_out(self):
        class Mine(Exception):
            pass

        def stop(share, step):
            raise Mine(step)

        for name, work in self.long_work().items():
            with self.subTest(name), self.assertRaises(Mine):
                work(progress=stop)
        self.scene.render(self.camera)

    def test_interrupts_are_heard(self):
        for name, work in self.long_work().items():
            with self.subTest(name):
                timer = threading.Timer(0.3, os.kill, [os.getpid(), signal.SIGINT])
                timer.start()
                with self.assertRaises(KeyboardInterrupt):
                    work()
                timer.join()
                self.assertEqual(self.scene.render(self.camera).width, self.camera.width)

    def test_other_threads_run_on(self):
        turns, is_over = [], threading.Event()

        def turn():
            while not is_over.wait(0.001):
                turns.append(time.monotonic())

        other = threading.Thread(target=turn)
        other.start()
        self.scene.truth(self.camera, spp=2000)
        is_over.set()
        other.join()
        self.assertGreater(len(turns), 20)

    def test_works_in_a_thread(self):
        pictures = []
        threads = [threading.Thread(target=lambda: pictures.append(self.scene.render(self.camera))) for _ in range(4)]
        [thread.start() for thread in threads]
        [thread.join() for thread in threads]
        self.assertEqual(len({picture.exposed().tobytes() for picture in pictures}), 1)

    @unittest.skipUnless(hasattr(os, "fork"), "no fork")
    def test_a_forked_child_raises_and_a_spawned_one_works(self):
        self.scene.render(self.camera)
        for method, expected in [("fork", "spawn"), ("spawn", "rendered")]:
            context = multiprocessing.get_context(method)
            mine, its = context.Pipe()
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)
                child = context.Process(target=bake_in_child, args=(its,))
                child.start()
            self.assertTrue(mine.poll(60), f"{method}: no answer")
            self.assertIn(expected, mine.recv())
            child.join()

    def test_stdout_is_left_alone(self):
        script = "import sys, focus_brush as fb; s = fb.open(sys.argv[1]); s.focus(); s.render(); fb.compare(*[s.truth(spp=1)] * 2)"
        words = [sys.executable, "-c", script, str(FOLDER / "scene.glb")]
        done = subprocess.run(words, capture_output=True, text=True, cwd=tempfile.gettempdir())
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))


if __name__ == "__main__":
    unittest.main()
