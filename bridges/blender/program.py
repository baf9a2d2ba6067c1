"""The program: where it is, and what it is asked."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from .names import BridgeError

# Exit codes: done, and partly done.
FINE = (0, 4)
HOW = "Focus Brush was not found: set its path in Edit > Preferences > Add-ons > Focus Brush > Program"


def find(chosen=""):
    """The program: the one that was chosen, else the one that the system's search path has. Nothing else is tried."""
    if chosen:
        path = Path(chosen).expanduser()
        if not path.is_file() or not os.access(path, os.X_OK):
            raise BridgeError(f"{path}: is no program that can be started (set the path in Edit > Preferences > Add-ons > Focus Brush)")
        return str(path)
    found = shutil.which("focus-brush")
    if found is None:
        raise BridgeError(HOW)
    return found


def run(program, *arguments):
    """Runs a command to its end; gives what it printed. A failure is the line that the program says."""
    try:
        done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, encoding="utf-8", check=False)
    except OSError as error:
        raise BridgeError(f"{program}: cannot be started: {error} (set the path in the add-on's preferences)") from error
    if done.returncode not in FINE:
        raise failure(done.returncode, done.stderr, program)
    return done.stdout


def failure(returncode, text, program):
    """What a command that failed said: its last line that is an error."""
    lines = [line for line in text.splitlines() if line.startswith("error:")]
    return BridgeError(lines[-1].removeprefix("error: ") if lines else f"{program} ended with {returncode}")


class Queue:
    """Commands, one after the other, that nobody waits for: `poll` from a timer. What they print goes into files."""

    def __init__(self, program, commands):
        """Commands are (arguments, the file for what they print or None)."""
        self.program, self.waiting = program, list(commands)
        self.process, self.files, self.said = None, [], None

    def poll(self):
        """Whether all are done. The first failure ends it."""
        if self.process is not None:
            code = self.process.poll()
            if code is None:
                return False
            self.said.seek(0)
            text = self.said.read()
            for file in self.files:
                file.close()
            self.process, self.files = None, []
            if code not in FINE:
                self.waiting = []
                raise failure(code, text, self.program)
        if not self.waiting:
            return True
        arguments, output = self.waiting.pop(0)
        self.said = tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace")
        self.files = [self.said] + ([open(output, "wb")] if output else [])
        try:
            self.process = subprocess.Popen(
                [self.program, *map(str, arguments)],
                stdin=subprocess.DEVNULL,
                stdout=self.files[1] if output else subprocess.DEVNULL,
                stderr=self.said,
            )
        except OSError as error:
            raise BridgeError(f"{self.program}: cannot be started: {error} (set the path in the add-on's preferences)") from error
        return False

    def finish(self):
        """Waits until all are done."""
        while not self.poll():
            if self.process is not None:
                self.process.wait()

    def stop(self):
        """Ends what is running."""
        self.waiting = []
        if self.process is not None:
            self.process.terminate()

def start(program, *arguments):
    """Starts the program and does not wait for it."""
    try:
        return subprocess.Popen([program, *map(str, arguments)], stdin=subprocess.DEVNULL)
    except OSError as error:
        raise BridgeError(f"{program}: cannot be started: {error} (set the path in the add-on's preferences)") from error
