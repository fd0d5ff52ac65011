"""Every closed form of the lecture's light, rendered: each estimator that applies against the exact value.

One pixel looks at the origin of a little receiver from close by, through a pin-hole field of view; everything is
turned and moved by one rigid motion, and colours differ by channel, so that no symmetry hides a mistake. Truths lie
within 4.5 standard errors, from the exact variance where it is known. Scenes differ in numbers, not in the kinds of
things they contain (lights of radiance zero and balls far away make up for what one lacks), so few kernels do.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numba
import numpy as np
import pytest
from scipy import integrate

import raylab
from raylab import description as d
from raylab.closed_forms import irradiance as forms
from raylab.closed_forms import phong, variances
from raylab.ladders import frame

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="a quarter of a million samples each")

SAMPLES = 1 << 18
SIGMAS = 4.5
# Embree's vertices are float32: up to 2^-24 of the extent of a scene, which is some ten times the distances that
# count here; an irradiance changes four times as much at most (it goes with 1/r^2 and two cosines).
GEOMETRY = 40 * 2.0**-24
X, Y, Z = np.eye(3)
N = np.array([0.48, 0.6, 0.64])
RHO = np.array([0.2, 0.5, 0.8])
WHITE = np.ones(3)
LIGHT = np.array([1.0, 2.5, 0.5])


def rotation(axis, degrees):
    """Rodrigues' matrix about a unit axis."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    angle = math.radians(degrees)
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross


def affine(linear, offset=(0.0, 0.0, 0.0)):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, offset
    return matrix


POSE = affine(rotation(N, 77.0), (5.0, -3.0, 2.0))


# --- scenes ---


def mesh(*corners, radiance=None, **more):
    """A fan over the corners; the side from which they run counterclockwise is the front."""
    faces = np.array([[0, i, i + 1] for i in range(1, len(corners) - 1)])
    return d.Mesh(vertices=np.array(corners, np.float64), faces=faces, radiance=radiance, **{"front": None, **more})


def square(centre, n, half=(1.0, 1.0), **more):
    """A rectangle with half edges along the first two rows of frame(n), and normal n."""
    linear = frame(np.asarray(n, np.float64)).T @ np.diag([*half, 1.0])
    return d.Rectangle(to_world=affine(linear, centre), **{"front": None, **more})


def rectangle(corners, radiance):
    """A rectangle light with these corners, its front to the side from which they run counterclockwise."""
    centre, a, b = np.mean(corners, axis=0), (corners[1] - corners[0]) / 2.0, (corners[3] - corners[0]) / 2.0
    linear = np.stack([a, b, np.cross(a, b)], axis=1)
    return d.Rectangle(to_world=affine(linear, centre), radiance=radiance, front=None)


def sphere(centre, radius, radiance=None, **more):
    return d.Sphere(center=np.asarray(centre, np.float64), radius=radius, radiance=radiance, **{"front": None, **more})


def disk(centre, n, radius, radiance):
    return d.Disk(to_world=affine(frame(np.asarray(n, np.float64)).T * radius, centre), radiance=radiance, front=None)


def scene(shapes, material=None, n=Z, view=None, lights=(), environment=None):
    """One pixel over a receiver of half edge 0.01 at the origin, seen along -view."""
    material = material or d.Diffuse(RHO)
    view = np.asarray(n) + 0.4 * frame(np.asarray(n))[0] if view is None else np.asarray(view)
    view = view / np.linalg.norm(view)
    left, up, back = frame(view)
    receiver = square((0.0, 0.0, 0.0), n, (0.01, 0.01), front=material)
    camera = d.Camera(
        to_world=POSE @ affine(np.stack([left, -up, -back], axis=1), 0.05 * view), fov=0.01, width=1, height=1
    )
    moved = tuple(replace(shape, to_world=POSE @ shape.to_world) for shape in (receiver, *shapes))
    return raylab.Scene(
        d.SceneDescription(camera=camera, shapes=moved, lights=lights, environment=environment, sampler="independent")
    )


DARK = np.zeros(3)
BELOW = np.array([0.3, 0.2, -3.0])
DARK_LIGHTS = (  # one of each kind that a scene with fewer kinds would be compiled without
    mesh(BELOW, BELOW + X, BELOW + Y, radiance=DARK),
    mesh(BELOW, BELOW + X, BELOW + X + Y, BELOW + Y, radiance=DARK),
    square(BELOW, Z, radiance=DARK),
    disk(BELOW, Z, 1.0, DARK),
    sphere(BELOW, 0.5, DARK),
)


def lit(shapes, lights=(), **more):
    """A scene of area, point and directional lights."""
    dark = (
        d.PointLight((POSE @ [*BELOW, 1.0])[:3], DARK),
        d.DirectionalLight(np.array([1.0, 0.0, 0.0]), DARK),
    )
    return scene((*shapes, *DARK_LIGHTS), lights=(*lights, *dark), **more)


# --- checks ---


def check(image, truth, variance=None):
    """The mean within SIGMAS standard errors of the truth; `variance` is the exact one of a sample, per channel."""
    mean, truth = image.mean[0, 0], np.broadcast_to(np.asarray(truth, np.float64), 3)
    count = image.samples[0, 0]
    error = image.standard_error[0, 0] if variance is None else np.sqrt(np.asarray(variance) / count)
    assert image.invalid_samples == 0
    assert image.invalid_rays == 0
    assert count == SAMPLES
    deviation = np.abs(mean - truth)
    assert np.all(deviation <= SIGMAS * error + GEOMETRY * truth), f"mean {mean}, truth {truth}, standard error {error}"


def check_variance(image, variance, mean, largest):
    """The sample variance against the exact one; samples lie in [0, largest].

    Its relative standard error is sqrt((kurtosis - 1) / n), and kurtosis <= max(largest - mean, mean)^2 / variance.
    """
    kurtosis = max(largest - mean, mean) ** 2 / variance
    measured = image.standard_error[0, 0, 0] ** 2 * SAMPLES
    allowed = SIGMAS * math.sqrt((kurtosis - 1.0) / SAMPLES) + 2.0 * GEOMETRY
    assert abs(measured / variance - 1.0) <= allowed, f"variance {measured}, exact {variance}, allowed {allowed:.2%}"


def render(scene, shade, seed=1):
    return raylab.render(scene, shade, spp=SAMPLES, seed=seed)


# --- area lights ---

TRIANGLE = np.array([(0.1, 0.8, 0.7), (0.9, -0.1, 1.1), (-0.3, -0.5, 0.6)])
CENTRED = np.array([(-1, 0.5, 1), (1, 0.5, 1), (1, -0.5, 1), (-1, -0.5, 1.0)])
LOW = np.array([(-1, 0.9, 0.7), (1, 0.9, 0.7), (1, -0.5, 0.7), (-1, -0.5, 0.7)])
UPRIGHT = np.array([(0.7, -0.5, -0.8), (0.7, -0.5, 0.6), (0.7, 0.5, 0.6), (0.7, 0.5, -0.8)])
EDGE = forms.behind_edge((0.0, 0.0, 0.0), (0.1, 0.0, 0.5), (0.1, 1.0, 0.5), (-1.0, 0.0, 1.0))
HEXAGON = np.array([(math.cos(t) - 0.2, 1.0, math.sin(t) + 0.1) for t in np.arange(6) * math.pi / 3])
TILTED = np.array([0.6, 0.0, 0.8])


def half_plane(x, y, along):
    """A large square in z = 0.5 to the right of the line through (x, y) that runs `along`."""
    along = np.array([*along, 0.0])
    across = np.cross(along, Z)
    corner = np.array([x, y, 0.5]) - 6.0 * along
    return mesh(corner, corner + 9.0 * across, corner + 9.0 * across + 12.0 * along, corner + 12.0 * along)


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


# --- environments ---

SKIES = ["env_uniform", "env_cosine", "env_brightness", "env_brdf", "direct"]
AWAY = sphere((0.0, 0.0, -9.0), 0.5)
GRADIENT = np.array([(0.36, -0.24, 0.6), (0.1, 0.8, -0.3), (-0.2, 0.1, 0.3)])
# From the coordinates of an image to those of `forms.texels`: pole +z, longitude from +x.
TO_POLE = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def sky_scene(environment, ball=AWAY, **more):
    return scene([ball], environment=environment, **more)


def gradient(a, rows):
    """L(w) = a + rows . w before the rigid motion."""
    return d.GradientEnvironment(np.asarray(a, np.float64), np.asarray(rows) @ POSE[:3, :3].T)


def image_sky(pixels):
    """Texels of constant radiance, the pole along +z before the rigid motion."""
    return d.ImageEnvironment(np.asarray(pixels, np.float64), affine(POSE[:3, :3] @ TO_POLE), "nearest")


@pytest.mark.parametrize("shade", SKIES)
def test_constant_sky(shade):
    check(render(sky_scene(d.ConstantEnvironment(LIGHT), n=N), shade), RHO * LIGHT)


@pytest.mark.parametrize("shade", SKIES)
def test_ball_before_a_constant_sky(shade):
    truth = RHO / math.pi * LIGHT * forms.sphere_before_sky(1.0, 2.5, 0.8)
    check(render(sky_scene(d.ConstantEnvironment(LIGHT), sphere((1.5, 0, 2), 1.0)), shade), truth)
    truth = RHO / math.pi * LIGHT * forms.sphere_before_sky(1.0, 2.5, 0.2)
    check(render(sky_scene(d.ConstantEnvironment(LIGHT), sphere((0, 6**0.5, 0.5), 1.0)), shade), truth)


@pytest.mark.parametrize("shade", SKIES)
def test_gradient_sky(shade):
    a = np.array([1.1, 1.0, 0.5])
    truth = RHO / math.pi * np.array([forms.gradient_sky(c, row, N) for c, row in zip(a, GRADIENT, strict=True)])
    check(render(sky_scene(gradient(a, GRADIENT), n=N), shade), truth)


@pytest.mark.parametrize("shade", SKIES)
def test_image_sky(shade):
    """Nine rows of 20 degrees, light in the upper three: E = sum L n . V while no lit texel meets the horizon of n."""
    pixels = np.zeros((9, 16, 3))
    pixels[:3] = np.random.default_rng(7).random((3, 16, 3)) ** 3
    pixels[1, 5] = (40.0, 10.0, 20.0)
    n = np.array([0.2, -0.3, math.sqrt(0.87)])  # 21 degrees off the pole
    v, _ = forms.texels(9, 16)
    truth = RHO / math.pi * np.einsum("ijc,ijk,k->c", pixels, v, n)
    check(render(sky_scene(image_sky(pixels), n=n), shade), truth)


CAP = np.zeros((9, 16, 3))
CAP[0] = 1.0  # radiance 1 within 20 degrees of the pole
ANGLE = math.radians(20.0)
UPWARDS = 0.5 * np.array([Z, Z, Z])
EXACT = {  # environment, exact variance, mean, largest sample: all for reflectance 1
    ("constant", "env_uniform"): (variances.env_uniform_gradient(1.0, 0.0), 1.0, 2.0),
    ("constant", "env_brightness"): (variances.env_uniform_gradient(1.0, 0.0), 1.0, 2.0),
    ("gradient", "env_uniform"): (variances.env_uniform_gradient(1.1, 0.5), 1.1 + 1.0 / 3.0, 3.2),
    ("gradient", "env_cosine"): (variances.env_cosine_gradient(0.5), 1.1 + 1.0 / 3.0, 1.6),
    ("gradient", "env_brdf"): (variances.env_cosine_gradient(0.5), 1.1 + 1.0 / 3.0, 1.6),
    ("gradient", "env_brightness"): (
        variances.env_brightness_gradient_sphere(1.1, 0.5),
        1.1 + 1.0 / 3.0,
        4.4,
    ),
    ("cap", "env_uniform"): (variances.env_uniform_cap(ANGLE), math.sin(ANGLE) ** 2, 2.0),
    ("cap", "env_cosine"): (variances.env_cosine_cap(ANGLE), math.sin(ANGLE) ** 2, 1.0),
    ("cap", "env_brightness"): (
        variances.cone_cap(ANGLE),
        math.sin(ANGLE) ** 2,
        4.0 * math.sin(ANGLE / 2.0) ** 2,
    ),
}


@pytest.mark.parametrize(("kind", "shade"), EXACT)
def test_variance_under_a_sky(kind, shade):
    environment = {
        "constant": d.ConstantEnvironment(WHITE),
        "gradient": gradient(1.1 * WHITE, UPWARDS),
        "cap": image_sky(CAP),
    }[kind]
    exact, mean, largest = EXACT[kind, shade]
    image = render(sky_scene(environment, material=d.Diffuse(WHITE)), shade)
    check(image, mean, exact)
    check_variance(image, exact, mean, largest)


@pytest.mark.parametrize("shade", ["env_cosine", "env_brdf"])
def test_cosine_sampling_of_a_constant_sky_has_no_variance(shade):
    image = render(sky_scene(d.ConstantEnvironment(LIGHT)), shade)
    assert image.standard_error.max() <= 4 * 2.0**-53 * LIGHT.max()
    np.testing.assert_allclose(image.mean[0, 0], RHO * LIGHT, rtol=SAMPLES * 2.0**-53)


# --- Phong ---


def glossy(exponent, specular=RHO, diffuse=DARK):
    return d.Phong(diffuse_reflectance=diffuse, specular_reflectance=specular, exponent=exponent)


def view_of(n, cosine):
    """A view whose mirror direction has that cosine to n, and the mirror direction."""
    s, _, n = frame(np.asarray(n))
    sine = math.sqrt(1.0 - cosine**2)
    return cosine * n + sine * s, cosine * n - sine * s


@pytest.mark.parametrize("cosine", [1.0, 0.6, 0.3])
@pytest.mark.parametrize("shade", ["env_brightness", "env_brdf", "direct"])
def test_phong_under_a_constant_sky(shade, cosine):
    view, _ = view_of(N, cosine)
    material = glossy(10.0, 0.5 * RHO, 0.4 * RHO)
    truth = LIGHT * RHO * (0.4 + 0.5 * phong.constant_sky(10, cosine))
    check(render(sky_scene(d.ConstantEnvironment(LIGHT), material=material, n=N, view=view), shade), truth)


@pytest.mark.parametrize("shade", ["env_brdf", "direct"])
def test_phong_under_a_gradient_sky(shade):
    """A mixture of 0.4 diffuse and 0.5 of a lobe of exponent 10 under 1.1 + 0.5 z, seen along the normal."""
    material = glossy(10.0, 0.5 * RHO, 0.4 * RHO)
    truth = RHO * (0.4 * (1.1 + 1.0 / 3.0) + 0.5 * phong.gradient_sky(10, 1.1, 0.5))
    check(render(sky_scene(gradient(1.1 * WHITE, UPWARDS), material=material, view=Z), shade), truth)


@pytest.mark.parametrize("exponent", [1, 7, 20])
@pytest.mark.parametrize("shade", ["area", "direct"])
def test_phong_under_a_polygon(shade, exponent):
    view, r = view_of(Z, 0.8)
    for corners in (TRIANGLE, UPRIGHT):
        light = mesh(*corners, radiance=LIGHT) if len(corners) == 3 else rectangle(corners, LIGHT)
        truth = RHO * LIGHT * phong.polygon(corners, exponent, r)
        check(render(lit([light], material=glossy(exponent), view=view), shade), truth)


@pytest.mark.parametrize("shade", ["env_brdf", "env_brightness"])
def test_variance_of_a_lobe_of_exponent_20(shade):
    """By itself 1 / ((n + 1)(n + 3)); by a uniform hemisphere, as constant skies are, (n + 2)^2 / (2 n + 3) - 1."""
    known = {
        "env_brdf": (variances.phong_brdf(20), 22.0 / 21.0),
        "env_brightness": (variances.phong_uniform(20), 22.0),
    }
    exact, largest = known[shade]
    image = render(sky_scene(d.ConstantEnvironment(WHITE), material=glossy(20.0, WHITE), view=Z), shade)
    check(image, 1.0, exact)
    check_variance(image, exact, 1.0, largest)


# --- two estimators of one scene ---


def agree(scene, first, second):
    a, b = render(scene, first, seed=3), render(scene, second, seed=4)
    error = np.hypot(a.standard_error, b.standard_error)
    assert np.all(np.abs(a.mean - b.mean) <= SIGMAS * error), f"{first}: {a.mean}, {second}: {b.mean}, +- {error}"


@pytest.mark.parametrize("shade", SKIES[1:])
def test_estimators_agree_behind_a_ball_and_a_plate(shade):
    """A lopsided sky behind a ball that the horizon cuts and a plate: no closed form."""
    blocked = scene(
        [sphere((0.6, 0.9, 0.7), 0.8), half_plane(-0.4, 0.0, (0, -1))],
        environment=gradient([1.1, 1.0, 0.5], GRADIENT),
    )
    agree(blocked, "env_uniform", shade)


def test_light_sampling_and_both_agree_on_a_glossy_surface():
    view, _ = view_of(Z, 0.7)
    shapes = [
        rectangle(UPRIGHT, LIGHT),
        sphere((-0.8, 0.4, 0.8), 0.3, 3.0 * LIGHT),
        half_plane(0.1, 0.075, (-0.6, 0.8)),
    ]
    agree(lit(shapes, material=glossy(30.0, 0.5 * RHO, 0.3 * RHO), view=view), "area", "direct")
