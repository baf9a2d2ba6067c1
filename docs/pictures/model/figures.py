#!/usr/bin/env python3
"""Draws the figures of docs/theory/model.md: `figures.py FOLDER` writes *.svg there. Curves and rays are computed from the formula."""
import math
import sys

INK, PALE, NEAR, SHARP, FAR, PAPER = "#222", "#999", "#c25a12", "#777", "#2b6cb5", "#fff"


class Figure:
    """An SVG picture of lines and words, on white paper so that it can be read on a dark page, too."""

    def __init__(self, width, height):
        self.width, self.height, self.parts = width, height, []

    def line(self, points, colour=INK, width=1.5, dash=None):
        way = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(f'<polyline points="{way}" fill="none" stroke="{colour}" stroke-width="{width}"{dashed}/>')

    def area(self, points, colour):
        way = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.parts.append(f'<polygon points="{way}" fill="{colour}"/>')

    def dot(self, x, y, colour=INK, radius=3.5):
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{colour}"/>')

    def text(self, x, y, words, colour=INK, anchor="middle", size=18):
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" fill="{colour}" text-anchor="{anchor}" font-size="{size}">{words}</text>')

    def write(self, path):
        with open(path, "w", encoding="utf-8") as file:
            file.write(
                f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}" width="{self.width}" '
                f'height="{self.height}" font-family="DejaVu Sans, Verdana, sans-serif">\n'
                f'<rect width="{self.width}" height="{self.height}" rx="6" fill="{PAPER}"/>\n' + "\n".join(self.parts) + "\n</svg>\n"
            )


def through_the_lens():
    """A point's rays, its conjugate, the painted distance T, and the circle on the sensor."""
    figure = Figure(700, 300)
    axis, lens, scale = 150, 330, 1.0
    point, conjugate, sensor, radius = (40, 170), 200.0, 250.0, 80.0
    t = 0.86

    def conjugate_point():
        # The chief ray goes straight through the lens's middle.
        slope = (axis - point[1]) / (lens - point[0])
        return lens + conjugate * scale, axis + slope * conjugate * scale

    cx, cy = conjugate_point()
    slope = (axis - point[1]) / (lens - point[0])
    painted = t * conjugate
    sx = lens + sensor * scale
    for side, colour in ((-1, FAR), (1, FAR)):
        ax, ay = lens, axis + side * radius
        figure.line([point, (ax, ay)], colour, 1.2)
        figure.line([(ax, ay), (cx, cy)], colour, 1.2, "5 4")
        # At T the ray is cut, and goes on along the chief ray.
        px, py = ax + (cx - ax) * t, ay + (cy - ay) * t
        figure.line([(ax, ay), (px, py)], colour, 2)
        figure.line([(px, py), (sx, py + slope * (sx - px))], colour, 2)
        figure.dot(sx, py + slope * (sx - px), colour)
    figure.line([point, (lens, axis), (sx, axis + slope * sensor)], PALE, 1, "2 3")
    figure.line([(lens, axis - radius - 20), (lens, axis - radius)], INK, 5)
    figure.line([(lens, axis + radius), (lens, axis + radius + 20)], INK, 5)
    figure.line([(lens, axis - radius), (lens, axis + radius)], PALE, 1)
    figure.line([(lens + painted, 40), (lens + painted, 260)], NEAR, 1, "4 4")
    figure.line([(sx, 40), (sx, 260)], INK, 3)
    figure.line([(20, axis), (680, axis)], PALE, 0.8)
    figure.dot(*point)
    figure.dot(cx, cy, SHARP)
    figure.text(16, point[1] + 28, "P, depth z", anchor="start")
    figure.text(lens, 40, "aperture, radius R")
    figure.text(lens + painted - 8, 278, "T = t · z'", NEAR)
    figure.text(cx + 10, cy - 10, "z'", SHARP)
    figure.text(sx + 6, 278, "sensor, d", anchor="start")
    return figure


def blur_by_depth():
    """The signed circle of confusion over depth, for some t and anchors."""
    figure = Figure(700, 340)
    left, right, top, bottom = 70, 560, 20, 290
    s, height, yfov, radius, pixels = 2.0, 0.024, 0.7, 0.0125, 540
    d = height / (2 * math.tan(yfov / 2))
    near, far, most = 0.6, 12.0, 24.0

    def x_of(z):
        return left + (right - left) * math.log(z / near) / math.log(far / near)

    def y_of(px):
        return (top + bottom) / 2 - (bottom - top) / 2 * px / most

    def circle(t, a, z):
        kappa = (t - 1) / d + t * (1 - a) * (1 / s - 1 / z)
        return kappa * 2 * radius / math.tan(yfov / 2) * pixels / 2

    for z in (0.6, 1, 2, 4, 8):
        figure.line([(x_of(z), top), (x_of(z), bottom)], "#ddd", 1)
        figure.text(x_of(z), bottom + 18, f"{z:g}", size=15)
    for px in (-20, -10, 0, 10, 20):
        figure.line([(left, y_of(px)), (right, y_of(px))], "#ddd" if px else PALE, 1)
        figure.text(left - 8, y_of(px) + 4, f"{px}", anchor="end", size=15)
    figure.text((left + right) / 2, bottom + 38, "depth z, log scale; the lens is focused at 2", size=16)
    figure.text(left + 6, top + 16, "far, px", FAR, "start", 16)
    figure.text(x_of(1) + 6, bottom - 8, "near, px", NEAR, "start", 16)
    for t, a, colour, dash, name in (
        (1.0, 0.0, INK, None, "t 1, anchor 0: the lens"),
        (1.0, 0.5, "#7a4bb0", None, "t 1, anchor ½"),
        (1.0, 1.0, SHARP, None, "t 1, anchor 1: sharp"),
        (1.02, 0.0, FAR, "6 4", "t 1.02, anchor 0"),
        (0.98, 1.0, NEAR, "6 4", "t 0.98, anchor 1"),
    ):
        ways = [near * (far / near) ** (k / 120) for k in range(121)]
        points = [(x_of(z), y_of(circle(t, a, z))) for z in ways if abs(circle(t, a, z)) <= most]
        figure.line(points, colour, 2, dash)
        figure.text(right + 6, points[-1][1] + 4, name.split(":")[0], colour, "start", 15)
    return figure


def aperture_image():
    """A surface point behind an edge: what of the aperture it sees, and how that lands on the sensor."""
    figure = Figure(700, 280)
    point, edge, lens, axis, radius = (40, 140), (180, 128), 400, 140, 90
    # The ray past the edge's tip.
    cut = point[1] + (edge[1] - point[1]) * (lens - point[0]) / (edge[0] - point[0])
    figure.area([point, (lens, cut), (lens, axis + radius)], "#dbe8f6")
    figure.line([point, (lens, cut)], FAR, 1.2)
    figure.line([point, (lens, axis + radius)], FAR, 1.2)
    figure.line([point, edge], PALE, 1)
    figure.line([(edge[0], 20), edge], INK, 6)
    figure.line([(lens, axis - radius), (lens, cut)], PALE, 5)
    figure.line([(lens, cut), (lens, axis + radius)], FAR, 5)
    figure.dot(*point)
    figure.text(point[0], point[1] + 24, "P")
    figure.text(edge[0] + 12, 32, "what stands before it", anchor="start", size=16)
    figure.text(lens, axis + radius + 24, "aperture", size=16)
    figure.text(lens + 12, axis - radius + 30, "hidden", PALE, "start", 16)
    figure.text(lens + 12, axis + 44, "seen", FAR, "start", 16)

    share = (cut - (axis - radius)) / (2 * radius)

    def image(x, y, size, turned, words):
        # A disc of which a part is cut off at the top, or at the bottom where near blur turns it by half a turn.
        cut_at = -size + 2 * size * share
        points = []
        for k in range(181):
            angle = 2 * math.pi * k / 180
            px, py = size * math.cos(angle), max(size * math.sin(angle), cut_at)
            px = math.copysign(min(abs(px), math.sqrt(max(size**2 - py**2, 0))), px)
            points.append((x - px, y - py) if turned else (x + px, y + py))
        figure.area(points, NEAR if turned else FAR)
        figure.text(x, y + 62, words, NEAR if turned else FAR, size=16)

    image(560, 90, 34, False, "far: κ &gt; 0")
    image(640, 90, 20, False, "")
    image(600, 200, 34, True, "near: κ &lt; 0")
    return figure


def ghosting():
    """Copies that two views of one point leave on the plane that is focused on, and the width of a pixel there."""
    figure = Figure(700, 290)
    left, focus, point, axis, spacing, pixel = 60, 610, 370, 140, 110, 26
    figure.line([(point, 30), (point, 250)], PALE, 1, "2 4")
    figure.line([(focus, 30), (focus, 250)], INK, 1.5)
    places = []
    for side in (-1, 1):
        y = axis + side * spacing / 2
        land = axis - side * spacing / 2 * (focus - point) / (point - left)
        figure.line([(left, y), (focus, land)], FAR, 1.3)
        wide = pixel * (focus - left) / (point - left) / 2
        figure.line([(focus, land - wide), (focus, land + wide)], NEAR, 7)
        figure.dot(left, y, FAR, 5)
        places.append((land, wide))
    figure.dot(point, axis, INK, 4)
    figure.line([(left - 22, axis - spacing / 2), (left - 22, axis + spacing / 2)], INK, 1)
    figure.text(left - 34, axis + 5, "m")
    lower = max(land for land, _ in places)
    upper = min(land for land, _ in places)
    figure.line([(focus + 18, upper), (focus + 18, lower)], INK, 1)
    figure.text(focus + 26, axis + 5, "|Δx|", anchor="start")
    figure.text(focus - 12, lower + places[0][1] + 22, "p'", NEAR, "end")
    figure.text(left, axis + spacing / 2 + 34, "views", FAR)
    figure.text(point, 276, "the point, at z")
    figure.text(690, 276, "focused on, at z + f", anchor="end")
    return figure


def step_of_t():
    """A white wall, sharp on the left, blurred on the right of a step of t: conserved and normalised."""
    figure = Figure(700, 250)
    left, right, top, bottom, radius = 60, 560, 30, 200, 1.0

    def disc_beyond(x):
        # The share of a disc of radius 1 around 0 that lies on the side of x and beyond.
        if x <= -1:
            return 1.0
        if x >= 1:
            return 0.0
        return (math.acos(x) - x * math.sqrt(1 - x * x)) / math.pi

    def x_of(x):
        return left + (right - left) * (x + 2.5) / 5

    def y_of(value):
        return bottom - (bottom - top) * value / 1.75

    for value in (0, 0.5, 1, 1.5):
        figure.line([(left, y_of(value)), (right, y_of(value))], "#ddd", 1)
        figure.text(left - 8, y_of(value) + 4, f"{value:g}", anchor="end", size=15)
    figure.line([(x_of(0), top), (x_of(0), bottom)], PALE, 1, "3 3")
    # The blurred half brings the share of its discs that lie at x: all far right, half of one at the step.
    blurred = lambda x: 1 - disc_beyond(x / radius)
    steps = [k / 100 for k in range(-250, 0)]
    figure.line([(x_of(x), y_of(1 + blurred(x))) for x in steps], NEAR, 2.2)
    figure.line([(x_of(x), y_of(blurred(x))) for x in (k / 100 for k in range(0, 251))], NEAR, 2.2)
    figure.line([(x_of(0), y_of(1.5)), (x_of(0), y_of(0.5))], NEAR, 2.2)
    figure.line([(x_of(-2.5), y_of(1)), (x_of(2.5), y_of(1))], FAR, 2.2, "7 4")
    figure.text(x_of(-1.6), bottom + 28, "painted sharp")
    figure.text(x_of(1.6), bottom + 28, "painted blurred")
    figure.text(right + 8, y_of(1) - 8, "conserve", NEAR, "start", 16)
    figure.text(right + 8, y_of(1) + 18, "normalise", FAR, "start", 16)
    return figure


FIGURES = {
    "through-the-lens": through_the_lens,
    "blur-by-depth": blur_by_depth,
    "aperture-image": aperture_image,
    "ghosting": ghosting,
    "step-of-t": step_of_t,
}

if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    for name, draw in FIGURES.items():
        draw().write(f"{sys.argv[1]}/{name}.svg")
