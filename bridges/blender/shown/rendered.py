"""What a render shows: the scene as Cycles is given it, whatever the viewport shows.

Only a render has a dependency graph of the render: objects disabled in viewports, modifiers and levels of the render, all particles,
members of instances. So a render is started with an engine that draws nothing and looks.
"""

from contextlib import contextmanager

import bpy

from ..names import BridgeError

ENGINE = "FOCUS_BRUSH_LOOK"
RESULT = "Render Result"


def look(scene, layer, visit):
    """Calls `visit` once with the dependency graph of a render of a view layer. What `visit` raises is raised here."""
    found = []

    class Look(bpy.types.RenderEngine):
        bl_idname = ENGINE
        bl_label = "Focus Brush"
        bl_use_preview = False
        bl_use_postprocess = False

        def render(self, depsgraph):
            if not found:
                found.append(_tried(visit, depsgraph))

    with _render_of_ours(scene, Look):
        try:
            bpy.ops.render.render(scene=scene.name, layer=layer.name)
        except RuntimeError as error:
            raise BridgeError(f"{scene.name}: cannot be rendered: {str(error).strip()} (render it once here)") from error
    if not found:
        raise BridgeError(f"{scene.name}: the render of {layer.name} did not begin (render it once here)")
    if found[0] is not None:
        raise found[0]


def _tried(visit, depsgraph):
    """Blender prints what a render engine raises, and goes on."""
    try:
        visit(depsgraph)
    except Exception as error:
        return error
    return None


@contextmanager
def _render_of_ours(scene, engine):
    """Lets a render of the scene be one of an engine alone, and the user's last picture stay."""
    render = scene.render
    names = ("engine", "use_compositing", "use_sequencer", "use_multiview")
    before = {name: getattr(render, name) for name in names}
    picture = bpy.data.images.get(RESULT)
    slot = picture.render_slots.active_index if picture else 0
    bpy.utils.register_class(engine)
    try:
        render.use_compositing = render.use_sequencer = render.use_multiview = False
        render.engine = ENGINE
        if picture:
            # Ours is in the last slot, or in the one before if the user looks at the last.
            last = len(picture.render_slots) - 1
            picture.render_slots.active_index = max(0, last - (slot == last))
        yield
    finally:
        for name, value in before.items():
            setattr(render, name, value)
        bpy.utils.unregister_class(engine)
        made = bpy.data.images.get(RESULT)
        if picture:
            picture.render_slots.active_index = slot
        elif made:
            bpy.data.images.remove(made)


def layer_of(scene):
    """The view layer that is rendered: the one in use here if it is rendered, else the first that is."""
    used = [layer for layer in scene.view_layers if layer.use] or list(scene.view_layers)
    here = bpy.context.view_layer
    return next((layer for layer in used if bpy.context.scene == scene and layer == here), used[0])


def name_of(instance):
    """The name of the object that an instance of a dependency graph shows."""
    return instance.object.original.name


def why_left(instance, layer):
    """Why a mesh of a render's dependency graph is nothing that its picture shows, a sentence; None if it is shown."""
    each, above = instance.object, instance.parent or instance.object
    if not (each.visible_camera and above.visible_camera) or above.original.indirect_only_get(view_layer=layer):
        return f"{name_of(instance)}: is not seen by the camera here, and stays behind with its light and its shadows"
    if each.is_shadow_catcher or above.is_shadow_catcher:
        return f"{name_of(instance)}: only catches shadows, and stays behind"
    slots = materials_of(each)
    if slots and not layer.material_override and all(_is_volume(material) for material in slots):
        return f"{name_of(instance)}: is a volume, which stays behind"
    return None


def materials_of(each):
    """The materials of the slots of an evaluated object, the file's own."""
    slots = list(each.data.materials)
    for index, slot in enumerate(each.material_slots):
        if slot.link == "OBJECT" and index < len(slots):
            slots[index] = slot.material
    return [material.original if material else None for material in slots]


def mesh_of(each, depsgraph, materials):
    """A new mesh as a render has it, with these materials."""
    if each.original.type == "MESH":
        mesh = bpy.data.meshes.new_from_object(each, preserve_all_data_layers=True, depsgraph=depsgraph)
    else:
        # What the render made of a curve or of balls; the other way Blender 4.2 fails on it.
        mesh = each.data.copy()
    for index, material in enumerate(materials):
        if index < len(mesh.materials):
            mesh.materials[index] = material
        else:
            mesh.materials.append(material)
    return mesh


def _is_volume(material):
    """Whether a material has an inside and no surface."""
    tree = material.node_tree if material and material.use_nodes else None
    output = tree.get_output_node("CYCLES") if tree else None
    return output is not None and bool(output.inputs["Volume"].links) and not output.inputs["Surface"].links


def is_holdout(instance, layer):
    """Whether an instance cuts a hole into the picture."""
    return (instance.parent or instance.object).original.holdout_get(view_layer=layer)
