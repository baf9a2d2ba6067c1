"""Names that both sides of the bridge rely on."""

# The one key of `extras` that holds what glTF cannot carry, and the version of what stands there.
KEY = "focus_brush"
VERSION = 1

# What the way back makes in a mesh and in the file.
UV_MAP = "Focus Brush"
ATTRIBUTES = {"focus.t": "focus_t", "focus.anchor": "focus_anchor", "focus.gloss": "focus_gloss"}
COLLECTION = "Focus Brush"
FOCUS_IMAGE = "Focus Brush map"
PICTURE = "Focus Brush picture"


class BridgeError(Exception):
    """What went wrong for the user, and what to do: one line."""


def extras(**fields):
    """Our entry of an `extras` object."""
    return {"version": VERSION, **fields}


def of_extras(holder):
    """Our entry of the `extras` of a part of a glTF document, `{}` if there is none."""
    extras = holder.get("extras")
    found = extras.get(KEY) if isinstance(extras, dict) else None
    return found if isinstance(found, dict) and found.get("version") == VERSION else {}
