"""From the described camera to the record that makes its eye rays."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab import keyframes
from raylab.camera import MovingCamera, Pinhole, ThinLens, first_depth, make_aperture, make_filter
from raylab.defects import RANGE
from raylab.errors import SceneError
from raylab.geometry import Placement
from raylab.motion import Moving
from raylab.pose import LINEAR
from raylab.vec3 import Vec3
from raylab.view import View

Array = npt.NDArray[np.float64]
WIDEST = 1e12  # radius of an aperture over its focus distance: beyond, eye rays have no direction but sideways
WIDEST_FILTER = 1e9  # pixels


def has_lens(camera: d.Camera) -> bool:
    """Whether the aperture has a size; without one the camera is a pinhole, bit for bit."""
    return camera.aperture_radius > 0.0


def make_camera(camera: d.Camera, placement: Placement, motion: Any = None) -> Pinhole | ThinLens | MovingCamera:
    """The camera record in normalised coordinates; SceneError for a camera that sees nothing."""
    check_camera(camera)
    check_place(camera, placement)
    if camera.motion is not None and isinstance(motion, Moving):
        return make_moving_camera(camera, placement)
    eye = pinhole(camera, placement)
    if not has_lens(camera):
        return eye
    left, up, _ = axes(camera)
    radius = camera.aperture_radius * placement.scale
    aperture = make_aperture(radius, camera.aperture_blades, camera.aperture_rotation)
    return ThinLens(
        origin=eye.origin,
        corner=eye.corner,
        across=eye.across,
        down=eye.down,
        start=eye.start,
        far=eye.far,
        wide=aperture.radius > 2.0,
        left=Vec3(*left),
        up=Vec3(*up),
        aperture=aperture,
        power=1.0 / (camera.focus_distance * placement.scale),
        filter=eye.filter,
    )


def make_moving_camera(camera: d.Camera, placement: Placement) -> MovingCamera:
    """The record of a camera that moves while the shutter is open."""
    assert camera.motion is not None
    matrices = np.array(camera.motion.matrices, np.float64)
    matrices[:, :3, :3] /= np.linalg.norm(matrices[:, :3, :3], axis=1, keepdims=True)
    still = make_camera(replace(camera, to_world=np.eye(4), motion=None), Placement(np.zeros(3), placement.scale))
    motion, shutter = replace(camera.motion, matrices=matrices), (camera.shutter_open, camera.shutter_close)
    rows = keyframes.table(motion, shutter, np.eye(4), placement.centre, placement.scale)
    rows[:, LINEAR] /= placement.scale  # directions keep their length
    return MovingCamera(still, View(rows))


def axes(camera: d.Camera) -> Array:
    """(3, 3): the unit vectors left, up and forward, one to a row."""
    matrix = np.asarray(camera.to_world, np.float64)
    return np.stack([matrix[:3, k] / np.linalg.norm(matrix[:3, k]) for k in range(3)])


def pinhole(camera: d.Camera, placement: Placement) -> Pinhole:
    """The record of a camera with a point aperture."""
    matrix = np.asarray(camera.to_world, np.float64)
    tan_x, tan_y = half_extents(camera)
    offset_x, offset_y = camera.principal_point_offset
    left, up, forward = axes(camera)
    corner = forward + left * tan_x * (1.0 - 2.0 * offset_x) + up * tan_y * (1.0 - 2.0 * offset_y)
    across, down = left * (-2.0 * tan_x / camera.width), up * (-2.0 * tan_y / camera.height)
    origin = placement.points(matrix[:3, 3])
    return Pinhole(
        origin=Vec3(*origin),
        corner=Vec3(*corner),
        across=Vec3(*across),
        down=Vec3(*down),
        start=first_depth(camera.near_clip * placement.scale, Vec3(*origin), Vec3(*left), Vec3(*up), Vec3(*forward)),
        far=camera.far_clip * placement.scale,
        filter=make_filter(camera.filter),
    )


def check_place(camera: d.Camera, placement: Placement) -> None:
    """SceneError for a distance whose square, or the inverse of it, is none in float64, in units of the scene."""
    matrices = np.asarray([camera.to_world] if camera.motion is None else camera.motion.matrices, np.float64)
    with np.errstate(over="ignore"):
        reach = float(np.abs(placement.points(matrices[:, :3, 3])).max())
    if not reach <= RANGE:
        raise SceneError(
            f"camera: it stands {reach:.3g} times the size of the scene away, at most {RANGE:.2g} is possible"
        )
    if has_lens(camera) and camera.focus_distance * placement.scale < 1.0 / RANGE:
        raise SceneError(
            f"camera: focus_distance must be at least {1.0 / RANGE:.2g} times the size of the scene, "
            f"got {camera.focus_distance}"
        )


def check_camera(camera: d.Camera) -> None:
    if camera.width < 1 or camera.height < 1:
        raise SceneError(f"camera: the film must have at least one pixel, got {camera.width} x {camera.height}")
    if not 0.0 < camera.fov < 180.0:
        raise SceneError(f"camera: fov must be between 0 and 180 degrees, got {camera.fov}")
    if not 0.0 <= camera.near_clip < camera.far_clip:
        raise SceneError(f"camera: expected 0 <= near_clip < far_clip, got {camera.near_clip}, {camera.far_clip}")
    matrix = np.asarray(camera.to_world)
    if matrix.shape != (4, 4) or not np.all(np.isfinite(matrix)) or abs(np.linalg.det(matrix[:3, :3])) < 1e-12:
        raise SceneError(f"camera: to_world must be a finite, invertible (4, 4) matrix, got\n{matrix}")
    if not np.all(np.isfinite(camera.principal_point_offset)):
        raise SceneError(f"camera: principal_point_offset must be finite, got {camera.principal_point_offset}")
    check_filter(camera.filter)
    if not 0.0 <= camera.aperture_radius < math.inf:
        raise SceneError(f"camera: aperture_radius must be finite and not negative, got {camera.aperture_radius}")
    if not camera.focus_distance > 0.0:
        raise SceneError(f"camera: focus_distance must be positive, or inf, got {camera.focus_distance}")
    if camera.aperture_radius > WIDEST * camera.focus_distance:
        raise SceneError(
            f"camera: focus_distance must not be below {1.0 / WIDEST:.0e} of aperture_radius, "
            f"got {camera.focus_distance} and {camera.aperture_radius}"
        )
    if camera.aperture_blades != 0 and camera.aperture_blades < 3:
        raise SceneError(f"camera: aperture_blades must be 0, a disk, or at least 3, got {camera.aperture_blades}")
    if not math.isfinite(camera.aperture_rotation):
        raise SceneError(f"camera: aperture_rotation must be finite, got {camera.aperture_rotation}")


def check_filter(described: d.Filter) -> None:
    if not (0.0 < described.radius <= WIDEST_FILTER and described.stddev > 0.0):
        raise SceneError(
            f"camera: the pixel filter needs a positive radius, at most {WIDEST_FILTER:g} pixels, got {described}"
        )
    sizes = (described.radius, described.stddev)
    if described.kind == "gaussian" and not (min(sizes) >= 1.0 / WIDEST_FILTER and max(sizes) <= 1e3 * min(sizes)):
        raise SceneError(
            f"camera: radius and stddev of a gaussian must be at least {1.0 / WIDEST_FILTER:g} pixels, and one at most "
            f"1000 times the other, got {described}"
        )


def half_extents(camera: d.Camera) -> tuple[float, float]:
    """Tangents of half the field of view, across and down."""
    tangent, aspect = math.tan(math.radians(camera.fov) / 2.0), camera.width / camera.height
    axis = camera.fov_axis
    if axis == "diagonal":
        return tangent * aspect / math.hypot(aspect, 1.0), tangent / math.hypot(aspect, 1.0)
    if axis == "smaller":
        axis = "y" if aspect > 1.0 else "x"
    elif axis == "larger":
        axis = "x" if aspect > 1.0 else "y"
    return (tangent, tangent / aspect) if axis == "x" else (tangent * aspect, tangent)
