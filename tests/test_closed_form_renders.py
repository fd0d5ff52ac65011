"""Every closed form of the lecture's lights, rendered: each estimator that applies against the exact value.

Truths lie within 4.5 standard errors, from the exact variance where it is known.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from receiver import (
    CENTRED,
    EDGE,
    GEOMETRY,
    LIGHT,
    POSE,
    RHO,
    TRIANGLE,
    UPRIGHT,
    WHITE,
    N,
    Z,
    affine,
    agree,
    check,
    check_variance,
    disk,
    glossy,
    half_plane,
    lit,
    mesh,
    rectangle,
    render,
    sphere,
    view_of,
)
from scipy import integrate

import raylab
from raylab import description as d
from raylab.closed_forms import irradiance as forms
from raylab.closed_forms import phong, variances

pytestmark = pytest.mark.compiled(reason="a quarter of a million samples each")

# --- area lights ---

LOW = np.array([(-1, 0.9, 0.7), (1, 0.9, 0.7), (1, -0.5, 0.7), (-1, -0.5, 0.7)])
HEXAGON = np.array([(math.cos(t) - 0.2, 1.0, math.sin(t) + 0.1) for t in np.arange(6) * math.pi / 3])
TILTED = np.array([0.6, 0.0, 0.8])


AREA = {  # shapes, normal, irradiance for radiance 1
    "triangle": ([mesh(*TRIANGLE, radiance=LIGHT)], Z, forms.polygon(TRIANGLE)),
    "triangle, oblique receiver": ([mesh(*TRIANGLE, radiance=LIGHT)], N, forms.polygon(TRIANGLE, n=N)),
    "rectangle": ([rectangle(CENTRED, LIGHT)], Z, 4.0 * forms.rectangle_parallel(1.0, 0.5, 1.0)),
    "rectangle cut by the horizon": ([rectangle(LOW, LIGHT)], TILTED, forms.polygon(LOW, n=TILTED)),
    "rectangle through the horizon": ([rectangle(UPRIGHT, LIGHT)], Z, forms.polygon(UPRIGHT)),
    "hexagon through the horizon": ([mesh(*HEXAGON, radiance=LIGHT)], Z, forms.polygon(HEXAGON)),
    "edge occluder": (
        [rectangle(CENTRED, LIGHT), half_plane(0.1, 0.0, (0, 1))],
        Z, forms.polygon(CENTRED, keep=[EDGE]),
    ),
    "oblique edge occluder": (
        [rectangle(CENTRED, LIGHT), half_plane(0.1, 0.075, (-0.6, 0.8))],
        Z, forms.polygon(CENTRED, keep=[((-0.8, -0.6, 0.25), 0.0)]),
    ),
    "coaxial disk": ([disk((0, 0, 1), -Z, 1.5, LIGHT)], Z, forms.disk_coaxial(1.5, 1.0)),
    "parallel disk": ([disk((0.6, 0, 1), -Z, 0.8, LIGHT)], Z, forms.disk_parallel(0.8, 1.0, 0.6)),
    "perpendicular disk": ([disk((0, -1, 1.2), (0, 1, 0), 0.8, LIGHT)], Z, forms.disk_perpendicular(0.8, 1.0, 1.2)),
    "sphere above": ([sphere((1.5, 0, 2), 1.0, LIGHT)], Z, forms.sphere(1.0, 2.5, 0.8)),
    "sphere cut by the horizon": ([sphere((0, 6**0.5, 0.5), 1.0, LIGHT)], Z, forms.sphere(1.0, 2.5 * 1.0, 0.2)),
    "sphere, centre below": ([sphere((6**0.5, 0, -0.5), 1.0, LIGHT)], Z, forms.sphere(1.0, 2.5, -0.2)),
    "two lights": (
        [rectangle(UPRIGHT, LIGHT), disk((0, 0, 1), -Z, 0.5, LIGHT)],
        Z, forms.polygon(UPRIGHT) + forms.disk_coaxial(0.5, 1.0),
    ),
    "wrong side": ([rectangle(CENTRED[::-1], LIGHT), disk((0.6, 0, 1), Z, 0.8, LIGHT)], Z, 0.0),
    "below": ([rectangle(CENTRED - 2.0 * Z, LIGHT), sphere((0, 0, -2), 1.0, LIGHT)], Z, 0.0),
}  # fmt: skip


@pytest.mark.parametrize("case", AREA)
@pytest.mark.parametrize("shade", ["area_diffuse", "area", "area_solid_angle", "direct"])
def test_area_lights(case, shade):
    shapes, n, irradiance = AREA[case]
    check(render(lit(shapes, n=n), shade), RHO / math.pi * LIGHT * irradiance)


@pytest.mark.parametrize("room", ["cube", "ball"])
def test_the_walls_of_a_luminous_room(room):
    """Inside a closed room of radiance L a surface reflects rho L, and the walls shine with L (1 + rho)."""
    if room == "cube":
        wall = d.Cube(to_world=affine(np.eye(3), (0.1, 0.2, 0.3)), flip_normals=True, radiance=LIGHT, front=None)
    else:
        wall = sphere((0.1, 0.2, 0.3), 1.5, LIGHT, flip_normals=True)
    check(render(lit([wall], n=N), "area"), RHO * LIGHT)
    looking = lit([replace(wall, front=d.Diffuse(RHO))])
    camera = replace(looking.description.camera, to_world=POSE)
    inside = raylab.Scene(replace(looking.description, camera=camera, shapes=looking.description.shapes[1:]))
    check(render(inside, "area"), LIGHT * (1.0 + RHO))


@pytest.mark.parametrize("height", [0.3, 1.0, 3.0])
def test_variance_of_a_disk_by_area(height):
    """Relative variance -> R^2 / (3 h^2) for a disk that is large, or near."""
    exact, mean = variances.area_disk(1.5, height), forms.disk_coaxial(1.5, height) / math.pi
    image = render(lit([disk((0, 0, height), -Z, 1.5, WHITE)], material=d.Diffuse(WHITE)), "area")
    check(image, mean, exact)
    check_variance(image, exact, mean, (1.5 / height) ** 2)


def test_variance_of_a_sphere_by_its_cone():
    angle = math.asin(1.0 / 2.5)
    exact, mean = variances.cone_cap(angle), math.sin(angle) ** 2
    image = render(lit([sphere((0, 0, 2.5), 1.0, WHITE)], material=d.Diffuse(WHITE)), "area_diffuse")
    check(image, mean, exact)
    check_variance(image, exact, mean, 4.0 * math.sin(angle / 2.0) ** 2)


@pytest.mark.parametrize("visible", [1.0, 0.2])
def test_variance_of_a_rectangle(visible):
    """A uniform point of the rectangle 2 x 1 at height 1, all of it or x < 0.2 to be seen: E f^2 by quadrature."""

    def square_of(y, x):
        return (2.0 / math.pi / (1.0 + x * x + y * y) ** 2) ** 2 / 2.0

    second, _ = integrate.dblquad(square_of, -1.0, visible, -0.5, 0.5)
    blocker = [half_plane(0.5 * visible, 0.0, (0, 1))] if visible < 1.0 else []
    keep = [EDGE] if visible < 1.0 else []
    mean = float(forms.polygon(CENTRED, keep=keep)) / math.pi
    image = render(lit([rectangle(CENTRED, WHITE), *blocker], material=d.Diffuse(WHITE)), "area")
    check(image, mean, second - mean**2)
    check_variance(image, second - mean**2, mean, 2.0 / math.pi)


@pytest.mark.parametrize("height", [0.1, 0.5, 2.0])
@pytest.mark.parametrize("shape", ["disk", "rectangle"])
def test_variance_by_solid_angle(shape, height):
    """g = Omega cos / pi: E g^2 = Omega / pi^2 times the integral of cos^2 over the light's directions.

    By area, g = A cos cos / (pi r^2): the same light at height 0.1 has more than 100 times the variance.
    """
    if shape == "disk":
        angle = math.atan2(1.5, height)
        light, largest = disk((0, 0, height), -Z, 1.5, WHITE), 4.0 * math.sin(angle / 2.0) ** 2
        exact, mean = variances.cone_cap(angle), forms.disk_coaxial(1.5, height) / math.pi
        by_area = variances.area_disk(1.5, height)
    else:
        light = rectangle(CENTRED * [1, 1, height], WHITE)
        mean = 4.0 * forms.rectangle_parallel(1.0, 0.5, height) / math.pi

        def integral(power, sharp):
            """Of h^power / r^sharp over the light."""

            def inner(y, x):
                return height**power / (x * x + y * y + height**2) ** (sharp / 2.0)

            return 4.0 * integrate.dblquad(inner, 0.0, 1.0, 0.0, 0.5, epsabs=1e-10)[0]

        omega = integral(1, 3)
        largest, exact = omega / math.pi, omega * integral(3, 5) / math.pi**2 - mean**2
        by_area = 2.0 * integral(4, 8) / math.pi**2 - mean**2
    image = render(lit([light], material=d.Diffuse(WHITE)), "area_solid_angle")
    check(image, mean, exact)
    check_variance(image, exact, mean, largest)
    assert by_area / exact > (100.0 if height < 0.2 else 1.0)


# --- lights without area ---


@pytest.mark.parametrize("shade", ["point_light", "directional_light", "direct"])
def test_lights_without_area(shade):
    """I cos / r^2 with I = 5 at (1, 2, 2) is 10/27, I cos with I = 3 from (0.6, 0, 0.8) is 2.4. One sample is exact."""
    towards = POSE[:3, :3] @ [-0.6, 0.0, -0.8]
    lights = (
        d.PointLight((POSE @ [1.0, 2.0, 2.0, 1.0])[:3], 5.0 * LIGHT),
        d.DirectionalLight(towards, 3.0 * LIGHT),
    )
    point, parallel = 10.0 / 27.0, 2.4
    truth = {"point_light": point, "directional_light": parallel, "direct": point + parallel}[shade]
    image = raylab.render(lit([], lights), shade, spp=16)
    np.testing.assert_allclose(image.mean[0, 0], RHO / math.pi * LIGHT * truth, rtol=GEOMETRY)


def test_a_blocker_takes_lights_without_area_away():
    """Both stand on the side of +x; a plate over x > 0.1 in z = 0.5 hides them, one over x < -0.1 does not."""
    towards = POSE[:3, :3] @ [-0.6, 0.0, -0.8]
    lights = (d.PointLight((POSE @ [1.0, 2.0, 2.0, 1.0])[:3], LIGHT), d.DirectionalLight(towards, LIGHT))
    for shade in ("point_light", "directional_light"):
        assert not raylab.render(lit([half_plane(0.1, 0.0, (0, 1))], lights), shade, spp=16).mean.any()
        open_sky = raylab.render(lit([], lights), shade, spp=16).mean
        beside = raylab.render(lit([half_plane(-0.1, 0.0, (0, -1))], lights), shade, spp=16).mean
        np.testing.assert_allclose(beside, open_sky, rtol=GEOMETRY)


# --- Phong ---


@pytest.mark.parametrize("exponent", [1, 7, 20])
@pytest.mark.parametrize("shade", ["area", "direct"])
def test_phong_under_a_polygon(shade, exponent):
    view, r = view_of(Z, 0.8)
    for corners in (TRIANGLE, UPRIGHT):
        light = mesh(*corners, radiance=LIGHT) if len(corners) == 3 else rectangle(corners, LIGHT)
        truth = RHO * LIGHT * phong.polygon(corners, exponent, r)
        check(render(lit([light], material=glossy(exponent), view=view), shade), truth)


def test_light_sampling_and_both_agree_on_a_glossy_surface():
    view, _ = view_of(Z, 0.7)
    shapes = [
        rectangle(UPRIGHT, LIGHT),
        sphere((-0.8, 0.4, 0.8), 0.3, 3.0 * LIGHT),
        half_plane(0.1, 0.075, (-0.6, 0.8)),
    ]
    agree(lit(shapes, material=glossy(30.0, 0.5 * RHO, 0.3 * RHO), view=view), "area", "direct")
