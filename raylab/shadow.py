"""shadow: the slides ask it of a point on a light and of a direction; here these are two functions.

Both ends of a shadow ray are moved off their surfaces by the bound of `raylab.point`. A surface shadows itself: what
lies below its horizon, or sees only the back of a light, is in shadow without a ray.
"""

from __future__ import annotations

import math

from raylab.embree import blocked
from raylab.jit import njit
from raylab.surface import DEGENERATE_SAMPLES, INVALID_RAYS, SHADOW_RAYS, direction32, is_valid_ray, round32
from raylab.vec3 import absolute, dot


@njit
def shadow(scene, x, y):
    """True when something stands between the points x and y (slide: shadow(x, y)).

    Where x is in the plane of the light, up to rounding, no light can be told from no light: counted, and in shadow.
    """
    d = y - x
    reach = y.slack + dot(y.tilt, absolute(d))
    facing = -dot(y.n, d)
    if dot(x.n, d) <= 0.0 or facing < reach:
        if facing >= 0.0 and dot(x.n, d) > 0.0:
            scene.tally[DEGENERATE_SAMPLES] += 1
        return True
    origin = round32(x.p + x.n * x.slack)
    return is_blocked(scene, origin, round32(y.p + y.n * reach - origin), 1.0)


@njit
def shadow_toward(scene, x, w):
    """True when something stands in the direction w seen from x (slide: shadow(x, w))."""
    if dot(x.n, w) <= 0.0:
        return True
    return is_blocked(scene, round32(x.p + x.n * x.slack), direction32(w), math.inf)


@njit
def is_blocked(scene, o, d, tfar):
    """Trace a shadow ray, and count it; an invalid ray is counted as such and lets no light through."""
    if not (is_valid_ray(o, d) and tfar > 0.0):
        scene.tally[INVALID_RAYS] += 1
        return True
    scene.tally[SHADOW_RAYS] += 1
    return blocked(scene.embree, o, d, tfar, scene.motion.time())
