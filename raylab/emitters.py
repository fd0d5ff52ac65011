"""From described lights to the rows that `raylab.lights` reads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab import lights, quadrics
from raylab.errors import SceneError
from raylab.geometry import Placement
from raylab.order import order
from raylab.point import plane_table
from raylab.record import Table
from raylab.view import View

Array = npt.NDArray[np.float64]
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
_SHAPES = {
    lights.TRIANGLE: ("triangle", lights.TriangleShape()),
    lights.RECTANGLE: ("rectangle", lights.RectangleShape()),
    lights.DISK: ("disk", lights.DiskShape()),
    lights.SPHERE: ("sphere", lights.SphereShape()),
    lights.CYLINDER: ("cylinder", lights.CylinderShape()),
}
_NO_AREA = "shape {!r}: an area light needs an area that is not 0 beside the size of the scene"


def colour(value: Any, what: str) -> Array:
    """`value` as a linear RGB triple; SceneError unless it is finite and not negative."""
    rgb = np.asarray(value, np.float64)
    if rgb.shape not in ((), (3,)):
        raise SceneError(f"{what} must be one number or an RGB triple, got shape {rgb.shape}")
    rgb = np.broadcast_to(rgb, 3)
    if not np.all(np.isfinite(rgb)) or rgb.min() < 0.0:
        raise SceneError(f"{what} must be finite and not negative, got {rgb.tolist()}")
    return rgb


class AreaLights:
    """Collects the area lights of a scene, shape by shape."""

    def __init__(self) -> None:
        self.rows: list[Array] = []
        self.corners: list[Array] = []
        self.shares: list[Array] = []

    def add_mesh(self, shape: d.Shape, kind: str, vertices: Array, faces: npt.NDArray[np.uint32]) -> int:
        """A mesh light over normalised vertices; returns its number."""
        corners = vertices[faces]
        if kind == "rectangle" and len(faces) == 2:
            v0, v1, v3 = vertices[[0, 1, 3]] if not is_reversed(faces) else vertices[[0, 3, 1]]
            return self._add_flat(shape, lights.RECTANGLE, np.array([v0, v1, v3]), 1.0)
        if len(faces) == 1:
            return self._add_flat(shape, lights.TRIANGLE, corners[0], 0.5)
        areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        if not areas.sum() > 0.0:
            raise SceneError(_NO_AREA.format(shape.name))
        shares = np.cumsum(areas) / areas.sum()
        shares[-1] = 1.0
        first = sum(len(s) for s in self.shares)
        self.corners.append(corners.reshape(-1, 3))
        self.shares.append(shares)
        return self._add(shape, lights.MESH, area=float(areas.sum()), first=first, triangles=len(faces))

    def add_quadric(self, shape: d.Shape, row: Array) -> int:
        """A sphere, disk or cylinder light from its normalised quadric row; returns its number."""
        p, to_world, side = row[1:4], np.linalg.inv(row[4:13].reshape(3, 3)), row[13]
        a, b, c = to_world.T
        if row[0] == quadrics.DISK:
            n = row[10:13] * side  # the row of the world-to-local matrix: it keeps its side under a mirror
            area = np.pi * float(np.linalg.norm(np.cross(a, b)))
            return self._add(shape, lights.DISK, p=p, e1=a, e2=b, n=n / np.linalg.norm(n), area=area)
        radius = float(np.linalg.norm(a))
        scaled = to_world.T @ to_world / radius**2
        round_axes = 3 if row[0] == quadrics.SPHERE else 2
        if (
            np.abs(scaled[:round_axes, :] - np.diag(np.diag(scaled))[:round_axes, :]).max() > 1e-9
            or abs(scaled[1, 1] - 1) > 1e-9
        ):
            raise SceneError(
                f"shape {shape.name!r}: an area light on a sphere or cylinder must not be stretched or sheared"
            )
        if row[0] == quadrics.SPHERE:
            if abs(scaled[2, 2] - 1) > 1e-9:
                raise SceneError(f"shape {shape.name!r}: an area light on a sphere must not be stretched")
            area = 4 * np.pi * radius**2
            return self._add(shape, lights.SPHERE, p=p, e1=[radius, 0, 0], e2=[side, 0, 0], area=area)
        area = 2 * np.pi * radius * float(np.linalg.norm(c))
        return self._add(shape, lights.CYLINDER, p=p, e1=a, e2=b, n=c, tilt=[side, 0, 0], area=area)

    def _add_flat(self, shape: d.Shape, kind: int, corners: Array, share: float) -> int:
        row = plane_table(corners[None])[0]
        n, slack, tilt = row[:3], row[4], row[5:]
        e1, e2 = corners[1] - corners[0], corners[2] - corners[0]
        area = share * float(np.linalg.norm(np.cross(e1, e2)))
        if not area > 0.0:
            raise SceneError(_NO_AREA.format(shape.name))
        return self._add(shape, kind, p=corners[0], e1=e1, e2=e2, n=n, area=area, slack=slack, tilt=tilt)

    def _add(
        self,
        shape: d.Shape,
        kind: int,
        area: float,
        slack: float = 0.0,
        first: int = 0,
        triangles: int = 0,
        **vectors: Any,
    ) -> int:
        """Append the row of a light; the vectors p, e1, e2, n and tilt are zero unless given."""
        radiance = colour(shape.radiance, f"shape {shape.name!r}: radiance")
        p, e1, e2, n, tilt = (vectors.get(name, np.zeros(3)) for name in ("p", "e1", "e2", "n", "tilt"))
        self.rows.append(np.concatenate([[kind], radiance, p, e1, e2, n, [area, slack], tilt, [first, triangles]]))
        return len(self.rows) - 1

    def power(self) -> Array:
        """Luminance times area of each light: its power, but for a factor of pi and the unit of length."""
        rows = np.array(self.rows).reshape(-1, lights.ROW)
        return rows[:, 1:4] @ LUMINANCE * rows[:, 16]

    def table(self) -> Table:
        """`scene.lights`, compiled for the kinds that occur."""
        if not self.rows:
            return Table(lights.NoLight, np.zeros((0, lights.ROW)))
        rows = np.stack(self.rows)
        present: dict[str, Any] = dict(_SHAPES[kind] for kind in sorted({int(k) for k in rows[:, 0]} - {lights.MESH}))
        if self.shares:
            present["mesh"] = lights.MeshShape(View(np.concatenate(self.corners)), View(np.concatenate(self.shares)))
        return Table(lights.AreaLight, rows, lights.Shapes(**present))


def is_reversed(faces: npt.NDArray[np.uint32]) -> bool:
    return bool(faces[0, 0] != 0)


def point_table(described: Sequence[d.Light], placement: Placement) -> Table:
    """`scene.points`, by position: intensity in normalised units (W/sr scale with length squared) and position."""
    found = [light for light in described if isinstance(light, d.PointLight)]
    if not found:
        return Table(lights.NoLight, np.zeros((0, 6)))
    rows = []
    for light in found:
        position = np.asarray(light.position, np.float64)
        if position.shape != (3,) or not np.all(np.isfinite(position)):
            raise SceneError(f"point light: position must be three finite numbers, got {position.tolist()}")
        intensity = colour(light.intensity, "point light: intensity")
        with np.errstate(over="ignore"):
            row = np.concatenate([intensity * placement.scale**2, placement.points(position)])
        if not np.all(np.isfinite(row)):
            raise SceneError(
                f"point light: in units of the scene its intensity or its position is beyond float64, got "
                f"{intensity.tolist()} at {position.tolist()}"
            )
        rows.append(row)
    return Table(lights.PointLight, _ordered(rows, found))


def sun_table(described: Sequence[d.Light]) -> Table:
    """`scene.suns`, by direction: irradiance and the unit direction to the light."""
    found = [light for light in described if isinstance(light, d.DirectionalLight)]
    if not found:
        return Table(lights.NoLight, np.zeros((0, 6)))
    rows = []
    for light in found:
        towards = np.asarray(light.direction, np.float64)
        if towards.shape != (3,) or not (np.all(np.isfinite(towards)) and towards.any()):
            raise SceneError(f"directional light: direction must be a finite vector, not zero, got {towards.tolist()}")
        towards = np.ldexp(
            towards, -np.frexp(np.abs(towards).max())[1]
        )  # exact; so that no square overflows or vanishes
        towards = towards / np.linalg.norm(towards)
        rows.append(np.concatenate([colour(light.irradiance, "directional light: irradiance"), -towards]))
    return Table(lights.DirectionalLight, _ordered(rows, found))


def _ordered(rows: list[Array], found: Sequence[d.Light]) -> Array:
    """Rows of three colours and three coordinates, by the latter."""
    table = np.stack(rows)
    return table[order(table[:, 3:], found)]
