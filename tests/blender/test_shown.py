"""What goes over is what a render shows: the objects, their places in the world, and Cycles' picture of them against ours."""

import importlib
import math
import unittest
import unittest.mock

import workshop
from workshop import PLACE, PROGRAM, bpy

import numpy as np  # noqa: E402
from mathutils import Matrix  # noqa: E402

workshop.install()
area_lights, cycles_light, exr_file, focus_back, glb_file, handover, meshes_back, program = (
    importlib.import_module(f"{workshop.MODULE}.{name}")
    for name in ("area_lights", "cycles_light", "exr_file", "focus_back", "glb_file", "handover", "meshes_back", "program")
)

SIZE = (48, 32)
# Pixels at edges differ by a filter's noise; one that shows another thing differs by more.
APART, SHARE = 0.25, 0.01
KEPT, THING = (0, 0, 0.9), (0.9, 0, 0)


def stage():
    """A wedge that is always seen, before a grey world."""
    scene = workshop.empty()
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.pixel_filter_type = 32, False, "BOX"
    world = bpy.data.worlds.new("grey")
    world.use_nodes = False
    world.color = (0.4, 0.4, 0.4)
    scene.world = world
    put("Kept", (-1.6, 0, 0), KEPT)
    scene.camera = workshop.camera(scene, "Shot", (0, -9, 2), (0, 0, 0), lens=50)
    scene.camera.data.dof.use_dof = False
    bpy.context.view_layer.update()
    return scene


def wedge(name, color=THING):
    """A mesh that no mirror and no turn gives back, shining in one colour."""
    mesh = bpy.data.meshes.new(name)
    corners = [(0, 0, 0), (0.8, 0, 0), (0, 0.4, 0), (0.2, 0, 1)]
    mesh.from_pydata(corners, [], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    material = area_lights.emitting(name, color)
    material.use_backface_culling = False
    mesh.materials.append(material)
    return mesh


def put(name, location, color=THING, collection=None, data=None, **fields):
    each = bpy.data.objects.new(name, data or wedge(name, color))
    each.location = location
    for key, value in fields.items():
        setattr(each, key, value)
    (collection or bpy.context.scene.collection).objects.link(each)
    return each


def empty(name, location, collection=None, **fields):
    each = bpy.data.objects.new(name, None)
    each.location = location
    for key, value in fields.items():
        setattr(each, key, value)
    (collection or bpy.context.scene.collection).objects.link(each)
    return each


def collection(name, within=None):
    made = bpy.data.collections.new(name)
    (within or bpy.context.scene.collection).children.link(made)
    return made


def layer_of(collection, within=None):
    """The layer collection of a collection."""
    within = within or bpy.context.view_layer.layer_collection
    for child in within.children:
        found = child if child.collection == collection else layer_of(collection, child)
        if found:
            return found
    return None


def instance(name, of, location, collection=None, **fields):
    return empty(name, location, collection, instance_type="COLLECTION", instance_collection=of, **fields)


def row_of(each):
    """Nodes that make three instances of an object in a render, and one in the viewport."""
    tree = bpy.data.node_groups.new("Row", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    line, on, what, viewport, switch, out = (
        tree.nodes.new(kind) for kind in (
            "GeometryNodeMeshLine", "GeometryNodeInstanceOnPoints", "GeometryNodeObjectInfo", "GeometryNodeIsViewport",
            "GeometryNodeSwitch", "NodeGroupOutput",
        )
    )
    switch.input_type = "INT"
    count = [socket for socket in switch.inputs if socket.type == "INT"]
    count[0].default_value, count[1].default_value = 3, 1
    line.inputs["Offset"].default_value = (0.7, 0, 0)
    what.inputs["Object"].default_value = each
    what.inputs["As Instance"].default_value = True
    for source, sink in (
        (viewport.outputs[0], next(socket for socket in switch.inputs if socket.type == "BOOLEAN")),
        (next(socket for socket in switch.outputs if socket.type == "INT"), line.inputs["Count"]),
        (line.outputs[0], on.inputs["Points"]), (what.outputs["Geometry"], on.inputs["Instance"]), (on.outputs[0], out.inputs[0]),
    ):
        tree.links.new(source, sink)
    return tree


def bed_of(stone):
    """Six stones as particles, of which the viewport shows none, on a bed that only carries them."""
    bed = put("Bed", (0.2, 0, -0.6), data=workshop.mesh_of("primitive_grid_add", "bed", x_subdivisions=2, y_subdivisions=2, size=1.6))
    bed.modifiers.new("Stones", "PARTICLE_SYSTEM")
    settings = bed.particle_systems[0].settings
    settings.type, settings.count, settings.render_type, settings.instance_object = "HAIR", 6, "OBJECT", stone
    settings.display_percentage, settings.use_advanced_hair, settings.particle_size = 0, True, 0.3
    bed.show_instancer_for_render = False


def flags():
    """All that says what is visible, and the names of all that there is."""
    layers = [(layer.name, each.name, each.hide_get(view_layer=layer)) for layer in bpy.context.scene.view_layers for each in layer.objects]
    objects = [
        (each.name, each.hide_viewport, each.hide_render, tuple(map(tuple, each.matrix_basis)), each.instance_type)
        + tuple((modifier.name, modifier.show_viewport, modifier.show_render) for modifier in each.modifiers)
        for each in bpy.data.objects
    ]
    collections = [(each.name, each.hide_viewport, each.hide_render) for each in bpy.data.collections]
    kinds = ("scenes", "meshes", "materials", "images", "cameras", "lights", "collections", "worlds", "node_groups", "actions")
    present = [(kind, [each.name for each in getattr(bpy.data, kind)]) for kind in kinds]
    render, window = bpy.context.scene.render, bpy.context.window
    settings = render.engine, render.use_compositing, render.use_sequencer, render.use_multiview, window.scene.name, window.view_layer.name
    return layers, objects, collections, present, settings


def gone_over(glb):
    """(name, matrix in Blender's world) of all nodes with a mesh."""
    file = glb_file.Glb(glb)
    nodes = file.document["nodes"]
    return sorted(
        ((nodes[index]["name"], meshes_back.TO_BLENDER @ world @ meshes_back.FROM_BLENDER)
         for index, world in file.placed_nodes() if "mesh" in nodes[index]),
        key=lambda each: (each[0], *each[1].translation),
    )


def pixels(file):
    planes, _ = exr_file.read(file)
    return np.stack([planes[channel] for channel in "RGB"], -1)


class Shown(unittest.TestCase):
    def over(self, *expected, told=None, animation=True):
        """Hands the open scene over; `expected` are (name, place or matrix) beside the wedge that is always there."""
        scene, folder = bpy.context.scene, PLACE / self.id().rsplit(".", 1)[1]
        folder.mkdir()
        bpy.context.view_layer.update()
        before = flags()
        manifest = handover.write(scene, folder)
        self.assertEqual(flags(), before)
        self.same(gone_over(folder / "scene.glb"), expected)
        if told:
            self.assertRegex("\n".join(manifest["told"]), told)
        self.same_picture(scene, folder)
        if animation:
            before = flags()
            handover.export_glb(scene, folder / "moving.glb", animation=True)
            self.assertEqual(flags(), before)
            self.same(gone_over(folder / "moving.glb"), expected)
        return folder

    def same(self, found, expected):
        wanted = [(name, place if isinstance(place, Matrix) else Matrix.Translation(place)) for name, place in expected]
        wanted = sorted([("Kept", Matrix.Translation((-1.6, 0, 0))), *wanted], key=lambda each: (each[0], *each[1].translation))
        self.assertEqual([name for name, _ in found], [name for name, _ in wanted])
        for (name, matrix), (_, other) in zip(found, wanted):
            error = max(abs(a - b) for row, others in zip(matrix, other) for a, b in zip(row, others))
            self.assertLess(error, 1e-5, f"{name}:\n{matrix}\n{other}")

    def same_picture(self, scene, folder, theirs=None):
        share = self.share_apart(*self.pictures(scene, folder, theirs))
        self.assertLess(share, SHARE, "share of pixels that show something else")

    def pictures(self, scene, folder, theirs=None):
        """Ours and Cycles' own."""
        theirs = theirs or workshop.render(scene, folder / "cycles.exr")
        program.run(
            PROGRAM, "render", folder / "scene.glb", "--world", folder / "world.json", "--aperture-radius", 0,
            "--renderer", "truth", "-o", folder / "ours.exr",
        )
        return pixels(folder / "ours.exr"), pixels(theirs)

    def share_apart(self, ours, theirs):
        return (np.abs(ours - theirs).max(-1) > APART).mean()

    def test_disabled_in_viewports(self):
        stage()
        arm = empty("Arm", (1, 0, 0.2), rotation_euler=(0, 0.4, 0), hide_viewport=True)
        thing = put("Thing", (0.3, 0, 0), hide_viewport=True, parent=arm)
        self.over((thing.name, Matrix.Translation((1, 0, 0.2)) @ Matrix.Rotation(0.4, 4, "Y") @ Matrix.Translation((0.3, 0, 0))))

    def test_closed_eye(self):
        stage()
        put("Thing", (0.5, 0, 0)).hide_set(True)
        self.over(("Thing", (0.5, 0, 0)))

    def test_disabled_in_renders(self):
        """Its child is not."""
        stage()
        above = put("Above", (0.5, 0, 0), hide_render=True)
        put("Thing", (0.4, 0, 0.1), parent=above)
        self.over(("Thing", (0.9, 0, 0.1)))

    def test_collections(self):
        stage()
        excluded, nested, unrendered, unviewed, closed = (collection(name) for name in "ABCDE")
        put("In A", (0, 0, -1), collection=excluded)
        put("In B", (0, 0, 0), collection=nested)
        put("In B 2", (0.2, 0, 0), collection=collection("B 2", nested), hide_viewport=True)
        put("In C", (1, 0, 0), collection=unrendered)
        put("In C 2", (1.2, 0, 0), collection=collection("C 2", unrendered))
        put("In D", (1, 0, 1), collection=unviewed)
        put("In E", (1, 0, -1), collection=closed)
        layer_of(excluded).exclude = layer_of(nested).exclude = True
        unrendered.hide_render, unviewed.hide_viewport, layer_of(closed).hide_viewport = True, True, True
        self.over(("In D", (1, 0, 1)), ("In E", (1, 0, -1)))

    def test_the_instances_of_an_excluded_collection(self):
        """Only those; of their members, those that a render shows; nested ones, too."""
        stage()
        outer = collection("Outer")
        inner, hidden = collection("Inner", outer), collection("Hidden", outer)
        put("Shown", (0, 0, 0), collection=inner)
        put("Unrendered", (0, 0, 1), collection=inner, hide_render=True)
        put("Unviewed", (0, 0, -1), collection=inner, hide_viewport=True)
        put("Deep", (0.5, 0, 1), collection=hidden)
        hidden.hide_render = True
        middle = collection("Middle")
        instance("Nested", inner, (0.8, 0, 0), middle)
        layer_of(outer).exclude = layer_of(middle).exclude = True
        instance("One", outer, (0, 0, 0))
        instance("Two", middle, (0.4, 0, 0.2))
        instance("Three", outer, (0, 0, 1), hide_render=True)
        self.over(("Shown", (0, 0, 0)), ("Unviewed", (0, 0, -1)), ("Shown", (1.2, 0, 0.2)), ("Unviewed", (1.2, 0, -0.8)), animation=False)

    def test_not_seen_by_the_camera(self):
        stage()
        unseen, plain = collection("Unseen"), collection("Plain")
        put("Thing", (1, 0, 0), visible_camera=False)
        put("Member", (0, 0, 0), collection=plain)
        put("Member 2", (0, 0, -0.8), collection=plain, visible_camera=False)
        layer_of(plain).exclude = True
        instance("One", plain, (0.5, 0, 0))
        instance("Two", plain, (1.5, 0, 0), visible_camera=False)
        put("Indirect", (0, 0, 1), collection=unseen)
        layer_of(unseen).indirect_only = True
        self.over(("Member", (0.5, 0, 0)), told="Thing: is not seen by the camera", animation=False)

    def test_holdouts(self):
        stage()
        holes = collection("Holes")
        put("Hole", (0.5, 0, 0), collection=holes)
        put("Own hole", (0.5, 0, -1), is_holdout=True)
        layer_of(holes).holdout = True
        self.over(("Hole", (0.5, 0, 0)), ("Own hole", (0.5, 0, -1)), told="Hole: is a holdout", animation=False)

    def test_modifiers_and_levels_of_the_render(self):
        stage()
        thing = put("Thing", (-0.3, 0, 0))
        for name, count, viewport, render in (("Rendered", 3, False, True), ("Viewed", 5, True, False)):
            array = thing.modifiers.new(name, "ARRAY")
            array.count, array.show_viewport, array.show_render = count, viewport, render
        finer = put("Finer", (0, 0, 1.2)).modifiers.new("Subdivision", "SUBSURF")
        finer.subdivision_type, finer.levels, finer.render_levels = "CATMULL_CLARK", 0, 3
        folder = self.over(("Thing", (-0.3, 0, 0)), ("Finer", (0, 0, 1.2)))
        for file in ("scene.glb", "moving.glb"):
            glb = glb_file.Glb(folder / file)
            counts = {
                node["name"]: sum(len(glb.corners(part, "POSITION")) for part in glb.document["meshes"][node["mesh"]]["primitives"])
                for node in glb.all("nodes") if "mesh" in node
            }
            self.assertEqual(counts, {"Kept": 4, "Thing": 12, "Finer": 4 * 3 * 16 * 2})

    def test_particles_and_instances_of_vertices(self):
        stage()
        stone = put("Stone", (0, 0, -9))
        bed_of(stone)
        corners = bpy.data.meshes.new("corners")
        corners.from_pydata([(0, 0, 0), (1, 0, 0)], [], [(0, 1, 0)][:0])
        above = put("Corners", (0.2, 0, 1), data=corners, instance_type="VERTS", show_instancer_for_render=False)
        put("Child", (0, 0, 0), parent=above)
        scene, folder = bpy.context.scene, PLACE / "particles"
        folder.mkdir()
        before = flags()
        handover.write(scene, folder)
        self.assertEqual(flags(), before)
        found = [name for name, _ in gone_over(folder / "scene.glb")]
        self.assertEqual(found, ["Child"] * 2 + ["Kept"] + ["Stone"] * 7)
        self.same_picture(scene, folder)

    def test_instances_of_geometry_nodes(self):
        """Whose count is another in the viewport."""
        stage()
        tree = row_of(put("Thing", (0, 0, -9), hide_render=True))
        row = put("Row", (-0.2, 0, 0))
        row.modifiers.new("Row", "NODES").node_group = tree
        self.over(*(("Thing", (0.7 * k - 0.2, 0, 0)) for k in range(3)), animation=False)

    def test_mirrored_and_sheared(self):
        """Cycles mirrors what is below a mirrored parent; a node below a stretched and turned one has no scale and rotation of its own."""
        stage()
        mirror = empty("Mirror", (0.6, 0, 0.3), scale=(-1, 1, 1), rotation_euler=(0, 0.2, 0))
        put("Mirrored", (-0.2, 0, 0), parent=mirror, rotation_euler=(0, 0, 0.4))
        stretched = empty("Stretched", (1, 0, -1), scale=(2, 1, 0.5))
        put("Sheared", (0, 0, 0), parent=stretched, rotation_euler=(0, 0.7, 0.3))
        put("Both", (-0.5, 0, -0.8), scale=(0.7, 0.6, -0.8), rotation_euler=(0.3, 0.5, 0))
        bpy.context.view_layer.update()
        places = [(name, bpy.data.objects[name].matrix_world.copy()) for name in ("Mirrored", "Sheared", "Both")]
        self.assertLess(places[0][1].determinant(), 0)
        self.over(*places)

    def test_mirrored_and_single_sided(self):
        """The winding of a mirrored mesh turns over, and its front stays its front."""
        stage()
        mirror = empty("Mirror", (1, 0, 0), scale=(-1, 1, 1))
        thing = put("Thing", (0, 0, 0), parent=mirror)
        thing.data.materials[0].use_backface_culling = True
        bpy.context.view_layer.update()
        self.over(("Thing", thing.matrix_world.copy()))

    def test_what_is_not_a_surface(self):
        stage()
        fog = put("Fog", (0.3, 0, 0), data=workshop.mesh_of("primitive_cube_add", "fog", size=6))
        material = bpy.data.materials.new("fog")
        material.use_nodes = True
        nodes = material.node_tree.nodes
        nodes.clear()
        volume, out = nodes.new("ShaderNodeVolumePrincipled"), nodes.new("ShaderNodeOutputMaterial")
        volume.inputs["Density"].default_value = 0.001
        material.node_tree.links.new(volume.outputs[0], out.inputs["Volume"])
        fog.data.materials.append(material)
        put("Catcher", (0, 2, -0.5), data=workshop.mesh_of("primitive_plane_add", "floor", size=2), is_shadow_catcher=True)
        self.over(told="Catcher: only catches shadows|Fog: is a volume", animation=False)

    def test_curves_materials_of_objects_and_the_override(self):
        scene = stage()
        text = bpy.data.curves.new("text", "FONT")
        text.body, text.extrude = "F", 0.1
        other = area_lights.emitting("other", (0, 0.9, 0))
        text.materials.append(other)
        put("Text", (0.2, 0, 0), data=text, rotation_euler=(math.pi / 2, 0, 0))
        own = put("Own", (1.2, 0, 0))
        own.material_slots[0].link, own.material_slots[0].material = "OBJECT", other
        both = put("Both", (0.6, 0, -1), (0.9, 0.9, 0))
        both.data.materials.append(other)
        both.data.polygons[1].material_index = 1
        places = [("Both", (0.6, 0, -1)), ("Text", Matrix.Translation((0.2, 0, 0)) @ Matrix.Rotation(math.pi / 2, 4, "X")), ("Own", (1.2, 0, 0))]
        folder = self.over(*places)
        scene.view_layers[0].material_override = other
        handover.write(scene, folder)
        self.same_picture(scene, folder)

    def test_the_layer_that_is_rendered(self):
        scene = stage()
        hidden = collection("Hidden")
        put("Thing", (0.5, 0, 0), collection=hidden)
        other = scene.view_layers.new("Other")
        bpy.context.window.view_layer = other
        layer_of(hidden).exclude = True
        other.use = False
        self.over(("Thing", (0.5, 0, 0)))

    def test_the_background_scene(self):
        scene = stage()
        behind = bpy.data.scenes.new("Behind")
        thing = bpy.data.objects.new("Thing", wedge("Thing"))
        thing.location = (0.5, 0, 0)
        behind.collection.objects.link(thing)
        scene.background_set = behind
        self.over(("Thing", (0.5, 0, 0)), animation=False)

    def test_lamps_in_instances(self):
        stage()
        lamps = collection("Lamps")
        panel, bulb = bpy.data.lights.new("Panel", "AREA"), bpy.data.lights.new("Bulb", "POINT")
        panel.energy, bulb.energy = 30, 1
        put("Panel", (0, 0, 0), data=panel, collection=lamps, rotation_euler=(math.pi / 2, 0, 0))
        put("Bulb", (0, 0, 0), data=bulb, collection=lamps, hide_viewport=True)
        put("Off", (0, 0, 2), data=bulb, collection=lamps, hide_render=True)
        layer_of(lamps).exclude = True
        instance("One", lamps, (1, 0, 0.5))
        scene, folder = bpy.context.scene, PLACE / "lamps"
        folder.mkdir()
        handover.write(scene, folder)
        place = Matrix.Translation((1, 0, 0.5)) @ Matrix.Rotation(math.pi / 2, 4, "X")
        self.same(gone_over(folder / "scene.glb"), [("Panel (light)", place)])
        glb = glb_file.Glb(folder / "scene.glb")
        self.assertEqual([node["name"] for node in glb.all("nodes") if "extensions" in node], ["Bulb"])

    def test_all_kinds_are_baked(self):
        """The light of what a render shows, by whatever it is there."""
        scene, folder = stage(), PLACE / "baked"
        folder.mkdir()
        excluded = collection("Excluded")
        member = put("Member", (0, 0, 0), (0, 0.9, 0), excluded)
        layer_of(excluded).exclude = True
        instance("One", excluded, (-1, 0, -0.9), scale=(-1, 1, 1))
        instance("Two", excluded, (-1.5, 0, 1.2), hide_render=True)
        bed_of(member)
        row = put("Row", (-0.6, 0, 0.3), (0.9, 0.9, 0))
        row.modifiers.new("Row", "NODES").node_group = row_of(member)
        put("Unviewed", (0.2, 0, -0.9), hide_viewport=True)
        put("Unseen", (0.2, 0, 0.2), visible_camera=False)
        text, ball = bpy.data.curves.new("text", "FONT"), bpy.data.metaballs.new("ball")
        text.body, text.extrude = "F", 0.1
        ball.elements.new().radius = 0.6
        for name, data, place in (("Text", text, (1.5, 0, 0.2)), ("Ball", ball, (-2, 0, -0.9))):
            data.materials.append(area_lights.emitting(name, (0, 0.5, 0.9)))
            put(name, place, data=data, rotation_euler=(math.pi / 2, 0, 0))
        theirs = workshop.render(scene, folder / "cycles.exr")
        cycles_light.bake(scene, PROGRAM, folder, 256, 4)
        self.same_picture(scene, folder, theirs)

    def test_nothing_changes_where_it_fails(self):
        scene = stage()
        array = put("Thing", (0.5, 0, 0), hide_viewport=True).modifiers.new("Array", "ARRAY")
        array.show_viewport = False
        before = flags()
        nowhere = PLACE / "nowhere" / "at" / "all\0.glb"
        for animation in (False, True):
            with self.assertRaises(Exception):
                handover.export_glb(scene, nowhere, animation=animation)
            self.assertEqual(flags(), before)
        # While the render looks, too, when meshes are made already.
        with unittest.mock.patch.object(area_lights, "told_of", side_effect=ZeroDivisionError):
            put("Panel", (0, 0, 3), data=bpy.data.lights.new("Panel", "AREA"))
            before = flags()
            for animation in (False, True):
                with self.assertRaises(ZeroDivisionError):
                    handover.export_glb(scene, PLACE / "never.glb", animation=animation)
                self.assertEqual(flags(), before)

    def test_a_mesh_in_edit_mode(self):
        stage()
        thing = put("Thing", (0.5, 0, 0))
        bpy.context.view_layer.objects.active = thing
        bpy.ops.object.mode_set(mode="EDIT")
        try:
            self.over(("Thing", (0.5, 0, 0)), animation=False)
            self.assertEqual(thing.mode, "EDIT")
        finally:
            bpy.ops.object.mode_set(mode="OBJECT")

    def test_what_moves_keeps_its_skin(self):
        """Also where its rig is disabled in renders, and a hidden one stays behind."""
        scene = stage()
        rig = bpy.data.armatures.new("rig")
        arm = put("Rig", (0, 0, 0), data=rig, hide_render=True)
        bpy.context.view_layer.objects.active = arm
        bpy.ops.object.mode_set(mode="EDIT")
        rig.edit_bones.new("bone").tail = (0, 0, 1)
        bpy.ops.object.mode_set(mode="OBJECT")
        for name, hidden in (("Thing", False), ("Hidden", True)):
            thing = put(name, (0, 0, 0), parent=arm, hide_render=hidden)
            thing.vertex_groups.new(name="bone").add(range(4), 1, "REPLACE")
            thing.modifiers.new("Rig", "ARMATURE").object = arm
        for frame, turn in ((1, 0), (20, 1)):
            arm.pose.bones["bone"].rotation_quaternion = (math.cos(turn / 2), 0, math.sin(turn / 2), 0)
            arm.pose.bones["bone"].keyframe_insert("rotation_quaternion", frame=frame)
        before = flags()
        handover.export_glb(scene, PLACE / "skin.glb", animation=True)
        self.assertEqual(flags(), before)
        glb = glb_file.Glb(PLACE / "skin.glb")
        skinned = [node["name"] for node in glb.all("nodes") if "skin" in node]
        self.assertEqual(skinned, ["Thing"])
        self.assertEqual([node["name"] for node in glb.all("nodes") if "mesh" in node and node["name"] != "Kept"], ["Thing"])
        self.assertTrue(any(channel["target"]["path"] == "rotation" for each in glb.all("animations") for channel in each["channels"]))

    def test_all_that_moves_is_one_animation(self):
        scene = stage()
        scene.frame_end = 12
        for name, places in (("Thing", ((0, 0, 0), (1.1, 0, 0))), ("Other", ((0, 0, 1), (0, 0, 2.1)))):
            thing = put(name, places[0])
            for frame, place in zip((1, 12), places):
                thing.location = place
                thing.keyframe_insert("location", frame=frame)
        handover.export_glb(scene, PLACE / "two.glb", animation=True)
        glb = glb_file.Glb(PLACE / "two.glb")
        self.assertEqual(len(glb.all("animations")), 1)
        animation = glb.all("animations")[0]
        for name, axis, there in (("Thing", 0, 1.1), ("Other", 1, 2.1)):
            channel = next(
                each for each in animation["channels"]
                if each["target"]["path"] == "translation" and glb.all("nodes")[each["target"]["node"]]["name"] == name
            )
            sampler = animation["samplers"][channel["sampler"]]
            times, places = glb.accessor(sampler["input"])[:, 0], glb.accessor(sampler["output"])
            self.assertAlmostEqual(float(times[0]), 0, places=6)
            self.assertAlmostEqual(float(times[-1]), 11 / 24, places=6)
            self.assertAlmostEqual(float(places[-1][axis]), there, places=5)

    def test_a_mirrored_camera(self):
        """Cycles mirrors its picture. Ours is the picture without the mirror, that is told, and the camera comes back as it was."""
        scene = stage()
        put("Thing", (0.5, 0, 0))
        camera = scene.camera
        camera.data.shift_x, camera.data.dof.aperture_blades, camera.data.dof.aperture_rotation = 0.1, 5, 0.2
        camera.parent = empty("Mirror", (0, 0, 0), scale=(-1, 1, 1))
        folder = PLACE / "mirrored camera"
        folder.mkdir()
        manifest = handover.write(scene, folder)
        self.assertRegex("\n".join(manifest["told"]), "Shot: mirrors its picture")
        theirs = self.pictures(scene, folder)
        self.assertLess(self.share_apart(theirs[0], theirs[1][:, ::-1]), SHARE)
        self.assertGreater(self.share_apart(*theirs), SHARE)
        handover.make_project(PROGRAM, folder, manifest)
        focus_back.fetch(PROGRAM, folder, picture=False)
        before, data = camera.matrix_world.copy(), camera.data
        focus_back.apply(scene, folder)
        bpy.context.view_layer.update()
        error = max(abs(a - b) for row, other in zip(before, camera.matrix_world) for a, b in zip(row, other))
        self.assertLess(error, 1e-5)
        self.assertAlmostEqual(data.shift_x, 0.1, places=5)
        self.assertAlmostEqual(data.dof.aperture_rotation, 0.2, places=5)

    def test_the_last_picture_stays(self):
        scene = stage()
        workshop.render(scene, PLACE / "first.exr")
        handover.export_glb(scene, PLACE / "unimportant.glb")
        picture = bpy.data.images["Render Result"]
        self.assertEqual(picture.render_slots.active_index, 0)
        picture.save_render(str(PLACE / "second.exr"), scene=scene)
        np.testing.assert_array_equal(pixels(PLACE / "first.exr"), pixels(PLACE / "second.exr"))

    def test_another_place_is_told_apart(self):
        """The comparison of pictures fails where it must."""
        scene, folder = stage(), PLACE / "apart"
        folder.mkdir()
        thing = put("Thing", (0.5, 0, 0))
        handover.write(scene, folder)
        thing.location.x = 1
        with self.assertRaises(AssertionError):
            self.same_picture(scene, folder)


if __name__ == "__main__":
    unittest.main(verbosity=1)
