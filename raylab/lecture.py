"""The words of the lecture: all that a student's file may import from raylab, in one place.

    from raylab.lecture import PI, Vec3, black, dist_sqr, dot, normalize, shadow

Nothing is defined here. Vectors and colours: `raylab.vec3`; points and shadow rays: `raylab.point`, `raylab.shadow`;
maps from the unit square: `raylab.sampling`; weights of two techniques: `raylab.mis`; what a ray meets:
`light_from` (`raylab.glossy`) and `seen_toward` (`raylab.beyond`). `njit` may be written, and is not needed.
"""

from __future__ import annotations

from raylab.beyond import seen_toward
from raylab.brdf import reflect
from raylab.glossy import light_from
from raylab.jit import njit
from raylab.lights import to_area
from raylab.mis import balance, balance_of, power, power_of
from raylab.point import Point, dist_sqr
from raylab.sampling import (
    PI,
    cos_power,
    frame,
    from_frame,
    invert_cos_hemisphere,
    invert_hemisphere,
    lift,
    pdf_concentric_disk,
    pdf_cone,
    pdf_cos_hemisphere,
    pdf_disk,
    pdf_hemisphere,
    pdf_phong_lobe,
    pdf_sphere,
    pdf_triangle,
    sample_concentric_disk,
    sample_cone,
    sample_cos_hemisphere,
    sample_disk,
    sample_hemisphere,
    sample_phong_lobe,
    sample_sphere,
    sample_triangle,
)
from raylab.shadow import shadow, shadow_toward
from raylab.vec3 import Vec3, absolute, black, cross, dot, is_finite, length, luminance, normalize

__all__ = [
    "PI", "Point", "Vec3", "absolute", "balance", "balance_of", "black", "cos_power", "cross", "dist_sqr", "dot",
    "frame", "from_frame", "invert_cos_hemisphere", "invert_hemisphere", "is_finite", "length", "lift", "light_from",
    "luminance", "njit", "normalize", "pdf_concentric_disk", "pdf_cone", "pdf_cos_hemisphere", "pdf_disk",
    "pdf_hemisphere", "pdf_phong_lobe", "pdf_sphere", "pdf_triangle", "power", "power_of", "reflect",
    "sample_concentric_disk", "sample_cone", "sample_cos_hemisphere", "sample_disk", "sample_hemisphere",
    "sample_phong_lobe", "sample_sphere", "sample_triangle", "seen_toward", "shadow", "shadow_toward", "to_area",
]  # fmt: skip
