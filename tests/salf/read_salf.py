#!/usr/bin/env python3
"""Reads a `.salf` file as docs/reference/salf.md describes it, and nothing else; needs Python 3 alone.

    read_salf.py FILE.salf              what it holds on the whole, as one JSON object
    read_salf.py FILE.salf --samples    every sample, a JSON object a line

A file that is no sound `.salf` file is told in one line on stderr; the exit code is 3.
"""

import hashlib
import json
import math
import struct
import sys
from collections import namedtuple

VERSIONS = {6: ("cpu", False), 7: ("cpu", True), 8: ("gpu", False), 9: ("gpu", True)}
MAGIC = b"FBSALF\r\n"
LONGEST_TEXT = 65536
LARGEST_SIDE = 16384
FARTHEST_BLOCK = 1 << 20
NO_PLANE = 0xFFFF
NO_TRIANGLE = 0xFFFFFFFF
FORMS = ("whole_cell", "part_of_cell", "patch", "part_of_quadrant")
SPLAT, SPLAT_LEVEL = "splat", 7
WORDS_OF_FORM = (0, 4, 0, 1)
RECORD = struct.Struct("<HHHH3s5s")

# seen: None if it sees the whole aperture, else rows of bits, row 0 at v = -1, column 0 the lowest bit.
Sample = namedtuple(
    "Sample", "form center half_size inverse_depth weight tilt radiance triangle barycentric is_carried seen"
)
Block = namedtuple("Block", "corner starts")


class Damaged(Exception):
    """Why a file is not read."""


class Bytes:
    """The bytes of a file, taken from the front."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        if count > len(self.data) - self.at:
            raise Damaged("cut short")
        self.at += count
        return self.data[self.at - count : self.at]

    def numbers(self, form):
        form = struct.Struct("<" + form)
        return form.unpack(self.take(form.size))

    def number(self, form):
        return self.numbers(form)[0]

    def many(self, form, count):
        form = struct.Struct("<" + form)
        return list(form.iter_unpack(self.take(form.size * count)))

    def text(self, errors="strict"):
        length = self.number("I")
        if length > LONGEST_TEXT:
            raise Damaged(f"a text of {length} bytes")
        try:
            return self.take(length).decode("utf-8", errors)
        except UnicodeDecodeError:
            raise Damaged("a text that is not UTF-8") from None

    def path(self):
        """A name as the system has it, which need not be UTF-8."""
        return self.text("surrogateescape")


def require(is_so, what):
    if not is_so:
        raise Damaged(what)


def f24(three):
    return struct.unpack("<f", (int.from_bytes(three, "little") << 7).to_bytes(4, "little"))[0]


def f32(value):
    """The nearest f32: what another reader holds in 32 bits."""
    try:
        return struct.unpack("<f", struct.pack("<f", value))[0]
    except OverflowError:
        raise Damaged("a weight that is not finite") from None


def is_rigid(pose):
    """Whether right, up and backward are unit vectors at right angles, not mirrored."""
    x, y, z = axes = pose[0:3], pose[4:7], pose[8:11]
    dot = lambda a, b: sum(p * q for p, q in zip(a, b))
    off = [dot(a, b) - (a is b) for a in axes for b in axes]
    cross = (x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0])
    return all(map(math.isfinite, pose)) and all(abs(each) < 1e-3 for each in off) and dot(cross, z) > 0


def read_camera(file):
    width, height = file.numbers("II")
    yfov, focus_distance, radius, sensor_height = file.numbers("4d")
    shift = file.numbers("2d")
    background, pose, ratio = file.numbers("3d"), file.numbers("16d"), file.number("d")
    shape = file.number("B")
    require(1 <= width <= LARGEST_SIDE and 1 <= height <= LARGEST_SIDE, "a picture without a size")
    require(0 < yfov < math.pi, "an angle of view that is none")
    require(focus_distance > 0 and 0 <= radius < math.inf and 0 < sensor_height < math.inf, "a lens that is none")
    require(all(-100 <= value <= 100 for value in shift), "a shift that is none")
    require(all(0 <= value < math.inf for value in background), "a background that is none")
    require(is_rigid(pose), "a pose that is none")
    require(0 < ratio < math.inf, "an anamorphic ratio that is none")
    aperture = {"ratio": ratio}
    if shape == 0:
        aperture["shape"] = "disc"
    elif shape == 1:
        blades, rotation, roundness = file.numbers("Idd")
        require(3 <= blades <= 64 and math.isfinite(rotation) and 0 <= roundness <= 1, "a polygon that is none")
        aperture.update(shape="polygon", blades=blades, rotation=rotation, roundness=roundness)
    elif shape == 2:
        aperture["shape"] = "square"
    elif shape == 3:
        columns, rows = file.numbers("II")
        require(1 <= columns <= LARGEST_SIDE and 1 <= rows <= LARGEST_SIDE, "a mask without a size")
        name = file.text()
        texels = file.numbers(f"{columns * rows}f")
        require(all(0 <= texel <= 1 for texel in texels), "a mask that is none")
        aperture.update(shape="mask", columns=columns, rows=rows, file=name, transmission=texels)
    else:
        raise Damaged(f"aperture shape {shape}")
    return {
        "width": width,
        "height": height,
        "yfov": yfov,
        "focus_distance": focus_distance,
        "aperture_radius": radius,
        "sensor_height": sensor_height,
        "shift": shift,
        "background": background,
        "pose": pose,
        "aperture": aperture,
    }


class Fields:
    """What the partly occluded samples of one block see, field by field."""

    def __init__(self, codes):
        self.codes, self.at = codes, 0
        self.range, self.code = 0xFFFFFFFF, 0
        for _ in range(4):
            self.code = self.code << 8 | self.next_byte()
        self.rows = {side: [[32768, 0] for _ in range(8)] for side in (8, 16)}
        self.cells = {side: [[32768, 0] for _ in range(2048)] for side in (8, 16)}
        self.last = {side: [[1] * side for _ in range(side)] for side in (8, 16)}

    def next_byte(self):
        self.at += 1
        return self.codes[self.at - 1] if self.at <= len(self.codes) else 0

    def bit(self, chance):
        hidden, known = chance
        h = (self.range >> 16) * hidden
        bit = int(self.code >= h)
        if bit:
            self.code -= h
            self.range -= h
        else:
            self.range = h
        while self.range < 1 << 24:
            self.code = (self.code << 8 | self.next_byte()) & 0xFFFFFFFF
            self.range <<= 8
        step = 131072 // (2 * known + 3)
        hidden += ((0 if bit else 65536) - hidden) * step >> 16
        chance[0], chance[1] = min(max(hidden, 24), 65512), min(known + 1, 60)
        return bit

    def field(self, side):
        last, field, alike = self.last[side], [], 0
        within = lambda k: min(max(k, 0), side - 1)
        for r in range(side):
            same = self.bit(self.rows[side][alike])
            alike = (2 * alike + same) % 8
            if same:
                field.append(last[r])
                continue
            above = field[r - 1] if r >= 1 else last[0]
            two_above = field[r - 2] if r >= 2 else last[0]
            before, below = last[within(r - 1)], last[within(r + 1)]
            row = []
            for c in range(side):
                left, right = within(c - 1), within(c + 1)
                cells = (
                    row[c - 2] if c >= 2 else last[r][0],
                    row[c - 1] if c >= 1 else last[r][0],
                    above[left],
                    above[c],
                    above[right],
                    two_above[c],
                    last[r][left],
                    last[r][c],
                    last[r][right],
                    before[c],
                    below[c],
                )
                pattern = sum(bit << k for k, bit in enumerate(cells))
                row.append(self.bit(self.cells[side][pattern]))
            field.append(row)
        self.last[side] = field
        return [sum(bit << c for c, bit in enumerate(row)) for row in field]


def part_of_cell(corner, side, sub_cells):
    """Centre, half sides and scale of some sub-cells of a cell, a bit each."""
    if sub_cells == (1 << 64) - 1:
        return [k + side / 2 for k in corner], [side / 2] * 2, float(side * side)
    numbers = [k for k in range(64) if sub_cells >> k & 1]
    digits = lambda k: k & 1 | k >> 1 & 2 | k >> 2 & 4
    n, g = len(numbers), side / 8
    center, half_size = [], []
    for k, places in zip(corner, ([digits(k) for k in numbers], [digits(k >> 1) for k in numbers])):
        mean, squares = sum(places) / n, sum(place * place for place in places) / n
        c = k + (mean + 0.5) * g
        spread = math.sqrt(3 * (squares - mean * mean) * g * g + g * g / 4)
        center.append(c)
        half_size.append(min(spread, c - k, k + side - c))
    return center, half_size, n * g * g


class Salf:
    """A light field: its header, and its samples by `samples()`."""

    def __init__(self, data):
        file = Bytes(data)
        if data[: len(MAGIC)] != MAGIC:
            raise Damaged("not a .salf file")
        file.take(len(MAGIC))
        self.version = file.number("I")
        known = f"only {min(VERSIONS)} to {max(VERSIONS)}"
        require(self.version in VERSIONS, f"version {self.version} is not known, {known}")
        self.baked_on, self.has_splats = VERSIONS[self.version]
        self.source = file.path()
        self.triangles = file.number("I")
        self.camera = read_camera(file)
        self.margin = file.number("I")
        counts = file.numbers("7Q")
        require(max(counts) < 1 << 32, "more samples than there can be")
        blocks, records, planes, words, patches, codes, loose = counts
        self.blocks = [Block(each[:2], each[2:]) for each in file.many("2i5I", blocks)]
        self.records = file.take(RECORD.size * records)
        self.planes = file.many("I3e", planes)
        self.words = [word for (word,) in file.many("H", words)]
        self.patches = file.many("3sHH3s", patches)
        self.codes = file.take(codes)
        self.loose = [self.read_loose(file) for _ in range(loose)]
        hashed = file.at
        require(file.take(32) == hashlib.sha256(data[:hashed]).digest(), "the checksum does not match")
        require(file.at == len(data), "more bytes than it should have")
        self.check_blocks()

    def check_blocks(self):
        require(bool(self.blocks) == bool(self.records), "samples of no block")
        require(not self.blocks or self.blocks[0].starts == (0,) * 5, "samples of no block")
        for plane in self.planes:
            require(plane[0] == NO_TRIANGLE or plane[0] < self.triangles, "a triangle that the scene does not have")
            require(all(map(math.isfinite, plane[1:])), "a plane that is not finite")
        for index, block in enumerate(self.blocks):
            ordered = all(start <= end for start, end in zip(block.starts, self.ends(index)))
            near = all(abs(k) <= FARTHEST_BLOCK for k in block.corner)
            require(ordered and near, f"block {index}")

    def check_triangle(self, triangle):
        require(triangle < self.triangles, "a triangle that the scene does not have")

    def ends(self, index):
        """What follows the parts of a block."""
        if index + 1 < len(self.blocks):
            return self.blocks[index + 1].starts
        records = len(self.records) // RECORD.size
        return (records, *map(len, (self.planes, self.words, self.patches, self.codes)))

    def read_loose(self, file):
        cx, cy, hx, hy, inverse_depth, weight, tx, ty, *radiance = numbers = file.numbers("11f")
        triangle, barycentric = file.number("I"), None
        if triangle == NO_TRIANGLE:
            triangle = None
        else:
            self.check_triangle(triangle)
            barycentric = file.numbers("2d")
        told = file.number("B")
        count, is_carried = told & 0x7F, told >> 7 == 1
        require(count in (0, 1, 4), f"{count} words of visibility")
        seen = None
        if count:
            side = {1: 8, 4: 16}[count]
            bits = int.from_bytes(file.take(8 * count), "little")
            seen = [bits >> side * row & (1 << side) - 1 for row in range(side)]
        require(all(map(math.isfinite, (*numbers, *(barycentric or ())))), "a sample that is not finite")
        return Sample(
            "loose", (cx, cy), (hx, hy), inverse_depth, weight, (tx, ty), tuple(radiance), triangle, barycentric,
            is_carried, seen
        )

    def samples(self):
        """Every sample, in order."""
        for index in range(len(self.blocks)):
            yield from self.samples_of_block(index)
        yield from self.loose

    def samples_of_block(self, index):
        (record, plane, word, patch, code), ends = self.blocks[index].starts, self.ends(index)
        planes = self.planes[plane : ends[1]]
        fields = Fields(self.codes[code : ends[4]])
        records = self.records[RECORD.size * record : RECORD.size * ends[0]]
        for place, number, b1, b2, inverse_depth, rgb in RECORD.iter_unpack(records):
            level, form, view = place >> 8 & 7, place >> 11 & 3, place >> 13 & 3
            is_patch, is_quadrant, is_splat = form == 2, form == 3, (form, level) == (0, SPLAT_LEVEL)
            level = 0 if is_splat else level
            require(level <= (3 if is_quadrant else 4) and view <= 2, "a sample that makes no sense")
            require(self.has_splats or not is_splat, "a splat in a version without them")
            inverse_depth = f24(inverse_depth)
            require(math.isfinite(inverse_depth), "a depth that is not finite")
            corner = [k + (place >> shift & 15) for k, shift in zip(self.blocks[index].corner, (0, 4))]
            if is_patch:
                require(patch < ends[3], f"block {index}")
                fraction, hx, hy, scale = self.patches[patch]
                patch += 1
                fraction, scale = int.from_bytes(fraction, "little"), f24(scale)
                require(math.isfinite(scale), "a patch that is not finite")
                center = [corner[0] + (fraction & 0xFFF) / 4096, corner[1] + (fraction >> 12) / 4096]
                half_size = [hx / 4096, hy / 4096]
            else:
                words = self.words[word : min(word + WORDS_OF_FORM[form], ends[2])]
                require(len(words) == WORDS_OF_FORM[form] and (not words or any(words)), f"block {index}")
                word += len(words)
                sub_cells = sum(bits << 16 * k for k, bits in enumerate(words)) if words else (1 << 64) - 1
                if is_quadrant:
                    sub_cells, level = sub_cells << 16 * level, 0
                center, half_size, scale = part_of_cell(corner, 1 << level, sub_cells)
            if is_splat:
                triangle, barycentric = b1 | b2 << 16, (0.0, 0.0)
                self.check_triangle(triangle)
                shares = (*struct.unpack("<e", struct.pack("<H", number)), 0.0, 0.0)
                require(math.isfinite(shares[0]) and shares[0] >= 0, "a weight that makes no sense")
            elif number == NO_PLANE and not is_patch:
                triangle, barycentric, shares = None, None, (1.0, 0.0, 0.0)
            else:
                require(number < len(planes), f"block {index}")
                triangle, *shares = planes[number]
                barycentric = (b1 / 65535, b2 / 65535)
                if triangle == NO_TRIANGLE:
                    triangle = barycentric = None
            bits = int.from_bytes(rgb, "little")
            quantum = 2.0 ** ((bits & 0x7F) - 74)
            weight, *tilt = (f32(f32(scale) * share) for share in shares)
            yield Sample(
                SPLAT if is_splat else FORMS[form],
                tuple(map(f32, center)),
                tuple(map(f32, half_size)),
                inverse_depth,
                weight,
                tuple(tilt),
                tuple((bits >> at & 0x7FF) * quantum for at in (7, 18, 29)),
                triangle,
                barycentric,
                place >> 15 == 1,
                fields.field(8 * view) if view else None,
            )
        require((word, patch) == ends[2:4], f"block {index}")


class Mean:
    """A weighted mean of some numbers."""

    def __init__(self, numbers):
        self.sums, self.weight = [0.0] * numbers, 0.0

    def add(self, values, weight=1.0):
        self.sums = [total + weight * value for total, value in zip(self.sums, values)]
        self.weight += weight

    def get(self):
        return [total / self.weight for total in self.sums] if self.weight else None


def share_seen(sample):
    if sample.seen is None:
        return 1.0
    return sum(bin(row).count("1") for row in sample.seen) / len(sample.seen) ** 2


def summary(salf):
    forms = dict.fromkeys((*FORMS, SPLAT, "loose"), 0)
    count = partial = background = 0
    seen, radiance, by_weight = Mean(1), Mean(3), Mean(3)
    low, high = math.inf, 0.0
    for sample in salf.samples():
        count += 1
        forms[sample.form] += 1
        partial += sample.seen is not None
        background += sample.triangle is None
        seen.add([share_seen(sample)])
        radiance.add(sample.radiance)
        by_weight.add(sample.radiance, max(0.0, sample.weight))
        if sample.inverse_depth > 0:
            low, high = min(low, sample.inverse_depth), max(high, sample.inverse_depth)
    share = lambda number: number / count if count else None
    without_texels = {key: value for key, value in salf.camera["aperture"].items() if key != "transmission"}
    return {
        "version": salf.version,
        "baked_on": salf.baked_on,
        "source": salf.source,
        "triangles": salf.triangles,
        "camera": {**salf.camera, "aperture": without_texels},
        "margin_px": salf.margin,
        "blocks": len(salf.blocks),
        "samples": count,
        "forms": forms,
        "open": count - partial,
        "partly_occluded": partial,
        "background": background,
        "share_open": share(count - partial),
        "share_partly_occluded": share(partial),
        "share_of_aperture_seen": seen.get() and seen.get()[0],
        "mean_radiance": radiance.get(),
        "mean_radiance_by_weight": by_weight.get(),
        "nearest_depth": 1 / high if high else None,
        "farthest_depth": 1 / low if high else None,
    }


def sample_json(sample):
    """One sample; rows of what it sees as hexadecimal numbers, the lowest bit at u = -1."""
    digits = None if sample.seen is None else len(sample.seen) // 4
    seen = None if sample.seen is None else [f"{row:0{digits}x}" for row in sample.seen]
    return {**sample._asdict(), "seen": seen}


def read(path):
    with open(path, "rb") as file:
        return Salf(file.read())


def finite(value):
    """JSON knows no infinity: a lens focused there says "inf", as camera files do."""
    if isinstance(value, dict):
        return {key: finite(each) for key, each in value.items()}
    return "inf" if value == math.inf else value


def refused(path, error):
    what = error.strerror if isinstance(error, OSError) else error
    print(f"error: {path}: {what} (check the file, or bake it again)", file=sys.stderr)
    return 3


def main(arguments):
    if len(arguments) not in (1, 2) or arguments[1:] not in ([], ["--samples"]):
        print("usage: read_salf.py FILE.salf [--samples]", file=sys.stderr)
        return 2
    try:
        salf = read(arguments[0])
        if not arguments[1:]:
            told = json.dumps(finite(summary(salf)), indent=2)
    except (Damaged, OSError) as error:
        return refused(arguments[0], error)
    if not arguments[1:]:
        print(told)
        return 0
    try:
        for sample in salf.samples():
            print(json.dumps(sample_json(sample)))
    except Damaged as error:
        return refused(arguments[0], error)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
