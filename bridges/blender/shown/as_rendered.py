"""The scene itself as a render has it, where no copy of it will do: animated, for skins and morph targets; or baked.

The exporter and the operators work on the viewport's dependency graph. Within `aligned` it has what a render has, and more: objects
disabled in viewports, modifiers and levels of the render. Within `tagged` the exporter leaves out what no render shows.
"""

from contextlib import contextmanager

import bpy

from .. import area_lights, camera_lens
from . import rendered

GEOMETRY = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


class _Changes:
    """Properties that were set for a while."""

    def __init__(self):
        self.before = []

    def set(self, holder, name, value):
        old = getattr(holder, name)
        if old != value:
            self.before.append((holder, name, old))
            setattr(holder, name, value)

    def undo(self):
        for holder, name, old in reversed(self.before):
            setattr(holder, name, old)
        self.before.clear()


@contextmanager
def aligned(scene):
    """Within, the viewport has all that the render has; afterwards everything is as it was."""
    layer, changes, closed = rendered.layer_of(scene), _Changes(), []
    try:
        for each in (*bpy.data.collections, *_below(layer.layer_collection), *bpy.data.objects):
            changes.set(each, "hide_viewport", False)
        for each in bpy.data.objects:
            for modifier in each.modifiers:
                _align_modifier(modifier, changes)
            for system in each.particle_systems:
                changes.set(system.settings, "display_percentage", 100)
        for each in layer.objects:
            if each.hide_get(view_layer=layer):
                closed.append(each)
                each.hide_set(False, view_layer=layer)
        layer.update()
        yield
    finally:
        for each in closed:
            each.hide_set(True, view_layer=layer)
        changes.undo()
        layer.update()


def _align_modifier(modifier, changes):
    changes.set(modifier, "show_viewport", modifier.show_render)
    if modifier.type in {"SUBSURF", "MULTIRES"}:
        changes.set(modifier, "levels", modifier.render_levels)


def _below(collection):
    for child in collection.children:
        yield child
        yield from _below(child)


class Tagged:
    """Which objects a render shows: those of the scene themselves, and those that instances show."""

    def __init__(self, source):
        self.source = source
        self.layer = rendered.layer_of(source)
        self.own, self.instanced, self.instancers, self.lights = set(), set(), set(), []
        self.told = []

    def gather(self, depsgraph):
        for instance in depsgraph.object_instances:
            each = instance.object.original
            if not instance.show_self or instance.object.type not in {"LIGHT", "MESH"}:
                continue
            why = rendered.why_left(instance, self.layer) if instance.object.type == "MESH" else None
            if why:
                self.told += [why] if why not in self.told else []
                continue
            above = instance.parent.original if instance.parent else each
            (self.own if above == each else self.instanced).add(each)
            if instance.is_instance:
                self.instancers.add(above)
            if above == each and each.type == "LIGHT" and each.data.type == "AREA":
                self.lights.append(each)
        for camera in [each for each in self.source.objects if each.type == "CAMERA"]:
            self.told += camera_lens.told_of(camera, self.source, camera.evaluated_get(depsgraph).matrix_world)

    def tag(self, vtree):
        """Has the exporter keep what a render shows, and all that something may hang on."""
        for uuid, node in vtree.nodes.items():
            each = node.blender_object
            if each is None:
                # What geometry nodes instance; the exporter has the mesh of a curve there a second time.
                node.keep_tag = node.original_object.type == "MESH" and node.original_object in self.instancers
            elif node.blender_bone is not None or each.type not in GEOMETRY | {"LIGHT"}:
                node.keep_tag = True
            elif each.parent is not None and each.parent in self.lights:
                node.keep_tag = True
            else:
                node.keep_tag = each in (self.instanced if _is_instance(vtree, uuid) else self.own)


def _is_instance(vtree, uuid):
    """Whether a node of the exporter's tree is there because a collection is instanced."""
    while True:
        above = vtree.nodes[uuid].parent_uuid
        if above is None:
            return False
        if vtree.nodes[above].children_type.get(uuid) == type(vtree.nodes[above]).CHILDREN_IS_IN_COLLECTION:
            return True
        uuid = above


# The one that goes over just now: what the exporter's hook asks.
current = None


@contextmanager
def tagged(source):
    """Within, the exporter writes what a render shows of the scene itself. Gives a `Tagged`."""
    global current
    going = Tagged(source)
    rendered.look(source, going.layer, going.gather)
    with aligned(source), area_lights.as_quads(going.lights) as told:
        going.told += told
        try:
            current = going
            yield going
        finally:
            current = None
