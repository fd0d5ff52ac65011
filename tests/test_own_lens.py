"""raylab render --shade FILE through a student's lens: the camera's rays, the same picture, and sentences."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

import raylab
from raylab.grading.assignment import load
from raylab.grading.own_lens import through
from raylab.jit import interpreted
from raylab.sampling import sample_concentric_disk
from raylab.vec3 import Vec3

LENS = """
import math
from raylab.lecture import Vec3

def sample_aperture(a, u):
    r = a * math.sqrt(u[0])
    return r * math.cos(2.0 * math.pi * u[1]), r * math.sin(2.0 * math.pi * u[1])

def lens_direction(toward, f, px, py):
    return toward - Vec3(px, py, 0.0) / f
"""


@pytest.fixture
def folder(tmp_path):
    """Where a student works, with a scene that has no lens."""
    shutil.copyfile(load("a1").folder / "soft_shadow.xml", tmp_path / "soft_shadow.xml")
    return tmp_path


def test_rays_through_a_students_lens_are_those_of_the_camera():
    """Slide "Depth of field": with the same point on the aperture the same ray, but for rounding to float32."""
    scene = raylab.load(load("a6").folder / "focus.xml")
    eye = scene.camera

    def sample_aperture(a, u):
        x, y = sample_concentric_disk(u)
        return a * x, a * y

    def lens_direction(toward, f, px, py):
        return Vec3(toward.x - px / f, toward.y - py / f, 1.0)

    seen = through(scene, sample_aperture, lens_direction)
    assert scene.camera is eye
    rng = np.random.default_rng(3)
    with interpreted():
        for film, lens, (column, row) in zip(
            rng.random((50, 2)), rng.random((50, 2)), rng.integers(0, 240, (50, 2)), strict=True
        ):
            o, d, far = eye.ray(column, row, tuple(film), eye.aperture.sample(tuple(lens)), 0.0)
            p, e, end = seen.camera.ray(column, row, tuple(film), tuple(lens), 0.0)
            np.testing.assert_allclose([*o, *d, far], [*p, *e, end], rtol=0.0, atol=2.0**-23)


def test_a_lens_needs_a_lens(folder, run):
    (folder / "shade.py").write_text(LENS)
    done = run("render", folder / "soft_shadow.xml", "--shade", folder / "shade.py")
    assert done.code == 2
    assert "the scene needs a camera of type thinlens that stands still" in done.stderr
    assert "this one has a pinhole" in done.stderr
    (folder / "shade.py").write_text(LENS.replace("return r * math.cos", "return r + x * math.cos"))
    done = run("render", load("a6").folder / "focus.xml", "--shade", folder / "shade.py")
    assert done.code == 2
    assert "line 7: `x` is not defined" in done.stderr


@pytest.mark.certify
@pytest.mark.parametrize(("change", "said"), [("", "The difference is noise"), (" * 2.0", "More than noise")])
def test_pictures_through_a_students_lens(change, said, folder, run):
    """A lens of twice the radius, but with the same focus, blurs everything twice as much."""
    (folder / "shade.py").write_text(LENS.replace("math.sqrt(u[0])", f"math.sqrt(u[0]){change}"))
    out = folder / "mine.png"
    done = run("render", load("a6").folder / "focus.xml", "--shade", folder / "shade.py", "--spp", 16, "-o", out)
    assert done.code == 0
    assert said in done.stdout
    assert (folder / "mine_compared.png").is_file()
