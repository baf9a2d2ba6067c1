"""Makes the pictures that the tests compare with.

    GAUSSIANS_SCENE=DIR cargo test -p gaussians -- --ignored write_the_scene
    python make.py SPLAT_TRUTH.py DIR

SPLAT_TRUTH.py is an independent implementation of the image formation (numpy, numba); DIR has scene.ply, camera.json and paint.json.
"""
import importlib.util
import json
import pathlib
import sys
import numpy as np

spec = importlib.util.spec_from_file_location("splat_truth", sys.argv[1])
splat_truth = importlib.util.module_from_spec(spec)
sys.modules["splat_truth"] = splat_truth
spec.loader.exec_module(splat_truth)
scene, here = pathlib.Path(sys.argv[2]), pathlib.Path(__file__).parent
cloud = splat_truth.read(str(scene / "scene.ply"))
camera, paint = (json.loads((scene / name).read_text()) for name in ("camera.json", "paint.json"))
plain, painted = splat_truth.View(cloud, camera), splat_truth.View(cloud, camera, paint=paint)
pictures = {
    "pinhole": splat_truth.truth(plain, 1),
    "projected": splat_truth.decoded(splat_truth.ewa(plain, linear=False)),
    "truth": splat_truth.truth(plain, 64),
    "painted": splat_truth.truth(painted, 64),
    "dilated": splat_truth.decoded(splat_truth.ewa(plain, coc=0.5, linear=False)),
}
for name, picture in pictures.items():
    np.save(here / f"{name}.npy", picture.astype("<f4"))
