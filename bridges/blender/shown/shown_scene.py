"""A scene of nothing but what a render shows, made for the exporter and removed afterwards.

Every mesh as the render has it, once for all of its instances; every instance an object without a parent, with its place in the world.
What was which object of the user's scene is kept beside it (`Shown`).
"""

from contextlib import contextmanager
from dataclasses import dataclass

import bpy

from .. import area_lights, camera_lens
from . import rendered

# What Cycles shows and glTF has no word for.
LEFT = {"CURVES": "hair", "POINTCLOUD": "points", "VOLUME": "a volume", "GPENCIL": "a drawing", "GREASEPENCIL": "a drawing"}


@dataclass
class Shown:
    """What an object of ours stands for: an object's name and library, a place, and the name of the object's own data."""

    name: str
    library: str
    matrix: object
    data_name: str
    # Quads of area lights are no object of the user's.
    is_ours: bool = False


class ShownScene:
    """The scene while it is there."""

    def __init__(self, source):
        self.source = source
        self.layer = rendered.layer_of(source)
        self.scene = None
        # Of every object of ours, by its name.
        self.shown = {}
        # Of every camera's data, by its name: what stands in `extras`, the angle of view and the aspect.
        self.lenses = {}
        self.told = []
        self._gathered = []
        self._meshes = {}
        self._made = []
        self._black = None

    def gather(self, depsgraph, only_seen_lights):
        """Takes over what a render's dependency graph shows."""
        for instance in depsgraph.object_instances:
            if not instance.show_self:
                continue
            kind = instance.object.type
            if kind == "LIGHT":
                self._light(instance, only_seen_lights)
            elif kind == "MESH":
                self._mesh(instance, depsgraph)
            elif kind in LEFT:
                self._tell(f"{rendered.name_of(instance)}: is {LEFT[kind]}, which stays behind (make it a mesh)")
            if instance.show_particles and any(_is_hair(each) for each in instance.object.particle_systems):
                self._tell(f"{rendered.name_of(instance)}: its hair stays behind (make it a mesh)")
        for camera in [each for each in self.source.objects if each.type == "CAMERA"]:
            self._camera(camera, depsgraph)

    def _tell(self, sentence):
        if sentence not in self.told:
            self.told.append(sentence)

    def _tell_all(self, sentences):
        for sentence in sentences:
            self._tell(sentence)

    def _mesh(self, instance, depsgraph):
        each = instance.object
        # A mesh that is being edited keeps its polygons elsewhere.
        if not len(each.data.polygons) and each.mode != "EDIT":
            return
        why = rendered.why_left(instance, self.layer)
        if why:
            self._tell(why)
            return
        materials = self._materials(instance)
        key = each.data.as_pointer(), tuple(material.as_pointer() if material else 0 for material in materials)
        if key not in self._meshes:
            self._meshes[key] = rendered.mesh_of(each, depsgraph, materials)
            self._made.append(self._meshes[key])
        self._put(instance, self._meshes[key], _data_name(each))

    def _materials(self, instance):
        """The materials of an instance's slots, as the render has them."""
        slots = rendered.materials_of(instance.object)
        if rendered.is_holdout(instance, self.layer):
            self._tell(f"{rendered.name_of(instance)}: is a holdout here, and comes over black")
            return [self._black_material()] * max(1, len(slots))
        if self.layer.material_override:
            return [self.layer.material_override] * max(1, len(slots))
        return slots

    def _black_material(self):
        """Sends no light."""
        if self._black is None:
            self._black = area_lights.emitting("holdout", (0, 0, 0))
            self._made.append(self._black)
        return self._black

    def _light(self, instance, only_seen):
        light = instance.object.original
        if light.data.type != "AREA":
            self._put(instance, light.data, light.data.name)
        elif light.visible_camera or not only_seen:
            mesh, material = area_lights.quad(light, instance.matrix_world)
            self._made += [mesh, material]
            self._put(instance, mesh, mesh.name, suffix=" (light)")
            self._tell_all(area_lights.told_of(light))

    def _camera(self, camera, depsgraph):
        seen = camera.evaluated_get(depsgraph)
        if camera != self.source.camera and seen == camera:
            # A render has no place for it.
            self._tell(f"{camera.name}: is hidden from renders here, and stays behind")
            return
        self._tell_all(camera_lens.told_of(camera, self.source, seen.matrix_world))
        data = camera.data
        if data.type == "PERSP" and data.name not in self.lenses:
            frame = camera_lens.Frame(data, self.source.render)
            lens = camera_lens.lens_of(camera, self.source, depsgraph)
            self.lenses[data.name] = lens, frame.yfov(data), frame.width / frame.height
        library = camera.library.filepath if camera.library else ""
        self._gathered.append((Shown(camera.name, library, seen.matrix_world.copy(), data.name), data))

    def _put(self, instance, data, data_name, suffix=""):
        original = instance.object.original
        library = original.library.filepath if original.library else ""
        shown = Shown(original.name + suffix, library, instance.matrix_world.copy(), data_name, bool(suffix))
        self._gathered.append((shown, data))

    def begin(self, window, only_seen_lights):
        rendered.look(self.source, self.layer, lambda depsgraph: self.gather(depsgraph, only_seen_lights))
        self.scene = bpy.data.scenes.new(self.source.name)
        # Before anything is in it: Blender has not evaluated what is put into a scene that no window shows.
        window.scene = self.scene
        for shown, data in self._gathered:
            each = bpy.data.objects.new(shown.name, data)
            self._made.append(each)
            each.matrix_basis = shown.matrix
            self.shown[each.name] = shown
            self.scene.collection.objects.link(each)
        self.scene.view_layers[0].update()

    def end(self):
        """Leaves nothing of it."""
        bpy.data.batch_remove(self._made)
        if self.scene is not None:
            bpy.data.scenes.remove(self.scene)


# The one that goes over just now: what the exporter's hooks ask.
current = None


@contextmanager
def of(source, only_seen_lights=False):
    """Within, a scene of what a render of `source` shows is the window's; afterwards nothing is left of it. Gives a `ShownScene`."""
    global current
    window = bpy.context.window
    before, layer, active = window.scene, window.view_layer, ShownScene(source)
    try:
        active.begin(window, only_seen_lights)
        current = active
        yield active
    finally:
        current = None
        window.scene = before
        window.view_layer = layer
        active.end()


def _data_name(each):
    """The name of an object's own data, whatever the render made of it."""
    original = each.original.data
    return original.name if original else each.data.name


def _is_hair(system):
    return system.settings.type == "HAIR" and system.settings.render_type == "PATH"
