"""basic: the slides' basic ray tracer (Whitted 1980, "An improved illumination model for shaded display").

One shadow ray for every point light, one reflection ray, possibly one refraction ray, per intersection: no random
number but the pixel's, hence hard shadows and perfect mirrors. An area light counts as a point light of intensity
I = L A cos(theta_s) in its middle. Surfaces see the sky in mirrors and through glass only.

The recursion ends when a path has `scene.max_depth` rays, eye ray and shadow ray included; light that would come by a
longer way is left out. Each boundary of glass doubles the rays, at most 2^(max_depth - 1) in all.
"""

from __future__ import annotations

from typing import NamedTuple

from raylab.brdf import reflect
from raylab.direct import follow, met
from raylab.jit import njit
from raylab.record import record
from raylab.shade import area, directional_light, point_light
from raylab.surface import BACK, FRONT
from raylab.vec3 import black, luminance


@njit
def basic(x, V, brdf, N, scene, rng):
    """Slide "Basic ray tracing": shadow rays to point lights, mirrors and glass by recursion."""
    return radiance(x, V, brdf, N, scene, scene.max_depth - 1)


@njit
def radiance(x, V, brdf, N, scene, rays):
    """What leaves x toward V, found with at most `rays` more rays in a row."""
    if rays <= 0:
        return black
    result = black
    if not brdf.is_specular():
        result += point_light(x, V, brdf, N, scene, MIDDLE) + directional_light(x, V, brdf, N, scene, MIDDLE)
        result += area(x, V, brdf, N, scene, MIDDLE)
    for w, share in ((reflect(V, N), brdf.reflection(V, N)), brdf.refraction(V, N)):
        if luminance(share) > 0.0:
            hit = follow(scene, x, w)
            light = met(scene, hit, w)
            material = scene.shapes[hit.shape, FRONT if hit.front else BACK] if hit.found else -1
            if material >= 0:
                light += radiance(hit.x, -w, scene.materials.at(material, hit.N, hit.uv), hit.N, scene, rays - 1)
            result += light * share
    return result


@record
class Middle(NamedTuple):
    """Not random at all: every point of the square is its middle, which the shapes map to their own."""

    half: float = 0.5

    def square(self):
        return self.half, self.half


MIDDLE = Middle()
