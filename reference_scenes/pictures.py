"""Scenes whose pictures are known in closed form: radiance along any eye ray, `radiance(o, d)` -> (n, 3).

o (3,) is the eye and d (n, 3) are directions. Each function finds what the ray meets by hand and takes the irradiance
there from `raylab.closed_forms`; nothing of raylab's ray tracing, shading or sampling is used. Numbers repeat those
of the scene files.
"""

from __future__ import annotations

from collections.abc import Callable

import make_assets
import numpy as np
import numpy.typing as npt

import raylab
from raylab.closed_forms import irradiance as forms
from raylab.sensor import half_extents

Array = npt.NDArray[np.float64]
UP = np.array([0.0, 1.0, 0.0])


def view(scene: raylab.Scene, dx: float, dy: float, radiance: Callable[[Array, Array], Array]) -> Array:
    """(h, w, 3): the picture with one eye ray through each pixel, at (dx, dy) in [0, 1)^2 from its upper left."""
    camera = scene.description.camera
    tan_x, tan_y = half_extents(camera)
    x = tan_x * (1.0 - 2.0 * (np.arange(camera.width) + dx) / camera.width)
    y = tan_y * (1.0 - 2.0 * (np.arange(camera.height) + dy) / camera.height)
    left, up, forward, o = camera.to_world[:3].T
    d = forward + x[None, :, None] * left + y[:, None, None] * up
    return radiance(o, d.reshape(-1, 3)).reshape(camera.height, camera.width, 3)


def plane(o: Array, d: Array, axis: int, height: float) -> tuple[Array, Array]:
    """Distances (n,) to the plane where coordinate `axis` is `height`, inf behind the eye, and the points (n, 3)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (height - o[axis]) / d[:, axis]
        t = np.where(t > 0.0, t, np.inf)
        return t, np.where(np.isfinite(t)[:, None], o + t[:, None] * d, 0.0)


def ball(o: Array, d: Array, centre: Array, radius: float) -> tuple[Array, Array]:
    """Distances (n,) to the front of a sphere, inf for a miss, and unit normals (n, 3) there."""
    a, b, c = (d * d).sum(axis=1), d @ (o - centre), ((o - centre) ** 2).sum() - radius**2
    room = b * b - a * c
    t = np.where(room >= 0.0, (-b - np.sqrt(np.maximum(room, 0.0))) / a, np.inf)
    t = np.where(t > 0.0, t, np.inf)
    points = np.where(np.isfinite(t)[:, None], o + np.where(np.isfinite(t), t, 0.0)[:, None] * d, centre + radius * UP)
    return t, (points - centre) / radius


def rgb(values: Array, colour: npt.ArrayLike) -> Array:
    """(n, 3): `colour` times `values` (n,)."""
    return np.multiply.outer(values, np.asarray(colour))


def reflected(irradiance: Array, reflectance: npt.ArrayLike, radiance: npt.ArrayLike) -> Array:
    """(n, 3): rho / pi L E."""
    return rgb(irradiance / np.pi, np.asarray(reflectance) * np.asarray(radiance))


# --- Cornell CS667 ---


def cs667_sphere(o: Array, d: Array, centre: Array, radiance: float) -> Array:
    _, x = plane(o, d, 1, 0.0)
    to_centre = centre - x
    distance = np.linalg.norm(to_centre, axis=1)
    return reflected(forms.sphere(1.0, distance, to_centre[:, 1] / distance), np.full(3, 0.5), radiance)


def cs667_sphere_normal(o: Array, d: Array) -> Array:
    """rho L (R / d)^2 = 0.4 at the centre of the pixel, averaged over the pixel by quadrature"""
    return cs667_sphere(o, d, np.array([0.0, 5.0, 0.0]), 20.0)


def cs667_sphere_grazing(o: Array, d: Array) -> Array:
    """rho L / pi (atan(1 / sqrt 24) - sqrt 24 / 25) = 0.171847 at the centre of the pixel, averaged by quadrature"""
    return cs667_sphere(o, d, np.array([5.0, 0.0, 0.0]), 200.0)


def cs667_triangle_normal(o: Array, d: Array) -> Array:
    """rho L / 2 pi |sum Theta n . Gamma| = 0.162163 at the centre of the pixel, averaged by quadrature"""
    _, x = plane(o, d, 1, 0.0)
    light = np.array([(0.0, 5.0, 1.0), (-0.8660, 5.0, -0.5), (0.8660, 5.0, -0.5)])
    return reflected(forms.polygon(light, x, np.broadcast_to(UP, x.shape)), np.full(3, 0.5), 20.0)


# --- pictures ---


def light_below_horizon(o: Array, d: Array) -> Array:
    """Lambert's polygon formula after clipping the light at the horizon of the table, averaged over each pixel"""
    colour = np.array([1.0, 0.42, 0.10])
    phi = 2.0 * np.pi * np.arange(12) / 12
    light = np.stack([1.6 * np.cos(phi), 1.6 * np.sin(phi) - 0.25, np.full(12, -0.3)], axis=1)
    to_table, x = plane(o, d, 1, 0.0)
    to_light, y = plane(o, d, 2, -0.3)
    on_table = np.isfinite(to_table) & (np.abs(x[:, 0]) <= 4.0) & (x[:, 2] >= 0.0) & (x[:, 2] <= 7.0)
    inward = np.roll(light, -1, axis=0)[:, [1, 0]] - light[:, [1, 0]]
    inside = (((y[:, None, :2] - light[:, :2]) * inward * [-1.0, 1.0]).sum(axis=-1) >= 0.0).all(axis=1)
    in_light = np.isfinite(to_light) & inside & ~(on_table & (to_table < to_light))
    result = np.where(in_light[:, None], colour, 0.0)
    rows = on_table & ~in_light
    normals = np.broadcast_to(UP, x[rows].shape)
    result[rows] = reflected(forms.polygon(light, x[rows], normals), [0.85, 0.80, 0.80], colour)
    return result


def touching_light(o: Array, d: Array) -> Array:
    """Lambert's polygon formula for a light that stands on the floor, averaged over each pixel"""
    colour = np.array([1.0, 0.86, 0.62])
    light = np.array([(-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 2.0, 0.0), (-1.0, 2.0, 0.0)])
    to_floor, x = plane(o, d, 1, 0.0)
    to_light, y = plane(o, d, 2, 0.0)
    in_light = np.isfinite(to_light) & (np.abs(y[:, 0]) <= 1.0) & (y[:, 1] >= 0.0) & (y[:, 1] <= 2.0)
    on_floor = np.isfinite(to_floor) & (np.abs(x[:, 0]) <= 4.0) & (x[:, 2] <= 4.0)
    result = np.where(in_light[:, None], colour, 0.0)
    rows = on_floor & (x[:, 2] > 0.0) & ~in_light  # its back is black
    normals = np.broadcast_to(UP, x[rows].shape)
    result[rows] = reflected(forms.polygon(light, x[rows], normals), [0.72, 0.70, 0.66], colour)
    return result


def edge_occluder(o: Array, d: Array) -> Array:
    """Lambert's polygon formula for what the edge of the roof leaves of the light, averaged over each pixel"""
    light = np.array([(-2.0, 2.5, -1.0), (-1.0, 2.5, -1.0), (-1.0, 2.5, 1.0), (-2.0, 2.5, 1.0)])
    radiance = [14.0, 13.2, 11.8]
    to_roof, roof = plane(o, d, 1, 0.5)
    _, floor = plane(o, d, 1, 0.0)
    on_roof = np.isfinite(to_roof) & (roof[:, 0] <= 0.0)
    x = np.where(on_roof[:, None], roof, floor)
    n = np.broadcast_to(UP, x.shape)
    below = ~on_roof
    result = np.zeros_like(x)
    result[on_roof] = reflected(forms.polygon(light, x[on_roof], n[on_roof]), [0.48, 0.15, 0.09], radiance)
    edge = forms.behind_edge(x[below], (0.0, 0.5, -12.0), (0.0, 0.5, 12.0), (12.0, 0.5, 0.0))
    result[below] = reflected(forms.polygon(light, x[below], n[below], [edge]), [0.75, 0.72, 0.66], radiance)
    return result


def ball_under_sky(o: Array, d: Array) -> Array:
    """pi minus what the ball or the sheet hides of the sky, averaged over each pixel"""
    sky = np.array([0.50, 0.66, 0.88])
    sheet = np.array([(-3.0, 0.0, -3.0), (3.0, 0.0, -3.0), (3.0, 0.0, 3.0), (-3.0, 0.0, 3.0)])
    centre = UP
    to_sheet, x = plane(o, d, 1, 0.0)
    to_ball, n = ball(o, d, centre, 1.0)
    on_ball = np.isfinite(to_ball)
    on_sheet = ~on_ball & np.isfinite(to_sheet) & (np.abs(x[:, 0]) <= 3.0) & (np.abs(x[:, 2]) <= 3.0)
    result = np.broadcast_to(sky, x.shape).copy()
    distance = np.linalg.norm(centre - x[on_sheet], axis=1)
    result[on_sheet] = reflected(forms.sphere_before_sky(1.0, distance, 1.0 / distance), [0.88, 0.84, 0.76], sky)
    hidden = forms.polygon(sheet, centre + n[on_ball], n[on_ball])
    result[on_ball] = reflected(np.pi - hidden, [0.85, 0.32, 0.15], sky)
    return result


def many_lights(o: Array, d: Array) -> Array:
    """The sum over all lamps of the closed form for a disk parallel to the floor, averaged over each pixel"""
    centres, radiances = make_assets.lamps()
    radius, height = make_assets.LAMP_RADIUS, make_assets.LAMP_HEIGHT
    _, above = plane(o, d, 1, height)
    to_floor, x = plane(o, d, 1, 0.0)
    on_floor = np.isfinite(to_floor) & (np.abs(x[:, 0]) <= 12.0) & (np.abs(x[:, 2]) <= 12.0)
    behind_lamp = (np.hypot(*(above[:, None, [0, 2]] - centres).T) <= radius).any(axis=0)  # their backs are black
    lit = on_floor & ~behind_lamp
    offsets = np.hypot(*(x[lit][:, None, [0, 2]] - centres).T).T
    result = np.zeros_like(x)
    result[lit] = 0.6 / np.pi * forms.disk_parallel(radius, height, offsets) @ radiances
    return result


PICTURES: dict[str, Callable[[Array, Array], Array]] = {
    form.__name__: form
    for form in (
        cs667_sphere_normal,
        cs667_sphere_grazing,
        cs667_triangle_normal,
        light_below_horizon,
        touching_light,
        edge_occluder,
        ball_under_sky,
        many_lights,
    )
}
