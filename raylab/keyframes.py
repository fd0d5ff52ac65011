"""From keyframes to motion: checked, decomposed, cut to the shutter interval, and put in numbers for `raylab.pose`.

A keyframe is decomposed as M = T R S: translation, rotation and symmetric stretch, by its singular values (Shoemake
and Duff 1992, "Matrix animation and polar decomposition"). A mirrored one has a negative stretch.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.errors import SceneError
from raylab.pose import PIECE_COLUMNS

Array = npt.NDArray[np.float64]
Shutter = tuple[float, float]
TOLERANCE = 2.0**-13  # of the size of a mesh and its path: how far its chords may stand off its curved path
MOST_SEGMENTS = 128  # Embree takes 129 time steps
LONGEST = 2.0**100  # 1.3e30: a time, or one over a time, whose square and that of a velocity is a number
_Moved = TypeVar("_Moved", d.Shape, d.Camera)


def check(motion: d.Animation, what: str) -> None:
    """Raise SceneError unless the keyframes make sense."""
    times, matrices = np.asarray(motion.times, np.float64), np.asarray(motion.matrices, np.float64)
    if times.ndim != 1 or len(times) < 2 or matrices.shape != (len(times), 4, 4):
        raise SceneError(f"{what}: an animation needs two keyframes or more, got {times.size} times")
    if not (np.all(np.abs(times) <= LONGEST) and np.all(np.diff(times) >= 1.0 / LONGEST)):
        raise SceneError(
            f"{what}: the times of keyframes must be finite and increase, by {1.0 / LONGEST:.2g} or more and not "
            f"beyond {LONGEST:.2g}, got {times.tolist()}"
        )
    for time, m in zip(times, matrices, strict=True):
        if not np.all(np.isfinite(m)) or not np.array_equal(m[3], [0, 0, 0, 1]):
            raise SceneError(f"{what}: the matrix at time {time:g} must be finite and affine")
        if np.linalg.cond(m[:3, :3]) > 1e12:
            raise SceneError(f"{what}: the matrix at time {time:g} squeezes space flat (it is singular)")
    if len(set(np.linalg.slogdet(matrices[:, :3, :3])[0])) > 1:
        raise SceneError(f"{what}: keyframes must not turn a shape inside out: some mirror it and some do not")


def decompose(matrix: Array) -> tuple[Array, Array, Array]:
    """Translation (3,), rotation (3, 3) and symmetric stretch (3, 3) with matrix = T R S."""
    rotation, stretch = matrix[:3, :3], np.eye(3)
    if np.abs(rotation.T @ rotation - stretch).max() > 8 * np.finfo(float).eps:  # else it is a rotation, or mirrors
        u, values, vt = np.linalg.svd(rotation)
        rotation, stretch = u @ vt, vt.T * values @ vt
    sign = np.sign(np.linalg.det(rotation))
    return matrix[:3, 3], rotation * sign, stretch * sign


def rotation_between(first: Array, last: Array) -> Array:
    """The axis times the angle, radians, that turns one rotation into another; small angles from their difference."""
    d = first.T @ (last - first)  # R - I
    if np.abs(d).max() > 1e-3:
        from scipy.spatial.transform import Rotation

        return np.asarray(Rotation.from_matrix(first.T @ last).as_rotvec())
    v = np.array([d[2, 1] - d[1, 2], d[0, 2] - d[2, 0], d[1, 0] - d[0, 1]]) / 2.0  # the axis times the sine
    sine = float(np.linalg.norm(v))
    return v * (math.asin(sine) / sine) if sine > 0.0 else v


@dataclass(frozen=True)
class Piece:
    """Motion between two times: even in translation, stretch and angle. `axis` has length 1."""

    start: float
    end: float
    translation: tuple[Array, Array]
    rotation: Array  # at the start
    axis: Array
    angle: float  # radians, up to the end
    stretch: tuple[Array, Array]

    @classmethod
    def between(cls, start: float, end: float, first: Array, last: Array) -> Piece:
        """From one keyframe to the next, the shorter way round."""
        (t0, r0, s0), (t1, r1, s1) = decompose(first), decompose(last)
        same = np.array_equal(first[:3, :3], last[:3, :3])
        turn = np.zeros(3) if same else rotation_between(r0, r1)
        angle = float(np.linalg.norm(turn))
        axis = turn / angle if angle > 0.0 else np.array([0.0, 0.0, 1.0])
        return cls(start, end, (t0, t1), r0, axis, angle, (s0, s1))

    def matrix(self, time: float) -> Array:
        """The (4, 4) matrix at a time."""
        s = (time - self.start) / (self.end - self.start)
        result = np.eye(4)
        stretch = self.stretch[0] + s * (self.stretch[1] - self.stretch[0])
        result[:3, :3] = self.rotation @ rotation_about(self.axis, s * self.angle) @ stretch
        result[:3, 3] = self.translation[0] + s * (self.translation[1] - self.translation[0])
        return result

    def cut(self, start: float, end: float) -> Piece:
        """The part of the motion between two times within it."""

        def mixed(pair: tuple[Array, Array], s: float) -> Array:
            mixture: Array = pair[0] + s * (pair[1] - pair[0])
            return mixture

        a, b = ((t - self.start) / (self.end - self.start) for t in (start, end))
        return replace(
            self,
            start=start,
            end=end,
            translation=(mixed(self.translation, a), mixed(self.translation, b)),
            rotation=self.rotation @ rotation_about(self.axis, a * self.angle),
            angle=(b - a) * self.angle,
            stretch=(mixed(self.stretch, a), mixed(self.stretch, b)),
        )

    def row(self, shutter: Shutter, local: Array, centre: Array, scale: float) -> Array:
        """The row of `raylab.pose`: local coordinates through `local`, then the motion, then (x - centre) scale."""
        opened, length = shutter[0], shutter[1] - shutter[0]
        k = _cross(self.axis)
        a, b, c = self.rotation @ (np.eye(3) + k @ k), self.rotation @ k, -self.rotation @ k @ k
        t0, t1 = ((t - centre) * scale for t in self.translation)
        s0, s1 = ((s * scale) @ local[:3] for s in self.stretch)
        times = [(self.start - opened) / length, (self.end - opened) / length, self.angle]
        return np.concatenate([times, t0, t1 - t0, a.ravel(), b.ravel(), c.ravel(), s0.T.ravel(), (s1 - s0).T.ravel()])

    def acceleration(self, points: Array) -> float:
        """Bound on |x''| over the piece for local points (n, 3): w^2 |S x| + 2 w |S' x|."""
        speed, duration = self.angle / (self.end - self.start), self.end - self.start
        reach = max(float(np.linalg.norm(points @ s.T, axis=1).max()) for s in self.stretch)
        growth = float(np.linalg.norm(points @ (self.stretch[1] - self.stretch[0]).T, axis=1).max()) / duration
        return speed * speed * reach + 2.0 * speed * growth

    def velocity(self, points: Array, time: float) -> Array:
        """(n, 3): T' + R' S x + R S' x."""
        duration, s = self.end - self.start, (time - self.start) / (self.end - self.start)
        r = self.rotation @ rotation_about(self.axis, s * self.angle)
        turning = r @ _cross(self.axis) * (self.angle / duration)
        stretch = self.stretch[0] + s * (self.stretch[1] - self.stretch[0])
        linear = turning @ stretch + r @ (self.stretch[1] - self.stretch[0]) / duration
        result: Array = (self.translation[1] - self.translation[0]) / duration + points @ linear.T
        return result


def _cross(n: Array) -> Array:
    return np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])


def rotation_about(axis: Array, angle: float) -> Array:
    """Rodrigues: I + sin(a) [n]_x + (1 - cos(a)) [n]_x^2."""
    k = _cross(axis)
    result: Array = np.eye(3) + math.sin(angle) * k + (1.0 - math.cos(angle)) * (k @ k)
    return result


def matrix_at(motion: d.Animation, time: float) -> Array:
    """The (4, 4) matrix at a time; at a keyframe its own matrix, bit for bit."""
    times, matrices = motion.times, motion.matrices
    i = int(np.searchsorted(times, time))
    if i == 0 or i == len(times) or times[i] == time:
        return np.asarray(matrices[min(i, len(times) - 1)], np.float64)
    return Piece.between(times[i - 1], times[i], matrices[i - 1], matrices[i]).matrix(time)


def pieces(motion: d.Animation, shutter: Shutter) -> list[Piece]:
    """The motion within the shutter interval; before the first and after the last keyframe it stands still."""
    times, matrices = motion.times, motion.matrices
    whole = [
        Piece.between(times[i], times[i + 1], matrices[i], matrices[i + 1])
        for i in range(len(times) - 1)
        if times[i] < shutter[1] and times[i + 1] > shutter[0]
    ]
    if times[0] > shutter[0]:
        whole.insert(0, Piece.between(shutter[0], min(times[0], shutter[1]), matrices[0], matrices[0]))
    if times[-1] < shutter[1]:
        whole.append(Piece.between(max(times[-1], shutter[0]), shutter[1], matrices[-1], matrices[-1]))
    return [p.cut(max(p.start, shutter[0]), min(p.end, shutter[1])) for p in whole]


def table(motion: d.Animation, shutter: Shutter, local: Array, centre: Array, scale: float) -> Array:
    """(n, PIECE_COLUMNS): the rows of `raylab.pose` in normalised coordinates."""
    rows = np.array([p.row(shutter, local, centre, scale) for p in pieces(motion, shutter)])
    return rows.reshape(-1, PIECE_COLUMNS)


def chord_error(motion: d.Animation, shutter: Shutter, points: Array, segments: int) -> float:
    """How far local `points` (n, 3) can stand off chords between `segments` + 1 equal time steps, at most.

    In a step of length h: h^2 / 8 max |x''|, for a rotation r (dtheta)^2 / 8; and h / 4 |change of velocity| for each
    keyframe inside it.
    """
    parts, step = pieces(motion, shutter), (shutter[1] - shutter[0]) / segments
    bends = [(b.start, float(np.linalg.norm(b.velocity(points, b.start) - a.velocity(points, a.end), axis=1).max()))
             for a, b in pairwise(parts)]  # fmt: skip
    worst = 0.0
    for k in range(segments):
        low, high = shutter[0] + k * step, shutter[0] + (k + 1) * step
        within = [p for p in parts if p.start < high and p.end > low] or parts  # all, if the step is lost in rounding
        curved = max(p.acceleration(points) for p in within) * step * step / 8.0
        slack = 1e-12 * step  # a keyframe on a time step makes no error
        kinked = sum(bend * step / 4.0 for time, bend in bends if low + slack < time < high - slack)
        worst = max(worst, curved + kinked)
    return worst


def segments_needed(motion: d.Animation, shutter: Shutter, points: Array) -> tuple[int, float]:
    """The least power of two of chords that stay within TOLERANCE of the path's size, and their error bound."""
    path = np.concatenate([points @ m[:3, :3].T + m[:3, 3] for m in samples(motion, shutter, 16)])
    size = float(np.ptp(path, axis=0).max())
    segments = 1
    while chord_error(motion, shutter, points, segments) > TOLERANCE * size and segments < MOST_SEGMENTS:
        segments *= 2
    return segments, chord_error(motion, shutter, points, segments)


def samples(motion: d.Animation, shutter: Shutter, segments: int) -> list[Array]:
    """The matrices at the ends of `segments` equal parts of the shutter interval."""
    return [matrix_at(motion, shutter[0] + (shutter[1] - shutter[0]) * k / segments) for k in range(segments + 1)]


def moves(motion: d.Animation | None, shutter: Shutter) -> bool:
    """Whether anything changes while the shutter is open."""
    if motion is None or not shutter[0] < shutter[1]:
        return False
    inside = [m for t, m in zip(motion.times, motion.matrices, strict=True) if shutter[0] < t < shutter[1]]
    first = matrix_at(motion, shutter[0])
    return any(not np.array_equal(first, m) for m in (*inside, matrix_at(motion, shutter[1])))


def at_rest(description: d.SceneDescription) -> d.SceneDescription:
    """The scene with everything that does not move while the shutter is open put in its place."""
    camera = description.camera
    shutter = (camera.shutter_open, camera.shutter_close)
    if not (math.isfinite(shutter[0]) and math.isfinite(shutter[1]) and shutter[0] <= shutter[1]):
        raise SceneError(f"camera: expected finite shutter_open <= shutter_close, got {shutter[0]} and {shutter[1]}")
    if max(map(abs, shutter)) > LONGEST or 0.0 < shutter[1] - shutter[0] < 1.0 / LONGEST:
        raise SceneError(
            f"camera: the shutter must be open for no time or at least {1.0 / LONGEST:.2g}, and its times not beyond "
            f"{LONGEST:.2g}, got {shutter[0]} and {shutter[1]}"
        )
    if camera.motion is None and all(shape.motion is None for shape in description.shapes):
        return description
    still: Callable[..., d.Shape] = _put
    shapes = tuple(still(shape, shutter, f"shape {shape.name!r}") for shape in description.shapes)
    return replace(description, camera=_put(camera, shutter, "camera"), shapes=shapes)


def _put(thing: _Moved, shutter: Shutter, what: str) -> _Moved:
    if thing.motion is None:
        return thing
    check(thing.motion, what)
    place = matrix_at(thing.motion, shutter[0])
    return replace(thing, to_world=place, motion=thing.motion if moves(thing.motion, shutter) else None)
