"""One pixel of a little receiver at the origin, its lights and skies, and checks of what it shows.

It is seen from close by through a pin-hole field of view; everything is turned and moved by one rigid motion, and
colours differ by channel, so that no symmetry hides a mistake. Scenes differ in numbers, not in the kinds of things
they contain (lights of radiance zero and balls far away make up for what one lacks), so few kernels do.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

import raylab
from raylab import description as d
from raylab.closed_forms import irradiance as forms
from raylab.ladders import frame

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


TRIANGLE = np.array([(0.1, 0.8, 0.7), (0.9, -0.1, 1.1), (-0.3, -0.5, 0.6)])
CENTRED = np.array([(-1, 0.5, 1), (1, 0.5, 1), (1, -0.5, 1), (-1, -0.5, 1.0)])
UPRIGHT = np.array([(0.7, -0.5, -0.8), (0.7, -0.5, 0.6), (0.7, 0.5, 0.6), (0.7, 0.5, -0.8)])
EDGE = forms.behind_edge((0.0, 0.0, 0.0), (0.1, 0.0, 0.5), (0.1, 1.0, 0.5), (-1.0, 0.0, 1.0))


def half_plane(x, y, along):
    """A large square in z = 0.5 to the right of the line through (x, y) that runs `along`."""
    along = np.array([*along, 0.0])
    across = np.cross(along, Z)
    corner = np.array([x, y, 0.5]) - 6.0 * along
    return mesh(corner, corner + 9.0 * across, corner + 9.0 * across + 12.0 * along, corner + 12.0 * along)


def glossy(exponent, specular=RHO, diffuse=DARK):
    return d.Phong(diffuse_reflectance=diffuse, specular_reflectance=specular, exponent=exponent)


def view_of(n, cosine):
    """A view whose mirror direction has that cosine to n, and the mirror direction."""
    s, _, n = frame(np.asarray(n))
    sine = math.sqrt(1.0 - cosine**2)
    return cosine * n + sine * s, cosine * n - sine * s


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


def agree(scene, first, second):
    a, b = render(scene, first, seed=3), render(scene, second, seed=4)
    error = np.hypot(a.standard_error, b.standard_error)
    assert np.all(np.abs(a.mean - b.mean) <= SIGMAS * error), f"{first}: {a.mean}, {second}: {b.mean}, +- {error}"
