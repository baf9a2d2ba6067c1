"""Blender's cameras as lenses, and back.

A lens in `extras` has the fields of a Focus Brush camera file: `aperture_radius`, `sensor_height`, `focus_distance` (scene units,
axial; "inf"), `shift` (picture heights, right and up), `aperture` (`shape`, `blades`, `rotation`, `ratio`), `width`, `height`.

    R = lens / (2 N) / min(1, ratio)        Cycles squeezes the aperture's width by its ratio; ours never leaves [-R, R]
    h = 2 lens tan(yfov / 2)                the part of the sensor that the picture shows, by sensor fit
    rotation = rotation of Cycles + pi / n  there an edge's middle lies on the axis, here a corner does
"""

import math

import bpy
from mathutils import Matrix

from .names import KEY, BridgeError, extras

# Cycles' own least focus distance.
NEAREST = 1e-5


class Frame:
    """What of the sensor the picture shows. Lengths in metres."""

    def __init__(self, data, render):
        share = render.resolution_percentage / 100
        self.width = max(1, int(render.resolution_x * share))
        self.height = max(1, int(render.resolution_y * share))
        self.aspect = (self.width * render.pixel_aspect_x) / (self.height * render.pixel_aspect_y)
        fit = data.sensor_fit
        if fit == "AUTO":
            fit = "HORIZONTAL" if self.aspect >= 1 else "VERTICAL"
            side = data.sensor_width
        else:
            side = data.sensor_width if fit == "HORIZONTAL" else data.sensor_height
        self.is_horizontal = fit == "HORIZONTAL"
        self.sensor_height = side * 1e-3 / (self.aspect if self.is_horizontal else 1)
        # Shift is told in shares of the side that fits.
        self.shift_scale = self.aspect if self.is_horizontal else 1

    def yfov(self, data):
        return 2 * math.atan(self.sensor_height / (2 * data.lens * 1e-3))


def focus_distance(camera, depsgraph):
    """How far along the axis of a camera object its plane of focus lies."""
    dof = camera.data.dof
    target = dof.focus_object
    if target is None:
        return dof.focus_distance
    seen = target.evaluated_get(depsgraph)
    place = seen.matrix_world
    if target.type == "ARMATURE" and dof.focus_subtarget:
        bone = seen.pose.bones.get(dof.focus_subtarget)
        if bone is not None:
            place = place @ bone.matrix
    pose = camera.evaluated_get(depsgraph).matrix_world
    axis = -pose.col[2].to_3d().normalized()
    return max(abs(axis.dot(place.translation - pose.translation)), NEAREST)


def is_mirrored(matrix):
    """Whether a camera at a place mirrors its picture, as Blender's do below a negative scale. A lens of ours does not: it stands there
    without the mirror, and what it sees on the left is on the right here."""
    return matrix.determinant() < 0


def lens_of(camera, scene, depsgraph):
    """The lens of a perspective camera object, as it stands in `extras`."""
    data = camera.data
    mirrored = is_mirrored(camera.evaluated_get(depsgraph).matrix_world)
    dof = data.dof
    frame = Frame(data, scene.render)
    ratio = dof.aperture_ratio
    radius = data.lens * 1e-3 / (2 * dof.aperture_fstop) / min(1, ratio) if dof.aperture_fstop > 0 else 0
    aperture = {"shape": "disc", "ratio": ratio}
    if dof.aperture_blades >= 3:
        aperture["shape"] = "polygon"
        aperture["blades"] = dof.aperture_blades
        turn = dof.aperture_rotation + math.pi / dof.aperture_blades
        aperture["rotation"] = math.pi - turn if mirrored else turn
    return extras(
        width=frame.width,
        height=frame.height,
        focus_distance=focus_distance(camera, depsgraph),
        aperture_radius=radius,
        sensor_height=frame.sensor_height,
        shift=[(-1 if mirrored else 1) * data.shift_x * frame.shift_scale, data.shift_y * frame.shift_scale],
        aperture=aperture,
    )


def cameras_of(data, scene):
    """The camera objects of a scene that share camera data."""
    return [each for each in scene.objects if each.type == "CAMERA" and each.data == data]


def told_of(camera, scene, matrix):
    """What of a camera at a place does not come along, a sentence each."""
    data, told = camera.data, []
    if data.type != "PERSP":
        return [f"{camera.name}: is {data.type.lower()}, and only perspective cameras have a lens (it stays behind)"]
    if is_mirrored(matrix):
        told.append(f"{camera.name}: mirrors its picture here (it has a negative scale, or hangs below one), and does not there")
    render = scene.render
    if render.pixel_aspect_x != render.pixel_aspect_y:
        told.append(f"{camera.name}: pixels that are not square come over as square ones")
    if not data.dof.use_dof:
        told.append(f"{camera.name}: its depth of field is off; its f-stop comes along all the same")
    if data.dof.focus_object is not None and len(cameras_of(data, scene)) > 1:
        told.append(f"{camera.name}: shares its data with another camera and focuses on an object; the distance is that of "
                    f"{cameras_of(data, scene)[0].name} (Object > Relations > Make Single User)")
    return told


def set_lens(camera, lens, yfov, scene):
    """Gives a camera object the lens that came back. Its sensor stays; its focal length follows the angle of view."""
    data, dof = camera.data, camera.data.dof
    render = scene.render
    if "width" in lens and "height" in lens:
        render.resolution_x, render.resolution_y, render.resolution_percentage = lens["width"], lens["height"], 100
    frame = Frame(data, render)
    data.lens_unit = "MILLIMETERS"
    data.lens = 1e3 * frame.sensor_height / (2 * math.tan(yfov / 2))
    mirrored = is_mirrored(camera.matrix_world)
    shift = [(-1 if mirrored else 1) * lens.get("shift", [0, 0])[0], lens.get("shift", [0, 0])[1]]
    data.shift_x, data.shift_y = (value / frame.shift_scale for value in shift)
    aperture = lens.get("aperture", {})
    shape = aperture.get("shape", "disc")
    if shape == "mask":
        raise BridgeError(f"{camera.name}: its aperture is a picture, which Cycles does not have (choose a disc or a polygon)")
    ratio = aperture.get("ratio", 1)
    blades = {"disc": 0, "square": 4}.get(shape, aperture.get("blades", 6))
    # Ours: the square [-R, R]², all of it. A Cycles polygon of four has its corners on the circle.
    turn = math.pi / 4 if shape == "square" else aperture.get("rotation", 0)
    turn = math.pi - turn if mirrored else turn
    widened = math.sqrt(2) if shape == "square" else 1
    dof.aperture_blades = blades
    dof.aperture_rotation = turn - math.pi / blades if blades else 0
    dof.aperture_ratio = ratio
    radius = lens["aperture_radius"]
    dof.use_dof = radius > 0
    if radius > 0:
        dof.aperture_fstop = data.lens * 1e-3 / (2 * radius * widened * min(1, ratio))
    distance = lens["focus_distance"]
    dof.focus_object = None
    # Blender has no infinity: as far as its sliders go.
    dof.focus_distance = 1e6 if distance == "inf" else distance


def set_pose(camera, pose):
    """Gives a camera object its pose: rows of a matrix with glTF's axes, in the world."""
    to_blender = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
    mirror = Matrix.Diagonal((-1 if is_mirrored(camera.matrix_world) else 1, 1, 1, 1))
    camera.matrix_world = to_blender @ Matrix(pose) @ mirror
