"""Unwraps patches of surface in a process of its own, so that a crash of the unwrapper ends nothing else.

It is started as a script, without the package around it: NumPy would take longer to load than most patches to unwrap.
"""

if __name__ == "__main__":
    import sys

    import _native  # type: ignore

    _native._run_unwrap_child(sys.argv[1:])
