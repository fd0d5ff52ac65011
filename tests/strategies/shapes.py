"""Shapes and lamps: corners of meshes come from few places, so that triangles are degenerate, slivers, twice there."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from hypothesis import strategies as st
from scenes import moved

from raylab import description as d
from strategies.numbers import brightness, points, similarities, stretch, transforms, triple


def finished(shape: d.Shape, material: Any, both: bool, flipped: bool) -> d.Shape:
    return replace(shape, front=material, back=material if both else None, flip_normals=flipped)


def faced(shape: st.SearchStrategy[Any], material: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    """A shape of a material on one side or on both."""
    return st.builds(finished, shape, material, st.booleans(), st.booleans())


@st.composite
def meshes(draw: Any, textured: bool = False) -> d.Mesh:
    """Triangles between few corners: some flat, thin, twice there or in each other's plane."""
    corners = draw(st.lists(points(), min_size=3, max_size=7))
    corner = st.integers(0, len(corners) - 1)
    faces = draw(st.lists(st.tuples(corner, corner, corner), min_size=1, max_size=6))
    uv = None
    if textured:
        number = st.sampled_from((0.0, 0.5, 1.0, -2.0, 1e-300, 1e9, 3e38, 1e39, -1e300))
        uv = np.array(draw(st.lists(st.tuples(number, number), min_size=len(corners), max_size=len(corners))))
    return d.Mesh(vertices=np.array(corners), faces=np.array(faces), uv=uv, to_world=draw(transforms))


boxes = st.builds(lambda m: d.Cube(to_world=m), transforms)
quadrics = st.one_of(
    st.builds(lambda m: d.Disk(to_world=m), transforms),
    st.builds(lambda m, c, r: d.Sphere(to_world=m, center=c, radius=r), transforms, points(), stretch.map(abs)),
    st.builds(
        lambda m, a, b, r: d.Cylinder(to_world=m, p0=a, p1=b, radius=r),
        transforms,
        points(),
        points(),
        stretch.map(abs),
    ),
)

# --- lamps ---

ORDINARY_LAMP = moved(1, -1, 3, 0.7, -0.7, -1)
on_lamp = st.one_of(st.just(ORDINARY_LAMP), transforms)
square_lamps = st.builds(
    lambda m, L: d.Rectangle(to_world=m, radiance=L, front=None, name="lamp"), on_lamp, triple(brightness)
)
round_lamps = st.builds(
    lambda m, r, L: d.Sphere(to_world=m, radius=r, radiance=L, front=None, name="ball"),
    st.one_of(st.just(moved(1, -2, 3)), similarities),
    st.sampled_from((0.5, 1.0, 1e-3, 1e-6, 1e-8, 3.0, 1e3)),
    triple(brightness),
)
flat_lamps = st.builds(
    lambda m, L: d.Disk(to_world=m, radiance=L, front=None, name="disk"), on_lamp, triple(brightness)
)
tubes = st.builds(
    lambda m, L: d.Cylinder(to_world=m, radiance=L, front=None, name="tube"), similarities, triple(brightness)
)
triangle_lamps = st.builds(
    lambda m, L: d.Mesh(
        vertices=np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), faces=np.array([[0, 2, 1]]), to_world=m, radiance=L,
        front=None, name="triangle",
    ), on_lamp, triple(brightness),
)  # fmt: skip
mesh_lamps = st.builds(
    lambda mesh, L: replace(
        mesh,
        vertices=np.concatenate([mesh.vertices, [[0, 0, 2], [1, 0, 2], [0, 1, 2], [1, 1, 2]]]),
        faces=np.concatenate([mesh.faces, np.array([[0, 2, 1], [1, 2, 3]]) + len(mesh.vertices)]),
        radiance=L, front=None, name="mesh lamp",
    ), meshes(), triple(brightness),
)  # fmt: skip


@st.composite
def crowds(draw: Any) -> tuple[d.Rectangle, ...]:
    """More lamps than `direct` samples one by one: copies of a few in a row, dark, faint and blinding ones."""
    kinds = draw(st.lists(square_lamps, min_size=1, max_size=4))
    count = draw(st.sampled_from((65, 66, 100)))
    which = draw(st.lists(st.integers(0, len(kinds) - 1), min_size=count, max_size=count))
    step = draw(st.sampled_from((0.05, 0.0, 1e-9, 100.0)))
    lamps = [kinds[i] for i in which]
    return tuple(replace(lamp, to_world=moved(step * k, 0, 0) @ lamp.to_world) for k, lamp in enumerate(lamps))
