#!/usr/bin/env python3
"""The standard picture of a `.salf` file, by the sum that docs/reference/salf.md gives; needs Python 3 alone.

    salf_picture.py FILE.salf OUT.pfm [POINTS]

The aperture is taken at POINTS places (64 unless said): through each, every sample sends its light to the box that is its footprint.
OUT.pfm is the radiance, exposure *conserve*: a PFM picture, linear RGB, rows from the bottom.
"""

import array
import math
import sys

sys.dont_write_bytecode = True  # Running it leaves nothing here.

from read_salf import Damaged, read, refused  # noqa: E402

# Fractional parts of multiples of 1/g and 1/g², g³ = g + 1, are spread evenly over a square.
G = 1.324717957244746


def passes(aperture, u, v):
    """What of the light passes the aperture at (u, v), in [0, 1]."""
    ratio = aperture["ratio"]
    u, v = u / min(1, 1 / ratio), v / min(1, ratio)
    if max(abs(u), abs(v)) > 1:
        return 0.0
    if aperture["shape"] == "disc":
        return float(u * u + v * v <= 1)
    if aperture["shape"] == "polygon":
        wedge = 2 * math.pi / aperture["blades"]
        angle = (math.atan2(v, u) - aperture["rotation"]) % wedge
        straight = math.cos(wedge / 2) / math.cos(angle - wedge / 2)
        return float(math.hypot(u, v) <= straight + (1 - straight) * aperture["roundness"])
    if aperture["shape"] == "mask":
        column = min(int((u + 1) / 2 * aperture["columns"]), aperture["columns"] - 1)
        row = min(int((1 - v) / 2 * aperture["rows"]), aperture["rows"] - 1)
        return aperture["transmission"][row * aperture["columns"] + column]
    return 1.0


def aperture_points(aperture, count):
    """`count` places where light passes, and each one's share of it."""
    found, k = [], 0
    while len(found) < count:
        k += 1
        u, v = 2 * (k / G % 1) - 1, 2 * (k / G**2 % 1) - 1
        passing = passes(aperture, u, v)
        if passing > 0:
            found.append((u, v, passing))
    total = sum(passing for _, _, passing in found)
    return [(u, v, passing / total) for u, v, passing in found]


def overlaps(center, half, count):
    """The pixels of a row or column, of `count`, that a footprint lies in, and its share in each."""
    half = max(half, 1e-6)  # A point has a place, too.
    low, high = center - half, center + half
    for pixel in range(max(math.floor(low), 0), min(math.ceil(high), count)):
        yield pixel, (min(high, pixel + 1) - max(low, pixel)) / (2 * half)


def picture(salf, count):
    camera = salf.camera
    width, height = camera["width"], camera["height"]
    per_kappa = camera["aperture_radius"] * height / 2 / math.tan(camera["yfov"] / 2)
    pixels = array.array("d", bytes(8 * 3 * width * height))
    points = aperture_points(camera["aperture"], count)
    for sample in salf.samples():
        r = (1 / camera["focus_distance"] - sample.inverse_depth) * per_kappa
        (x, y), (half_x, half_y), (tilt_u, tilt_v) = sample.center, sample.half_size, sample.tilt
        side = sample.seen and len(sample.seen)
        for u, v, share in points:
            if side and not sample.seen[int((v + 1) / 2 * side)] >> int((u + 1) / 2 * side) & 1:
                continue
            light = share * max(0.0, sample.weight + tilt_u * u + tilt_v * v)
            columns = list(overlaps(x + r * u, half_x, width))
            for row, share_y in overlaps(y - r * v, half_y, height):
                for column, share_x in columns:
                    at = 3 * (row * width + column)
                    for channel, radiance in enumerate(sample.radiance):
                        pixels[at + channel] += light * share_x * share_y * radiance
    return width, height, pixels


def write_pfm(path, width, height, pixels):
    out = array.array("f", pixels)
    if sys.byteorder == "big":
        out.byteswap()
    with open(path, "wb") as file:
        file.write(f"PF\n{width} {height}\n-1.0\n".encode())
        for row in reversed(range(height)):
            file.write(out[3 * width * row : 3 * width * (row + 1)].tobytes())


def main(arguments):
    if len(arguments) not in (2, 3) or not all(count.isdecimal() and int(count) for count in arguments[2:]):
        print("usage: salf_picture.py FILE.salf OUT.pfm [POINTS]", file=sys.stderr)
        return 2
    try:
        drawn = picture(read(arguments[0]), int(arguments[2]) if arguments[2:] else 64)
    except (Damaged, OSError) as error:
        return refused(arguments[0], error)
    try:
        write_pfm(arguments[1], *drawn)
    except OSError as error:
        print(f"error: {arguments[1]}: {error.strerror} (check the folder)", file=sys.stderr)
        return 3
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
