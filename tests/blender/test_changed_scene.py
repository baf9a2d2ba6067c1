"""A painted project whose scene is remeshed, subdivided, decimated, unwrapped anew and moved: the paint follows the surface."""

import importlib
import math
import unittest

import workshop
from workshop import PLACE, PROGRAM, bpy

import numpy as np  # noqa: E402
from mathutils import Matrix, Vector  # noqa: E402

workshop.install()
exr_file, handover, meshes_back, program = (
    importlib.import_module(f"{workshop.MODULE}.{name}") for name in ("exr_file", "handover", "meshes_back", "program")
)

POINTS = 10_000


def t_of(places):
    """What is painted at places of the world: a smooth pattern that no symmetry of the scene has."""
    x, y, z = places.T
    return 1 + 0.15 * np.sin(1.3 * x + 0.4) * np.cos(1.1 * y - 0.3) + 0.1 * np.sin(1.7 * z)


def things(change=None):
    """Three meshes; each may be changed in its own axes."""
    scene = workshop.empty()
    suzanne = workshop.mesh_of("primitive_monkey_add", "head", size=1)
    round_head = workshop.put(scene, "Head", suzanne, (0, 0, 0.8), (0.2, 0.1, 0.4))
    smooth = round_head.modifiers.new("Subdivision", "SUBSURF")
    smooth.levels = smooth.render_levels = 1
    workshop.put(scene, "Ring", workshop.mesh_of("primitive_torus_add", "ring", major_radius=0.6, minor_radius=0.2), (1.6, 0.2, 0.3), (0.5, 0, 0))
    workshop.put(scene, "Floor", workshop.mesh_of("primitive_grid_add", "floor", x_subdivisions=9, y_subdivisions=7, size=5))
    scene.camera = workshop.camera(scene, "Shot", (0, -6, 2), (0, 0, 0.5), dof={"focus_distance": 6})
    if change is not None:
        for name in ("Head", "Ring", "Floor"):
            change(scene.objects[name])
    bpy.context.view_layer.update()
    return scene


def remeshed(each):
    modifier = each.modifiers.new("Remesh", "REMESH")
    modifier.mode, modifier.voxel_size = "VOXEL", 0.03


def solid_floor_remeshed(each):
    """A voxel grid needs an inside: the floor stays as it is."""
    if each.name != "Floor":
        remeshed(each)


def subdivided(each):
    modifier = each.modifiers.new("More", "SUBSURF")
    modifier.subdivision_type, modifier.levels, modifier.render_levels = "SIMPLE", 1, 1


def decimated(each):
    modifier = each.modifiers.new("Fewer", "DECIMATE")
    modifier.ratio = 0.5


def moved(each):
    each.matrix_world = MOTION @ each.matrix_basis


def all_at_once(each):
    solid_floor_remeshed(each)
    subdivided(each)
    decimated(each)
    moved(each)


def moved_in_its_vertices(each):
    """The transform stays, and the mesh moves below it."""
    each.data = each.data.copy()
    world = each.matrix_basis
    each.data.transform(world.inverted() @ MOTION @ world)


MOTION = Matrix.Translation((4, -1.5, 0.7)) @ Matrix.Rotation(0.6, 4, "Z")


def written(folder, scene):
    folder.mkdir()
    handover.export_glb(scene, folder / "scene.glb")
    return folder / "scene.glb"


def painted(folder):
    """A project of the scene as it was, with t painted on it."""
    scene = things()
    glb = written(folder, scene)
    blank, project = folder / "blank.fbrush", folder / "painted.fbrush"
    program.run(PROGRAM, "new", glb, "-o", blank)
    program.run(PROGRAM, "export", blank, "--glb", folder / "atlas.glb", "--focus-map", folder / "map.exr")
    workshop.write_map(folder / "atlas.glb", folder / "map.exr", lambda places: (t_of(places), 0 * places[:, 0]))
    program.run(PROGRAM, "new", glb, "--focus", folder / "map.exr", "-o", project)
    return project


def kept(folder, project, back):
    """The share of points on the new surface whose t is what was painted there; `back` leads to where they were."""
    program.run(PROGRAM, "export", project, "--glb", folder / "atlas.glb", "--focus-map", folder / "map.exr")
    t = exr_file.read(folder / "map.exr")[0]["focus.t"]
    height, width = t.shape
    random = np.random.default_rng(3)
    worlds, uvs = [], []
    for placed in meshes_back.placed_meshes(folder / "atlas.glb"):
        world = np.array(placed.world)
        worlds.append(placed.corners @ world[:3, :3].T + world[:3, 3])
        uvs.append(placed.uv)
    corners, uv = np.concatenate(worlds), np.concatenate(uvs)
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    chosen = random.choice(len(areas), POINTS, p=areas / areas.sum())
    weights = random.dirichlet((1, 1, 1), POINTS)
    at = np.einsum("pk,pkc->pc", weights, corners[chosen])
    place = np.einsum("pk,pkc->pc", weights, uv[chosen])
    x, y = place[:, 0] * width - 0.5, (1 - place[:, 1]) * height - 0.5
    x0, y0 = np.clip(np.floor(x).astype(int), 0, width - 2), np.clip(np.floor(y).astype(int), 0, height - 2)
    fx, fy = x - x0, y - y0
    found = (t[y0, x0] * (1 - fx) + t[y0, x0 + 1] * fx) * (1 - fy) + (t[y0 + 1, x0] * (1 - fx) + t[y0 + 1, x0 + 1] * fx) * fy
    was = at @ np.array(back)[:3, :3].T + np.array(back)[:3, 3]
    return float(np.mean(np.abs(found - t_of(was)) <= 0.01))


class ChangedScene(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.project = painted(PLACE / "before")

    def followed(self, name, change, back=Matrix(), least=0.99):
        folder = PLACE / name
        glb = written(folder, things(change))
        project = folder / "after.fbrush"
        program.run(PROGRAM, "new", glb, "--paint-from", self.project, "-o", project)
        share = kept(folder, project, back)
        print(f"{name}: {100 * share:.2f} % of {POINTS} points keep their t")
        self.assertGreaterEqual(share, least)

    def test_the_same(self):
        self.followed("same", None)

    def test_remeshed(self):
        self.followed("remeshed", solid_floor_remeshed)

    def test_subdivided(self):
        self.followed("subdivided", subdivided)

    def test_decimated_to_half(self):
        self.followed("decimated", decimated)

    def test_moved(self):
        self.followed("moved", moved, MOTION.inverted())

    def test_moved_in_its_vertices(self):
        self.followed("vertices", moved_in_its_vertices, MOTION.inverted())

    def test_all_at_once(self):
        self.followed("all", all_at_once, MOTION.inverted())

    def test_unpainted_is_told_apart(self):
        """Without paint, few points have the right t by chance: the count can fail."""
        folder = PLACE / "unpainted"
        glb = written(folder, things())
        program.run(PROGRAM, "new", glb, "-o", folder / "after.fbrush")
        self.assertLess(kept(folder, folder / "after.fbrush", Matrix()), 0.3)

    def test_what_has_no_partner_is_listed(self):
        folder = PLACE / "more"
        scene = things()
        workshop.put(scene, "New", workshop.mesh_of("primitive_cube_add", "new", size=0.5), (-2, 0, 1))
        bpy.context.view_layer.update()
        glb = written(folder, scene)
        found = workshop.said(PROGRAM, "new", glb, "--paint-from", self.project, "-o", folder / "after.fbrush")
        self.assertRegex(found, 'all of "New"')
        self.assertNotRegex(found, '"Head"')

    def test_a_file_that_was_overwritten_is_followed_too(self):
        """The project knows the surface that it was painted on; rendering and exporting it follow."""
        folder = PLACE / "overwritten"
        folder.mkdir()
        project = folder / "painted.fbrush"
        glb = folder / "scene.glb"
        glb.write_bytes((PLACE / "before" / "scene.glb").read_bytes())
        program.run(PROGRAM, "new", glb, "--focus", PLACE / "before" / "map.exr", "-o", project)
        handover.export_glb(things(subdivided), glb)
        self.assertGreaterEqual(kept(folder, project, Matrix()), 0.99)


if __name__ == "__main__":
    unittest.main(verbosity=1)
