"""What a scene does not need is not in its kernel, not among its dimensions and not imported."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numba
import numpy as np
import pytest
from scenes import GLOSSY, camera, moved, outdoors, room

from raylab import description as d
from raylab import samplers
from raylab.jit import entry_point
from raylab.packet import new_packet
from raylab.pixels import fresh_accumulate, new_accumulator, view
from raylab.scene import FEATURES, Scene
from raylab.strategies import strategy
from raylab.view import View

pytestmark = pytest.mark.compiled(reason="looks at machine code")


def machine_code(scene: Scene, shade: str = "direct") -> str:
    """The assembly of the scene's kernel."""
    accumulator = new_accumulator(1, 4, 4)
    arguments = (
        scene.data, scene.camera, strategy(shade, scene), samplers.make("independent", 0, 1), new_packet(),
        view(accumulator), 4, 4, (0, 0), (0, 0),
    )  # fmt: skip
    entry_point(fresh_accumulate, arguments)
    signature = tuple(numba.typeof(a) for a in arguments)
    return fresh_accumulate._outer.inspect_asm(signature)


def calls(assembly: str) -> set[str]:
    """The outside functions that the code calls."""
    names = (
        "rtcIntersect1",
        "rtcIntersect16",
        "rtcOccluded1",
        "sin",
        "cos",
        "sincos",
        "atan2",
        "exp",
        "expm1",
        "log1p",
        "pow",
        "log",
    )
    found = {name for name in names if re.search(rf"\$?\b{name}\b", assembly)}
    return found - {"sincos"} | ({"sin", "cos"} if "sincos" in found else set())  # some systems have both in one


def size(assembly: str) -> int:
    return sum(1 for line in assembly.splitlines() if line.startswith("\t") and not line.startswith("\t."))


def through_lens(scene: Scene, aperture: float) -> Scene:
    """The scene seen by a thin lens."""
    eye = replace(scene.description.camera, aperture_radius=aperture, focus_distance=5.0)
    return Scene(replace(scene.description, camera=eye))


def moving_lamp(width: int, closed: float, fov: float = 45.0) -> Scene:
    """The room, its lamp moving while the shutter is open from 0 to `closed`."""
    still = room(width, fov=fov).description
    floor, cube, light = still.shapes
    motion = d.Animation(np.array([0.0, 1.0]), np.array([light.to_world, moved(0, -1, 3, 0.7, -0.7, -1)]))
    eye = replace(still.camera, shutter_close=closed)
    return Scene(replace(still, camera=eye, shapes=(floor, cube, replace(light, motion=motion))))


@pytest.fixture(scope="module")
def code() -> dict[str, str]:
    """Kernels of scenes that have more and more, all rendered by `direct`."""
    image = np.random.default_rng(1).random((8, 16, 3))
    dark = Scene(d.SceneDescription(camera=camera(4), shapes=(d.Rectangle(),)))
    return {
        "nothing": machine_code(dark),
        "lamp": machine_code(room(4)),
        "lamp, time": machine_code(moving_lamp(4, 1.0)),
        "lamp, lens": machine_code(through_lens(room(4), 0.1)),
        "constant sky": machine_code(outdoors(d.ConstantEnvironment(np.ones(3)), 4)),
        "image sky": machine_code(outdoors(d.ImageEnvironment(image), 4)),
        "glossy": machine_code(room(4, GLOSSY)),
        "mirror": machine_code(room(4, d.Conductor())),
        "rough metal": machine_code(room(4, d.RoughConductor())),
        "textured": machine_code(room(4, d.Diffuse(d.Bitmap(np.full((2, 2, 3), 0.5))))),
    }


def test_a_dark_scene_traces_no_shadow_rays(code):
    assert calls(code["nothing"]) == {"rtcIntersect16"}


def test_a_lamp_brings_shadow_rays_and_nothing_else(code):
    assert calls(code["lamp"]) == {"rtcIntersect16", "rtcOccluded1"}


def test_only_a_lens_brings_points_on_an_aperture(code):
    assert size(code["lamp, lens"]) > size(code["lamp"])
    assert calls(code["lamp, lens"]) == calls(code["lamp"])
    closed = through_lens(room(4), 0.0)  # the same types, so the same kernel
    assert numba.typeof(closed.camera) == numba.typeof(room(4).camera)
    assert "lens" not in closed.features


def test_only_motion_brings_time(code):
    """A frozen scene has the types, and so the kernel, of a static one."""
    assert size(code["lamp, time"]) > size(code["lamp"])
    frozen, static, data = moving_lamp(4, 0.0), room(4), moving_lamp(4, 1.0).data
    assert all(numba.typeof(a) == numba.typeof(b) for a, b in zip(frozen.data, static.data, strict=True))
    assert [
        n for n, a, b in zip(data._fields, data, static.data, strict=True) if numba.typeof(a) != numba.typeof(b)
    ] == ["motion"]
    assert "motion" not in frozen.features
    assert moving_lamp(4, 1.0).features == {"area lights", "motion"}


def test_a_sky_brings_directions(code):
    assert calls(code["constant sky"]) == {"rtcIntersect16", "rtcOccluded1", "sin", "cos"}


def test_only_an_image_is_looked_up_by_angles(code):
    assert "atan2" in calls(code["image sky"])
    assert all("atan2" not in calls(code[name]) for name in ("nothing", "lamp", "constant sky", "glossy", "textured"))


def test_only_a_lobe_needs_powers(code):
    assert "exp" in calls(code["glossy"])
    assert all("exp" not in calls(code[name]) for name in ("nothing", "lamp", "constant sky", "image sky", "textured"))


def test_only_rough_surfaces_have_microfacets(code):
    assert "raylab10microfacet" in code["rough metal"]
    assert all("raylab10microfacet" not in code[name] for name in code if name != "rough metal")
    assert "raylab5rough" not in code["glossy"]


def test_only_basic_ray_tracing_recurs(code):
    """The ray tracer that calls itself is in no other kernel, be it of mirrors; Snell's law is not in a mirror's."""
    assert all("raylab5basic" not in assembly for assembly in code.values())
    assert "raylab5basic8radiance" in machine_code(room(4, d.Conductor()), "basic")
    assert all(
        "raylab7fresnel" not in code[name] for name in ("nothing", "lamp", "constant sky", "image sky", "glossy")
    )


def test_each_feature_makes_the_kernel_longer(code):
    assert size(code["nothing"]) < size(code["lamp"]) < size(code["glossy"])
    assert size(code["lamp"]) < size(code["textured"])
    assert size(code["lamp"]) < size(code["mirror"])
    assert size(code["constant sky"]) < size(code["image sky"])


def test_the_slide_alone_is_no_longer_than_direct():
    assert size(machine_code(room(4), "area_diffuse")) <= size(machine_code(room(4), "direct"))


@pytest.mark.parametrize(
    ("scene", "dimensions"),
    [
        (Scene(d.SceneDescription(camera=camera(1), shapes=(d.Rectangle(to_world=moved(0, 0, 0, 9, 9, 1)),))), 2),
        (room(1, fov=0.1), 4),
        (outdoors(d.ConstantEnvironment(np.ones(3)), 1, fov=0.1), 4),
        (through_lens(room(1, fov=0.1), 0.1), 6),
        (through_lens(room(1, fov=0.1), 0.0), 4),
        (moving_lamp(1, 1.0, fov=0.1), 5),
        (moving_lamp(1, 0.0, fov=0.1), 4),
    ],
    ids=[
        "pixel",
        "pixel and lamp",
        "pixel and sky",
        "pixel, lens and lamp",
        "pixel, closed lens and lamp",
        "pixel, time and lamp",
        "pixel, frozen time and lamp",
    ],
)
def test_no_dimension_is_spent_on_what_is_not_there(scene, dimensions):
    sampler = samplers.make("independent", 0, 1)
    kernel_arguments = (
        scene.data._replace(tally=View(np.zeros(2, np.int64))), scene.camera, strategy("direct", scene), sampler,
        new_packet(), view(new_accumulator(1, 1, 1)), 1, 1, (0, 1), (0, 1),
    )  # fmt: skip
    entry_point(fresh_accumulate, kernel_arguments)(*kernel_arguments)
    assert sampler.counter.next[0] == dimensions


def test_features_are_what_the_scene_has():
    assert room(4).features == {"area lights"}
    assert outdoors(d.ConstantEnvironment(np.ones(3)), 4).features == {"environment"}
    assert room(4, GLOSSY).features == {"area lights", "glossy BRDF"}
    assert room(4).features < set(FEATURES)
    assert through_lens(room(4), 0.1).features == {"area lights", "lens"}


PROBE = """
import sys
sys.path.insert(0, {tests!r})
import raylab
from scenes import room
raylab.render(room(4), "area", spp=1)
heavy = ("colour", "skimage", "matplotlib", "OpenImageIO", "trimesh", "lxml", "scipy.stats")
print(*(module for module in heavy if module in sys.modules))
"""


def test_a_plain_render_imports_nothing_heavy():
    tests = str(Path(__file__).parent)
    done = subprocess.run([sys.executable, "-c", PROBE.format(tests=tests)], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
