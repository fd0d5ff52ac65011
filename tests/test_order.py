"""Order: lights by their places, whatever their order in the file, and messages in the order of the file."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scenes import GLOSSY, GREY, animation, lamp, moved, turned

from raylab import description as d
from raylab.metamorphic import mapped
from raylab.order import STEP, content, order
from raylab.scene import Scene


def row_of_lamps(n=5):
    """At one height and, but for rounding, depth; of radiances that tell them apart."""
    return [
        replace(lamp(), to_world=moved(x, 0.7 + 1e-15 * (k % 2), 0.7, 0.05, -0.05, -1), radiance=np.full(3, 1.0 + k))
        for k, x in enumerate(np.linspace(-1.0, 1.0, n))
    ]


def radiances(described):
    """Of the area lights in the order of their table."""
    return Scene(described).data.lights.rows.array[:, 1].tolist()


def test_by_place():
    assert order([[1.0, 0.0], [-1.0, 5.0], [1.0, -1.0]], [None] * 3) == [1, 2, 0]
    assert order(np.zeros((0, 3)), []) == []


def test_what_is_within_rounding_goes_by_the_next_coordinate():
    tenth = 0.1 + 0.2
    assert order([[tenth, 1.0], [0.3, 2.0], [0.3 + STEP, 0.0]], [None] * 3) == [0, 1, 2]
    assert order([[0.3, 1.0], [tenth, 2.0], [0.3 + STEP, 0.0]], [None] * 3) == [0, 1, 2]


def test_what_is_in_one_place_goes_by_what_is_said_of_it():
    described = [replace(lamp(), radiance=np.full(3, value)) for value in (3.0, 1.0, 2.0)]
    assert order(np.zeros((3, 2)), described) == [1, 2, 0]


@pytest.mark.parametrize("turn", [0.0, 90.0])
def test_rounding_does_not_exchange_lamps_of_one_height(turn):
    described = d.SceneDescription(shapes=tuple(row_of_lamps()))
    expected = radiances(mapped(described, turned(turn)))
    for offset in np.random.default_rng(2).uniform(-9.0, 9.0, (20, 3)):
        assert radiances(mapped(described, turned(turn, offset=offset))) == expected


@pytest.mark.parametrize("factor", [0.25, 3.0])
def test_brighter_lamps_in_one_place_keep_their_order(factor):
    lamps = [replace(lamp(), radiance=np.array(c)) for c in ((3.0, 1.0, 1.0), (1.0, 3.0, 1.0), (1.0, 1.0, 9.0))]
    before = radiances(d.SceneDescription(shapes=tuple(lamps)))
    after = radiances(d.SceneDescription(shapes=tuple(replace(s, radiance=s.radiance * factor) for s in lamps)))
    assert after == [factor * value for value in before] == [factor, factor, 3.0 * factor]


def test_half_a_turn_reverses_a_row():
    """On which the relation `light_order` stands."""
    described = d.SceneDescription(shapes=tuple(row_of_lamps()))
    assert radiances(described) == [1.0, 2.0, 3.0, 4.0, 5.0]
    assert radiances(mapped(described, np.diag([-1.0, -1.0, 1.0, 1.0]))) == [5.0, 4.0, 3.0, 2.0, 1.0]


THINGS = [
    lamp(), replace(lamp(), radiance=None), replace(lamp(), front=GREY), replace(lamp(), front=GLOSSY),
    replace(lamp(), front=d.Diffuse(d.Bitmap(np.ones((1, 2, 3))))), replace(lamp(), flip_normals=True),
    replace(lamp(), motion=animation(np.eye(4), moved(0, 0, 1))), d.Cube(), d.Disk(), d.Sphere(), d.Cylinder(),
    d.Mesh(vertices=np.eye(3), faces=np.array([[0, 1, 2]])), d.Sphere(front=d.Conductor()), d.Sphere(back=GREY),
    d.Mesh(vertices=np.eye(3), faces=np.array([[0, 1, 2]]), normals=np.eye(3)), d.Sphere(front=d.Dielectric()),
    d.Sphere(front=d.RoughConductor(distribution="ggx")), d.Sphere(front=d.RoughPlastic()), d.Sphere(radius=2.0),
    d.PointLight(np.zeros(3), np.ones(3)), d.DirectionalLight(np.ones(3), np.ones(3)),
]  # fmt: skip


def test_all_that_can_be_said_can_be_compared():
    words = [content(thing) for thing in THINGS]
    assert len(set(words)) == len(THINGS)
    assert all((a < b) != (b < a) for a in words for b in words if a is not b)
    assert content(replace(lamp(), name="a")) == content(replace(lamp(), name="b"))


def test_messages_keep_the_order_of_the_file():
    flat = d.Mesh(
        vertices=np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]]), faces=np.array([[0, 1, 2], [0, 1, 3]])
    )
    first, second = replace(flat, name="far", to_world=moved(5, 0, 0)), replace(flat, name="near")
    scene = Scene(d.SceneDescription(shapes=(first, second)))
    assert [warning.split(":")[0] for warning in scene.warnings] == ["shape 'far'", "shape 'near'"]
    assert scene.description.shapes == (first, second)


def test_a_mesh_without_triangles_has_no_place():
    empty = d.Mesh(vertices=np.zeros((0, 3)), faces=np.zeros((0, 3), int))
    assert radiances(d.SceneDescription(shapes=(empty, *row_of_lamps(2), empty))) == [1.0, 2.0]
