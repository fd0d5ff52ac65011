"""Random scenes in families: the scenes of one are of the same types, so that few kernels are compiled."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from hypothesis import strategies as st
from scenes import moved, turned

from raylab import description as d
from raylab.metamorphic import mapped
from strategies import materials as m
from strategies.cameras import cameras, lenses
from strategies.motion import drifting, in_motion, opened
from strategies.numbers import HUGE, axes, brightness, degrees, far_place, place, points, similarities, triple
from strategies.shapes import (
    ORDINARY_LAMP,
    boxes,
    crowds,
    faced,
    flat_lamps,
    mesh_lamps,
    meshes,
    quadrics,
    round_lamps,
    square_lamps,
    triangle_lamps,
    tubes,
)

point_lights = st.builds(d.PointLight, points(far_place), triple(brightness))
suns = st.builds(d.DirectionalLight, points(st.one_of(place, st.sampled_from(HUGE))), triple(brightness))


@st.composite
def skies(draw: Any, smooth: bool = True) -> d.ImageEnvironment:
    """A picture of few texels, at least one of which shines; black, faint and blinding ones beside each other."""
    height, width = draw(st.integers(1, 4)), draw(st.integers(1, 5))
    texel = st.one_of(st.sampled_from((0.0, 1.0, 0.3)), st.sampled_from((1e-45, 1e-38, 1e-20, 1e20, 3e38)))
    pixels = np.array(draw(st.lists(texel, min_size=3 * height * width, max_size=3 * height * width)))
    pixels = pixels.reshape(height, width, 3)
    pixels[draw(st.integers(0, height - 1)), draw(st.integers(0, width - 1))] = 1.0
    turn = turned(draw(degrees), draw(axes))
    if smooth:
        return d.ImageEnvironment(pixels, turn)
    return d.ImageEnvironment(pixels, turn, filter="nearest", mis_compensation=draw(st.booleans()))


@dataclass(frozen=True, repr=False)
class Family:
    """Scenes of the same record types, which one kernel renders, and how."""

    name: str
    scenes: st.SearchStrategy[d.SceneDescription]
    shade: str
    sampler: str = "independent"


@st.composite
def described(
    draw: Any,
    shapes: st.SearchStrategy[Any],
    anchors: tuple[d.Shape, ...],
    lamps: tuple[st.SearchStrategy[Any], ...] = (),
    lights: tuple[st.SearchStrategy[Any], ...] = (),
    sky: st.SearchStrategy[Any] | None = None,
    camera: st.SearchStrategy[d.Camera] | None = None,
    crowd: st.SearchStrategy[tuple[d.Shape, ...]] | None = None,
) -> d.SceneDescription:
    """Shapes among `anchors`, which give the scene its types, in any unit from 2^-300 to 2^300."""
    scene = d.SceneDescription(
        camera=draw(camera if camera is not None else cameras()),
        shapes=(
            *anchors,
            *draw(st.lists(shapes, max_size=3)),
            *(draw(lamp) for lamp in lamps),
            *(draw(crowd) if crowd is not None else ()),
        ),
        lights=tuple(draw(light) for light in lights),
        environment=None if sky is None else draw(sky),
        max_depth=draw(st.sampled_from((8, 1, 2, 3, 10))),
    )
    power = draw(st.one_of(st.just(0), st.just(0), st.integers(-300, 300)))
    if power == 0:
        return scene
    size = 2.0**power
    scaled = mapped(replace(scene, lights=()), np.diag([size, size, size, 1.0]), size)
    return replace(scaled, lights=scene.lights)


FLOOR = d.Rectangle(to_world=moved(0, 0, 0, 4, 4, 1), front=d.Diffuse(), back=d.Diffuse(), name="floor")
LAMP = d.Rectangle(to_world=ORDINARY_LAMP, radiance=np.ones(3), front=None, name="drifting lamp")
BALL_LAMP = d.Sphere(to_world=moved(1, -1, 3), radius=0.5, radiance=np.ones(3), front=None, name="drifting ball")
CHECKS = d.Bitmap(np.array([[[0.2, 0.5, 0.8], [0.9, 0.9, 0.9]]]))
BALLS = (
    d.Sphere(center=np.array([0, 0, 0.6]), radius=0.6, front=d.Diffuse()),
    d.Disk(to_world=moved(0, 0, 0, 3, 3, 1), front=d.Diffuse()),
)
MIRRORS = (
    FLOOR,
    d.Sphere(center=np.array([-0.7, 0, 0.8]), radius=0.7, front=d.Dielectric(), back=d.Dielectric().inside),
    d.Sphere(center=np.array([0.9, 0, 0.8]), radius=0.7, front=d.Conductor()),
)


def floor(material: d.Material) -> d.Rectangle:
    return replace(FLOOR, front=material, back=material)


flat = meshes() | boxes
solid = faced(flat, m.diffuse)
ROOM = described(solid, (FLOOR,), (square_lamps,))
MIRROR_ROOM = described(
    faced(flat | quadrics, m.diffuse | m.conductors | m.glass), MIRRORS, (square_lamps,), (point_lights,),
    st.builds(d.ConstantEnvironment, triple(brightness)),
)  # fmt: skip
CROWD = described(solid, (FLOOR,), crowd=crowds())
LAMPS_OF_TRIANGLES = triangle_lamps | mesh_lamps | in_motion(triangle_lamps) | in_motion(mesh_lamps)
MOVING_SOLID = solid | in_motion(solid)
MOVING_ROUND = faced(quadrics, m.diffuse) | in_motion(faced(quadrics, m.diffuse), similarities)
FAMILIES = (
    Family("room", ROOM, "area", "sobol"),
    Family("room, direct", ROOM, "direct", "sobol"),
    Family("solid angle", described(solid, (FLOOR,), (triangle_lamps, mesh_lamps, square_lamps)), "area_solid_angle"),
    Family("balls", described(faced(quadrics, m.diffuse), BALLS, (round_lamps,), (point_lights,)), "direct"),
    Family(
        "disks and tubes",
        described(faced(quadrics, m.diffuse), BALLS, (flat_lamps, tubes, round_lamps), (suns,)),
        "mis_power",
    ),
    Family("sky", described(faced(flat, m.phong), (floor(d.Phong()),), sky=skies()), "direct"),
    Family("texels of a sky", described(solid, (FLOOR,), sky=skies(smooth=False)), "mis_balance", "sobol"),
    Family("lens", described(solid, (FLOOR,), (square_lamps,), camera=cameras(lens=True)), "area", "sobol"),
    Family("blades", described(solid, (FLOOR,), (square_lamps,), camera=lenses()), "area", "sobol"),
    Family("mirrors", MIRROR_ROOM, "direct"),
    Family("basic", MIRROR_ROOM, "basic", "latin"),
    Family(
        "rough",
        described(faced(flat, m.rough_metal), (floor(d.RoughConductor()),), (square_lamps,)),
        "direct",
        "sobol",
    ),
    Family(
        "plastic",
        described(
            faced(meshes(textured=True) | boxes, m.rough_plastic | m.rough_metal),
            (floor(d.RoughPlastic(CHECKS, distribution="ggx")), FLOOR, replace(FLOOR, front=d.RoughConductor())),
            (square_lamps,),
        ),
        "mis_power",
        "stratified",
    ),
    Family(
        "textures",
        described(
            faced(meshes(textured=True) | boxes | quadrics, m.textured | m.diffuse),
            (floor(d.Diffuse(CHECKS)), *BALLS),
            (square_lamps,),
        ),
        "area",
        "sobol",
    ),
    Family("many lights", CROWD, "direct", "sobol"),
    Family("one of many, by power", CROWD, "one_light_power"),
    Family("one of many, uniformly", CROWD, "one_light_uniform", "latin"),
    Family(
        "motion",
        described(
            MOVING_SOLID, (drifting(FLOOR), drifting(LAMP)), (square_lamps | in_motion(square_lamps),),
            camera=opened(cameras()),
        ),
        "area",
        "sobol",
    ),
    Family(
        "moving lamps",
        described(
            MOVING_SOLID | MOVING_ROUND,
            (drifting(FLOOR), drifting(BALL_LAMP)),
            (LAMPS_OF_TRIANGLES, in_motion(round_lamps, similarities)),
            camera=opened(cameras()),
        ),
        "direct",
    ),
    Family(
        "moving camera",
        described(MOVING_ROUND, (drifting(FLOOR), *BALLS), (in_motion(flat_lamps),),
                  camera=opened(cameras(lens=True), moving=True)),
        "direct",
    ),
)  # fmt: skip
