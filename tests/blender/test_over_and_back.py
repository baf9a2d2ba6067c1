"""A scene of nodes, instances, modifiers, two cameras with lenses, an area light and a world, over and back."""

import importlib
import json
import math
import shutil
import time
import unittest

import workshop
from workshop import PLACE, PROGRAM, bpy

import numpy as np  # noqa: E402
from bpy_extras.object_utils import world_to_camera_view  # noqa: E402
from mathutils import Matrix, Vector  # noqa: E402

workshop.install()
camera_lens, exr_file, focus_back, glb_file, handover, live, meshes_back, names, program = (
    importlib.import_module(f"{workshop.MODULE}.{name}")
    for name in ("camera_lens", "exr_file", "focus_back", "glb_file", "handover", "live", "meshes_back", "names", "program")
)


def told(*arguments):
    return json.loads(program.run(PROGRAM, *arguments, "--json"))


class OverAndBack(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = workshop.studio()
        cls.folder = PLACE / "over"
        cls.folder.mkdir()
        before = sorted(each.name for each in bpy.data.objects)
        cls.manifest = handover.write(cls.scene, cls.folder)
        cls.left = (before, sorted(each.name for each in bpy.data.objects))
        handover.make_project(PROGRAM, cls.folder, cls.manifest)
        cls.project = cls.folder / cls.manifest["project"]

    def test_nothing_of_ours_is_left_in_the_scene(self):
        self.assertEqual(*self.left)
        self.assertFalse([each.name for each in bpy.data.materials if each.name.endswith("(light)")])
        self.assertFalse([each.name for each in bpy.data.scenes if each.name.startswith("Focus Brush")])

    def test_cameras_project_as_blender_does(self):
        points = np.random.default_rng(5).uniform((-2, -2, 0), (2, 2, 1.5), (100, 3))
        for name in ("Wide", "Tall"):
            here = self.scene.objects[name]
            there = self.camera(name)
            width, height = there["width"], there["height"]
            self.assertEqual((width, height), (96, 64))
            to_camera = Matrix(there["camera_to_world"]).inverted() @ meshes_back.TO_BLENDER.inverted()
            farthest = self.farthest(here, there, to_camera, points)
            print(f"{name}: 100 points within {farthest:.5f} px")
            self.assertLess(farthest, 0.1)

    def farthest(self, here, there, to_camera, points):
        """How far apart Blender and a lens of ours put points of the scene, px."""
        width, height = there["width"], there["height"]
        shift = there.get("shift", [0, 0])
        half = height / 2 / math.tan(there["yfov"] / 2)
        farthest = 0
        for point in points:
            x, y, _ = world_to_camera_view(self.scene, here, Vector(point))
            seen = to_camera @ Vector(point)
            px = width / 2 - shift[0] * height + half * seen.x / -seen.z
            py = height / 2 + shift[1] * height - half * seen.y / -seen.z
            farthest = max(farthest, abs(px - x * width), abs(py - (1 - y) * height))
        return farthest

    def test_every_fit_of_the_sensor_projects_as_blenders(self):
        points = np.random.default_rng(6).uniform((-2, -2, 0), (2, 2, 1.5), (100, 3))
        here, render = self.scene.objects["Wide"], self.scene.render
        data = here.data
        before = data.sensor_fit, render.resolution_x, render.resolution_y, render.resolution_percentage
        for fit in ("AUTO", "HORIZONTAL", "VERTICAL"):
            for width, height, percentage in ((96, 64, 100), (64, 96, 100), (80, 80, 100), (192, 128, 50)):
                data.sensor_fit = fit
                render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, percentage
                bpy.context.view_layer.update()
                there = camera_lens.lens_of(here, self.scene, bpy.context.evaluated_depsgraph_get())
                there["yfov"] = camera_lens.Frame(data, render).yfov(data)
                farthest = self.farthest(here, there, here.matrix_world.inverted(), points)
                self.assertLess(farthest, 0.01, f"{fit}, {width} × {height}")
        data.sensor_fit, render.resolution_x, render.resolution_y, render.resolution_percentage = before
        bpy.context.view_layer.update()

    def camera(self, name):
        file = PLACE / f"{name}.fbrush"
        program.run(PROGRAM, "new", self.folder / "scene.glb", "--camera", name, "-o", file)
        return told("info", file)["camera"]

    def test_lenses_come_over(self):
        for name in ("Wide", "Tall"):
            here, there = self.scene.objects[name], self.camera(name)
            dof = here.data.dof
            ratio = dof.aperture_ratio
            f_stop = here.data.lens * 1e-3 / (2 * there["aperture_radius"] * min(1, ratio))
            self.assertAlmostEqual(f_stop, dof.aperture_fstop, delta=1e-4 * f_stop)
            distance = camera_lens.focus_distance(here, bpy.context.evaluated_depsgraph_get())
            self.assertAlmostEqual(there["focus_distance"], distance, delta=1e-4 * distance)
            self.assertAlmostEqual(there["aperture"]["ratio"], ratio, places=6)
            pose = meshes_back.TO_BLENDER @ Matrix(there["camera_to_world"])
            error = max(abs(a - b) for row, other in zip(pose, here.matrix_world) for a, b in zip(row, other))
            print(f"{name}: pose within {error:.1e}, f/{f_stop:.5f}, {there['focus_distance']:.5f} m")
            self.assertLess(error, 1e-5)
        self.assertEqual(self.camera("Wide")["aperture"]["blades"], 5)

    def test_the_lens_comes_back(self):
        """What Focus Brush holds, set on a camera that was changed, gives the camera that went over."""
        here = self.scene.objects["Wide"]
        dof, data = here.data.dof, here.data
        fields = [(data, "lens"), (data, "shift_x"), (data, "shift_y"), (dof, "aperture_fstop"), (dof, "aperture_ratio"), (dof, "aperture_rotation")]
        before, pose, target = [getattr(*each) for each in fields], here.matrix_world.copy(), dof.focus_object
        distance = camera_lens.focus_distance(here, bpy.context.evaluated_depsgraph_get())
        data.lens, data.shift_x, dof.aperture_fstop, dof.aperture_blades = 80, 0, 9, 0
        here.location = (9, 9, 9)
        there = told("info", self.project)["camera"]
        camera_lens.set_pose(here, there["camera_to_world"])
        camera_lens.set_lens(here, there, there["yfov"], self.scene)
        bpy.context.view_layer.update()
        for value, each in zip(before, fields):
            self.assertAlmostEqual(getattr(*each), value, delta=1e-4 * max(1, abs(value)), msg=each[1])
        self.assertEqual(dof.aperture_blades, 5)
        self.assertAlmostEqual(dof.focus_distance, distance, delta=1e-4 * distance)
        error = max(abs(a - b) for row, other in zip(pose, here.matrix_world) for a, b in zip(row, other))
        self.assertLess(error, 1e-5)
        dof.focus_object = target

    def test_the_world_is_the_same_all_around(self):
        planes, _ = exr_file.read(self.folder / "world.exr")
        height, width = planes["R"].shape
        for direction in ((1, 0, 0), (0, 1, 0), (-0.6, 0, 0.8), (0.48, -0.6, 0.64)):
            x, y, z = direction[0], direction[2], -direction[1]
            u, v = math.atan2(z, x) / math.tau + 0.5, 0.5 - math.asin(y) / math.pi
            texel = int(min(v * height, height - 1)), int(u * width) % width
            found = [planes[channel][texel] for channel in "RGB"]
            for value, axis in zip(found, direction):
                # Generated coordinates of a world are its directions; light below 0 is none.
                self.assertAlmostEqual(value, max(0, 0.3 * axis + 0.4), delta=2e-3, msg=str(direction))

    def test_all_that_a_render_shows_went_over(self):
        placed = [node.get("name") for node in glb_file.Glb(self.folder / "scene.glb").all("nodes") if "mesh" in node]
        for name in ("Ground", "Box", "Twin 0", "Twin 1", "Twin 2", "Ball", "Row", "Panel (light)"):
            self.assertIn(name, placed)
        self.assertEqual(sum(name.startswith("Stone") for name in placed), 2)

    def test_an_area_light_shines_as_in_blender(self):
        glb = glb_file.Glb(self.folder / "scene.glb")
        panel = next(each for each in glb.all("materials") if each["name"] == "Panel (light)")
        strength = panel["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"]
        self.assertAlmostEqual(strength * panel["emissiveFactor"][0], 60 / math.pi / 0.72, delta=1e-3)
        self.assertFalse(panel.get("doubleSided", False))

    def test_paint_is_on_the_same_places(self):
        """A map whose t says where in the world each texel lies, painted by the program, is read at 100 points of Blender's surfaces."""
        folder = PLACE / "painted"
        shutil.copytree(self.folder, folder)
        focus_back.fetch(PROGRAM, folder, picture=False)
        workshop.write_places(folder / "back" / "scene.glb", folder / "back" / "focus.exr")
        focus_back.apply(self.scene, folder)
        image = bpy.data.images[names.FOCUS_IMAGE]
        width, height = image.size
        texels = np.array(image.pixels[:], np.float32).reshape(height, width, 4)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        random, farthest, looked = np.random.default_rng(7), 0, 0
        targets = [each for each in self.scene.objects if each.type == "MESH" and each.data.uv_layers.get(names.UV_MAP)]
        self.assertGreaterEqual(len(targets), 9)
        for each in targets:
            mesh = each.data
            mesh.calc_loop_triangles()
            layer = mesh.uv_layers[names.UV_MAP].data
            for _ in range(math.ceil(100 / len(targets))):
                triangle = mesh.loop_triangles[random.integers(len(mesh.loop_triangles))]
                weights = random.dirichlet((1, 1, 1))
                at = sum((each.matrix_world @ mesh.vertices[v].co * w for v, w in zip(triangle.vertices, weights)), Vector())
                uv = sum((Vector(layer[loop].uv) * w for loop, w in zip(triangle.loops, weights)), Vector((0, 0)))
                found = texels[min(int(uv.y * height), height - 1), min(int(uv.x * width), width - 1), :3]
                # A texel is as wide as the atlas is fine.
                texel = self.texel_size(triangle, each, layer, width, height)
                farthest = max(farthest, (Vector(found) - at).length / texel)
                looked += 1
        print(f"{looked} points of {len(targets)} objects within {farthest:.2f} texels")
        self.assertLess(farthest, 1)

    def texel_size(self, triangle, each, layer, width, height):
        a, b, c = (each.matrix_world @ each.data.vertices[v].co for v in triangle.vertices)
        p, q, r = (Vector((layer[loop].uv.x * width, layer[loop].uv.y * height)) for loop in triangle.loops)
        area = abs((q - p).cross(r - p))
        return math.sqrt((b - a).cross(c - a).length / area)

    def test_the_buttons_say_what_is_wrong(self):
        chosen = bpy.context.scene.focus_brush
        preferences = bpy.context.preferences.addons[workshop.MODULE].preferences
        chosen.folder = "//focus-brush"
        with self.assertRaisesRegex(RuntimeError, "not saved yet"):
            bpy.ops.focus_brush.write()
        chosen.folder = str(PLACE / "empty")
        with self.assertRaisesRegex(RuntimeError, "Open in Focus Brush first"):
            bpy.ops.focus_brush.fetch()
        preferences.program = str(PLACE / "nothing")
        try:
            with self.assertRaisesRegex(RuntimeError, "Preferences"):
                bpy.ops.focus_brush.open()
        finally:
            preferences.program = PROGRAM

    def test_live_shows_what_was_saved_there(self):
        folder = PLACE / "live"
        shutil.copytree(self.folder, folder)
        chosen = bpy.context.scene.focus_brush
        chosen.folder, chosen.live, chosen.picture = str(folder), True, False
        live.look()
        project = folder / self.manifest["project"]
        recipe = folder / "recipe.json"
        recipe.write_text('{"nodes": {"Box": {"t": 1.25, "anchor": 1}}}')
        program.run(PROGRAM, "new", folder / "scene.glb", "--focus", recipe, "-o", project)
        begun = time.monotonic()
        while not self.has_t(1.25) and time.monotonic() - begun < 60:
            live.look()
            time.sleep(0.1)
        chosen.live = False
        self.assertTrue(self.has_t(1.25))

    def has_t(self, t):
        box = bpy.data.objects["Box"].data.attributes.get("focus_t")
        return box is not None and all(abs(each.value - t) < 1e-6 for each in box.data)

    def test_the_addon_goes_and_comes(self):
        package = importlib.import_module(workshop.MODULE)
        package.unregister()
        self.assertFalse(hasattr(bpy.types.Scene, "focus_brush"))
        package.register()
        self.assertTrue(hasattr(bpy.context.scene, "focus_brush"))

    def test_a_program_that_is_not_there_says_how_to_set_it(self):
        with self.assertRaisesRegex(names.BridgeError, "Preferences"):
            program.find(str(PLACE / "nothing"))

    def test_an_error_of_the_program_is_one_line(self):
        with self.assertRaisesRegex(names.BridgeError, "nothing.glb"):
            program.run(PROGRAM, "info", PLACE / "nothing.glb")


if __name__ == "__main__":
    unittest.main(verbosity=1)
