"""The program: where it is, and what it is asked."""

import json
import os
import shutil
import subprocess
from pathlib import Path

from .names import BridgeError

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
    if done.returncode not in (0, 4):
        lines = [line for line in done.stderr.splitlines() if line.startswith("error:")]
        raise BridgeError(lines[-1].removeprefix("error: ") if lines else f"{program} ended with {done.returncode}")
    return done.stdout


def told(program, *arguments):
    """What a command says as JSON."""
    return json.loads(run(program, *arguments, "--json"))


def start(program, *arguments):
    """Starts the program and does not wait for it."""
    try:
        return subprocess.Popen([program, *map(str, arguments)], stdin=subprocess.DEVNULL)
    except OSError as error:
        raise BridgeError(f"{program}: cannot be started: {error} (set the path in the add-on's preferences)") from error
