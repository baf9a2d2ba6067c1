#!/usr/bin/env python3
"""Draws glTF models beside Cycles' pictures of them: models.jpg, and the rows of the table in docs/guide/models.md.

    python models.py FOCUS-BRUSH FOLDER MODEL.glb ... [--spp 192] [--size 320x240]

Needs the modules bpy, numpy and OpenEXR, and ImageMagick's montage. All models are lit by one sky with a small sun, framed as the program
frames what brings no camera, and drawn through its lens with their back faces. What is in between goes to FOLDER and is kept: a picture that
is there is not made again.
"""
import argparse
import json
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
CYCLES = os.path.join(HERE, "..", "..", "..", "bridges", "compare", "render_cycles.py")
# The brightest hundredth of a picture is shown at this grey, if it would be brighter.
SHOWN_AT = 0.9


def write_sky(path, width=512, height=256):
    """A blue sky over brown ground, and a sun of nine pixels that sends as much again."""
    import numpy

    up = 1 - 2 * (numpy.arange(height, dtype="f4")[:, None] + 0.5) / height
    sky = numpy.stack([0.75 - 0.45 * up, 0.85 - 0.3 * up, numpy.ones_like(up)], -1)
    ground = numpy.array([0.18, 0.16, 0.12], "f4")
    rows = numpy.where(up[..., None] > 0, sky, ground).astype("f4")
    pixels = numpy.repeat(rows, width, axis=1)
    pixels[62:65, 150:153] = [4200, 3900, 3400]
    write(path, pixels)


def run(*command):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def drawn(program, model, folder, size, spp):
    """Our picture and Cycles', as files."""
    name = os.path.splitext(os.path.basename(model))[0]
    at = lambda ending: os.path.join(folder, name + ending)
    sky, look = os.path.join(folder, "sky.exr"), ["--back-faces", "show"]
    if not os.path.exists(at(".fbrush")):
        run(program, "new", model, "-o", at(".fbrush"))
    if not os.path.exists(at(".ours.exr")):
        run(program, "render", at(".fbrush"), "--size", size, "--world", sky, *look, "-o", at(".ours.exr"))
    if not os.path.exists(at(".cycles.exr")):
        how = ["--size", size, "--world", sky, "--spp", str(spp)]
        run(sys.executable, CYCLES, model, at(".fbrush"), at(".cycles.exr"), *how)
    return name, at(".ours.exr"), at(".cycles.exr")


def pixels(path):
    import OpenEXR

    channels = OpenEXR.File(path).channels()
    found = channels["RGB"] if "RGB" in channels else channels["RGBA"]
    return found.pixels[..., :3].astype("float32")


def write(path, pixels):
    import OpenEXR

    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": pixels}).write(path)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("folder")
    parser.add_argument("models", nargs="+")
    parser.add_argument("--spp", type=int, default=192)
    parser.add_argument("--size", default="320x240")
    options = parser.parse_args()
    import numpy

    os.makedirs(options.folder, exist_ok=True)
    sky = os.path.join(options.folder, "sky.exr")
    if not os.path.exists(sky):
        write_sky(sky)
    pairs = []
    for model in options.models:
        name, ours, cycles = drawn(options.program, model, options.folder, options.size, options.spp)
        bright = numpy.percentile(pixels(cycles), 99)
        scale = numpy.float32(min(1.0, SHOWN_AT / bright))
        shown = []
        for path in (ours, cycles):
            exr, ppm = path.replace(".exr", ".shown.exr"), path.replace(".exr", ".ppm")
            write(exr, pixels(path) * scale)
            linear = numpy.clip(pixels(exr), 0, 1)
            srgb = numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
            with open(ppm, "wb") as file:
                file.write(f"P6 {linear.shape[1]} {linear.shape[0]} 255\n".encode() + (srgb * 255 + 0.5).astype("u1").tobytes())
            shown.append((exr, ppm))
        found = subprocess.run(
            [options.program, "compare", "--json", shown[0][0], shown[1][0]], check=True, capture_output=True, text=True
        )
        found = json.loads(found.stdout)
        mean = 100 * (pixels(ours).mean() / pixels(cycles).mean() - 1)
        print(f"| {name} | {found['psnr']:.1f} dB | {found['flip']:.3f} | {mean:+.1f} % | {numpy.log2(scale):.1f} |", flush=True)
        pair = os.path.join(options.folder, name + ".pair.png")
        run("montage", shown[0][1], shown[1][1], "-tile", "2x1", "-geometry", "+0+0", pair)
        pairs += ["-label", f"{name}: ours, Cycles'", pair]
    look = ["-font", "DejaVu-Sans", "-pointsize", "18", "-fill", "#222", "-background", "white", "-quality", "88"]
    run("montage", *look, *pairs, "-tile", "2x", "-geometry", "+6+6", os.path.join(HERE, "models.jpg"))


if __name__ == "__main__":
    main()
