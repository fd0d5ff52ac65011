"""Scenes of hypothesis: small, of few types, so that few kernels are compiled, and with extremes in every number.

A number is ordinary, or one that is planted: zero, tiny, huge, just beside another. Corners of meshes come from a few
places, so that triangles are degenerate, slivers, twice there, on a light or in its plane, again and again.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

import numpy as np
from hypothesis import strategies as st
from scenes import look_at, moved, turned

from raylab import description as d
from raylab.metamorphic import mapped

ORDINARY = st.integers(-16, 16).map(lambda k: k / 8.0)
NEAR_ONE = (1.0 - 2.0**-53, 1.0 + 2.0**-52, 1.0 + 2.0**-24, 1.0 - 2.0**-25, 1.0 + 1e-6)
TINY = (0.0, -0.0, 5e-324, 2.0**-300, 1e-160, 1e-30, 1e-18, 1e-12, 2.0**-24, 1e-6, 1e-3)
HUGE = (1e3, 1e6, 1e9, 1e12, 1e18, 1e30, 1e38, 1e150, 1e160, 2.0**300, 1e300, 1.7e308)

place = st.one_of(ORDINARY, ORDINARY, ORDINARY, st.sampled_from((*NEAR_ONE, *TINY, *(-t for t in TINY))))
far_place = st.one_of(*[place] * 11, st.sampled_from((1e3, 1e6, -1e9, 1e12)))
stretch = st.one_of(
    st.sampled_from((1.0, 1.0, 2.0, 0.5, -1.0)), st.sampled_from((1e-8, 1e-6, 1e-3, 2.0**-18, 2.0**-24, 1e3, 1e5))
)
degrees = st.one_of(st.sampled_from((0.0, 90.0, 180.0, 45.0, 1e-9, 90.0 + 1e-12, 1e-300)), st.floats(-360.0, 360.0))
brightness = st.one_of(st.sampled_from((1.0, 3.0, 0.5)), st.sampled_from((0.0, 5e-324, 1e-300, 1e-30, 1e30, 1e150)))
share = st.one_of(st.sampled_from((0.5, 0.2, 0.9)), st.sampled_from((0.0, 1.0, 5e-324, 1e-30, 1.0 - 2.0**-53)))
exponent = st.sampled_from((0.0, 5e-324, 0.5, 1.0, 10.0, 1e3, 1e6, 1e9))
ratio = st.sampled_from((1.0, 1.5, 1.33, 1.0 + 2.0**-52, 1e-6, 1e6, 1e-300, 5e-324))
roughness = st.sampled_from((0.1, 0.5, 1.0, 10.0, 1e-3, 1e-6, 1e-300))


def triple(number: st.SearchStrategy[float]) -> st.SearchStrategy[np.ndarray]:
    """Three numbers, mostly the same one."""
    return st.one_of(number.map(lambda x: np.full(3, x)), st.tuples(number, number, number).map(np.array))


def points(number: st.SearchStrategy[float] = place) -> st.SearchStrategy[np.ndarray]:
    return st.tuples(number, number, number).map(np.array)


axes = st.sampled_from((np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), np.array([0.6, 0.0, 0.8])))
similarities = st.builds(
    lambda angle, axis, at, size: turned(angle, axis, at, (size, size, size)), degrees, axes, points(far_place), stretch
)
transforms = st.one_of(
    similarities,
    st.builds(turned, degrees, axes, points(far_place), st.tuples(stretch, stretch, stretch)),
)


def finished(shape: d.Shape, material: Any, both: bool, flipped: bool) -> d.Shape:
    return replace(shape, front=material, back=material if both else None, flip_normals=flipped)


def faced(shape: st.SearchStrategy[Any], material: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    """A shape of a material on one side or on both."""
    return st.builds(finished, shape, material, st.booleans(), st.booleans())


@st.composite
def meshes(draw: Any) -> d.Mesh:
    """Triangles between few corners: some flat, thin, twice there or in each other's plane."""
    corners = draw(st.lists(points(), min_size=3, max_size=7))
    corner = st.integers(0, len(corners) - 1)
    faces = draw(st.lists(st.tuples(corner, corner, corner), min_size=1, max_size=6))
    return d.Mesh(vertices=np.array(corners), faces=np.array(faces), to_world=draw(transforms))


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
diffuse = st.builds(d.Diffuse, triple(share))
phong = st.builds(lambda a, b, n: d.Phong(a * (1.0 - b), b, n), triple(share), triple(share), exponent)
conductors = st.builds(
    d.Conductor,
    triple(st.sampled_from((0.0, 0.2, 1.0, 1e6, 1e-300))),
    triple(st.sampled_from((0.0, 1.0, 4.0, 1e6, 1e-300))),
    triple(share),
)
glass = st.builds(d.Dielectric, ratio, ratio, triple(share), triple(share))
rough = st.builds(
    lambda eta, k, alpha, name: d.RoughConductor(eta, k, alpha_u=alpha, alpha_v=alpha, distribution=name),
    triple(st.sampled_from((0.0, 0.2, 1.0, 1e6))),
    triple(st.sampled_from((0.0, 1.0, 4.0, 1e6))),
    roughness,
    st.sampled_from(("beckmann", "ggx")),
)
point_lights = st.builds(d.PointLight, points(far_place), triple(brightness))
suns = st.builds(d.DirectionalLight, points(st.one_of(place, st.sampled_from(HUGE))), triple(brightness))


@st.composite
def cameras(draw: Any, lens: bool = False) -> d.Camera:
    """2 x 2 pixels: at an ordinary place, on the floor, in a light's plane, or far away."""
    origin = draw(st.one_of(st.just(np.array([0.0, -5.0, 3.0])), points(far_place)))
    target = origin + np.array([0.0, 0.0, 1.0])
    if draw(st.integers(0, 3)):
        target = draw(st.just(np.array([0.0, 0.0, 0.5])) | points())
    up = np.array(draw(st.sampled_from(((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.3, 0.5, 0.8)))))
    gaze = target - origin
    if not np.linalg.norm(np.cross(up, gaze)) > 1e-6 * np.linalg.norm(gaze):
        up, target = np.array([0.0, 1.0, 0.0]), origin - np.array([0.0, 0.0, 1.0])
    camera = d.Camera(
        to_world=look_at(origin, target, up),
        fov=draw(st.sampled_from((45.0, 20.0, 1e-6, 1e-300, 120.0, 179.999999, 180.0 - 1e-13))),
        near_clip=draw(st.sampled_from((1e-2, 0.0, 1e-300, 1.0))),
        far_clip=draw(st.sampled_from((1e4, np.inf, 1e308, 5.0))),
        width=2,
        height=2,
        filter=d.Filter(radius=draw(st.sampled_from((0.5, 1e-300, 100.0, 1e6)))),
    )
    if not lens:
        return camera
    return replace(
        camera,
        aperture_radius=draw(st.sampled_from((0.2, 1e-300, 1e-12, 1e3, 1e9))),
        focus_distance=draw(st.sampled_from((4.0, 1e-3, 1e-9, 1e9, 1e300, np.inf))),
    )


@st.composite
def skies(draw: Any) -> d.ImageEnvironment:
    """A picture of few texels, at least one of which shines; black, faint and blinding ones beside each other."""
    height, width = draw(st.integers(1, 4)), draw(st.integers(1, 5))
    texel = st.one_of(st.sampled_from((0.0, 1.0, 0.3)), st.sampled_from((1e-45, 1e-38, 1e-20, 1e20, 3e38)))
    pixels = np.array(draw(st.lists(texel, min_size=3 * height * width, max_size=3 * height * width)))
    pixels = pixels.reshape(height, width, 3)
    pixels[draw(st.integers(0, height - 1)), draw(st.integers(0, width - 1))] = 1.0
    turn = turned(draw(degrees), draw(axes))
    return d.ImageEnvironment(pixels, turn, filter="bilinear")


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
) -> d.SceneDescription:
    """Shapes among `anchors`, which give the scene its types, in any unit from 2^-300 to 2^300."""
    scene = d.SceneDescription(
        camera=draw(camera if camera is not None else cameras()),
        shapes=(*anchors, *draw(st.lists(shapes, max_size=3)), *(draw(lamp) for lamp in lamps)),
        lights=tuple(draw(light) for light in lights),
        environment=None if sky is None else draw(sky),
    )
    power = draw(st.one_of(st.just(0), st.just(0), st.integers(-300, 300)))
    if power == 0:
        return scene
    size = 2.0**power
    scaled = mapped(replace(scene, lights=()), np.diag([size, size, size, 1.0]), size)
    return replace(scaled, lights=scene.lights)


FLOOR = d.Rectangle(to_world=moved(0, 0, 0, 4, 4, 1), front=d.Diffuse(), back=d.Diffuse(), name="floor")
GLOSSY_FLOOR = replace(FLOOR, front=d.Phong(), back=d.Phong())
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

boxes = st.builds(lambda m: d.Cube(to_world=m), transforms)
BALLS = (
    d.Sphere(center=np.array([0, 0, 0.6]), radius=0.6, front=d.Diffuse()),
    d.Disk(to_world=moved(0, 0, 0, 3, 3, 1), front=d.Diffuse()),
)
MIRRORS = (
    FLOOR,
    d.Sphere(center=np.array([-0.7, 0, 0.8]), radius=0.7, front=d.Dielectric(), back=d.Dielectric().inside),
    d.Sphere(center=np.array([0.9, 0, 0.8]), radius=0.7, front=d.Conductor()),
)
solid = faced(meshes() | boxes, diffuse)
ROOM = described(solid, (FLOOR,), (square_lamps,))
FAMILIES = (
    Family("room", ROOM, "area", "sobol"),
    Family("room, direct", ROOM, "direct", "sobol"),
    Family("solid angle", described(solid, (FLOOR,), (triangle_lamps, mesh_lamps, square_lamps)), "area_solid_angle"),
    Family(
        "balls",
        described(faced(quadrics, diffuse), BALLS, (round_lamps,), (point_lights,)),
        "direct",
    ),
    Family(
        "disks and tubes",
        described(faced(quadrics, diffuse), BALLS, (flat_lamps, tubes, round_lamps), (suns,)),
        "mis_power",
    ),
    Family("sky", described(faced(meshes() | boxes, phong), (GLOSSY_FLOOR,), sky=skies()), "direct"),
    Family(
        "lens", described(solid, (FLOOR,), (square_lamps,), camera=cameras(lens=True)), "area", "sobol"
    ),
    Family(
        "mirrors",
        described(
            faced(meshes() | boxes | quadrics, diffuse | conductors | glass), MIRRORS, (square_lamps,), (point_lights,),
            st.builds(d.ConstantEnvironment, triple(brightness)),
        ),
        "direct",
    ),
    Family(
        "rough",
        described(faced(meshes() | boxes, rough), (replace(FLOOR, front=d.RoughConductor()),), (square_lamps,)),
        "direct",
        "sobol",
    ),
)  # fmt: skip


# --- a number that is none ---

MAY_BE_INFINITE = ("far_clip", "focus_distance")
NOT_READ = ("stddev",)  # of a box filter


def leaves(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Where in a description there are floating-point numbers: the names and places that lead to each."""
    if is_dataclass(value):
        return [leaf for f in fields(value) for leaf in leaves(getattr(value, f.name), (*path, f.name))]
    if isinstance(value, tuple):
        return [leaf for i, item in enumerate(value) for leaf in leaves(item, (*path, i))]
    if isinstance(value, float) or (isinstance(value, np.ndarray) and value.dtype == np.float64 and value.size):
        return [path]
    return []


def poisoned(value: Any, path: tuple[Any, ...], place: int, bad: float) -> Any:
    """The description with `bad` for the number at the end of the path; in an array at that `place`."""
    if not path:
        if isinstance(value, float):
            return bad
        array = value.copy()
        array.ravel()[place % array.size] = bad
        return array
    if isinstance(value, tuple):
        i = path[0]
        return (*value[:i], poisoned(value[i], path[1:], place, bad), *value[i + 1 :])
    return replace(value, **{path[0]: poisoned(getattr(value, path[0]), path[1:], place, bad)})
