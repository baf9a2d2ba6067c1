"""Light from Cycles: what Cycles sees from the camera, baked into the scene's atlas as radiance that needs no light.

    scene.glb ─▶ unwrap ─▶ a mesh in the world with the atlas ─▶ bake, from every surface to its twin ─▶ light.exr
                      └───────────────────────────────▶ lit.glb: materials unlit, their radiance named in `extras`

The objects of the scene shade, with their own nodes and coordinates; the unwrapped mesh only says where. It changes the scene, so it
works on a copy of the file in a process of its own (`in_background`).
"""

import sys
from pathlib import Path

import bpy
import numpy as np

from . import handover, meshes_back, program, world_light
from .glb_file import Glb, atlas_set
from .names import KEY, BridgeError, extras, of_extras
from .shown import as_rendered, real_meshes, rendered

ATLAS = "Focus Brush atlas"
# How far above a surface the bake begins, in shares of the scene: well above the rounding of 32-bit floats, below all that is modelled.
LIFT = 2e-5
MARGIN_TEXELS = 8
UNLIT = "KHR_materials_unlit"


def bake(scene, found, folder, side=2048, samples=256, project="scene.fbrush"):
    """Bakes the scene's light and writes the handover of a scene that has it; gives the manifest. The open scene is changed."""
    handover.check(scene)
    folder = Path(folder)
    window = bpy.context.window
    window.scene, window.view_layer = scene, rendered.layer_of(scene)
    raw, unwrapped = folder / "unlit.glb", folder / "unwrapped.glb"
    told = handover.export_glb(scene, raw, only_seen_lights=True)
    program.run(found, "unwrap", raw, "--side", side, "-o", unwrapped)
    with as_rendered.aligned(scene):
        shading = real_meshes.of(scene)
        target = _atlas_object(scene, unwrapped)
        image = _image_of(target, unwrapped, side)
        _bake(scene, target, shading, samples)
    _save(scene, image, folder / "light.exr")
    bpy.data.objects.remove(target)
    light_named(unwrapped, "light.exr").write(folder / "scene.glb")
    for file in (raw, unwrapped):
        file.unlink()
    world = world_light.write(scene, folder)
    return handover.save(folder, scene, world.name, project, "cycles", told)


def light_named(path, picture):
    """A file with an atlas whose materials send the radiance of a picture over it."""
    glb = Glb(path)
    shining = {}
    for node in glb.all("nodes"):
        if "mesh" not in node or not of_extras(node):
            continue
        for primitive in glb.document["meshes"][node["mesh"]]["primitives"]:
            uv_set = int(atlas_set(primitive).removeprefix("TEXCOORD_"))
            key = (primitive.get("material"), uv_set)
            if key not in shining:
                shining[key] = _shining_material(glb, key[0], uv_set, picture)
            primitive["material"] = shining[key]
            # glTF multiplies colours of vertices into what a material shows.
            for name in [name for name in primitive["attributes"] if name.startswith("COLOR_")]:
                del primitive["attributes"][name]
    used = set(glb.document.get("extensionsUsed", [])) | {UNLIT}
    glb.document["extensionsUsed"] = sorted(used)
    return glb


def _shining_material(glb, index, uv_set, picture):
    materials = glb.document.setdefault("materials", [])
    old = materials[index] if index is not None else {"name": "no material"}
    color = old.get("pbrMetallicRoughness", {})
    kept = {name: color[name] for name in ("baseColorFactor", "baseColorTexture") if name in color}
    materials.append(
        {
            "name": old.get("name", f"material {index}"),
            "doubleSided": old.get("doubleSided", False),
            "pbrMetallicRoughness": kept,
            "extensions": {UNLIT: {}},
            "extras": {KEY: extras(radiance={"uri": picture, "texCoord": uv_set})},
        }
    )
    return len(materials) - 1


def _atlas_object(scene, path):
    """All that was unwrapped, in the world, as one mesh with the atlas as its UV map."""
    corners, uv = [], []
    for placed in meshes_back.placed_meshes(path):
        if not placed.object_name:
            continue
        world = np.array(placed.world)
        corners.append(placed.corners @ world[:3, :3].T + world[:3, 3])
        uv.append(placed.uv)
        if placed.world.determinant() < 0:
            # A mirrored mesh is wound the other way round.
            corners[-1], uv[-1] = corners[-1][:, ::-1], uv[-1][:, ::-1]
    if not corners:
        raise BridgeError(f"{scene.name}: shows no mesh (there is nothing to bake)")
    corners, uv = np.concatenate(corners), np.concatenate(uv)
    mesh = bpy.data.meshes.new(ATLAS)
    count = len(corners)
    mesh.from_pydata(corners.reshape(-1, 3).tolist(), [], np.arange(3 * count).reshape(-1, 3).tolist())
    mesh.uv_layers.new(name=ATLAS).data.foreach_set("uv", uv.astype(np.float32).ravel())
    target = bpy.data.objects.new(ATLAS, mesh)
    scene.collection.objects.link(target)
    return target


def _image_of(target, unwrapped, side):
    image = bpy.data.images.new(ATLAS, side, side, alpha=False, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    material = bpy.data.materials.new(ATLAS)
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.nodes.active = node
    target.data.materials.append(material)
    return image


def _bake(scene, target, shading, samples):
    corners = np.array([vertex.co for vertex in target.data.vertices])
    lift = LIFT * float(np.linalg.norm(np.ptp(corners, axis=0)))
    scene.render.engine = "CYCLES"
    scene.cycles.samples = samples
    scene.render.bake.view_from = "ACTIVE_CAMERA"
    bpy.ops.object.select_all(action="DESELECT")
    for each in shading:
        each.select_set(True)
    target.select_set(True)
    bpy.context.view_layer.objects.active = target
    bpy.ops.object.bake(
        type="COMBINED",
        pass_filter={"EMIT", "DIRECT", "INDIRECT", "DIFFUSE", "GLOSSY", "TRANSMISSION"},
        use_selected_to_active=True,
        cage_extrusion=lift,
        max_ray_distance=2 * lift,
        margin=MARGIN_TEXELS,
        margin_type="EXTEND",
        target="IMAGE_TEXTURES",
        save_mode="INTERNAL",
        use_clear=True,
    )


def _save(scene, image, path):
    """The image as a linear picture of 32 bits."""
    image.filepath_raw = str(path)
    image.file_format = "OPEN_EXR"
    image.save()


def in_background(program_path, folder, side, samples, copy):
    """Starts a process of Blender's own that bakes a copy of the open file; the copy is the one named. Gives the process."""
    bpy.ops.wm.save_as_mainfile(filepath=str(copy), copy=True, check_existing=False)
    script = Path(__file__).with_name("bake_copy.py")
    arguments = [program_path, str(folder), bpy.context.scene.name, str(side), str(samples)]
    blender = bpy.app.binary_path
    if not blender:
        return program.start(sys.executable, script, copy, *arguments)
    return program.start(blender, "--background", copy, "--python-exit-code", "3", "--python", script, "--", *arguments)
