"""Bitwise relations: what must not change a picture changes no bit of it. One test for each relation.

scene times 2^k, dyadic translation, threads, order of the tiles, order of lights and shapes, point aperture against
pinhole, closed shutter against a static scene. (Checkpoints: test_checkpoint.py; the table: `raylab stress A10`.)
"""

from __future__ import annotations

import sys
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from helpers import same_bits
from scenes import camera, dance, lamp, moved, room

from raylab import beyond, keyframes, schedule, shade
from raylab import description as d
from raylab.camera import Pinhole, ThinLens
from raylab.metamorphic import mapped
from raylab.motion import Static
from raylab.packet import LANES
from raylab.render import render
from raylab.scene import Scene

render_module = sys.modules["raylab.render"]  # raylab.render is the function
pytestmark = pytest.mark.compiled(reason="pictures")
RED, GREEN = (d.Diffuse(np.array(colour)) for colour in ((0.75, 0.25, 0.25), (0.25, 0.75, 0.25)))


def everything(x, V, brdf, N, scene, rng):
    """All that sums over lights, and what chooses one of them."""
    sums = shade.point_light(x, V, brdf, N, scene, rng) + shade.directional_light(x, V, brdf, N, scene, rng)
    return sums + shade.area(x, V, brdf, N, scene, rng) + beyond.one_light_power(x, V, brdf, N, scene, rng)


def lit_by_many():
    """Dyadic coordinates. Lamps of two kinds: some at one height, three in one place, two back to back, two of one box;
    points and suns."""
    eye = np.array([[-1, 0, 0, 0], [0, 0, 1, -4], [0, 1, 0, 1], [0, 0, 0, 1]], float)
    at = moved(1, 0.5, 2, 0.25, -0.5, -1)
    across = np.array([[0, 0.5, 0, 1], [0.5, 0, 0, 0.5], [0, 0, -1, 2], [0, 0, 0, 1]], float)
    lamps = [
        replace(lamp(), to_world=to_world, radiance=np.array(radiance))
        for to_world, radiance in (
            (moved(-1, -1, 3, 1, -1, -1), (4.0, 2.0, 1.0)), (moved(-1, 1, 3, 0.5, -1, -1), (1.0, 2.0, 4.0)),
            (at, (1.0, 4.0, 2.0)), (at, (3.0, 1.0, 0.5)), (at, (3.0, 1.0, 0.5)), (across, (0.5, 1.0, 0.5)),
            (moved(1, 0.5, 2, 0.25, 0.5, 1), (2.0, 2.0, 2.0)),
        )
    ]  # fmt: skip
    ball = d.Sphere(to_world=moved(-1, 0, 1, 0.25, 0.25, 0.25), radiance=np.array([1.0, 8.0, 1.0]))
    floor = d.Rectangle(to_world=moved(0, 0, 0, 4, 4, 1), front=RED, back=GREEN)
    cube = d.Cube(to_world=moved(0.5, 0.5, 0.5, 0.5, 0.5, 0.5), front=RED)
    points = [d.PointLight(np.array([x, -2.0, 3.0]), np.array([1.0, x + 4.0, 0.3])) for x in (1.0, 0.5, -3.0)]
    suns = [d.DirectionalLight(np.array([x, 0.5, -1.0]), np.array([0.1, 0.3, x])) for x in (1.0, 0.5)]
    view = d.Camera(to_world=eye, fov=50.0, near_clip=0.125, far_clip=64.0, width=12, height=12)
    shapes = (floor, cube, *lamps, ball, replace(ball, to_world=moved(-1, 1, 1, 0.25, 0.25, 0.25)))
    return d.SceneDescription(camera=view, shapes=shapes, lights=(*points, *suns), hide_emitters=True)


def picture(described):
    return render(Scene(described), everything, sampler="sobol", spp=4, seed=3).mean


@pytest.fixture(scope="module")
def plain():
    mean = picture(lit_by_many())
    assert mean.max() > 0.1
    return mean


# --- the scene ---


@pytest.mark.parametrize("k", [-60, -20, -1, 1, 30, 60])
def test_a_scene_times_a_power_of_two(k, plain):
    """A10."""
    size = 2.0**k
    assert same_bits(picture(mapped(lit_by_many(), np.diag([size, size, size, 1.0]), size)), plain)


@pytest.mark.parametrize("offset", [1.0, -1024.0, 2.0**30])
def test_a_scene_moved_by_a_dyadic_number(offset, plain):
    assert same_bits(picture(mapped(lit_by_many(), moved(offset, -offset, 0.25 * offset))), plain)


@pytest.mark.parametrize("seed", range(6))
def test_lights_in_any_order(seed, plain):
    """The n-th random numbers are those of the n-th light, and sums are rounded: the order is that of their places."""
    described, rng = lit_by_many(), np.random.default_rng(seed)
    first = next(i for i, shape in enumerate(described.shapes) if shape.radiance is not None)
    lamps = described.shapes[first:]
    shapes = (*described.shapes[:first], *(lamps[i] for i in rng.permutation(len(lamps))))
    lights = tuple(described.lights[i] for i in rng.permutation(len(described.lights)))
    assert same_bits(picture(replace(described, shapes=shapes, lights=lights)), plain)


@pytest.mark.parametrize("seed", range(6))
def test_shapes_in_any_order(seed, plain):
    """Names do not matter either. (Where shapes coincide a ray may meet either; here only hidden lamps do.)"""
    described, rng = lit_by_many(), np.random.default_rng(seed)
    numbers = rng.permutation(len(described.shapes))
    shapes = tuple(replace(described.shapes[i], name=f"shape {k}") for k, i in enumerate(numbers))
    assert same_bits(picture(replace(described, shapes=shapes)), plain)


def test_a_point_aperture_is_the_pinhole():
    scene = room(8)
    c = replace(scene.description.camera, focus_distance=3.0, aperture_blades=6)
    closed = Scene(replace(scene.description, camera=c))
    assert type(closed.camera) is Pinhole
    assert "lens" not in closed.features
    assert same_bits(render(closed, spp=4).mean, render(scene, spp=4).mean)


@pytest.mark.parametrize("time", [0.0, 0.3, 1.0, 7.0])
def test_a_closed_shutter_is_the_static_picture(time):
    """E06: no time is drawn, nothing of motion is compiled."""
    described = dance(shutter_open=time, shutter_close=time)

    def put(thing):
        return (
            thing
            if thing.motion is None
            else replace(thing, to_world=keyframes.matrix_at(thing.motion, time), motion=None)
        )

    still = replace(described, camera=put(described.camera), shapes=tuple(put(s) for s in described.shapes))
    frozen, plain = Scene(described), Scene(still)
    assert isinstance(frozen.data.motion, Static)
    assert frozen.features == plain.features
    assert same_bits(render(frozen, spp=2).mean, render(plain, spp=2).mean)


# --- how the work is done ---


@pytest.mark.parametrize("sampler", ["independent", "stratified", "sobol"])
def test_any_number_of_threads_and_rows_of_a_tile(sampler):
    scene = room(17)
    one = render(scene, "area", sampler=sampler, spp=12, seed=5, threads=1)
    for threads, rows in ((2, 1), (3, 4), (1, 17), (8, 5)):
        other = render(scene, "area", sampler=sampler, spp=12, seed=5, threads=threads, band_rows=rows)
        assert same_bits(one.mean, other.mean)
        assert same_bits(one.standard_error, other.standard_error)


def through_a_lens():
    scene = Scene(replace(room(8).description, camera=replace(camera(8), aperture_radius=0.1, focus_distance=5.0)))
    assert type(scene.camera) is ThinLens
    return scene


def in_motion():
    scene = Scene(dance(shutter_open=0.1, shutter_close=0.9))
    assert "motion" in scene.features
    return scene


@pytest.mark.parametrize("make", [through_a_lens, in_motion])
def test_any_number_of_threads_with_a_lens_and_in_motion(make):
    scene = make()
    one = render(scene, spp=4, threads=1, band_rows=1)
    assert same_bits(one.mean, render(scene, spp=4, threads=3, band_rows=3).mean)
    assert one.invalid_samples == 0


class Shuffled(ThreadPoolExecutor):
    """One thread that keeps the tiles it is given until there are TILES of them, and then takes them in any order."""

    TILES = 17
    taken: list[int]

    def __init__(self, threads):
        super().__init__(1)
        self.kept, Shuffled.taken = [], []

    def submit(self, function, /, *arguments):
        gate = super().submit  # the real one
        future = _Later()
        self.kept.append((future, function, arguments))
        if len(self.kept) == self.TILES:
            for i in np.random.default_rng(4).permutation(self.TILES):
                later, work, (rows, samples) = self.kept[i]
                Shuffled.taken.append(rows[0])
                gate(later.work, work, rows, samples)
            self.kept = []
        return future


class _Later(Future):
    def work(self, function, *arguments):
        self.set_result(function(*arguments))


def test_tiles_in_any_order(monkeypatch):
    scene = room(17)
    one = render(scene, "area", sampler="sobol", spp=12, seed=5, threads=1, band_rows=1)
    monkeypatch.setattr(render_module, "ThreadPoolExecutor", Shuffled)
    other = render(scene, "area", sampler="sobol", spp=12, seed=5, threads=1, band_rows=1)
    assert any(b < a for a, b in pairwise(Shuffled.taken))
    assert same_bits(one.mean, other.mean)


@pytest.mark.parametrize("first_pass", [1, 1 << 22])
def test_few_passes_or_many(monkeypatch, first_pass):
    """On a slow machine a picture is made in many passes and on a fast one in few; the packets are the same."""
    ends: list[int] = []
    monkeypatch.setattr(schedule, "FIRST_PASS", first_pass)

    def noted(run, pool, first, last, progress):
        ends.append(last)
        one_pass(run, pool, first, last, progress)

    one_pass = render_module._one_pass
    monkeypatch.setattr(render_module, "_one_pass", noted)
    pictures = []
    for short in (1e-9, 1e9):
        monkeypatch.setattr(schedule, "SHORT", short)
        ends.clear()
        pictures.append(render(room(17), "area", sampler="independent", spp=200, seed=5).mean)
        assert ends[-1] == 200
        assert all(end == 1 or end % LANES == 0 for end in ends[:-1]), ends
        assert len(ends) >= (3 if short < 1 else 1)
    assert same_bits(*pictures)
