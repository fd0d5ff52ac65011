"""Own lens: a scene seen through a student's lens (slide "Depth of field").

The camera is a record like `raylab.camera.ThinLens`; where that works out the point on the aperture and the direction
of the ray, this one calls the student's functions, in the coordinates of the camera: left x, up y, forward z.
"""

from __future__ import annotations

import copy
from typing import Any, NamedTuple

from raylab.camera import ThinLens
from raylab.embree import TNEAR
from raylab.errors import UserError
from raylab.lanes import FILM
from raylab.record import record
from raylab.scene import Scene
from raylab.surface import round32
from raylab.vec3 import Vec3, cross, dot, length


class Lens(NamedTuple):
    """What the record holds: the camera of the scene, its axis, the aperture's radius, the distance of the focus."""

    eye: Any
    forward: Vec3
    radius: float
    focus: float


def through(scene: Scene, sample_aperture: Any, lens_direction: Any) -> Scene:
    """The scene with another lens; UserError if it has none. The functions take numbers in the scene's own scale."""
    eye, described = scene.camera, scene.description.camera
    if not isinstance(eye, ThinLens) or described.aperture_blades:
        raise UserError(
            "to look through your lens, the scene needs a camera of type thinlens that stands still, with a round "
            f"aperture_radius above 0, as focus.xml has it; this one has {_found(described, eye)}"
        )

    def draw(self, rng):
        return rng.square(), rng.square()

    def draw_lanes(self, lanes):
        lanes.squares(FILM, 2)

    def ray(self, column, row, film, lens, time):
        eye = self.eye
        dx, dy = eye.filter.sample(film)
        toward = eye.corner + eye.across * (column + 0.5 + dx) + eye.down * (row + 0.5 + dy)
        px, py = sample_aperture(self.radius, lens)
        own = lens_direction(Vec3(dot(toward, eye.left), dot(toward, eye.up), 1.0), self.focus, px, py)
        d = eye.left * own.x + eye.up * own.y + self.forward * own.z
        o = eye.origin + eye.left * px + eye.up * py
        start = eye.start
        if eye.wide:
            start = max(start, (length(o) - 2.0) / length(d))
        return round32(o + d * start), round32(d), max(TNEAR, eye.far - start)

    methods = {"draw": draw, "draw_lanes": draw_lanes, "ray": ray}
    made: Any = type("OwnLens", (Lens,), {**methods, "__module__": __name__, "__slots__": ()})
    seen, scale = copy.copy(scene), scene.placement.scale
    forward = cross(eye.left, eye.up)
    seen.camera = record(made)(eye, forward, described.aperture_radius * scale, described.focus_distance * scale)
    return seen


def _found(described: Any, eye: Any) -> str:
    if described.motion is not None:
        return "one that moves"
    return f"an aperture of {described.aperture_blades} blades" if isinstance(eye, ThinLens) else "a pinhole"
