"""OpenEXR pictures as Focus Brush writes them, channel by channel: Blender shows no channels of other names than R, G, B, A.

One part, scan lines, no compression, ZIPS or ZIP; float, half or whole numbers.
"""

import struct
import zlib

import numpy as np

from .names import BridgeError

MAGIC = 20000630
TILED_OR_MORE = 0x1A00
KINDS = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}
LINES = {0: 1, 2: 1, 3: 16}


def _text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def read(path):
    """(channels by name, each (rows, columns), row 0 on top; attributes by name as bytes)."""
    with open(path, "rb") as file:
        data = file.read()
    if len(data) < 8 or struct.unpack_from("<I", data)[0] != MAGIC:
        raise BridgeError(f"{path}: is no OpenEXR picture (export it again)")
    if struct.unpack_from("<I", data, 4)[0] & TILED_OR_MORE:
        raise BridgeError(f"{path}: is tiled or has several parts (export it from Focus Brush)")
    at, attributes = 8, {}
    while data[at] != 0:
        name, at = _text(data, at)
        _, at = _text(data, at)
        size = struct.unpack_from("<I", data, at)[0]
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    at += 1
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    compression = attributes["compression"][0]
    if compression not in LINES:
        raise BridgeError(f"{path}: is compressed in another way than ZIP (export it from Focus Brush)")
    channels = []
    list_at, listed = 0, attributes["channels"]
    while listed[list_at] != 0:
        name, list_at = _text(listed, list_at)
        channels.append((name, KINDS[struct.unpack_from("<I", listed, list_at)[0]]))
        list_at += 16
    lines = LINES[compression]
    chunks = -(-height // lines)
    offsets = struct.unpack_from(f"<{chunks}Q", data, at)
    planes = {name: np.empty((height, width), kind) for name, kind in channels}
    row_size = width * sum(kind.itemsize for _, kind in channels)
    for offset in offsets:
        y, size = struct.unpack_from("<ii", data, offset)
        rows = min(lines, height - (y - y0))
        packed = data[offset + 8:offset + 8 + size]
        content = packed if size == rows * row_size else _unpacked(packed)
        place = 0
        for row in range(y - y0, y - y0 + rows):
            for name, kind in channels:
                planes[name][row] = np.frombuffer(content, kind, width, place)
                place += width * kind.itemsize
    return planes, attributes


def _unpacked(packed):
    """ZIP: bytes as differences, first the even ones, then the odd ones."""
    steps = np.frombuffer(zlib.decompress(packed), np.uint8)
    values = np.cumsum(np.concatenate((steps[:1].astype(np.int64), steps[1:].astype(np.int64) - 128))).astype(np.uint8)
    half = (len(values) + 1) // 2
    content = np.empty(len(values), np.uint8)
    content[0::2], content[1::2] = values[:half], values[half:]
    return content.tobytes()
